//! Tests with a stated significance and power, for whatever draws random numbers. Knows no renderer; all numbers are f64.
//!
//! All pixels of one run share its lights, so the run is the unit of every statistic, and "passes" means something only
//! together with the smallest relative bias d that would have been seen in R runs of relative standard deviation s:
//! R = (z(1 - alpha / 2K) + z(power))^2 s^2 / d^2 for K comparisons.
//!
//! ```
//! use manylight_stats::{BlockTest, Reference, Runs};
//! // Eight runs of an estimator, two blocks; the exact block means are 1 and 3.
//! let runs = [0.02, -0.01, 0.03, -0.02, 0.01, -0.03, 0.02, -0.02].map(|e| vec![1.0 + e, 3.0 - e]);
//! let verdict = BlockTest::default().run(&Runs::new(runs.to_vec())?, Reference::Exact(&[1.0, 3.0]))?;
//! assert!(verdict.passes(), "{verdict}");
//! // It would not have seen a bias of 1 %.
//! assert!(verdict.detectable.unwrap().common > 0.01);
//! # Ok::<(), manylight_stats::StatsError>(())
//! ```

mod block_test;
mod chi2;
mod distribution;
mod equivalence;
mod error;
mod heavy_tail;
mod mean_test;
mod moments;
mod multiple;
mod permutation;
mod power;
mod rng;
mod runs;
mod slope;
#[cfg(test)]
mod synthetic;
mod verdict;

pub use block_test::{BlockTest, Reference};
pub use chi2::{Chi2, chi2_goodness_of_fit};
pub use distribution::{Alternative, normal_quantile, normal_upper, student_quantile, student_upper};
pub use equivalence::Equivalence;
pub use error::StatsError;
pub use heavy_tail::TopShare;
pub use mean_test::MeanTest;
pub use moments::{BlockMoments, Moments};
pub use multiple::{holm, sidak_alpha};
pub use permutation::{PERMUTATIONS, Permutation, label_permutation, sign_flip};
pub use power::Detection;
pub use runs::Runs;
pub use slope::{Point, Slope};
pub use verdict::{Detectable, Outcome, Verdict, Worst};
