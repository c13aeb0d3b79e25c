//! Shapes with a closed-form intersection: spheres and discs.

use manylight_math::{Aabb, Frame, Ray, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// \[m\]
    pub centre: Vec3,
    /// Positive. \[m\]
    pub radius: f32,
    /// Orientation of its texture coordinates: u is the azimuth around `n` over 2 pi, v the polar angle over pi.
    pub frame: Frame,
    /// Normals point inwards.
    pub flipped: bool,
}

impl Sphere {
    /// With normals outwards and a frame along the axes.
    pub fn new(centre: Vec3, radius: f32) -> Self {
        Sphere { centre, radius, frame: Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z }, flipped: false }
    }
    /// [m^2]
    pub fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }
    pub(crate) fn bounds(&self) -> Aabb {
        Aabb { lo: self.centre - self.radius, hi: self.centre + self.radius }
    }
    /// Distance to the first hit in (0, t_max).
    pub(crate) fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.roots(ray)?.into_iter().find(|t| *t > 0.0 && *t < t_max)
    }
    /// Both hits in (0, t_max).
    pub(crate) fn both(&self, ray: &Ray) -> [Option<f32>; 2] {
        let inside = |t: &f32| *t > 0.0 && *t < ray.t_max;
        self.roots(ray).map_or([None; 2], |roots| roots.map(|t| Some(t).filter(inside)))
    }
    /// Where the line meets it, the nearer first; f64, so that far and huge spheres keep their digits.
    fn roots(&self, ray: &Ray) -> Option<[f32; 2]> {
        let d = ray.dir.as_dvec3();
        let o = (ray.origin - Vec3::ZERO).as_dvec3() - self.centre.as_dvec3();
        let (a, b) = (d.length_squared(), o.dot(d));
        let r2 = (self.radius as f64).powi(2);
        // |o - (o.d/a) d|^2 instead of b^2 - a c: no cancellation far away (Haines et al. 2019).
        let h2 = r2 - (o - d * (b / a)).length_squared();
        if !(h2 >= 0.0) {
            return None;
        }
        let root = (h2 * a).sqrt();
        let q = -b - root.copysign(b);
        let (t0, t1) = (q / a, (o.length_squared() - r2) / q);
        let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
        Some([near as f32, far as f32])
    }
    /// The point in a unit direction from the centre, and its outward or inward normal.
    pub(crate) fn surface(&self, out: Vec3) -> (Vec3, Vec3) {
        (self.centre + out * self.radius, if self.flipped { -out } else { out })
    }
    pub(crate) fn uv(&self, normal: Vec3) -> Vec2 {
        let l = self.frame.to_local(if self.flipped { -normal } else { normal });
        let phi = l.y.atan2(l.x);
        Vec2::new(if phi < 0.0 { phi + TAU } else { phi } / TAU, l.z.clamp(-1.0, 1.0).acos() / PI)
    }
    pub(crate) fn dpdu(&self, normal: Vec3) -> Vec3 {
        self.frame.n.cross(if self.flipped { -normal } else { normal })
    }
    /// Of the position by u and v. \[m\]
    pub(crate) fn derivatives(&self, normal: Vec3) -> (Vec3, Vec3) {
        let out = if self.flipped { -normal } else { normal };
        let l = self.frame.to_local(out);
        let azimuth = l.truncate().normalize_or(Vec2::X);
        let polar = self.frame.to_world(Vec3::new(azimuth.x * l.z, azimuth.y * l.z, -l.truncate().length()));
        (self.frame.n.cross(out) * (TAU * self.radius), polar * (PI * self.radius))
    }
}

/// A flat disc.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// \[m\]
    pub centre: Vec3,
    /// Positive. \[m\]
    pub radius: f32,
    /// `n` is the normal; `s` is where the azimuth is zero. u is the radius over the disc's, v the azimuth over 2 pi.
    pub frame: Frame,
}

impl Disk {
    /// [m^2]
    pub fn area(&self) -> f32 {
        PI * self.radius * self.radius
    }
    pub(crate) fn bounds(&self) -> Aabb {
        // Not sqrt(1 - n^2), which loses half its digits where n lies almost along an axis.
        let extent = self.radius * (self.frame.s * self.frame.s + self.frame.t * self.frame.t).map(f32::sqrt);
        Aabb { lo: self.centre - extent, hi: self.centre + extent }
    }
    pub(crate) fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let n = self.frame.n.as_dvec3();
        let o = self.centre.as_dvec3() - ray.origin.as_dvec3();
        let t = o.dot(n) / ray.dir.as_dvec3().dot(n);
        let out = ray.dir.as_dvec3() * t - o;
        let t = t as f32;
        (t > 0.0 && t < t_max && out.length_squared() <= (self.radius as f64).powi(2)).then_some(t)
    }
    /// The hit point projected onto the plane.
    pub(crate) fn surface(&self, p: Vec3) -> Vec3 {
        p - self.frame.n * self.frame.n.dot(p - self.centre)
    }
    pub(crate) fn uv(&self, p: Vec3) -> Vec2 {
        let l = self.frame.to_local(p - self.centre);
        let phi = l.y.atan2(l.x);
        Vec2::new(l.truncate().length() / self.radius, if phi < 0.0 { phi + TAU } else { phi } / TAU)
    }
    /// Of the position by u and v. \[m\]
    pub(crate) fn derivatives(&self, p: Vec3) -> (Vec3, Vec3) {
        let out = p - self.centre;
        (out.normalize_or(self.frame.s) * self.radius, self.frame.n.cross(out) * TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_inside_hits_the_far_wall_and_a_ray_outside_the_near_one() {
        let s = Sphere::new(Vec3::new(1.0, 0.0, 0.0), 2.0);
        assert_eq!(s.intersect(&Ray::new(Vec3::new(1.0, 0.0, 0.0), Vec3::X), f32::INFINITY), Some(2.0));
        assert_eq!(s.intersect(&Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X), f32::INFINITY), Some(4.0));
        assert_eq!(s.intersect(&Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::NEG_X), f32::INFINITY), None);
    }
    #[test]
    fn a_sphere_a_thousand_radii_away_keeps_its_digits() {
        let s = Sphere::new(Vec3::new(0.0, 0.0, 1e4), 1.0);
        let t = s.intersect(&Ray::new(Vec3::ZERO, Vec3::Z), f32::INFINITY).unwrap();
        assert!((t - 9999.0).abs() < 2e-3, "{t}");
    }
    #[test]
    fn a_disc_ends_at_its_radius() {
        let d = Disk { centre: Vec3::ZERO, radius: 1.0, frame: Frame::around(Vec3::Z) };
        let down = |x: f32| d.intersect(&Ray::new(Vec3::new(x, 0.0, 3.0), Vec3::NEG_Z), f32::INFINITY);
        assert_eq!((down(0.999), down(1.001)), (Some(3.0), None));
        let parallel = Ray::new(Vec3::new(-3.0, 0.0, 0.0), Vec3::X);
        assert_eq!(d.intersect(&parallel, f32::INFINITY), None);
    }
}
