//! A sheet of glass without thickness.

use crate::bsdf::{BsdfSample, Lobe, Mode, Model};
use crate::cone::Cone;
use crate::fresnel;
use manylight_math::{Spectrum, Vec2, Vec3};

/// Two parallel smooth interfaces so near to each other that nothing is refracted: a delta lobe of reflection, one straight
/// through. With all reflections between the two, R' = R + T^2 R / (1 - R^2) = 2 R / (1 + R).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric {
    eta: f32,
    specular_reflectance: Spectrum,
    specular_transmittance: Spectrum,
}

impl ThinDielectric {
    /// Indices of refraction of the sheet and outside, and a factor for each lobe (1 for physical glass).
    pub fn new(int_ior: f32, ext_ior: f32, specular_reflectance: Spectrum, specular_transmittance: Spectrum) -> Self {
        ThinDielectric { eta: int_ior / ext_ior, specular_reflectance, specular_transmittance }
    }
}

impl Model for ThinDielectric {
    const SMOOTH: bool = false;
    const DELTA: bool = true;

    fn eval(&self, _wi: Vec3, _wo: Vec3) -> Spectrum {
        Spectrum::BLACK
    }
    fn pdf_sa(&self, _wi: Vec3, _wo: Vec3) -> f32 {
        0.0
    }
    fn sample(&self, wi: Vec3, _mode: Mode, u_lobe: f32, _u: Vec2) -> Option<BsdfSample> {
        if !(wi.z.abs() > 0.0) {
            return None;
        }
        let interface = fresnel::dielectric(wi.z.abs(), self.eta);
        let reflected = 2.0 * interface.reflected / (1.0 + interface.reflected);
        if u_lobe < reflected {
            return Some(BsdfSample::mirror(wi, self.specular_reflectance, reflected));
        }
        // 1 - R', without its cancellation at grazing angles.
        let pdf = interface.transmitted / (1.0 + interface.reflected);
        let through = BsdfSample { wo: -wi, weight: self.specular_transmittance, pdf, delta: true, eta: 1.0 };
        (pdf > 0.0).then_some(through)
    }
    fn albedo(&self, _wi: Vec3) -> Spectrum {
        Spectrum::BLACK
    }
    fn upper_bound(&self, _wi: Vec3, _cone: &Cone) -> Lobe {
        Lobe::NONE
    }
}
