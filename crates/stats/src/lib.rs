//! Tests with a stated significance and power, for whatever draws random numbers. Knows no renderer.
//!
//! ```
//! use manylight_stats::{chi2_goodness_of_fit, sidak_alpha};
//! let die = chi2_goodness_of_fit(&[95, 108, 99, 101, 92, 105], &[100.0; 6], 0);
//! assert!(die.p_value > sidak_alpha(0.01, 3), "{die:?}");
//! ```

mod chi2;
mod multiple;

pub use chi2::{Chi2, chi2_goodness_of_fit};
pub use multiple::{holm, sidak_alpha};
