//! Holds methods against what they claim.
//!
//! A method says what it promises as data ([`Claim`](manylight_framework::Claim)); a [`Verifier`] reads it and makes the checks that it
//! calls for, in small scenes of its own or in any other:
//!
//! | claim | check |
//! |---|---|
//! | unbiased | block means over passes are the truth's: two-sided t tests, Holm over blocks |
//! | never too bright | nowhere above the truth: one-sided |
//! | the bias vanishes with a knob | at a far end of the knob at most a quarter of it is left, or what the noise hides |
//! | infinite variance | no verdict but where the geometry term is bounded |
//! | misses paths | held against the truth of the paths that it makes, or one-sided |
//!
//! The truth is a closed form or the path tracer, and for the path tracer bidirectional path tracing. A right method fails with a
//! probability of [`ALPHA`] at most, and each verdict says the smallest bias it would have seen.
//!
//! ```
//! use manylight_reference::PathTracer;
//! use manylight_verify::{Built, Effort, Made, Place, Verifier};
//! let tracer = Made {
//!     name: "light by chance".into(),
//!     make: |scene: &manylight_scene::Scene, _: &manylight_verify::Knobs| {
//!         let max_edges = scene.max_depth().unwrap_or(u32::MAX);
//!         Ok(Built { method: Box::new(PathTracer { max_edges, next_event: false, ..PathTracer::default() }), spp: 16 })
//!     },
//! };
//! let furnace = Place::standard()?.swap_remove(0);
//! let report = Verifier::new(vec![furnace], Effort::QUICK, 1).verify(&tracer)?;
//! assert!(report.says_something() && !report.fails(), "{report}");
//! # Ok::<(), manylight_verify::VerifyError>(())
//! ```

mod error;
mod finding;
mod ladder;
mod measure;
mod place;
pub mod stability;
mod subject;
mod verifier;

pub use error::VerifyError;
pub use finding::{Finding, Outcome, Report};
pub use measure::Effort;
pub use place::Place;
pub use subject::{Built, Knobs, Made, Subject};
pub use verifier::{ALPHA, Verifier};
