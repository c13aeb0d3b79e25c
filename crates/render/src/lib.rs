//! Passes into images, images into files: the one crate below the program that reads a clock, starts threads and writes.
//!
//! An image is the mean of passes, and the pass is the unit of every statistic: virtual lights are shared by all pixels of
//! a pass, so that only whole passes are independent. With n passes x_1 .. x_n of a pixel's channel,
//!
//! ```text
//! mean = sum x_i / n,    standard error of the mean = sqrt(sum (x_i - mean)^2 / (n (n - 1)))
//! ```
//!
//! ```
//! use manylight_framework::Image;
//! use manylight_render::Accumulator;
//! let pass = |x: f32| Image { width: 1, height: 1, pixels: vec![manylight_math::Spectrum::gray(x)] };
//! let mut film = Accumulator::new(1, 1);
//! film.add(&pass(1.0))?;
//! film.add(&pass(3.0))?;
//! assert_eq!(film.mean().pixels[0].to_array(), [2.0; 3]);
//! assert_eq!(film.standard_error().unwrap().pixels[0].to_array(), [1.0; 3]);
//! # Ok::<(), manylight_render::RenderError>(())
//! ```

mod accumulator;
mod budget;
mod error;
mod explain;
pub mod files;
mod memory;
mod run;
mod stats;
mod workers;

pub use accumulator::Accumulator;
pub use budget::Budget;
pub use error::RenderError;
pub use explain::{Explained, explain};
pub use memory::peak_memory;
pub use run::{Observer, Progress, Rendering, Session, Settings, render};
pub use stats::{NonFinite, Rays, SampleAt, Seconds, Stats, Subject};
