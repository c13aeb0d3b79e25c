//! A rough interface between two transparent media.

use crate::bsdf::{Bsdf, BsdfSample, Lobe, Mode, Model, Split};
use crate::cone::Cone;
use crate::fresnel;
use crate::microfacet::{Distribution, Microfacets, mirror};
use crate::principled::lattice_albedo;
use manylight_math::{Spectrum, Vec2, Vec3};

/// Microfacets of glass (Walter et al. 2007), which scatter to both sides: F D G / (4 cos cos) by reflection and
///
/// > |i.h| |o.h| / (|cos_i| |cos_o|) (1 - F) D G eta^2 / (i.h + eta o.h)^2
///
/// by refraction (Eq. 21), with eta the index of the side of `wo` over that of `wi` and h along -(i + eta o). That is how it
/// scatters importance; radiance is 1 / eta^2 of it. `wi.z` < 0 is inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    microfacets: Microfacets,
    eta: f32,
    specular_reflectance: Spectrum,
    specular_transmittance: Spectrum,
}

/// Two directions as the microfacet between them has it.
struct Facet {
    /// Normal, above the surface.
    h: Vec3,
    /// Cosines to it, of the same sign for reflection.
    cos_i: f32,
    cos_o: f32,
    /// Index of the side of `wo` over that of `wi`; 1 for reflection.
    eta: f32,
    fresnel: fresnel::Interface,
}

impl RoughDielectric {
    /// Roughness along both tangents, indices of refraction inside (below the surface) and outside, which differ, and a factor for
    /// reflection and for refraction (1 for physical glass).
    pub fn new(
        distribution: Distribution,
        (alpha_u, alpha_v): (f32, f32),
        (int_ior, ext_ior): (f32, f32),
        specular_reflectance: Spectrum,
        specular_transmittance: Spectrum,
    ) -> Self {
        let microfacets = Microfacets::new(distribution, alpha_u, alpha_v);
        RoughDielectric { microfacets, eta: int_ior / ext_ior, specular_reflectance, specular_transmittance }
    }

    fn facet(&self, wi: Vec3, wo: Vec3) -> Option<Facet> {
        if !(wi.z * wo.z).is_normal() {
            return None;
        }
        let eta = if wi.z * wo.z > 0.0 {
            1.0
        } else if wi.z > 0.0 {
            self.eta
        } else {
            1.0 / self.eta
        };
        let h = (wi + wo * eta).try_normalize()?;
        let h = if h.z < 0.0 { -h } else { h };
        let (cos_i, cos_o) = (wi.dot(h), wo.dot(h));
        // Facets are seen from the side of the surface that they are on.
        let seen = h.z > 0.0 && cos_i * wi.z > 0.0 && cos_o * wo.z > 0.0;
        seen.then(|| Facet { h, cos_i, cos_o, eta, fresnel: fresnel::dielectric(cos_i, self.eta) })
    }
    /// Smith's masking over the cosine, from either side.
    fn masking_over_cos(&self, w: Vec3) -> f32 {
        self.microfacets.masking_over_cos(above(w))
    }
    /// Density of `wo` per density of `h`.
    fn jacobian(&self, f: &Facet) -> f32 {
        if f.eta == 1.0 {
            0.25 / f.cos_o.abs()
        } else {
            let sum = f.cos_i + f.eta * f.cos_o;
            f.eta * f.eta * f.cos_o.abs() / (sum * sum)
        }
    }
    /// 1 / eta^2 where radiance is refracted.
    pub(crate) fn radiance_factor(&self, wi: Vec3, wo: Vec3) -> f32 {
        if wi.z * wo.z > 0.0 {
            1.0
        } else if wi.z > 0.0 {
            1.0 / (self.eta * self.eta)
        } else {
            self.eta * self.eta
        }
    }
    /// What is left of f cos / pdf, where facets are drawn as they are seen and by what they reflect: at grazing angles neither f
    /// nor the density is known well.
    fn weight(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.microfacets.reflection_weight(above(wi), above(wo))
    }
    /// Through the facet `h`, as if none ever reflected. `None` if the path stays on its side.
    pub(crate) fn refract(&self, wi: Vec3, h: Vec3, mode: Mode) -> Option<BsdfSample> {
        let cos = wi.dot(h);
        let interface = fresnel::dielectric(cos, self.eta);
        let cos_t = -interface.cos_t.copysign(cos);
        let wo = ((h * cos - wi) / interface.eta + h * cos_t).normalize();
        let pdf = if wo.z * wi.z < 0.0 { self.pdf_sa(wi, wo) } else { 0.0 };
        let radiance = if mode == Mode::Radiance { self.radiance_factor(wi, wo) } else { 1.0 };
        let weight = self.specular_transmittance * (self.weight(wi, wo) * radiance);
        (pdf > 0.0).then(|| BsdfSample { eta: interface.eta, ..BsdfSample::smooth(wo, weight, pdf) })
    }
    /// As [`Bsdf::upper_bound`](crate::Bsdf::upper_bound), from both sides and to both.
    pub(crate) fn bound_of_both_sides(&self, wi: Vec3, axis: Vec3, cos_half: f32) -> Lobe {
        if !(wi.z.abs() > 0.0) {
            return Lobe::NONE;
        }
        // Seen from below it is the same with the index turned round.
        let eta = if wi.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let axis = if wi.z > 0.0 { axis } else { Vec3::new(axis.x, axis.y, -axis.z) };
        let wi = above(wi);
        let reflected = Cone::above_surface(axis, cos_half).map_or(Lobe::NONE, |cone| {
            let bound = self.microfacets.reflection_bound(wi, &cone);
            let f = fresnel::dielectric_reflected_bound(bound.cos_half_min, bound.cos_half_max, eta)
                * self.specular_reflectance.largest()
                * Cone::ROUNDING;
            Lobe { with_cosine: f * bound.with_cosine, without_cosine: f * bound.without_cosine }
        });
        let below = Vec3::new(axis.x, axis.y, -axis.z);
        let refracted = Cone::above_surface(below, cos_half).map_or(Lobe::NONE, |cone| {
            // |i.h| |o.h| eta^2 / (i.h + eta o.h)^2 is largest where both cosines are one.
            let steepest = (eta / (eta - 1.0)).powi(2) * (1.0f32).max(1.0 / (eta * eta));
            let common = 1.001
                * self.microfacets.density_supremum()
                * self.masking_over_cos(wi)
                * steepest
                * self.specular_transmittance.largest();
            let supremum = self.microfacets.masking_over_cos_supremum();
            // G1 itself is at most one (Beckmann's fit a little more).
            let over_cos = supremum.min(1.0002 / cone.cos_min);
            Lobe { with_cosine: common * (over_cos * cone.cos_max).min(1.0002), without_cosine: common * over_cos }
        });
        Lobe {
            with_cosine: reflected.with_cosine.max(refracted.with_cosine),
            without_cosine: reflected.without_cosine.max(refracted.without_cosine),
        }
    }
}

fn above(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, w.z.abs())
}

impl Model for RoughDielectric {
    const SMOOTH: bool = true;
    const DELTA: bool = false;

    /// Of importance.
    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        let Some(f) = self.facet(wi, wo) else { return Spectrum::BLACK };
        let common = self.microfacets.density(f.h) * self.masking_over_cos(wi) * self.masking_over_cos(wo);
        if f.eta == 1.0 {
            self.specular_reflectance * (0.25 * common * f.fresnel.reflected)
        } else {
            self.specular_transmittance * (common * f.fresnel.transmitted * f.cos_i.abs() * self.jacobian(&f))
        }
    }
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        let Some(f) = self.facet(wi, wo) else { return 0.0 };
        let seen = self.microfacets.density(f.h) * self.microfacets.visible_over_cos(above(wi)) * f.cos_i.abs();
        let chosen = if f.eta == 1.0 { f.fresnel.reflected } else { f.fresnel.transmitted };
        seen * chosen * self.jacobian(&f)
    }
    /// `None` where a microfacet sends the path to the wrong side.
    fn sample(&self, wi: Vec3, mode: Mode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if !(wi.z.abs() > 0.0) {
            return None;
        }
        // Normals as they are seen from below are those seen from above, mirrored at the surface and turned.
        let h = self.microfacets.sample_visible(wi * wi.z.signum(), u);
        let cos = wi.dot(h);
        let interface = fresnel::dielectric(cos, self.eta);
        if u_lobe >= interface.reflected {
            return self.refract(wi, h, mode);
        }
        let wo = mirror(wi, h);
        let pdf = if wo.z * wi.z > 0.0 { self.pdf_sa(wi, wo) } else { 0.0 };
        (pdf > 0.0).then(|| BsdfSample::smooth(wo, self.specular_reflectance * self.weight(wi, wo), pdf))
    }
    /// The mean weight, of importance, of the 233 samples of a Fibonacci lattice: within 0.03.
    fn albedo(&self, wi: Vec3) -> Spectrum {
        lattice_albedo(|u_lobe, u| self.sample(wi, Mode::Importance, u_lobe, u))
    }
    fn upper_bound(&self, wi: Vec3, cone: &Cone) -> Lobe {
        self.bound_of_both_sides(wi, cone.axis, cone.half.cos())
    }
    fn split(&self, _wi: Vec3, alpha: f32) -> Option<Split> {
        self.microfacets.as_sharp_as(alpha).then_some(Split { dull: Bsdf::Black, sharp: (*self).into(), chance: 1.0 })
    }
}
