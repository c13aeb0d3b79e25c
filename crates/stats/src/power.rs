//! What a test would have seen.

use crate::{Alternative, normal_quantile, student_quantile, student_upper};

/// A test's promise: it errs with probability `alpha` over all its comparisons, and sees a bias with probability `power`.
///
/// A bias of d standard errors is seen with that power if d >= z(1 - alpha / 2K) + z(power); the comparisons are K, and K
/// stands for 2K where one side counts. Bonferroni's alpha / K is the first step of Holm's, so Holm sees as much or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Family-wise probability of a false alarm.
    pub alpha: f64,
    /// Comparisons that share it.
    pub comparisons: usize,
    /// Probability to see what is there.
    pub power: f64,
    /// Which departures count.
    pub alternative: Alternative,
}

impl Detection {
    /// Runs needed for a relative bias d at a relative standard deviation s of one run, in units of s^2 / d^2.
    pub fn factor(&self) -> f64 {
        (self.critical(f64::INFINITY) + normal_quantile(self.power)).powi(2)
    }
    /// Runs of one estimator needed against an exact value (against as many runs of another: twice as many). Rounded up.
    pub fn runs_needed(&self, relative_std_dev: f64, relative_bias: f64) -> u64 {
        (self.factor() * (relative_std_dev / relative_bias).powi(2)).ceil() as u64
    }
    /// The smallest bias that is seen with the stated power in a single comparison whose standard error has `degrees` of
    /// freedom.
    pub fn smallest_bias(&self, std_error: f64, degrees: f64) -> f64 {
        std_error * (self.critical(degrees) + student_quantile(self.power, degrees))
    }
    /// The power against a bias of `bias` standard errors in a single comparison, by the shifted t distribution (close to
    /// the noncentral one from some 20 degrees on).
    pub fn power_against(&self, bias: f64, degrees: f64) -> f64 {
        student_upper(self.critical(degrees) - bias, degrees)
    }
    /// The size of t from which on a single comparison is rejected.
    fn critical(&self, degrees: f64) -> f64 {
        self.alternative.critical(self.alpha / self.comparisons.max(1) as f64, degrees)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{assert_between, count};
    use crate::{MeanTest, Moments};

    fn detection(comparisons: usize) -> Detection {
        Detection { alpha: 0.01, comparisons, power: 0.9, alternative: Alternative::Different }
    }
    #[test]
    fn the_figures_of_the_conventions() {
        for (comparisons, z, factor) in [(256, 4.113, 29.10), (64, 3.781, 25.63)] {
            let test = detection(comparisons);
            assert!((test.critical(f64::INFINITY) - z).abs() < 5e-4);
            assert!((test.factor() - factor).abs() < 5e-3, "{}", test.factor());
        }
        assert_eq!(detection(256).runs_needed(0.1, 0.01), 2911);
    }
    #[test]
    fn one_sided_tests_see_more() {
        let one_sided = Detection { alternative: Alternative::Greater, ..detection(64) };
        assert!(one_sided.smallest_bias(1.0, 50.0) < detection(64).smallest_bias(1.0, 50.0));
        assert_eq!(one_sided.smallest_bias(1.0, 50.0), {
            let doubled = Detection { alpha: 0.02, ..detection(64) };
            doubled.smallest_bias(1.0, 50.0)
        });
    }
    #[test]
    fn power_and_smallest_bias_agree() {
        let test = detection(16);
        assert!((test.power_against(test.smallest_bias(1.0, 40.0), 40.0) - 0.9).abs() < 1e-9);
    }
    #[test]
    fn a_bias_that_should_be_seen_is_seen() {
        for (runs, low, high) in [(16, 0.86, 0.93), (64, 0.88, 0.92), (400, 0.89, 0.91)] {
            let test = detection(8);
            // In true standard errors: what the runs themselves estimate varies with them.
            let bias = test.smallest_bias((runs as f64).sqrt().recip(), runs as f64 - 1.0);
            let seen = count(7, 2000, |rng| {
                let a: Moments = (0..runs).map(|_| bias + rng.normal()).collect();
                MeanTest::one_sample(&a, 0.0, Alternative::Different).p_value < 0.01 / 8.0
            });
            assert_between(seen, 2000, low, high);
        }
    }
}
