//! A smooth interface between two transparent media.

use crate::bsdf::{BsdfSample, Lobe, Mode, Model};
use crate::cone::Cone;
use crate::fresnel;
use manylight_math::{Spectrum, Vec2, Vec3};

/// Glass or water: a delta lobe of reflection and one of refraction. `wi.z` < 0 is inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    eta: f32,
    specular_reflectance: Spectrum,
    specular_transmittance: Spectrum,
}

impl Dielectric {
    /// Indices of refraction inside (below the surface) and outside, and a factor for each lobe (1 for physical glass).
    pub fn new(int_ior: f32, ext_ior: f32, specular_reflectance: Spectrum, specular_transmittance: Spectrum) -> Self {
        Dielectric { eta: int_ior / ext_ior, specular_reflectance, specular_transmittance }
    }
}

impl Model for Dielectric {
    const SMOOTH: bool = false;
    const DELTA: bool = true;

    fn eval(&self, _wi: Vec3, _wo: Vec3) -> Spectrum {
        Spectrum::BLACK
    }
    fn pdf_sa(&self, _wi: Vec3, _wo: Vec3) -> f32 {
        0.0
    }
    /// A path along the surface is on neither side: none.
    fn sample(&self, wi: Vec3, mode: Mode, u_lobe: f32, _u: Vec2) -> Option<BsdfSample> {
        if !(wi.z.abs() > 0.0) {
            return None;
        }
        let interface = fresnel::dielectric(wi.z, self.eta);
        if u_lobe < interface.reflected {
            return Some(BsdfSample::mirror(wi, self.specular_reflectance, interface.reflected));
        }
        // The refracted direction. Rounding at the critical angle: nothing goes through.
        if !(interface.cos_t > 0.0 && interface.transmitted > 0.0) {
            return None;
        }
        let wo = Vec3::new(-wi.x / interface.eta, -wi.y / interface.eta, -interface.cos_t.copysign(wi.z));
        let weight = match mode {
            Mode::Importance => self.specular_transmittance,
            Mode::Radiance => self.specular_transmittance / (interface.eta * interface.eta),
        };
        Some(BsdfSample { wo, weight, pdf: interface.transmitted, delta: true, eta: interface.eta })
    }
    fn albedo(&self, _wi: Vec3) -> Spectrum {
        Spectrum::BLACK
    }
    fn upper_bound(&self, _wi: Vec3, _cone: &Cone) -> Lobe {
        Lobe::NONE
    }
}
