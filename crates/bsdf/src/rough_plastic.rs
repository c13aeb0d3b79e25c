//! A diffuse base under a rough coat.

use crate::bsdf::{BsdfSample, Lobe, Mode, Model, Split};
use crate::cone::Cone;
use crate::fresnel;
use crate::microfacet::{Microfacets, mirror};
use crate::plastic::{self, Choice};
use crate::rough_transmittance::RoughTransmittance;
use manylight_math::{INV_PI, Spectrum, Vec2, Vec3};
use manylight_sampling::warp;

/// A diffuse base under a rough dielectric coat, one-sided: microfacets, and [`Plastic`](crate::Plastic)'s diffuse lobe
/// with the transmittances of a rough interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughPlastic {
    coat: &'static RoughTransmittance,
    base: Spectrum,
    specular_reflectance: Spectrum,
    specular_weight: f32,
}

impl RoughPlastic {
    /// `coat`: distribution, roughness and index of refraction. The rest is as for [`Plastic`](crate::Plastic::new).
    pub fn new(
        coat: &'static RoughTransmittance,
        diffuse_reflectance: Spectrum,
        specular_reflectance: Spectrum,
        nonlinear: bool,
    ) -> Self {
        RoughPlastic {
            coat,
            base: plastic::base(diffuse_reflectance, coat.internal_reflectance, coat.eta, nonlinear),
            specular_reflectance,
            specular_weight: plastic::specular_weight(diffuse_reflectance, specular_reflectance),
        }
    }
    fn choice(&self, wi: Vec3) -> Option<Choice> {
        let transmitted = self.coat.transmitted(wi.z);
        Choice::new(1.0 - transmitted, transmitted, self.specular_weight)
    }
}

impl Model for RoughPlastic {
    const SMOOTH: bool = true;
    const DELTA: bool = false;

    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        let Some((h, cos)) = Microfacets::half_vector(wi, wo) else { return Spectrum::BLACK };
        let fresnel = fresnel::dielectric(cos, self.coat.eta).reflected;
        let diffuse = INV_PI * self.coat.transmitted(wi.z) * self.coat.transmitted(wo.z);
        self.specular_reflectance * (fresnel * self.coat.microfacets.reflection(wi, wo, h)) + self.base * diffuse
    }
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        let Some((h, _)) = Microfacets::half_vector(wi, wo) else { return 0.0 };
        let Some(choice) = self.choice(wi) else { return 0.0 };
        choice.coat * self.coat.microfacets.reflection_pdf_sa(wi, h) + choice.base * warp::cosine_hemisphere_pdf(wo)
    }
    /// `None` where a microfacet sends the path into the surface.
    fn sample(&self, wi: Vec3, _mode: Mode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if !(wi.z > 0.0) {
            return None;
        }
        let wo = if u_lobe < self.choice(wi)?.coat {
            mirror(wi, self.coat.microfacets.sample_visible(wi, u))
        } else {
            warp::cosine_hemisphere(u)
        };
        let pdf = self.pdf_sa(wi, wo);
        if !(pdf > 0.0) {
            return None;
        }
        Some(BsdfSample::smooth(wo, self.eval(wi, wo) * (wo.z / pdf), pdf))
    }
    /// From tables: within 0.001.
    fn albedo(&self, wi: Vec3) -> Spectrum {
        if !(wi.z > 0.0) {
            return Spectrum::BLACK;
        }
        self.specular_reflectance * self.coat.reflected(wi.z)
            + self.base * (self.coat.transmitted(wi.z) * self.coat.mean_transmitted)
    }
    fn upper_bound(&self, wi: Vec3, cone: &Cone) -> Lobe {
        let bound = self.coat.microfacets.reflection_bound(wi, cone);
        let fresnel = fresnel::dielectric_reflected_bound(bound.cos_half_min, bound.cos_half_max, self.coat.eta);
        let leaving = self.coat.transmitted_bound(cone.cos_min, cone.cos_max);
        let diffuse = INV_PI * self.coat.transmitted(wi.z) * leaving;
        // The lobes may be largest in different channels.
        let largest = |reflection: f32, diffuse: f32| {
            (self.specular_reflectance * (fresnel * reflection) + self.base * diffuse).largest() * Cone::ROUNDING
        };
        Lobe {
            with_cosine: largest(bound.with_cosine, diffuse * cone.cos_max),
            without_cosine: largest(bound.without_cosine, diffuse),
        }
    }
    fn split(&self, wi: Vec3, alpha: f32) -> Option<Split> {
        if !self.coat.microfacets.as_sharp_as(alpha) {
            return None;
        }
        // Without the other lobe's reflectance either part would choose by weights that are no longer true.
        let dull = RoughPlastic { specular_reflectance: Spectrum::BLACK, specular_weight: 0.0, ..*self };
        let sharp = RoughPlastic { base: Spectrum::BLACK, specular_weight: 1.0, ..*self };
        let chance = self.choice(wi).map_or(0.0, |choice| choice.coat);
        Some(Split { dull: dull.into(), sharp: sharp.into(), chance })
    }
}
