//! How far an image is from a reference.
//!
//! The main figure is relMSE = mean (I - R)^2 / (R^2 + eps) with eps = 0.01 (mean R)^2, beside it those that show what it
//! hides: the 99.9th percentile, the worst pixels, and every pixel that is not finite. A [`Study`] is methods x budgets x runs of such
//! errors: intervals over runs, slopes, efficiencies, as CSV, JSON, SVG and one HTML page.
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
mod drawing;
mod error;
mod flip;
mod halves;
mod page;
mod plot;
mod steadiness;
mod study;
mod view;

pub use blocks::{Block, block_means};
pub use compare::{Comparison, compare};
pub use difference::{Difference, ImageSummary, WorstPixel};
pub use drawing::{Drawing, Mark};
pub use error::ReportError;
pub use flip::Flip;
pub use halves::{HalvesError, compare_halves};
pub use page::{Figure, Gallery, Picture};
pub use plot::Axis;
pub use steadiness::{Sequence, Steadiness};
pub use study::{COLUMNS, Column, Cost, Duel, Estimate, Noise, Row, Study, Subject, Summary, Verdict, separate};
pub use view::ImageView;
