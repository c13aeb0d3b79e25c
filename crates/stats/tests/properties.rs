//! What holds for all numbers.

use manylight_stats::{Moments, chi2_goodness_of_fit, holm, normal_quantile, normal_upper};
use proptest::prelude::*;

proptest! {
    #[test]
    fn moments_merge_to_those_of_all(a in prop::collection::vec(-1e3f64..1e3, 0..40), b in prop::collection::vec(-1e3f64..1e3, 0..40)) {
        let mut merged: Moments = a.iter().copied().collect();
        merged.merge(&b.iter().copied().collect());
        let all: Moments = a.iter().chain(&b).copied().collect();
        prop_assert_eq!(merged.count(), all.count());
        prop_assert!((merged.mean() - all.mean()).abs() < 1e-9);
        prop_assert!(all.count() < 2 || (merged.variance() - all.variance()).abs() < 1e-9 * (1.0 + all.variance()));
    }
    #[test]
    fn holm_lies_between_no_adjustment_and_bonferroni(p in prop::collection::vec(0.0f64..1.0, 1..30)) {
        let n = p.len() as f64;
        for ((i, adjusted), raw) in holm(&p).into_iter().enumerate().zip(&p) {
            prop_assert!(*raw <= adjusted && adjusted <= (raw * n).min(1.0).max(*raw) + 1e-15 || p.iter().any(|q| q < raw));
            prop_assert!(adjusted <= 1.0, "{}", i);
        }
        let smallest = p.iter().copied().fold(1.0, f64::min);
        prop_assert_eq!(holm(&p).into_iter().fold(1.0, f64::min), (smallest * n).min(1.0));
    }
    #[test]
    fn chi_squared_does_not_see_the_order_of_bins(bins in prop::collection::vec((0u64..100, 5.5f64..100.0), 2..20), shift in 0usize..20) {
        let test = |bins: &[(u64, f64)]| {
            let (seen, expected): (Vec<u64>, Vec<f64>) = bins.iter().copied().unzip();
            chi2_goodness_of_fit(&seen, &expected, 0)
        };
        let mut turned = bins.clone();
        turned.rotate_left(shift % bins.len());
        let (a, b) = (test(&bins), test(&turned));
        prop_assert_eq!(a.degrees, b.degrees);
        prop_assert!((a.statistic - b.statistic).abs() <= 1e-9 * a.statistic && (a.p_value - b.p_value).abs() < 1e-9);
    }
    #[test]
    fn normal_quantile_and_tail_are_inverse(p in 1e-12f64..1.0) {
        prop_assert!((normal_upper(-normal_quantile(p)) / p - 1.0).abs() < 1e-8);
    }
}
