//! Warps of the unit square, each with its density. `_sa` densities are per solid angle.

use manylight_math::{INV_4PI, INV_PI, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Uniform over the unit disc (Shirley and Chiu 1997, concentric). Density 1/pi.
pub fn disc(u: Vec2) -> Vec2 {
    let o = u * 2.0 - 1.0;
    if o.x == 0.0 && o.y == 0.0 {
        return Vec2::ZERO;
    }
    let (r, phi) =
        if o.x.abs() > o.y.abs() { (o.x, PI / 4.0 * (o.y / o.x)) } else { (o.y, PI / 2.0 - PI / 4.0 * (o.x / o.y)) };
    Vec2::new(r * phi.cos(), r * phi.sin())
}

/// Cosine-weighted over the upper hemisphere.
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = disc(u);
    Vec3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}
/// Density of `cosine_hemisphere`. [1/sr]
pub fn cosine_hemisphere_pdf(w: Vec3) -> f32 {
    if w.z > 0.0 { w.z * INV_PI } else { 0.0 }
}

/// Uniform over the unit sphere.
pub fn sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}
/// Density of `sphere`. [1/sr]
pub const SPHERE_PDF: f32 = INV_4PI;

/// Uniform over the cone around +z with the given `versine` = 1 - cos(half angle), which stays exact for narrow cones.
pub fn cone(u: Vec2, versine: f32) -> Vec3 {
    let v = u.x * versine;
    let r = (v * (2.0 - v)).max(0.0).sqrt(); // sin = sqrt((1 - cos)(1 + cos))
    let (sin, cos) = (TAU * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, 1.0 - v)
}
/// Density of `cone`. [1/sr]
pub fn cone_pdf(versine: f32) -> f32 {
    1.0 / (TAU * versine)
}

/// Barycentrics (b1, b2) uniform over a triangle (Osada et al. 2002, square-root form).
pub fn triangle(u: Vec2) -> Vec2 {
    let r = u.x.sqrt();
    Vec2::new(r * (1.0 - u.y), r * u.y)
}

/// Tent of half width one around zero: density 1 - |x|.
pub fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Purpose, Stream};
    use manylight_stats as stats;

    const N: usize = 200_000;
    fn chi2(name: &str, bins: usize, pick: impl Fn(Vec2) -> f32) {
        let mut s = Stream::new(11, [0; 3], Purpose::TEST);
        let mut seen = vec![0u64; bins];
        for _ in 0..N {
            seen[((pick(s.next_2d()) * bins as f32) as usize).min(bins - 1)] += 1;
        }
        let expected = vec![N as f64 / bins as f64; bins];
        let test = stats::chi2_goodness_of_fit(&seen, &expected, 0);
        // 12 cases in this module: Sidak at a family-wise 0.01.
        assert!(test.p_value > stats::sidak_alpha(0.01, 12), "{name}: p = {}", test.p_value);
    }
    /// Azimuth in [0, 1).
    fn turn(x: f32, y: f32) -> f32 {
        let t = y.atan2(x) / TAU;
        if t < 0.0 { t + 1.0 } else { t }
    }

    #[test]
    fn warps_follow_their_densities() {
        chi2("disc radius", 20, |u| disc(u).length_squared());
        chi2("disc azimuth", 20, |u| turn(disc(u).x, disc(u).y));
        chi2("cosine z", 20, |u| cosine_hemisphere(u).z.powi(2));
        chi2("cosine azimuth", 20, |u| turn(cosine_hemisphere(u).x, cosine_hemisphere(u).y));
        chi2("sphere z", 20, |u| 0.5 * (sphere(u).z + 1.0));
        chi2("sphere azimuth", 20, |u| turn(sphere(u).x, sphere(u).y));
        chi2("cone z", 20, |u| (1.0 - cone(u, 0.25).z) / 0.25);
        chi2("triangle b1", 20, |u| 1.0 - (1.0 - triangle(u).x).powi(2));
        chi2("triangle b2", 20, |u| 1.0 - (1.0 - triangle(u).y).powi(2));
        chi2("triangle sum", 20, |u| (triangle(u).x + triangle(u).y).powi(2));
        chi2("tent", 20, |u| {
            let x = tent(u.x);
            if x < 0.0 { 0.5 * (1.0 + x).powi(2) } else { 1.0 - 0.5 * (1.0 - x).powi(2) }
        });
        chi2("narrow cone", 20, |u| (1.0 - cone(u, 1e-3).z) / 1e-3);
    }
    #[test]
    fn directions_are_unit_even_for_a_cone_of_a_microradian() {
        let mut s = Stream::new(3, [0; 3], Purpose::TEST);
        for _ in 0..1000 {
            for w in [cone(s.next_2d(), 5e-13), sphere(s.next_2d()), cosine_hemisphere(s.next_2d())] {
                assert!((w.length() - 1.0).abs() < 1e-5);
            }
            assert!(cone(s.next_2d(), 5e-13).truncate().length() <= 1.0001e-6);
        }
    }
}
