//! Lambert's model.

use crate::bsdf::{BsdfSample, Lobe, Mode, Model};
use crate::cone::Cone;
use manylight_math::{INV_PI, Spectrum, Vec2, Vec3};
use manylight_sampling::warp;

/// Ideally diffuse, one-sided: f = rho / pi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    reflectance: Spectrum,
}

impl Diffuse {
    /// `reflectance`: the fraction of light scattered, in [0, 1].
    pub fn new(reflectance: Spectrum) -> Self {
        Diffuse { reflectance }
    }
    /// rho / pi, which it is wherever it scatters. [1/sr]
    #[inline]
    pub fn value(&self) -> Spectrum {
        self.reflectance * INV_PI
    }
}

impl Model for Diffuse {
    const SMOOTH: bool = true;
    const DELTA: bool = false;

    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        if wi.z > 0.0 && wo.z > 0.0 { self.reflectance * INV_PI } else { Spectrum::BLACK }
    }
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        if wi.z > 0.0 { warp::cosine_hemisphere_pdf(wo) } else { 0.0 }
    }
    fn sample(&self, wi: Vec3, _mode: Mode, _u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let wo = warp::cosine_hemisphere(u);
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return None;
        }
        Some(BsdfSample::smooth(wo, self.reflectance, warp::cosine_hemisphere_pdf(wo)))
    }
    fn albedo(&self, wi: Vec3) -> Spectrum {
        if wi.z > 0.0 { self.reflectance } else { Spectrum::BLACK }
    }
    fn upper_bound(&self, _wi: Vec3, cone: &Cone) -> Lobe {
        cone.lobe_of_constant(self.reflectance.largest() * INV_PI)
    }
}
