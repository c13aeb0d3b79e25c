//! Media that scatter, absorb and emit: fog, smoke, juice, fire.
//!
//! With sigma_t = sigma_a + sigma_s [1/m] and a phase function f [1/sr] that integrates to one, along a ray
//!
//! > L(0) = int T(0,t) \[j(t) + sigma_s(t) int f L(w) dw\] dt + T(0,s) L(s),    T(a,b) = exp(-int_a^b sigma_t).
//!
//! [`Medium::fly`] draws t, [`Medium::transmittance`] estimates T, [`Medium::emitted`] the integral over the
//! emission j; all are unbiased in each channel, though the channels share one draw.
//!
//! ```
//! use manylight_math::{Ray, Spectrum, Vec3};
//! use manylight_media::{HenyeyGreenstein, Homogeneous, Medium};
//! use manylight_sampling::{Purpose, Stream};
//! let fog = Homogeneous::new(Spectrum::gray(0.4), Spectrum::gray(0.5), HenyeyGreenstein::new(0.3).unwrap()).unwrap();
//! let fog = Medium::from(fog);
//! let mut s = Stream::new(1, [0; 3], Purpose::TEST);
//! let t = fog.transmittance(&Ray::new(Vec3::ZERO, Vec3::X), 0.0, 2.0, &mut s);
//! assert!((t.luminance() - (-1.0f32).exp()).abs() < 1e-6);
//! ```

pub mod blackbody;
mod glow;
mod heterogeneous;
mod homogeneous;
mod march;
mod medium;
mod phase;
mod volume;

pub use glow::Glow;
pub use heterogeneous::Heterogeneous;
pub use homogeneous::Homogeneous;
pub use medium::{Flight, Medium, MediumError};
pub use phase::HenyeyGreenstein;
pub use volume::{Grid, Interpolation, Volume};
