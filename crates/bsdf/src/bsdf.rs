//! The interface: one value that is any of the models.

use crate::cone::Cone;
use crate::{
    Conductor, Dielectric, Diffuse, Plastic, Principled, RoughConductor, RoughDielectric, RoughPlastic, ThinDielectric,
};
use manylight_math::{Spectrum, Vec2, Vec3};

/// What the path carries. Refraction squeezes radiance into another solid angle, and importance not: the two differ by
/// (eta_i / eta_t)^2 (Veach 1997, section 5.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Paths from the eye: what comes back along them is radiance.
    Radiance,
    /// Paths from a light: what comes back along them is importance.
    Importance,
}

/// One direction drawn by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Where the path goes.
    pub wo: Vec3,
    /// f |cos| / pdf.
    pub weight: Spectrum,
    /// Density per solid angle [1/sr] (of all smooth lobes together), or the probability of the delta lobe.
    pub pdf: f32,
    /// The direction was drawn from a delta lobe: no other direction could have been.
    pub delta: bool,
    /// Index of refraction of where the path goes over that of where it came from; 1 for reflection.
    pub eta: f32,
}

impl BsdfSample {
    /// The delta lobe of reflection, chosen with probability `pdf`.
    pub(crate) fn mirror(wi: Vec3, weight: Spectrum, pdf: f32) -> Self {
        BsdfSample { wo: Vec3::new(-wi.x, -wi.y, wi.z), weight, pdf, delta: true, eta: 1.0 }
    }
    pub(crate) fn smooth(wo: Vec3, weight: Spectrum, pdf: f32) -> Self {
        BsdfSample { wo, weight, pdf, delta: false, eta: 1.0 }
    }
}

/// Largest channel of a BSDF over a cone of directions: never below the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lobe {
    /// Bound of f cos. [1/sr]
    pub with_cosine: f32,
    /// Bound of f alone, for where a cosine has been cancelled. [1/sr]
    pub without_cosine: f32,
}

impl Lobe {
    /// Nothing is scattered into the cone.
    pub const NONE: Lobe = Lobe { with_cosine: 0.0, without_cosine: 0.0 };
}

/// A BSDF in two, by roughness: their sum is the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// All but the sharp lobes, delta lobes included.
    pub dull: Bsdf,
    /// The sharp lobes.
    pub sharp: Bsdf,
    /// Probability with which the whole samples its sharp lobes: how much of the light they are likely to carry.
    pub chance: f32,
}

/// What each model answers; [`Bsdf`] has the contracts. `upper_bound` is only asked for `wi` above the surface.
pub(crate) trait Model {
    const SMOOTH: bool;
    const DELTA: bool;
    fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum;
    fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32;
    fn sample(&self, wi: Vec3, mode: Mode, u_lobe: f32, u: Vec2) -> Option<BsdfSample>;
    fn albedo(&self, wi: Vec3) -> Spectrum;
    fn upper_bound(&self, wi: Vec3, cone: &Cone) -> Lobe;
    /// `None`: no lobe is as sharp as that, delta lobes aside.
    fn split(&self, _wi: Vec3, _alpha: f32) -> Option<Split> {
        None
    }
}

/// How a point of a surface scatters: a model with its textures resolved.
///
/// All models but the dielectrics (and the principled one with transmission) are one-sided: they scatter for `wi.z > 0` only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Scatters nothing.
    Black,
    /// Lambert's model.
    Diffuse(Diffuse),
    /// A smooth metal: delta.
    Conductor(Conductor),
    /// A rough metal.
    RoughConductor(RoughConductor),
    /// A smooth interface between transparent media: delta, and on both sides.
    Dielectric(Dielectric),
    /// A diffuse base under a smooth coat: delta and diffuse.
    Plastic(Plastic),
    /// A diffuse base under a rough coat.
    RoughPlastic(RoughPlastic),
    /// A sheet of glass: delta, and on both sides.
    ThinDielectric(ThinDielectric),
    /// A rough interface between transparent media, on both sides.
    RoughDielectric(RoughDielectric),
    /// Metal, glass, cloth and lacquer by a dozen numbers; on both sides if it transmits.
    Principled(Principled),
}

macro_rules! from_models {
    ($($model:ident),*) => {
        $(impl From<$model> for Bsdf {
            fn from(model: $model) -> Self {
                Bsdf::$model(model)
            }
        })*
    };
}
from_models!(
    Diffuse,
    Conductor,
    RoughConductor,
    Dielectric,
    Plastic,
    RoughPlastic,
    ThinDielectric,
    RoughDielectric,
    Principled
);

// One is kept in every virtual light.
const _: () = assert!(size_of::<Bsdf>() <= 48);

/// `answer` of whichever model it is, `black` if it is none.
macro_rules! ask {
    ($bsdf:expr, $black:expr, $model:ident => $answer:expr) => {
        match $bsdf {
            Bsdf::Black => $black,
            Bsdf::Diffuse($model) => $answer,
            Bsdf::Conductor($model) => $answer,
            Bsdf::RoughConductor($model) => $answer,
            Bsdf::Dielectric($model) => $answer,
            Bsdf::Plastic($model) => $answer,
            Bsdf::RoughPlastic($model) => $answer,
            Bsdf::ThinDielectric($model) => $answer,
            Bsdf::RoughDielectric($model) => $answer,
            Bsdf::Principled($model) => $answer,
        }
    };
}

impl Bsdf {
    /// f(wi, wo) of the non-delta lobes, without a cosine; black on the wrong side. Of importance: where it is refracted,
    /// radiance is `radiance_factor` of it. [1/sr]
    #[inline]
    pub fn eval(&self, wi: Vec3, wo: Vec3) -> Spectrum {
        ask!(self, Spectrum::BLACK, m => m.eval(wi, wo))
    }
    /// What radiance scatters over what importance does: (eta_i / eta_t)^2 where it is refracted, else 1.
    pub fn radiance_factor(&self, wi: Vec3, wo: Vec3) -> f32 {
        match self {
            Bsdf::RoughDielectric(m) => m.radiance_factor(wi, wo),
            Bsdf::Principled(m) if m.transmits() => m.radiance_factor(wi, wo),
            _ => 1.0,
        }
    }
    /// Density with which [`Bsdf::sample`] draws `wo` from the non-delta lobes, the probability of choosing them included. [1/sr]
    pub fn pdf_sa(&self, wi: Vec3, wo: Vec3) -> f32 {
        ask!(self, 0.0, m => m.pdf_sa(wi, wo))
    }
    /// Draws where the path goes. `u_lobe` chooses the lobe and `u` the direction in it. `None` is a path that ends: its
    /// share of the density is missing from the integral of [`Bsdf::pdf_sa`].
    pub fn sample(&self, wi: Vec3, mode: Mode, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        ask!(self, None, m => m.sample(wi, mode, u_lobe, u))
    }
    /// There are lobes that [`Bsdf::eval`] sees.
    pub fn has_smooth(&self) -> bool {
        ask!(self, false, m => is_smooth(m))
    }
    /// It scatters for `wi.z` > 0 only, and to `wo.z` > 0.
    #[inline]
    pub fn is_one_sided(&self) -> bool {
        match self {
            Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) | Bsdf::RoughDielectric(_) => false,
            Bsdf::Principled(m) => !m.transmits(),
            _ => true,
        }
    }
    /// There are delta lobes, that only [`Bsdf::sample`] finds.
    pub fn has_delta(&self) -> bool {
        ask!(self, false, m => is_delta(m))
    }
    /// Directional albedo of the non-delta lobes: the integral of f |cos| over `wo`. Closed form where there is one; the
    /// models that have none state their accuracy.
    pub fn albedo(&self, wi: Vec3) -> Spectrum {
        ask!(self, Spectrum::BLACK, m => m.albedo(wi))
    }
    /// Bound of the non-delta lobes, of radiance and of importance, over all `wo` of the cone around `axis`. A `cos_half` that was computed must have been
    /// rounded down: at exactly 1 the cone is one direction; at -1 it is the sphere.
    pub fn upper_bound(&self, wi: Vec3, axis: Vec3, cos_half: f32) -> Lobe {
        match self {
            Bsdf::RoughDielectric(m) => return m.bound_of_both_sides(wi, axis, cos_half),
            Bsdf::Principled(m) => return m.bound_of_both_sides(wi, axis, cos_half),
            _ => {}
        }
        if !(wi.z > 0.0) {
            return Lobe::NONE;
        }
        let Some(cone) = Cone::above_surface(axis, cos_half) else { return Lobe::NONE };
        ask!(self, Lobe::NONE, m => m.upper_bound(wi, &cone))
    }
    /// Parts the lobes of a roughness of at most `alpha` from the others; `None` if there are none, delta lobes aside.
    pub fn split(&self, wi: Vec3, alpha: f32) -> Option<Split> {
        ask!(self, None, m => m.split(wi, alpha))
    }
}

fn is_smooth<M: Model>(_: &M) -> bool {
    M::SMOOTH
}
fn is_delta<M: Model>(_: &M) -> bool {
    M::DELTA
}
