//! Biases that are to vanish, at two settings of the knobs that are far apart.
//!
//! With B the root of the mean squared bias over blocks, a bias that vanishes at least like the knob's cube root has
//! B(far) <= B(near) / 4 over a factor of 64. One that stays does not, unless it is below what the noise lets one see.

use crate::finding::Outcome;
use manylight_framework::KnobSet;
use manylight_stats::Runs;

/// What has to be left of the bias at most.
const LEFT: f64 = 0.25;
/// Standard errors that chance does not bridge (one-sided p below 1e-4, and the root is pulled up by noise).
const SIGMAS: f64 = 4.0;

/// A setting of knobs.
pub(crate) struct Rung {
    pub knobs: Vec<(&'static str, &'static str)>,
    pub first_pass: u64,
}

/// A knob with a coarse and a fine value.
const KNOBS: &[(KnobSet, &str, &str)] =
    &[(KnobSet::PATHS, "8", "512"), (KnobSet::ERROR, "0.32", "0.005"), (KnobSet::ALPHA, "1", "16")];
/// Passes of a progressive method that are as fine as the others' far end.
const LATE: u64 = 4096;

impl Rung {
    pub fn near(knobs: KnobSet) -> Rung {
        let knobs = named(knobs).map(|k| (k.0, k.1)).collect();
        Rung { knobs, first_pass: 0 }
    }
    pub fn far(knobs: KnobSet) -> Rung {
        let first_pass = if knobs.contains(KnobSet::PASSES) { LATE } else { 0 };
        let knobs = named(knobs).map(|k| (k.0, k.2)).collect();
        Rung { knobs, first_pass }
    }
    /// For messages.
    pub fn name(&self) -> String {
        let all: Vec<String> = self.knobs.iter().map(|(k, v)| format!("{k}={v}")).collect();
        all.join(" ")
    }
}

fn named(knobs: KnobSet) -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    let own = KNOBS.iter().filter(move |k| knobs.contains(k.0));
    own.flat_map(|(k, near, far)| k.names().into_iter().map(move |n| (n, *near, *far)))
}

/// Root of the mean squared relative bias over blocks, and a bound of its standard error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bias {
    pub size: f64,
    pub std_error: f64,
}

impl Bias {
    /// Of runs against the truth's. The last block is the mean of all, and left out.
    pub fn of(runs: &Runs, truth: &Runs) -> Bias {
        let blocks = runs.blocks() - 1;
        let whole = truth.moments(blocks).mean();
        let (mut squares, mut variance) = (0.0, 0.0);
        for k in 0..blocks {
            let (a, b) = (runs.moments(k), truth.moments(k));
            squares += ((a.mean() - b.mean()) / whole).powi(2) / blocks as f64;
            variance += (a.std_error().powi(2) + b.std_error().powi(2)) / whole.powi(2) / blocks as f64;
        }
        // The root of a mean square moves by no more than the root of the mean square of what moves.
        Bias { size: squares.sqrt(), std_error: variance.sqrt() }
    }
}

/// Does the bias vanish from `near` to `far`?
pub(crate) fn judge(near: Bias, far: Bias) -> (Outcome, String) {
    let noise = SIGMAS * far.std_error.hypot(LEFT * near.std_error);
    let most = LEFT * near.size + noise;
    let percent = |x: f64| format!("{:.2} %", 100.0 * x);
    let detail = format!(
        "from {} to {} (+- {}); {} would have been too much",
        percent(near.size),
        percent(far.size),
        percent(far.std_error),
        percent(most)
    );
    let outcome = if far.size > most { Outcome::Fails } else { Outcome::Holds { would_have_seen: Some(most) } };
    (outcome, detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fails(near: f64, far: f64, std_error: f64) -> bool {
        judge(Bias { size: near, std_error }, Bias { size: far, std_error }).0 == Outcome::Fails
    }
    #[test]
    fn a_bias_that_stays_fails_and_one_that_goes_holds() {
        assert!(fails(0.2, 0.1, 0.005) && fails(0.05, 0.05, 0.005) && fails(0.0, 0.03, 0.005));
        assert!(!fails(0.2, 0.03, 0.005) && !fails(0.0, 0.015, 0.005) && !fails(0.2, 0.1, 0.1));
    }
    #[test]
    fn all_knobs_have_two_ends() {
        let all = KnobSet::PATHS.union(KnobSet::ERROR).union(KnobSet::ALPHA).union(KnobSet::PASSES);
        let (near, far) = (Rung::near(all), Rung::far(all));
        // Passes are no parameter.
        assert_eq!(near.knobs.len() + 1, all.names().len());
        assert_eq!((near.first_pass, far.first_pass), (0, LATE));
        assert!(near.knobs.iter().zip(&far.knobs).all(|(a, b)| a.0 == b.0 && a.1 != b.1));
    }
}
