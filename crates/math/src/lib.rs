//! Vectors (from `glam`), linear RGB, rays, boxes and frames: what every other crate counts in.
//!
//! Lengths are metres, directions are unit and point *away* from the vertex they belong to unless a function says otherwise.
//!
//! ```
//! use manylight_math::{Frame, Spectrum, Vec3};
//! let frame = Frame::around(Vec3::Y);
//! let local = frame.to_local(Vec3::new(0.6, 0.8, 0.0));
//! assert!((local.z - 0.8).abs() < 1e-6);
//! assert_eq!(Spectrum::gray(2.0) * 0.5, Spectrum::ONE);
//! ```

mod aabb;
mod frame;
mod ray;
mod spectrum;

pub use aabb::Aabb;
pub use frame::Frame;
pub use glam::{DAffine3, DMat3, DMat4, DVec3, Mat3, Vec2, Vec3, Vec3A};
pub use ray::{MediumId, Ray};
pub use spectrum::Spectrum;

/// 1 / pi. [1/sr] as the BSDF of a white diffuse surface.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
/// 1 / (4 pi). [1/sr] as the isotropic phase function.
pub const INV_4PI: f32 = 0.25 * std::f32::consts::FRAC_1_PI;
