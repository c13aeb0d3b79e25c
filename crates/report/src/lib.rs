//! How far an image is from a reference.
//!
//! The main figure is relMSE = mean (I - R)^2 / (R^2 + eps) with eps = 0.01 (mean R)^2, beside it those that show what it
//! hides: the 99.9th percentile, the worst pixels, and every pixel that is not finite.
//!
//! ```
//! use manylight_math::Spectrum;
//! use manylight_report::{ImageView, compare};
//! let (image, reference) = ([Spectrum::gray(1.1); 4], [Spectrum::ONE; 4]);
//! let difference = compare(&ImageView::new(2, 2, &image)?, &ImageView::new(2, 2, &reference)?)?;
//! assert!((difference.relmse.unwrap() - 0.01 / 1.01).abs() < 1e-6, "{difference}");
//! # Ok::<(), manylight_report::ReportError>(())
//! ```

mod blocks;
mod compare;
mod difference;
mod error;
mod flip;
mod halves;
mod view;

pub use blocks::{Block, block_means};
pub use compare::{Comparison, compare};
pub use difference::{Difference, ImageSummary, WorstPixel};
pub use error::ReportError;
pub use flip::Flip;
pub use halves::{HalvesError, compare_halves};
pub use view::ImageView;
