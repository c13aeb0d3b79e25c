//! Axis-aligned boxes.

use crate::{Frame, Vec3};

/// An axis-aligned box; empty if `lo > hi` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner. \[m\]
    pub lo: Vec3,
    /// Upper corner. \[m\]
    pub hi: Vec3,
}

impl Aabb {
    /// Holds nothing; the neutral element of `join`.
    pub const EMPTY: Aabb = Aabb { lo: Vec3::splat(f32::INFINITY), hi: Vec3::splat(f32::NEG_INFINITY) };

    /// A box of one point.
    #[inline]
    pub fn point(p: Vec3) -> Self {
        Aabb { lo: p, hi: p }
    }
    /// The smallest box around some points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Aabb::EMPTY, |b, p| b.join(&Aabb::point(p)))
    }
    /// The smallest box around both.
    #[inline]
    pub fn join(&self, o: &Aabb) -> Aabb {
        Aabb { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }
    /// True if it holds no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }
    /// The middle. \[m\]
    #[inline]
    pub fn centre(&self) -> Vec3 {
        0.5 * self.lo + 0.5 * self.hi
    }
    /// Half the diagonal; zero if empty. \[m\]
    #[inline]
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.hi - self.lo).length() }
    }
    /// Is `p` inside or on the border?
    #[inline]
    pub fn contains(&self, p: Vec3) -> bool {
        self.lo.cmple(p).all() && p.cmple(self.hi).all()
    }
    /// One of the eight corners, by the bits of `i` (0..8). \[m\]
    pub fn corner(&self, i: usize) -> Vec3 {
        let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
        Vec3::new(pick(0, self.lo.x, self.hi.x), pick(1, self.lo.y, self.hi.y), pick(2, self.lo.z, self.hi.z))
    }
    /// The box of all differences `x - y` of a point x of this box and a point y of the other. \[m\]
    #[inline]
    pub fn minus(&self, o: &Aabb) -> Aabb {
        Aabb { lo: self.lo - o.hi, hi: self.hi - o.lo }
    }
    /// Largest cosine between the frame's normal and the vectors of a box, seen as vectors from the origin: never below the truth
    /// by more than rounding, exact for a box in the frame's own axes (Walter et al. 2005, section 4.1). 1 if it holds the origin.
    ///
    /// With z along the normal, cos = z / |(x, y, z)| is largest at the largest z, and at the least |x| and |y| if that z is
    /// positive, at the largest if it is not.
    #[inline]
    pub fn largest_cosine(&self, frame: &Frame) -> f32 {
        // By corners, not by centre and half size: the sign of z decides what lies below a horizon.
        let z = (frame.n * self.lo).max(frame.n * self.hi).element_sum();
        let (centre, half) = (0.5 * (self.lo + self.hi), 0.5 * (self.hi - self.lo));
        let aside = |a: Vec3| {
            let (middle, reach) = (a.dot(centre).abs(), a.abs().dot(half));
            // Rounding must not push a box aside.
            if z > 0.0 { (middle - reach - 4e-7 * (middle + reach)).max(0.0) } else { middle + reach }
        };
        let (x, y) = (aside(frame.s), aside(frame.t));
        let cos = z / (x * x + y * y + z * z).sqrt();
        // 0 / 0: the origin itself.
        if cos.is_nan() || self.contains(Vec3::ZERO) { 1.0 } else { cos.min(1.0) }
    }
    /// Smallest and largest squared distance between points of two boxes. [m^2]
    #[inline]
    pub fn distances2(&self, o: &Aabb) -> (f32, f32) {
        let near = (self.lo - o.hi).max(o.lo - self.hi).max(Vec3::ZERO);
        let far = (self.hi - o.lo).max(o.hi - self.lo);
        (near.length_squared(), far.length_squared())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vec3() -> impl Strategy<Value = Vec3> {
        (-10f32..10.0, -10f32..10.0, -10f32..10.0).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }
    proptest! {
        #[test]
        fn distances_hold_between_any_two_points(a in vec3(), b in vec3(), c in vec3(), d in vec3(), u in 0f32..1.0, v in 0f32..1.0) {
            let (x, y) = (Aabb::around([a, b]), Aabb::around([c, d]));
            let (near, far) = x.distances2(&y);
            let d2 = (a.lerp(b, u) - c.lerp(d, v)).length_squared();
            prop_assert!(near <= d2 * (1.0 + 1e-5) + 1e-5 && d2 <= far * (1.0 + 1e-5) + 1e-5, "{} {} {}", near, d2, far);
        }
    }
    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn no_direction_to_a_box_has_a_larger_cosine_than_is_said(n in vec3(), a in vec3(), b in vec3(), scale in -3f32..0.0, u in 0f32..1.0, v in 0f32..1.0, w in 0f32..1.0) {
            let Some(n) = n.try_normalize() else { return Ok(()) };
            let x = Aabb::around([a, a + b * 10f32.powf(scale)]);
            let inside = x.lo + (x.hi - x.lo) * Vec3::new(u, v, w);
            let bound = x.largest_cosine(&Frame::around(n));
            prop_assert!(n.dot(inside.normalize_or(n)) <= bound + 2e-6, "{} {bound}", n.dot(inside.normalize()));
        }
        #[test]
        fn the_largest_cosine_of_one_point_is_its_cosine(n in vec3(), p in vec3()) {
            let (Some(n), Some(w)) = (n.try_normalize(), p.try_normalize()) else { return Ok(()) };
            prop_assert!((Aabb::point(p).largest_cosine(&Frame::around(n)) - n.dot(w)).abs() < 1e-6);
        }
    }
    #[test]
    fn the_worked_box_has_the_cosine_and_the_distances_of_the_formula() {
        let (b, up) = (Aabb { lo: Vec3::new(2.0, 0.0, 1.0), hi: Vec3::new(4.0, 1.0, 3.0) }, Frame::around(Vec3::Z));
        // Rounded up, never down.
        let above = b.largest_cosine(&up) - 3.0 / 13f32.sqrt();
        assert!((-6e-8..1e-6).contains(&above), "{above}");
        assert_eq!(Aabb::point(Vec3::ZERO).distances2(&b), (5.0, 26.0));
        // From above it lies below: the cosine is the least negative one.
        let below = b.largest_cosine(&Frame::around(Vec3::NEG_Z));
        assert!((below + 1.0 / (16f32 + 1.0 + 1.0).sqrt()).abs() < 1e-7, "{below}");
        let inside = Aabb { lo: -Vec3::ONE, hi: Vec3::ONE };
        assert_eq!(inside.largest_cosine(&up), 1.0);
    }
    #[test]
    fn the_empty_box_holds_nothing_and_joins_neutrally() {
        let b = Aabb::point(Vec3::ONE);
        assert!(Aabb::EMPTY.is_empty() && !b.is_empty());
        assert_eq!(Aabb::EMPTY.join(&b), b);
        assert_eq!(Aabb::EMPTY.radius(), 0.0);
    }
}
