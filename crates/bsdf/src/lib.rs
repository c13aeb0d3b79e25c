//! How surfaces scatter: evaluate, sample, density, albedo, and an upper bound over a cone of directions.
//!
//! Everything happens in the local shading frame: the normal is +z, every direction is unit and points *away* from the
//! surface. `wi` is where the path came from, `wo` where it goes; of radiance L arriving along `wo`, the surface sends
//! f(wi, wo) |wo.z| L towards `wi`. A [`Bsdf`] is a small `Copy` value whose textures are already resolved, so that a
//! virtual light can keep one.
//!
//! ```
//! use manylight_bsdf::{Bsdf, Diffuse, Mode};
//! use manylight_math::{Spectrum, Vec2, Vec3};
//! let bsdf = Bsdf::from(Diffuse::new(Spectrum::gray(0.5)));
//! let s = bsdf.sample(Vec3::Z, Mode::Radiance, 0.5, Vec2::new(0.3, 0.7)).unwrap();
//! assert_eq!(s.weight, Spectrum::gray(0.5)); // f cos / pdf
//! let bound = bsdf.upper_bound(Vec3::Z, s.wo, 0.99);
//! assert!(bsdf.eval(Vec3::Z, s.wo).largest() <= bound.without_cosine);
//! ```

mod bsdf;
mod conductor;
mod cone;
mod dielectric;
mod diffuse;
pub mod fresnel;
mod microfacet;
mod microfacet_bound;
mod plastic;
mod principled;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod rough_transmittance;
mod special;
mod thin_dielectric;

pub use bsdf::{Bsdf, BsdfSample, Lobe, Mode, Split};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use microfacet::{Distribution, MIN_ALPHA};
pub use plastic::Plastic;
pub use principled::{Principled, PrincipledParameters};
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use rough_transmittance::RoughTransmittance;
pub use thin_dielectric::ThinDielectric;
