//! A smooth metal.

use crate::bsdf::{BsdfSample, Lobe, Mode, Model};
use crate::cone::Cone;
use crate::fresnel;
use manylight_math::{Spectrum, Vec2, Vec3};

/// A mirror that reflects as a conductor does, one-sided: a delta lobe alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    eta: Spectrum,
    k: Spectrum,
    specular_reflectance: Spectrum,
}

impl Conductor {
    /// Index of refraction `eta` + i `k` relative to the outside, and a factor (1 for a physical metal). `eta` = 0 with
    /// `k` = 1 is a mirror that reflects everything.
    pub fn new(eta: Spectrum, k: Spectrum, specular_reflectance: Spectrum) -> Self {
        Conductor { eta, k, specular_reflectance }
    }
}

impl Model for Conductor {
    const SMOOTH: bool = false;
    const DELTA: bool = true;

    fn eval(&self, _wi: Vec3, _wo: Vec3) -> Spectrum {
        Spectrum::BLACK
    }
    fn pdf_sa(&self, _wi: Vec3, _wo: Vec3) -> f32 {
        0.0
    }
    fn sample(&self, wi: Vec3, _mode: Mode, _u_lobe: f32, _u: Vec2) -> Option<BsdfSample> {
        if !(wi.z > 0.0) {
            return None;
        }
        let weight = fresnel::conductor(wi.z, self.eta, self.k) * self.specular_reflectance;
        Some(BsdfSample::mirror(wi, weight, 1.0))
    }
    fn albedo(&self, _wi: Vec3) -> Spectrum {
        Spectrum::BLACK
    }
    fn upper_bound(&self, _wi: Vec3, _cone: &Cone) -> Lobe {
        Lobe::NONE
    }
}
