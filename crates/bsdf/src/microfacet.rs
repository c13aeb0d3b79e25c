//! Rough interfaces as a crowd of tiny mirrors: how their normals are distributed, how they shadow each other, and how to
//! draw one that is seen.

use crate::special;
use manylight_math::{Vec2, Vec3};
use manylight_sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// How the normals of microfacets are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// A Gaussian of slopes: alpha is sqrt(2) times their standard deviation (Beckmann and Spizzichino 1963).
    Beckmann,
    /// Longer tails (Trowbridge and Reitz 1975; Walter et al. 2007).
    Ggx,
}

/// Least roughness: below it single precision no longer resolves the lobe.
pub const MIN_ALPHA: f32 = 1e-4;

/// Microfacets with a roughness along each tangent, shadowed after Smith: masking and shadowing are independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Microfacets {
    pub distribution: Distribution,
    pub alpha_u: f32,
    pub alpha_v: f32,
}

impl Microfacets {
    /// Roughness below `MIN_ALPHA` is raised to it.
    pub fn new(distribution: Distribution, alpha_u: f32, alpha_v: f32) -> Self {
        Microfacets { distribution, alpha_u: alpha_u.max(MIN_ALPHA), alpha_v: alpha_v.max(MIN_ALPHA) }
    }

    /// Density of normals: area of microfacets per solid angle of their normal `h` (`h.z` > 0), per area of surface. [1/sr]
    pub fn density(&self, h: Vec3) -> f32 {
        let slope2 = (h.x / self.alpha_u).powi(2) + (h.y / self.alpha_v).powi(2);
        let normalisation = FRAC_1_PI / (self.alpha_u * self.alpha_v);
        match self.distribution {
            Distribution::Ggx => normalisation / (slope2 + h.z * h.z).powi(2),
            Distribution::Beckmann => {
                let cos2 = h.z * h.z;
                let gauss = (-slope2 / cos2).exp();
                // So far out in its tail a Gaussian is cut off (as by Mitsuba 3), before it loses its precision; there
                // 1 / cos^4 may also overflow.
                if gauss > 1e-30 { normalisation * gauss / (cos2 * cos2) } else { 0.0 }
            }
        }
    }

    /// Is the lobe as narrow as an isotropic one of roughness `alpha`? By its solid angle.
    pub fn as_sharp_as(&self, alpha: f32) -> bool {
        self.alpha_u * self.alpha_v <= alpha * alpha
    }
    /// alpha sin(theta) of a direction, squared: its cosine over it is cot(theta) / alpha.
    fn stretched_sin2(&self, w: Vec3) -> f32 {
        (self.alpha_u * w.x).powi(2) + (self.alpha_v * w.y).powi(2)
    }

    /// Smith's masking G1(w) / cos(w): finite at grazing angles, where both go to zero. `w.z` > 0.
    ///
    /// For Beckmann it is the rational fit of Walter et al. 2007 (section 5.3; relative error 0.35 %).
    pub fn masking_over_cos(&self, w: Vec3) -> f32 {
        masking_over_cos(self.distribution, w.z, self.stretched_sin2(w))
    }
    /// Smith's masking: the part of the microfacets turned towards `w` that is seen from there.
    pub fn masking(&self, w: Vec3) -> f32 {
        w.z * self.masking_over_cos(w)
    }
    /// What `masking_over_cos` is without a fit. [`Microfacets::sample_visible`] draws from exactly
    /// density(h) (w . h) `visible_over_cos(w)`.
    pub fn visible_over_cos(&self, w: Vec3) -> f32 {
        match self.distribution {
            Distribution::Ggx => self.masking_over_cos(w),
            Distribution::Beckmann => {
                let (cos, sin) = (f64::from(w.z), f64::from(self.stretched_sin2(w)).sqrt());
                (2.0 / projected_area(cos, sin, cos / sin)) as f32
            }
        }
    }

    /// Half vector of two directions above the surface, and its cosine to either; `None` if one is below.
    pub fn half_vector(wi: Vec3, wo: Vec3) -> Option<(Vec3, f32)> {
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return None;
        }
        let sum = wi + wo;
        // Of unit vectors the length of the sum is twice that cosine, also where rounding has turned the half vector.
        Some((sum.try_normalize()?, 0.5 * sum.length()))
    }
    /// The model without its Fresnel factor: D G / (4 cos cos) (Walter et al. 2007, Eq. 20). [1/sr]
    pub fn reflection(&self, wi: Vec3, wo: Vec3, h: Vec3) -> f32 {
        0.25 * self.density(h) * self.masking_over_cos(wi) * self.masking_over_cos(wo)
    }
    /// Density of `wo` mirrored at a normal drawn by `sample_visible`. [1/sr]
    pub fn reflection_pdf_sa(&self, wi: Vec3, h: Vec3) -> f32 {
        0.25 * self.density(h) * self.visible_over_cos(wi)
    }
    /// `reflection` cos(wo) over `reflection_pdf_sa`, where the density cancels.
    pub fn reflection_weight(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.masking(wo) * (self.masking_over_cos(wi) / self.visible_over_cos(wi))
    }

    /// Draws a normal as seen from `wi` (`wi.z` > 0): Heitz 2018 for GGX, Heitz and d'Eon 2014 for Beckmann.
    pub fn sample_visible(&self, wi: Vec3, u: Vec2) -> Vec3 {
        let view = View::new(self, wi);
        view.unstretch(match self.distribution {
            Distribution::Ggx => visible_ggx(view.cos, view.sin, u),
            Distribution::Beckmann => Vec3::new(-view.slope_along(u.x), -slope_across(u.y), 1.0),
        })
    }
    /// `sample_visible` at each pair (`u[i]`, `u[j]`), `j` running fastest. Gaussian slopes along and across the view are
    /// independent, so that a grid of them costs no more than its sides.
    pub fn sample_visible_grid(&self, wi: Vec3, u: &[f32]) -> Vec<Vec3> {
        let view = View::new(self, wi);
        match self.distribution {
            Distribution::Ggx => u
                .iter()
                .flat_map(|&x| u.iter().map(move |&y| Vec2::new(x, y)))
                .map(|u| view.unstretch(visible_ggx(view.cos, view.sin, u)))
                .collect(),
            Distribution::Beckmann => {
                let across: Vec<f32> = u.iter().map(|&u| slope_across(u)).collect();
                let along = u.iter().map(|&u| view.slope_along(u));
                along.flat_map(|x| across.iter().map(move |&y| view.unstretch(Vec3::new(-x, -y, 1.0)))).collect()
            }
        }
    }
}

/// A viewer of the surface stretched by its roughness, which then is one.
#[derive(Clone, Copy)]
struct View {
    alpha: Vec2,
    cos: f32,
    sin: f32,
    azimuth: Vec2,
}

impl View {
    fn new(m: &Microfacets, wi: Vec3) -> Self {
        let stretched = Vec3::new(m.alpha_u * wi.x, m.alpha_v * wi.y, wi.z).normalize();
        let sin = stretched.truncate().length();
        let azimuth = if sin > 0.0 { stretched.truncate() / sin } else { Vec2::X };
        View { alpha: Vec2::new(m.alpha_u, m.alpha_v), cos: stretched.z, sin, azimuth }
    }
    /// From a normal (of any length) of the stretched surface, x towards the viewer.
    fn unstretch(&self, n: Vec3) -> Vec3 {
        let n = (self.alpha * self.azimuth.rotate(n.truncate())).extend(n.z);
        n.normalize()
    }
    fn slope_along(&self, u: f32) -> f32 {
        visible_slope(f64::from(self.cos), f64::from(self.sin), f64::from(u)) as f32
    }
}

/// Across the view slopes are seen as they are: a viewer at the zenith.
fn slope_across(u: f32) -> f32 {
    visible_slope(1.0, 0.0, f64::from(u)) as f32
}

/// `wi` mirrored at the microfacet `h`.
pub(crate) fn mirror(wi: Vec3, h: Vec3) -> Vec3 {
    2.0 * wi.dot(h) * h - wi
}

/// G1 / cos from the cosine and (alpha sin)^2.
pub(crate) fn masking_over_cos(distribution: Distribution, cos: f32, stretched_sin2: f32) -> f32 {
    match distribution {
        Distribution::Ggx => 2.0 / (cos + (cos * cos + stretched_sin2).sqrt()),
        Distribution::Beckmann => {
            let sin = stretched_sin2.sqrt();
            if cos >= 1.6 * sin {
                return 1.0 / cos;
            }
            let a = cos / sin;
            (3.535 + 2.181 * a) / ((1.0 + (2.276 + 2.577 * a) * a) * sin)
        }
    }
}

/// Twice the projected area of the Gaussian microfacets of roughness one whose slope towards the viewer is below `x`,
/// for a viewer at cosine `cos`; all of them at x = cot(theta).
fn projected_area(cos: f64, sin: f64, x: f64) -> f64 {
    let (one_plus_erf, gauss) = special::one_plus_erf(x);
    cos * one_plus_erf + sin * gauss * (0.5 * std::f64::consts::FRAC_2_SQRT_PI)
}

/// Normal of GGX microfacets of roughness one seen from (sin, 0, cos): the visible half of a hemisphere, projected.
fn visible_ggx(cos: f32, sin: f32, u: Vec2) -> Vec3 {
    let p = warp::disc(u);
    // The half disc below the horizon is squeezed into what is seen.
    let s = 0.5 * (1.0 + cos);
    let y = (1.0 - s) * (1.0 - p.x * p.x).max(0.0).sqrt() + s * p.y;
    let z = (1.0 - p.x * p.x - y * y).max(0.0).sqrt();
    Vec3::new(sin * z - cos * y, -p.x, (sin * y + cos * z).max(0.0))
}

/// The slope towards the viewer below which a fraction `u` of the projected Gaussian area lies: Newton's iteration, kept in a bracket.
fn visible_slope(cos: f64, sin: f64, u: f64) -> f64 {
    let (mut low, mut high) = (-6.0, (cos / sin).min(6.0));
    // Half a step of a 24-bit number from either end.
    let u = u.clamp(3e-8, 1.0 - 3e-8);
    let target = u * projected_area(cos, sin, high);
    // Between the solution at grazing angles and a logistic one at the zenith.
    let mut x = (cos * 0.42 * (u / (1.0 - u)).ln() - (1.0 - cos) * (-u.ln()).sqrt()).clamp(low, high);
    for _ in 0..60 {
        let excess = projected_area(cos, sin, x) - target;
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let slope = std::f64::consts::FRAC_2_SQRT_PI * (-x * x).exp() * (cos - x * sin);
        let newton = x - excess / slope;
        if !(low < newton && newton < high) {
            x = 0.5 * (low + high);
        } else if (newton - x).abs() < 1e-4 {
            // Each step squares the error.
            return newton;
        } else {
            x = newton;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn visible_slopes_invert_the_projected_area() {
        for cos in [1e-9f64, 1e-3, 0.1, 0.5, 0.9, 0.9999, 1.0] {
            let sin = (1.0 - cos * cos).sqrt();
            for i in 0..=100 {
                let u = i as f64 / 100.0;
                let x = visible_slope(cos, sin, u);
                let got = projected_area(cos, sin, x) / projected_area(cos, sin, (cos / sin).min(6.0));
                assert!((got - u).abs() < 1e-7, "{cos} {u}: {got}");
            }
        }
    }
    #[test]
    fn the_fit_of_beckmann_masking_is_within_its_stated_error() {
        let m = Microfacets::new(Distribution::Beckmann, 0.4, 0.4);
        for i in 1..=1000 {
            let z = i as f32 / 1000.0;
            let w = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
            let ratio = m.masking_over_cos(w) / m.visible_over_cos(w);
            assert!((ratio - 1.0).abs() < 0.0036, "{z}: {ratio}");
        }
    }
    #[test]
    fn projected_density_of_normals_is_one() {
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            for (alpha_u, alpha_v) in [(0.1, 0.1), (0.5, 0.2), (1.0, 1.0)] {
                let m = Microfacets::new(distribution, alpha_u, alpha_v);
                let n = 1000;
                let mut sum = 0.0;
                for i in 0..n {
                    for j in 0..64 {
                        // Even in sqrt(1 - cos), to resolve the peak.
                        let (r, phi) = ((i as f32 + 0.5) / n as f32, 2.0 * PI * (j as f32 + 0.5) / 64.0);
                        let (sin, cos) = (r * (2.0 - r * r).sqrt(), 1.0 - r * r);
                        let h = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                        let solid_angle = 2.0 * r / n as f32 * 2.0 * PI / 64.0;
                        sum += f64::from(m.density(h) * cos * solid_angle);
                    }
                }
                assert!((sum - 1.0).abs() < 2e-3, "{distribution:?} {alpha_u} {alpha_v}: {sum}");
            }
        }
    }
}
