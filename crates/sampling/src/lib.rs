//! Random numbers and what is made of them: streams that depend on their place alone, warps with their densities, tables.
//!
//! ```
//! use manylight_sampling::{Purpose, Stream, warp};
//! let mut s = Stream::new(1, [0, 42, 0], Purpose::CAMERA);
//! let w = warp::cosine_hemisphere(s.next_2d());
//! assert!(w.z >= 0.0 && (warp::cosine_hemisphere_pdf(w) - w.z / std::f32::consts::PI).abs() < 1e-7);
//! ```

pub mod along;
mod discrete;
mod stream;
mod table2d;
pub mod warp;

pub use discrete::{AliasTable, Cdf};
pub use stream::{Numbers, Purpose, Stream};
pub use table2d::Table2d;
