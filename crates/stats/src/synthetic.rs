//! Synthetic experiments: what the tests of the tests are made of.

use crate::Runs;
use crate::rng::Rng;

impl Rng {
    /// Uniform in (0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }
    /// Standard normal (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
    /// exp(sigma z), divided by its mean.
    pub(crate) fn lognormal(&mut self, sigma: f64) -> f64 {
        (sigma * self.normal() - 0.5 * sigma * sigma).exp()
    }
    /// x >= 1 with P(X > x) = x^-index: no variance below index 2.
    pub(crate) fn pareto(&mut self, index: f64) -> f64 {
        self.uniform().powf(-1.0 / index)
    }
}

/// Runs whose entry is `draw(rng, block)`.
pub(crate) fn runs(rng: &mut Rng, runs: usize, blocks: usize, draw: impl Fn(&mut Rng, usize) -> f64) -> Runs {
    Runs::new((0..runs).map(|_| (0..blocks).map(|k| draw(rng, k)).collect()).collect()).unwrap()
}

/// How many of `n` experiments say yes.
pub(crate) fn count(seed: u64, n: usize, yes: impl Fn(&mut Rng) -> bool) -> usize {
    let mut rng = Rng::new(seed);
    (0..n).filter(|_| yes(&mut rng)).count()
}

/// Four binomial standard deviations of a count with mean `n p`.
fn slack(n: usize, p: f64) -> f64 {
    4.0 * (n as f64 * p * (1.0 - p)).sqrt()
}

/// `seen` of `n` is no more than a probability `p` allows.
pub(crate) fn assert_at_most(seen: usize, n: usize, p: f64) {
    assert!(seen as f64 <= n as f64 * p + slack(n, p), "{seen} of {n}, at most {p} expected");
}

/// `seen` of `n` is what a probability between `low` and `high` allows.
pub(crate) fn assert_between(seen: usize, n: usize, low: f64, high: f64) {
    assert_at_most(seen, n, high);
    assert!(seen as f64 >= n as f64 * low - slack(n, low), "{seen} of {n}, at least {low} expected");
}
