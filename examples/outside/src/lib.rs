//! A light and a light set from elsewhere.
//!
//! A virtual light on a diffuse surface shines as cos / d^2, whatever its material: all that need be kept is one colour.
//!
//! ```
//! use manylight_framework::Promise;
//! use outside::Reservoir;
//! assert!(Reservoir { candidates: 16 }.claim().is_unbiased());
//! ```

mod lambert;
mod reservoir;

pub use lambert::{Lambert, Sorted, Two};
pub use reservoir::{Candidates, Reservoir};
