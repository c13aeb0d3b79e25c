//! A cone of directions, as the bounds see it.

use crate::Lobe;
use manylight_math::Vec3;

/// All directions within the half angle around `axis`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    pub axis: Vec3,
    /// Half angle. [rad]
    pub half: f32,
    /// Least and largest cosine to the normal over the directions above the surface.
    pub cos_min: f32,
    pub cos_max: f32,
}

impl Cone {
    /// Rounding of unit directions and of the angles made of them. [rad]
    pub const SLACK: f32 = 1e-6;
    /// Rounding of the values that are bounded.
    pub const ROUNDING: f32 = 1.0 + 1e-5;

    /// `None` if the cone lies below the surface.
    pub fn above_surface(axis: Vec3, cos_half: f32) -> Option<Self> {
        let half = angle_of_versine(1.0 - cos_half) + Self::SLACK;
        let inclination = inclination(axis);
        let cos_max = (inclination - half).max(0.0).cos();
        // Also where a NaN ends.
        if !(cos_max > 0.0) {
            return None;
        }
        let cos_min = (inclination + half).min(std::f32::consts::FRAC_PI_2).cos().max(0.0);
        Some(Cone { axis, half, cos_min, cos_max })
    }
    /// Bound of a lobe whose BSDF is at most `f` in the cone, whatever the direction.
    pub fn lobe_of_constant(&self, f: f32) -> Lobe {
        let f = f * Self::ROUNDING;
        Lobe { with_cosine: f * self.cos_max, without_cosine: f }
    }
}

/// Angle to the normal, exact for small ones, where acos is not. [rad]
pub(crate) fn inclination(w: Vec3) -> f32 {
    w.truncate().length().atan2(w.z)
}

/// Angle whose versine, 1 - cos, is given. [rad]
fn angle_of_versine(versine: f32) -> f32 {
    2.0 * (0.5 * versine).clamp(0.0, 1.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Frame;
    use manylight_sampling::{Purpose, Stream, warp};

    #[test]
    fn cosines_of_directions_in_a_cone_stay_between_its_least_and_largest() {
        let mut s = Stream::new(5, [0; 3], Purpose::TEST);
        let mut above = 0;
        for _ in 0..20_000 {
            let axis = warp::sphere(s.next_2d());
            let cos_half = 1.0 - 2.0 * s.next_f32().powi(6);
            let versine = 1.0 - cos_half;
            let w = Frame::around(axis).to_world(warp::cone(s.next_2d(), versine));
            match Cone::above_surface(axis, cos_half) {
                None => assert!(w.z <= 0.0, "{w} in a cone said to lie below the surface"),
                Some(cone) if w.z > 0.0 => {
                    above += 1;
                    assert!(cone.cos_min <= w.z && w.z <= cone.cos_max, "{w} {cone:?}");
                }
                Some(_) => {}
            }
        }
        assert!(above > 5_000, "{above}");
    }
    #[test]
    fn a_cone_of_cosine_one_is_one_direction() {
        let w = Vec3::new(0.6, 0.0, 0.8);
        let cone = Cone::above_surface(w, 1.0).unwrap();
        assert!((cone.cos_max - 0.8).abs() < 2e-6 && (cone.cos_min - 0.8).abs() < 2e-6);
    }
}
