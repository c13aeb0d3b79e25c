//! Many comparisons, one alpha.

/// Significance of each of `cases` independent comparisons such that one of them errs with probability `family_alpha`:
/// 1 - (1 - alpha)^(1/n) (Sidak 1967). Independent cases only; `holm` needs no independence.
pub fn sidak_alpha(family_alpha: f64, cases: usize) -> f64 {
    -f64::exp_m1(f64::ln_1p(-family_alpha) / cases.max(1) as f64)
}

/// The p values adjusted by Holm (1979), in the order given: reject those below alpha, and the probability of rejecting any
/// that is true is at most alpha, however the cases depend on each other. A NaN counts as 0: what could not be tested does
/// not pass.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let p = |i: usize| if p_values[i].is_nan() { 0.0 } else { p_values[i] };
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p(a).total_cmp(&p(b)));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut largest: f64 = 0.0;
    for (rank, &i) in order.iter().enumerate() {
        largest = largest.max(p(i) * (p_values.len() - rank) as f64).min(1.0);
        adjusted[i] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sidak_gives_the_family_its_alpha_back() {
        for cases in [1, 2, 12, 1000] {
            let each = sidak_alpha(0.01, cases);
            assert!((1.0 - (1.0 - each).powi(cases as i32) - 0.01).abs() < 1e-12);
            assert!(each >= 0.01 / cases as f64);
        }
        assert_eq!(sidak_alpha(0.01, 0), sidak_alpha(0.01, 1));
    }
    #[test]
    fn holm_by_hand() {
        assert_eq!(holm(&[0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02]);
        assert_eq!(holm(&[0.5, 0.9]), [1.0, 1.0]);
        assert_eq!(holm(&[0.2, f64::NAN]), [0.2, 0.0]);
        assert!(holm(&[]).is_empty());
    }
}
