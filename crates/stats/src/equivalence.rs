//! "The same within d" as a claim that has to be earned.

use crate::{Alternative, MeanTest, Moments};

/// Two one-sided tests (Schuirmann 1987). The null hypothesis is a difference of `margin` or more, so that a small p value
/// shows equivalence; few runs show nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equivalence {
    /// The claim that is tested: |difference| < margin.
    pub margin: f64,
    /// Against "difference <= -margin".
    pub above_lower: MeanTest,
    /// Against "difference >= margin".
    pub below_upper: MeanTest,
    /// The larger of the two p values: below alpha, the claim is shown at level alpha.
    pub p_value: f64,
}

impl Equivalence {
    /// Of the mean of runs and an exact value.
    pub fn one_sample(a: &Moments, exact: f64, margin: f64) -> Self {
        Equivalence::of(margin, MeanTest::one_sample(a, exact, Alternative::Different))
    }
    /// Of the means of two sets of runs whose variances may differ.
    pub fn welch(a: &Moments, b: &Moments, margin: f64) -> Self {
        Equivalence::of(margin, MeanTest::welch(a, b, Alternative::Different))
    }
    fn of(margin: f64, test: MeanTest) -> Self {
        let shifted = |by, alternative| MeanTest::new(test.difference + by, test.std_error, test.degrees, alternative);
        let above_lower = shifted(margin, Alternative::Greater);
        let below_upper = shifted(-margin, Alternative::Less);
        // Not `f64::max`, which drops a NaN.
        let p_value = [above_lower.p_value, below_upper.p_value].into_iter().max_by(f64::total_cmp).unwrap_or(f64::NAN);
        Equivalence { margin, above_lower, below_upper, p_value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use crate::synthetic::{assert_between, count};

    fn sample(rng: &mut Rng, mean: f64, runs: usize) -> Moments {
        (0..runs).map(|_| mean + rng.normal()).collect()
    }
    #[test]
    fn at_the_margin_it_errs_as_often_as_it_says() {
        for (mean, seed) in [(0.5, 1), (-0.5, 2)] {
            let shown =
                count(seed, 2000, |rng| Equivalence::one_sample(&sample(rng, mean, 100), 0.0, 0.5).p_value < 0.05);
            assert_between(shown, 2000, 0.05, 0.05);
            let shown = count(seed, 2000, |rng| {
                Equivalence::welch(&sample(rng, mean, 200), &sample(rng, 0.0, 200), 0.5).p_value < 0.05
            });
            assert_between(shown, 2000, 0.05, 0.05);
        }
    }
    #[test]
    fn the_same_is_shown_to_be_the_same_by_enough_runs_only() {
        // Standard error 0.1, margin 0.5: 5 - 1.66 = 3.34 standard errors to spare on either side.
        let enough = count(3, 1000, |rng| Equivalence::one_sample(&sample(rng, 0.0, 100), 0.0, 0.5).p_value < 0.05);
        assert_between(enough, 1000, 0.995, 1.0);
        assert_eq!(count(4, 1000, |rng| Equivalence::one_sample(&sample(rng, 0.0, 4), 0.0, 0.1).p_value < 0.05), 0);
    }
    #[test]
    fn one_run_shows_nothing() {
        let one: Moments = [0.0].into_iter().collect();
        assert!(Equivalence::one_sample(&one, 0.0, 1.0).p_value.is_nan());
    }
}
