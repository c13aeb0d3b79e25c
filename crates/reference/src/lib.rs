//! Yardsticks that share nothing with the methods but the scene.
//!
//! `path`: at each vertex x of an eye path with throughput beta, one emitter point y and one direction w of the BSDF,
//!
//! > beta f |cos| L_e / p_light  x  w_light    +    beta f |cos| L_e / p_bsdf  x  w_bsdf,    w_a = p_a^2 / (p_a^2 + p_b^2)
//!
//! (Kajiya 1986; multiple importance sampling by Veach and Guibas 1995). Unbiased.
//!
//! `bidirectional` joins s vertices of a light path with t of an eye path, for all s and t, each way to make a path with density
//! p_s weighed by p_s / sum_i p_i (or the squares). `light-tracing` is t = 1 alone. Instant radiosity is t = 2 with weight 1.
//!
//! ```
//! use manylight_framework::Promise;
//! use manylight_reference::PathTracer;
//! assert!(PathTracer::default().claim().is_unbiased());
//! ```

mod bidirectional;
mod path;
mod splat;
mod subpath;
mod weights;

pub use bidirectional::BidirectionalPathTracer;
pub use path::PathTracer;
pub use weights::Combine;
