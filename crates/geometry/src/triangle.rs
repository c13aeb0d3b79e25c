//! The watertight ray-triangle test of Woop, Benthin and Wald (2013).

use manylight_math::{Ray, Vec3};

/// A ray with the shear that takes its direction to the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    pub origin: Vec3,
    pub axes: [usize; 3],
    pub shear: Vec3,
}

impl ShearedRay {
    pub fn new(ray: &Ray) -> Self {
        let d = ray.dir.to_array();
        let kz = if d[0].abs() > d[1].abs() && d[0].abs() > d[2].abs() {
            0
        } else if d[1].abs() > d[2].abs() {
            1
        } else {
            2
        };
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        if d[kz] < 0.0 {
            std::mem::swap(&mut kx, &mut ky); // keeps the winding
        }
        ShearedRay {
            origin: ray.origin,
            axes: [kx, ky, kz],
            shear: Vec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]),
        }
    }
    /// Distance and barycentrics (b1, b2) of the second and third vertex, for a hit in (0, t_max). The tree does the same by
    /// eight; this is what it is held against.
    #[cfg(test)]
    pub fn intersect(&self, v: &[Vec3; 3], t_max: f32) -> Option<(f32, f32, f32)> {
        let [kx, ky, kz] = self.axes;
        let (a, b, c) = (v[0] - self.origin, v[1] - self.origin, v[2] - self.origin);
        let sheared = |p: Vec3| (p[kx] - self.shear.x * p[kz], p[ky] - self.shear.y * p[kz]);
        let ((ax, ay), (bx, by), (cx, cy)) = (sheared(a), sheared(b), sheared(c));
        let (mut u, mut v, mut w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        if u == 0.0 || v == 0.0 || w == 0.0 {
            // On an edge in f32: decide in f64, where the products are exact.
            let cross = |p: (f32, f32), q: (f32, f32)| (p.0 as f64 * q.1 as f64 - p.1 as f64 * q.0 as f64) as f32;
            (u, v, w) = (cross((cx, cy), (bx, by)), cross((ax, ay), (cx, cy)), cross((bx, by), (ax, ay)));
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        let t = self.shear.z * (u * a[kz] + v * b[kz] + w * c[kz]) / det;
        // NaN (a degenerate triangle has det = 0) fails both comparisons.
        (t > 0.0 && t < t_max).then(|| (t, v / det, w / det))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vec3(r: f32) -> impl Strategy<Value = Vec3> {
        (-r..r, -r..r, -r..r).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }
    proptest! {
        #[test]
        fn the_hit_is_where_the_ray_and_the_barycentrics_say(v in [vec3(5.0), vec3(5.0), vec3(5.0)], u in 0.01f32..0.98, w in 0.01f32..0.98, o in vec3(20.0)) {
            prop_assume!(u + w < 0.99);
            let target = v[0] * (1.0 - u - w) + v[1] * u + v[2] * w;
            let Some(dir) = (target - o).try_normalize() else { return Ok(()) };
            let n = (v[1] - v[0]).cross(v[2] - v[0]);
            prop_assume!(n.length() > 0.1 && n.normalize().dot(dir).abs() > 0.05);
            let (t, b1, b2) = ShearedRay::new(&Ray::new(o, dir)).intersect(&v, f32::INFINITY).expect("aimed inside");
            let p = v[0] * (1.0 - b1 - b2) + v[1] * b1 + v[2] * b2;
            prop_assert!((p - (o + dir * t)).length() < 2e-4 && (p - target).length() < 2e-4);
        }
    }
    #[test]
    fn a_degenerate_triangle_is_never_hit() {
        let ray = ShearedRay::new(&Ray::new(Vec3::Z, Vec3::NEG_Z));
        assert!(ray.intersect(&[Vec3::ZERO; 3], f32::INFINITY).is_none());
        assert!(ray.intersect(&[Vec3::NEG_X, Vec3::ZERO, Vec3::X], f32::INFINITY).is_none());
    }
    #[test]
    fn nothing_behind_or_beyond_is_hit() {
        let v = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        assert!(ShearedRay::new(&Ray::new(Vec3::Z, Vec3::Z)).intersect(&v, f32::INFINITY).is_none());
        assert!(ShearedRay::new(&Ray::new(Vec3::Z, Vec3::NEG_Z)).intersect(&v, 1.0).is_none());
        assert!(ShearedRay::new(&Ray::new(Vec3::Z, Vec3::NEG_Z)).intersect(&v, 1.001).is_some());
    }
}
