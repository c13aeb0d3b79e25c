//! Photon maps: what light paths leave near a point or a ray is taken for what arrives there.
//!
//! A virtual light is connected to a receiver; a photon *is* at the receiver if it is nearer than a radius R, and its flux is spread
//! over the ball, the disc or the width that R makes (its *blur*). No shadow ray, no 1 / d^2, no caustic that cannot be connected,
//! and a bias that goes with R. Of light that scatters in a medium along the camera's ray c(u), there are
//!
//! > points at points (3D blur):  sum_i Phi_i f_i / (4/3 pi R^3), at points of the ray         (Jensen and Christensen 1998),
//! > points at the ray (2D):      sum_i Phi_i f_i T(u_i) / (pi R^2)                             (Jarosz et al. 2008),
//! > beams at the ray (1D):       sum_i Phi_i sigma_s f_i T(v_i) T(u_i) / (2 R sin(theta_i))   (Jarosz et al. 2011),
//!
//! and on surfaces Phi_i f_i / (pi R^2) of points on discs. Radii that shrink from pass to pass make the mean over passes converge to
//! the truth (Knaus and Zwicker 2011). Photons of a path's first edge are left out: they are direct light, which is sampled.
//!
//! These are lights, a light set and a kernel as any others: [`Photons`] and [`PhotonBeams`] make the lights, [`Nearby`] finds those
//! that a receiver can be near to, [`Estimate`] says what they give.
//!
//! ```
//! use manylight_photon::Radii;
//! let radii = Radii { first: 0.1, shrink: Some(0.5) };
//! assert_eq!(radii.at(0, 2.0), 0.1);
//! assert!((radii.at(15, 2.0) - 0.05).abs() < 1e-6); // 16^((0.5 - 1) / 2) = 1/2
//! ```

mod beam;
mod estimate;
mod generator;
mod nearby;
mod photon;
mod radii;

pub use beam::Beam;
pub use estimate::Estimate;
pub use generator::{BeamSource, PhotonBeams, Photons};
pub use nearby::{Near, Nearby, NearbyLights};
pub use photon::Photon;
pub use radii::Radii;
