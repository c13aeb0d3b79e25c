//! Orthonormal frames.

use crate::Vec3;

/// A right-handed orthonormal frame: local `z` is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x.
    pub s: Vec3,
    /// Local y.
    pub t: Vec3,
    /// Local z.
    pub n: Vec3,
}

impl Frame {
    /// Any frame around a unit normal.
    #[inline]
    pub fn around(n: Vec3) -> Self {
        let (s, t) = n.any_orthonormal_pair();
        Frame { s, t, n }
    }
    /// The frame whose x axis is as near to `tangent` as `n` allows (for anisotropic lobes); any, if they are parallel.
    pub fn with_tangent(n: Vec3, tangent: Vec3) -> Self {
        let across = tangent - n * n.dot(tangent);
        // What is left of a tangent along the normal is rounding: it says nothing.
        if !(across.length_squared() > 1e-6 * tangent.length_squared()) {
            return Frame::around(n);
        }
        // Once more, for the part along the normal that rounding left.
        match across.try_normalize().and_then(|s| (s - n * n.dot(s)).try_normalize()) {
            Some(s) => Frame { s, t: n.cross(s), n },
            None => Frame::around(n),
        }
    }
    /// The same frame turned upside down (around its x axis).
    pub fn flipped(self) -> Self {
        Frame { s: self.s, t: -self.t, n: -self.n }
    }
    /// World to local.
    #[inline]
    pub fn to_local(&self, w: Vec3) -> Vec3 {
        Vec3::new(self.s.dot(w), self.t.dot(w), self.n.dot(w))
    }
    /// Local to world.
    #[inline]
    pub fn to_world(&self, l: Vec3) -> Vec3 {
        self.s * l.x + self.t * l.y + self.n * l.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn to_world_undoes_to_local(x in -1f32..1.0, y in -1f32..1.0, z in -1f32..1.0, a in -1f32..1.0, b in -1f32..1.0, c in -1f32..1.0) {
            let Some(n) = Vec3::new(x, y, z).try_normalize() else { return Ok(()) };
            let w = Vec3::new(a, b, c);
            let along = n * 3.0 + w * 1e-6;
            for f in [Frame::with_tangent(n, along), Frame::around(n), Frame::with_tangent(n, w), Frame::with_tangent(n, n), Frame::around(n).flipped()] {
                prop_assert!((f.to_world(f.to_local(w)) - w).length() < 1e-5);
                prop_assert!((f.s.cross(f.t) - f.n).length() < 1e-5);
            }
        }
    }
}
