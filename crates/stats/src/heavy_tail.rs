//! A guard against variances that may not exist.

use statrs::function::beta::beta_reg;
use statrs::function::gamma::ln_gamma;

/// The largest share of the variance that the top 1 % of the runs may carry.
const TOP_PERCENT: f64 = 0.3;
/// A lognormal law whose top 1 % carry just that (sigma 0.68) has 0.30 + 0.16 ln(100 q) in its top q, for q from 1 % to 12 %.
const PER_LOG_OF_TOP: f64 = 0.16;
/// How seldom Gaussian runs may be called heavy, over all comparisons.
const FALSE_ALARM: f64 = 1e-3;

/// How much of the variance is carried by the runs that lie farthest from the mean.
///
/// A sample of 100 runs or more is heavy-tailed if the top 1 % of them (whole runs) carry more than 30 % of the sum of
/// squares. Below 100, one run is more than 1 %: of 16 Gaussian runs the farthest carries 29 % on average. There, one of
/// R runs stands for the top 1 / R of its law, and may carry what a law at the limit of the rule has there: 37 % at 64 runs,
/// 48 % at 32, 59 % at 16. Whatever R, the share has to be one that Gaussian runs do not reach by chance, over all
/// comparisons; with fewer than ten runs hardly anything is.
///
/// The guard does not see a tail none of whose events was drawn. What then is too dark is rejected, or unseen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TopShare {
    /// The top 1 % of the runs, rounded down, and one at the least.
    pub top_runs: usize,
    /// All of them.
    pub runs: usize,
    /// What part of the sum of squared deviations the top runs carry; 0 without any variance.
    pub share: f64,
    /// Upper bound of the probability that Gaussian runs reach this share.
    pub chance: f64,
}

impl TopShare {
    /// Of the runs of one block.
    pub fn new(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        let runs = values.len();
        let mean = values.iter().sum::<f64>() / runs as f64;
        let mut squares: Vec<f64> = values.iter().map(|x| (x - mean) * (x - mean)).collect();
        squares.sort_by(|a, b| b.total_cmp(a));
        let top_runs = (runs / 100).max(1);
        let all: f64 = squares.iter().sum();
        let share = if all > 0.0 { squares.iter().take(top_runs).sum::<f64>() / all } else { 0.0 };
        TopShare { top_runs, runs, share, chance: chance_of(top_runs, runs, share) }
    }
    /// Is this sample, one of `comparisons`, too heavy-tailed for a t test?
    pub fn is_heavy(&self, comparisons: usize) -> bool {
        let limit = TOP_PERCENT + PER_LOG_OF_TOP * (100.0 / self.runs as f64).ln().max(0.0);
        self.share > limit && self.chance < FALSE_ALARM / comparisons.max(1) as f64
    }
}

/// Bonferroni over the choices of m runs of R. The deviations of a Gaussian sample point uniformly in R - 1 dimensions, so
/// the share of m given ones is Beta(m/2, (R-1-m)/2) distributed or smaller (for m = 1 this is the test of Grubbs 1950).
fn chance_of(top: usize, runs: usize, share: f64) -> f64 {
    if runs < top + 2 {
        return 1.0;
    }
    let (m, r) = (top as f64, runs as f64);
    let ln_choices = ln_gamma(r + 1.0) - ln_gamma(m + 1.0) - ln_gamma(r - m + 1.0);
    let tail = beta_reg(0.5 * (r - 1.0 - m), 0.5 * m, (1.0 - share).clamp(0.0, 1.0));
    (ln_choices + tail.ln()).exp().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use crate::synthetic::{assert_at_most, assert_between, count};
    use crate::{normal_quantile, normal_upper};

    fn heavy(seed: u64, n: usize, runs: usize, comparisons: usize, draw: impl Fn(&mut Rng) -> f64) -> usize {
        count(seed, n, |rng| TopShare::new((0..runs).map(|_| draw(rng))).is_heavy(comparisons))
    }
    #[test]
    fn by_hand() {
        let top = TopShare::new([0.0, 0.0, 0.0, 4.0].into_iter());
        assert_eq!((top.top_runs, top.runs, top.share), (1, 4, 0.75));
        assert_eq!(TopShare::new((0..250).map(f64::from)).top_runs, 2);
        assert_eq!(TopShare::new([2.0; 5].into_iter()).share, 0.0);
        assert!(!TopShare::new([2.0; 5].into_iter()).is_heavy(1));
        for few in [vec![], vec![1.0], vec![1.0, 5.0]] {
            assert!(!TopShare::new(few.into_iter()).is_heavy(1));
        }
    }
    #[test]
    fn the_chance_is_that_of_grubbs() {
        // 16 runs: t with 14 degrees, t^2 / (t^2 + 14) = share. The two-sided tail of t = 4.140 454 1 is 0.001.
        let share = 4.140_454_1f64.powi(2) / (4.140_454_1f64.powi(2) + 14.0);
        assert!((chance_of(1, 16, share) / 0.016 - 1.0).abs() < 1e-6);
    }
    #[test]
    fn gaussian_runs_are_never_heavy() {
        for runs in [4, 8, 16, 32, 64, 100, 101, 250, 1000] {
            assert_at_most(heavy(runs as u64, 1000, runs, 1, Rng::normal), 1000, FALSE_ALARM);
        }
    }
    #[test]
    fn the_limit_is_that_of_a_lognormal_law_whose_top_percent_carries_it() {
        // Share of the law's variance beyond the upper quantile z of its logarithm; the lower tail adds nothing at this skew.
        let sigma: f64 = 0.6836;
        let mean = (0.5 * sigma * sigma).exp();
        let share = |top: f64| {
            let z = -normal_quantile(top);
            let square = mean.powi(4) * normal_upper(z - 2.0 * sigma);
            let cross = 2.0 * mean * mean * normal_upper(z - sigma);
            (square - cross + mean * mean * top) / (mean.powi(4) - mean * mean)
        };
        for (top, runs) in [(0.01, 100.0), (1.0 / 64.0, 64.0), (1.0 / 32.0, 32.0), (1.0 / 16.0, 16.0), (1.0 / 8.0, 8.0)]
        {
            let limit = TOP_PERCENT + PER_LOG_OF_TOP * f64::ln(100.0 / runs);
            assert!((share(top) - limit).abs() < 0.02, "{runs}: {} {limit}", share(top));
        }
    }
    #[test]
    fn lognormal_runs_are_seldom_heavy() {
        for (sigma, at_most) in [(0.25, 0.015), (0.5, 0.09)] {
            for runs in [16, 32, 64, 100, 250, 1000] {
                for comparisons in [1, 64] {
                    let alarms = heavy(runs as u64, 2000, runs, comparisons, |rng| rng.lognormal(sigma));
                    assert_at_most(alarms, 2000, at_most);
                }
            }
        }
    }
    #[test]
    fn runs_without_a_variance_are_heavy() {
        for (runs, at_least) in [(16, 0.3), (100, 0.75), (1000, 0.97)] {
            let found = heavy(9, 1000, runs, 1, |rng| rng.pareto(1.5));
            assert_between(found, 1000, at_least, 1.0);
        }
    }
}
