//! Tests of one mean: z, Student and Welch.

use crate::{Alternative, Moments};

/// What a test of one mean found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanTest {
    /// Estimate minus what it should be.
    pub difference: f64,
    /// Standard error of the difference.
    pub std_error: f64,
    /// Difference in standard errors. Without any variance: 0 if equal, infinite if not.
    pub t: f64,
    /// Degrees of freedom of t; infinite for a z test.
    pub degrees: f64,
    /// Probability of a t at least this extreme if the claim holds.
    pub p_value: f64,
}

impl MeanTest {
    /// A difference with its standard error.
    pub fn new(difference: f64, std_error: f64, degrees: f64, alternative: Alternative) -> Self {
        let t = if difference == 0.0 { 0.0 } else { difference / std_error };
        // No variance leaves no degrees of freedom for Satterthwaite to share out: 0 / 0.
        let degrees = if std_error == 0.0 { f64::INFINITY } else { degrees };
        MeanTest { difference, std_error, t, degrees, p_value: alternative.p_value(t, degrees) }
    }
    /// A mean whose standard error is known, against an exact value.
    pub fn z(mean: f64, std_error: f64, exact: f64, alternative: Alternative) -> Self {
        MeanTest::new(mean - exact, std_error, f64::INFINITY, alternative)
    }
    /// The mean of runs against an exact value (Student 1908).
    pub fn one_sample(a: &Moments, exact: f64, alternative: Alternative) -> Self {
        MeanTest::new(a.mean() - exact, a.std_error(), a.count() as f64 - 1.0, alternative)
    }
    /// The means of two sets of runs whose variances may differ (Welch 1947).
    pub fn welch(a: &Moments, b: &Moments, alternative: Alternative) -> Self {
        let (se_a, se_b) = (a.std_error(), b.std_error());
        let degrees = satterthwaite([(se_a, a.count() as f64 - 1.0), (se_b, b.count() as f64 - 1.0)]);
        MeanTest::new(a.mean() - b.mean(), se_a.hypot(se_b), degrees, alternative)
    }
}

/// Degrees of freedom of a sum of two variances given (standard error, degrees) of each (Satterthwaite 1946).
pub(crate) fn satterthwaite(parts: [(f64, f64); 2]) -> f64 {
    // Scaled by the larger, so that the fourth power of a small error does not underflow.
    let largest = parts[0].0.max(parts[1].0);
    let square = parts.map(|(se, _)| (se / largest).powi(2));
    (square[0] + square[1]).powi(2) / (square[0].powi(2) / parts[0].1 + square[1].powi(2) / parts[1].1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{assert_between, count};

    #[test]
    fn welch_by_hand() {
        // Means 2 and 6, variances 1 and 10, counts 3 and 5: se^2 = 1/3 + 2.
        let a: Moments = [1.0, 2.0, 3.0].into_iter().collect();
        let b: Moments = [2.0, 4.0, 6.0, 8.0, 10.0].into_iter().collect();
        let test = MeanTest::welch(&a, &b, Alternative::Different);
        assert!((test.t + 4.0 / (7.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((test.degrees - (49.0 / 9.0) / (1.0 / 18.0 + 1.0)).abs() < 1e-12, "{test:?}");
        assert!((test.p_value - 0.04).abs() < 0.01);
    }
    #[test]
    fn without_variance_equal_is_certain_and_unequal_impossible() {
        let (a, b): (Moments, Moments) = ([2.0; 4].into_iter().collect(), [2.5; 4].into_iter().collect());
        assert_eq!(MeanTest::welch(&a, &a, Alternative::Different).p_value, 1.0);
        assert_eq!(MeanTest::welch(&a, &b, Alternative::Different).p_value, 0.0);
        assert_eq!(MeanTest::one_sample(&a, 2.5, Alternative::Greater).p_value, 1.0);
        assert_eq!(MeanTest::one_sample(&a, 2.5, Alternative::Less).p_value, 0.0);
    }
    #[test]
    fn too_few_runs_never_pass() {
        let one: Moments = [2.0].into_iter().collect();
        assert!(MeanTest::one_sample(&one, 2.1, Alternative::Different).p_value.is_nan());
    }
    #[test]
    fn each_errs_as_often_as_it_says() {
        let errs = |seed, test: &dyn Fn(Moments, Moments) -> MeanTest| {
            count(seed, 4000, |rng| {
                let a = (0..6).map(|_| 3.0 + rng.normal()).collect();
                let b = (0..12).map(|_| 3.0 + 0.2 * rng.normal()).collect();
                test(a, b).p_value < 0.05
            })
        };
        assert_between(
            errs(1, &|a, _| MeanTest::z(a.mean(), 1.0 / 6f64.sqrt(), 3.0, Alternative::Different)),
            4000,
            0.05,
            0.05,
        );
        assert_between(errs(2, &|a, _| MeanTest::one_sample(&a, 3.0, Alternative::Different)), 4000, 0.05, 0.05);
        assert_between(errs(3, &|a, _| MeanTest::one_sample(&a, 3.0, Alternative::Greater)), 4000, 0.05, 0.05);
        assert_between(errs(4, &|a, _| MeanTest::one_sample(&a, 3.0, Alternative::Less)), 4000, 0.05, 0.05);
        assert_between(errs(5, &|a, b| MeanTest::welch(&a, &b, Alternative::Different)), 4000, 0.045, 0.055);
    }
}
