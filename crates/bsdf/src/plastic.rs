//! A diffuse base under a smooth coat.

use crate::bsdf::{BsdfSample, Lobe, Mode, Model};
use crate::cone::Cone;
use crate::fresnel;
use manylight_math::{INV_PI, Spectrum, Vec2, Vec3};
use manylight_sampling::warp;

/// A diffuse base under a smooth dielectric coat, one-sided: a delta lobe off the coat, and what enters it, scatters once
/// or more at the base and leaves: f = rho T(wi) T(wo) / (pi eta^2 (1 - rho R)), R the coat's reflectance from inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    eta: f32,
    /// rho / (eta^2 (1 - rho R)).
    base: Spectrum,
    specular_reflectance: Spectrum,
    /// How much the lobe choice leans to the coat.
    specular_weight: f32,
}

impl Plastic {
    /// Indices of refraction of the coat and outside. `specular_reflectance` is a factor (1 for a physical coat).
    /// `nonlinear`: light scattered several times at the base takes its colour several times; otherwise it only takes it
    /// once (rho R above becomes R).
    pub fn new(
        int_ior: f32,
        ext_ior: f32,
        diffuse_reflectance: Spectrum,
        specular_reflectance: Spectrum,
        nonlinear: bool,
    ) -> Self {
        let eta = int_ior / ext_ior;
        Plastic {
            eta,
            base: base(diffuse_reflectance, fresnel::diffuse_reflected_fit(1.0 / eta), eta, nonlinear),
            specular_reflectance,
            specular_weight: specular_weight(diffuse_reflectance, specular_reflectance),
        }
    }
    fn coat(&self, w: Vec3) -> fresnel::Interface {
        fresnel::dielectric(w.z, self.eta)
    }
    fn choice(&self, wi: Vec3) -> Option<Choice> {
        let coat = self.coat(wi);
        Choice::new(coat.reflected, coat.transmitted, self.specular_weight)
    }
}

/// rho / (eta^2 (1 - rho R)): the base with all that the coat sends back to it.
pub(crate) fn base(diffuse_reflectance: Spectrum, internal_reflectance: f32, eta: f32, nonlinear: bool) -> Spectrum {
    diffuse_reflectance.map(|rho| {
        let returned = if nonlinear { rho * internal_reflectance } else { internal_reflectance };
        rho / (eta * eta * (1.0 - returned))
    })
}
/// How much a lobe choice leans to the specular lobe, in [0, 1].
pub(crate) fn specular_weight(diffuse: Spectrum, specular: Spectrum) -> f32 {
    let sum = diffuse.mean() + specular.mean();
    if sum > 0.0 { specular.mean() / sum } else { 0.0 }
}
/// Probabilities of choosing either lobe. At grazing angles that of the base is small, but not nothing: it is not made
/// of the other.
pub(crate) struct Choice {
    pub coat: f32,
    pub base: f32,
}
impl Choice {
    /// `None` if neither lobe has anything to give.
    pub fn new(reflected: f32, transmitted: f32, specular_weight: f32) -> Option<Self> {
        let (coat, base) = (reflected * specular_weight, transmitted * (1.0 - specular_weight));
        let sum = coat + base;
        if sum > 0.0 { Some(Choice { coat: coat / sum, base: base / sum }) } else { None }
    }
}

impl Model for Plastic {
    const SMOOTH: bool = true;
    const DELTA: bool = true;

    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return Spectrum::BLACK;
        }
        self.base * (INV_PI * self.coat(wi).transmitted * self.coat(wo).transmitted)
    }
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        if !(wi.z > 0.0) {
            return 0.0;
        }
        self.choice(wi).map_or(0.0, |choice| choice.base * warp::cosine_hemisphere_pdf(wo))
    }
    fn sample(&self, wi: Vec3, _mode: Mode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if !(wi.z > 0.0) {
            return None;
        }
        let coat = self.coat(wi);
        let choice = self.choice(wi)?;
        if u_lobe < choice.coat {
            return Some(BsdfSample::mirror(
                wi,
                self.specular_reflectance * (coat.reflected / choice.coat),
                choice.coat,
            ));
        }
        let wo = warp::cosine_hemisphere(u);
        if !(wo.z > 0.0 && choice.base > 0.0) {
            return None;
        }
        let weight = self.base * (coat.transmitted * self.coat(wo).transmitted / choice.base);
        Some(BsdfSample::smooth(wo, weight, choice.base * warp::cosine_hemisphere_pdf(wo)))
    }
    fn albedo(&self, wi: Vec3) -> Spectrum {
        if !(wi.z > 0.0) {
            return Spectrum::BLACK;
        }
        self.base * (self.coat(wi).transmitted * (1.0 - fresnel::diffuse_reflected(self.eta)))
    }
    fn upper_bound(&self, wi: Vec3, cone: &Cone) -> Lobe {
        let leaving = fresnel::dielectric_transmitted_bound(cone.cos_min, cone.cos_max, self.eta);
        cone.lobe_of_constant(self.base.largest() * INV_PI * self.coat(wi).transmitted * leaving)
    }
}
