//! Leaving a surface without hitting it again.
//!
//! A computed point lies off its surface by rounding. Its `error` bounds by how much [m]; it grows with the size of the
//! coordinates that the point was made of, not with the scene.

use manylight_math::{Ray, Vec3};

/// The error bound of a point made of coordinates up to `largest` in magnitude: 16 units in the last place. Interpolating a
/// triangle costs less than 8 (gamma_7 of Higham), the rest is for the ray-triangle test on neighbours in the same plane.
pub(crate) fn error_bound(largest: f32) -> f32 {
    largest * (16.0 * 0.5 * f32::EPSILON)
}

/// The point moved beyond its error bound along its geometric normal, to the side that `towards` points to.
#[inline]
pub fn offset_from(p: Vec3, normal: Vec3, error: f32, towards: Vec3) -> Vec3 {
    // The second term covers the rounding of this very sum.
    let step = error + p.abs().max_element() * f32::EPSILON;
    p + normal * if normal.dot(towards) < 0.0 { -step } else { step }
}

/// The segment between two points that has to be clear; each end may lie on a surface, given by (normal, error).
///
/// It is the same segment, and so the same answer, from either end. `None` if the ends coincide within their errors: there is
/// no direction between them.
#[inline]
pub fn shadow_segment(a: (Vec3, Option<(Vec3, f32)>), b: (Vec3, Option<(Vec3, f32)>)) -> Option<Ray> {
    // Trace from the end that comes first in a fixed order, so that visibility is exactly symmetric.
    let ordered = a.0.to_array().partial_cmp(&b.0.to_array())?.is_le();
    let (a, b) = if ordered { (a, b) } else { (b, a) };
    let towards = b.0 - a.0; // only its side of each surface matters
    if !(towards.length_squared() > f32::MIN_POSITIVE) {
        return None;
    }
    let moved = |(p, surface): (Vec3, Option<(Vec3, f32)>), towards: Vec3| {
        surface.map_or(p, |(n, error)| offset_from(p, n, error, towards))
    };
    let (from, to) = (moved(a, towards), moved(b, -towards));
    let d = to - from;
    let length2 = d.length_squared();
    if !(length2 > f32::MIN_POSITIVE) {
        return None;
    }
    let length = length2.sqrt();
    let dir = d / length;
    // The length carries a few roundings of its own; stop short of the far end by more than those.
    Some(Ray { t_max: length * (1.0 - 4.0 * f32::EPSILON), ..Ray::new(from, dir) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_segment_is_the_same_from_both_ends() {
        let (p, q) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-4.0, 0.5, 9.0));
        let (n, m) = (Some((Vec3::Z, 1e-6)), Some((Vec3::X, 1e-6)));
        let (a, b) = (shadow_segment((p, n), (q, m)).unwrap(), shadow_segment((q, m), (p, n)).unwrap());
        assert_eq!((a.origin, a.dir, a.t_max), (b.origin, b.dir, b.t_max));
    }
    #[test]
    fn coincident_points_have_no_segment() {
        let end = (Vec3::ONE, Some((Vec3::Y, 1e-6)));
        assert!(shadow_segment(end, end).is_none());
    }
}
