//! Yardsticks that share nothing with the methods but the scene.
//!
//! `path`: at each vertex x of an eye path with throughput beta, one emitter point y and one direction w of the BSDF,
//!
//! > beta f |cos| L_e / p_light  x  w_light    +    beta f |cos| L_e / p_bsdf  x  w_bsdf,    w_a = p_a^2 / (p_a^2 + p_b^2)
//!
//! (Kajiya 1986; multiple importance sampling by Veach and Guibas 1995). Unbiased.
//!
//! ```
//! use manylight_framework::Promise;
//! use manylight_reference::PathTracer;
//! assert!(PathTracer::default().claim().is_unbiased());
//! ```

mod path;

pub use path::PathTracer;
