//! Pearson's chi-squared test of binned samples.

use statrs::function::gamma::gamma_ur;

/// Bins that expect fewer samples than this are pooled: below it the statistic is not chi-squared.
const POOL_BELOW: f64 = 5.0;

/// What a chi-squared test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chi2 {
    /// Sum of (observed - expected)^2 / expected over the pooled bins.
    pub statistic: f64,
    /// Pooled bins - 1 - fitted parameters.
    pub degrees: usize,
    /// Bins left after pooling.
    pub bins: usize,
    /// Probability of a statistic at least this large if the samples follow the expectation. NaN if pooling left nothing to
    /// test, so that `p_value > alpha` fails then.
    pub p_value: f64,
}

/// Do `observed` counts follow the `expected` ones?
///
/// Expectations are not rescaled: they should sum to the number of samples, and a density that integrates to something else
/// shows in the statistic. Samples that failed are a bin too. Bins are pooled in the order of their expectations, never by
/// what was observed. A sample where none can fall (expectation 0), or an expectation that is negative or NaN, gives p = 0.
///
/// # Panics
/// If the two lengths differ.
pub fn chi2_goodness_of_fit(observed: &[u64], expected: &[f64], fitted_parameters: usize) -> Chi2 {
    assert_eq!(observed.len(), expected.len(), "as many expectations as bins");
    let mut bins: Vec<(f64, f64)> = expected.iter().zip(observed).map(|(e, o)| (*e, *o as f64)).collect();
    let impossible = bins.iter().any(|(e, o)| !(*e >= 0.0 && e.is_finite()) || (*e == 0.0 && *o > 0.0));
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pooled = pool(&bins);
    let statistic = if impossible { f64::INFINITY } else { pooled.iter().map(|(e, o)| (o - e) * (o - e) / e).sum() };
    let degrees = pooled.len().saturating_sub(1 + fitted_parameters);
    let p_value = match (impossible, degrees) {
        (true, _) => 0.0,
        (false, 0) => f64::NAN,
        (false, _) => chi2_upper(statistic, degrees as f64),
    };
    Chi2 { statistic, degrees, bins: pooled.len(), p_value }
}

/// P(X >= statistic) for X chi-squared with `degrees`.
pub(crate) fn chi2_upper(statistic: f64, degrees: f64) -> f64 {
    if statistic <= 0.0 { 1.0 } else { gamma_ur(0.5 * degrees, 0.5 * statistic) }
}

/// Sums neighbours of a list sorted by expectation until each sum expects enough.
fn pool(sorted: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (mut pooled, mut open) = (Vec::new(), (0.0, 0.0));
    for (e, o) in sorted {
        open = (open.0 + e, open.1 + o);
        if open.0 >= POOL_BELOW {
            pooled.push(std::mem::take(&mut open));
        }
    }
    match pooled.last_mut() {
        Some(last) => *last = (last.0 + open.0, last.1 + open.1),
        None if open.0 > 0.0 => pooled.push(open),
        None => {}
    }
    pooled
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{assert_between, count};

    #[test]
    fn a_known_case_has_its_tabled_value() {
        // 95 % quantile of chi-squared with 5 degrees: 11.0705.
        assert!((chi2_upper(11.070_497_693_5, 5.0) - 0.05).abs() < 1e-9);
        let test = chi2_goodness_of_fit(&[8, 12], &[10.0, 10.0], 0);
        assert_eq!((test.statistic, test.degrees, test.bins), (0.8, 1, 2));
        // 2 (1 - Phi(sqrt(0.8)))
        assert!((test.p_value - 0.371_093_369_5).abs() < 1e-9, "{test:?}");
    }
    #[test]
    fn bins_that_expect_little_are_pooled_and_no_sample_is_lost() {
        let test = chi2_goodness_of_fit(&[3, 2, 1, 94, 2], &[2.0, 2.0, 2.0, 93.0, 1.0], 0);
        assert_eq!((test.bins, test.degrees), (2, 1));
        // {1, 2, 2} expect 5 and saw 7; {2, 93} expect 95 and saw 95.
        assert_eq!(test.statistic, 0.8);
    }
    #[test]
    fn a_sample_where_none_can_fall_fails() {
        assert_eq!(chi2_goodness_of_fit(&[1, 50, 50], &[0.0, 50.5, 50.5], 0).p_value, 0.0);
        assert!(chi2_goodness_of_fit(&[0, 50, 51], &[0.0, 50.5, 50.5], 0).p_value > 0.5);
        for bad in [f64::NAN, -1.0, f64::INFINITY] {
            assert_eq!(chi2_goodness_of_fit(&[0, 50, 51], &[bad, 50.5, 50.5], 0).p_value, 0.0);
        }
    }
    #[test]
    fn what_cannot_be_tested_does_not_pass() {
        for (seen, expected, fitted) in [(vec![3], vec![3.0], 0), (vec![], vec![], 0), (vec![40, 60], vec![50.0; 2], 1)]
        {
            let p = chi2_goodness_of_fit(&seen, &expected, fitted).p_value;
            assert!(p.is_nan(), "{seen:?}: {p}");
        }
    }
    #[test]
    fn a_density_that_does_not_integrate_to_one_fails() {
        assert!(chi2_goodness_of_fit(&[10_000; 10], &[9_800.0; 10], 0).p_value < 1e-4);
    }
    #[test]
    fn it_errs_as_often_as_it_says_and_sees_a_liar() {
        // 12 bins of which four are rare; the liar gives 40 % more weight to the first.
        let weights = [20.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 9.0, 0.3, 0.3, 0.2, 0.2];
        let total: f64 = weights.iter().sum();
        let expected = weights.map(|w| w / total * 1000.0);
        let rejected = |seed, lie: f64| {
            count(seed, 1000, |rng| {
                let mut seen = [0; 12];
                for _ in 0..1000 {
                    let mut u = rng.uniform() * (total + lie);
                    let bin = weights.iter().enumerate().position(|(i, w)| {
                        u -= w + if i == 0 { lie } else { 0.0 };
                        u < 0.0
                    });
                    seen[bin.unwrap_or(11)] += 1;
                }
                chi2_goodness_of_fit(&seen, &expected, 0).p_value < 0.05
            })
        };
        assert_between(rejected(1, 0.0), 1000, 0.05, 0.05);
        // Noncentrality 23.3 with 8 degrees: power 0.96 (Patnaik's approximation).
        assert_between(rejected(2, 8.0), 1000, 0.95, 0.97);
    }
}
