//! A rough metal.

use crate::bsdf::{Bsdf, BsdfSample, Lobe, Mode, Model, Split};
use crate::cone::Cone;
use crate::fresnel;
use crate::microfacet::{Distribution, Microfacets, mirror};
use manylight_math::{Spectrum, Vec2, Vec3};

/// Microfacets that reflect as a conductor does, one-sided (Walter et al. 2007): f = F D G / (4 cos cos).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    microfacets: Microfacets,
    eta: Spectrum,
    k: Spectrum,
    specular_reflectance: Spectrum,
}

impl RoughConductor {
    /// Roughness along both tangents (below [`MIN_ALPHA`](crate::MIN_ALPHA) it is raised to that), index of refraction
    /// `eta` + i `k` relative to the outside, and a factor (1 for a physical metal).
    pub fn new(
        distribution: Distribution,
        alpha_u: f32,
        alpha_v: f32,
        eta: Spectrum,
        k: Spectrum,
        specular_reflectance: Spectrum,
    ) -> Self {
        RoughConductor { microfacets: Microfacets::new(distribution, alpha_u, alpha_v), eta, k, specular_reflectance }
    }
    fn fresnel(&self, cos: f32) -> Spectrum {
        fresnel::conductor(cos, self.eta, self.k) * self.specular_reflectance
    }
}

impl Model for RoughConductor {
    const SMOOTH: bool = true;
    const DELTA: bool = false;

    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        let Some((h, cos)) = Microfacets::half_vector(wi, wo) else { return Spectrum::BLACK };
        self.fresnel(cos) * self.microfacets.reflection(wi, wo, h)
    }
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        Microfacets::half_vector(wi, wo).map_or(0.0, |(h, _)| self.microfacets.reflection_pdf_sa(wi, h))
    }
    /// `None` where a microfacet sends the path into the surface.
    fn sample(&self, wi: Vec3, _mode: Mode, _u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if !(wi.z > 0.0) {
            return None;
        }
        let wo = mirror(wi, self.microfacets.sample_visible(wi, u));
        let (h, cos) = Microfacets::half_vector(wi, wo)?;
        let pdf = self.microfacets.reflection_pdf_sa(wi, h);
        if !(pdf > 0.0) {
            return None;
        }
        Some(BsdfSample::smooth(wo, self.fresnel(cos) * self.microfacets.reflection_weight(wi, wo), pdf))
    }
    /// The mean weight of the 89 samples of a Fibonacci lattice: within 0.015.
    fn albedo(&self, wi: Vec3) -> Spectrum {
        const N: usize = 89;
        const STEP: usize = 55;
        let point = |i: usize| (i as f32 + 0.5) / N as f32;
        (0..N)
            .filter_map(|i| self.sample(wi, Mode::Radiance, 0.0, Vec2::new(point(i), point(i * STEP % N))))
            .map(|s| s.weight * (1.0 / N as f32))
            .sum()
    }
    fn upper_bound(&self, wi: Vec3, cone: &Cone) -> Lobe {
        let bound = self.microfacets.reflection_bound(wi, cone);
        let fresnel = fresnel::conductor_bound(bound.cos_half_min, bound.cos_half_max, self.eta, self.k);
        let largest = (fresnel * self.specular_reflectance).largest() * Cone::ROUNDING;
        Lobe { with_cosine: largest * bound.with_cosine, without_cosine: largest * bound.without_cosine }
    }
    fn split(&self, _wi: Vec3, alpha: f32) -> Option<Split> {
        self.microfacets.as_sharp_as(alpha).then_some(Split { dull: Bsdf::Black, sharp: (*self).into(), chance: 1.0 })
    }
}
