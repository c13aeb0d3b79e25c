//! Axis-aligned boxes.

use crate::Vec3;

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
    pub fn point(p: Vec3) -> Self {
        Aabb { lo: p, hi: p }
    }
    /// The smallest box around some points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Aabb::EMPTY, |b, p| b.join(&Aabb::point(p)))
    }
    /// The smallest box around both.
    pub fn join(&self, o: &Aabb) -> Aabb {
        Aabb { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }
    /// True if it holds no point.
    pub fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }
    /// The middle. \[m\]
    pub fn centre(&self) -> Vec3 {
        0.5 * self.lo + 0.5 * self.hi
    }
    /// Half the diagonal; zero if empty. \[m\]
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { 0.5 * (self.hi - self.lo).length() }
    }
    /// Is `p` inside or on the border?
    pub fn contains(&self, p: Vec3) -> bool {
        self.lo.cmple(p).all() && p.cmple(self.hi).all()
    }
    /// One of the eight corners, by the bits of `i` (0..8). \[m\]
    pub fn corner(&self, i: usize) -> Vec3 {
        let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
        Vec3::new(pick(0, self.lo.x, self.hi.x), pick(1, self.lo.y, self.hi.y), pick(2, self.lo.z, self.hi.z))
    }
    /// Smallest and largest squared distance between points of two boxes. [m^2]
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
    #[test]
    fn the_empty_box_holds_nothing_and_joins_neutrally() {
        let b = Aabb::point(Vec3::ONE);
        assert!(Aabb::EMPTY.is_empty() && !b.is_empty());
        assert_eq!(Aabb::EMPTY.join(&b), b);
        assert_eq!(Aabb::EMPTY.radius(), 0.0);
    }
}
