//! Virtual ray lights (Novak, Nowrouzezahrai, Dachsbacher and Jarosz 2012): every edge of a light path that runs through a
//! medium is a light, and scatters all along its length.
//!
//! A ray light r(v) of flux Phi \[W\] brings to the camera's ray c(u)
//!
//! > L = Phi int int T(c(u) -> eye) sigma_s(u) f_u  T V / w^2  f_v sigma_s(v) T(v) dv du,    w = |c(u) - r(v)|.
//!
//! Both points are drawn with a joint density in 1/w^2, which cancels it: what is left of the singularity is a logarithm, whose
//! variance over the ray lights is finite. Surface vertices of the same paths are point lights; vertices in media are none, the
//! rays through them stand for them.
//!
//! ```
//! use manylight_framework::Promise;
//! use manylight_vrl::{Extent, RayWalk};
//! let walk = RayWalk { paths: 64, max_edges: None, certain_edges: 1, extent: Extent::Short, emitters: false };
//! assert!(walk.claim().is_unbiased());
//! ```

mod generator;
mod kernel;
mod vrl;

pub use generator::{Extent, RayWalk};
pub use kernel::{Drawn, Rays, draw_pair};
pub use vrl::Vrl;
