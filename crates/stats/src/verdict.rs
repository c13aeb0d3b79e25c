//! What a block mean test concluded, as data.

use crate::{Detection, MeanTest, TopShare};
use std::fmt;

/// The conclusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No block differs by more than chance allows. What would have been seen is in `Verdict::detectable`.
    Passes,
    /// At least one block differs.
    Rejected,
    /// No conclusion: a few runs carry the variance of this block, so t means nothing.
    HeavyTail {
        /// Where.
        block: usize,
        /// How much.
        top: TopShare,
    },
}

/// The block with the smallest p value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// Its index.
    pub block: usize,
    /// Its difference as a part of the reference; `None` if the reference is 0 there.
    pub relative: Option<f64>,
    /// Its test, before any adjustment.
    pub test: MeanTest,
    /// Its p value adjusted for all comparisons.
    pub adjusted_p: f64,
}

/// The smallest relative biases that the test would have rejected with the stated power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detectable {
    /// A bias that all blocks share: what the least noisy block shows.
    pub common: f64,
    /// A bias of one block, whichever: what the noisiest block shows.
    pub single: f64,
}

/// What a block mean test found, and what it would have found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Verdict {
    /// The conclusion.
    pub outcome: Outcome,
    /// Where it is worst.
    pub worst: Worst,
    /// Without it "passes" says nothing. `None` if the reference is dark everywhere.
    pub detectable: Option<Detectable>,
    /// Alpha, comparisons and power.
    pub detection: Detection,
    /// Runs of the estimator.
    pub runs: usize,
}

impl Verdict {
    /// Neither rejected nor refused.
    pub fn passes(&self) -> bool {
        self.outcome == Outcome::Passes
    }
    /// Shown to be wrong.
    pub fn rejected(&self) -> bool {
        self.outcome == Outcome::Rejected
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Detection { alpha, comparisons, power, .. } = self.detection;
        match self.outcome {
            Outcome::Passes => write!(f, "passes")?,
            Outcome::Rejected => write!(f, "rejected")?,
            Outcome::HeavyTail { block, top } => {
                let TopShare { top_runs, runs, share, .. } = top;
                let share = 100.0 * share;
                // Whatever follows from t means nothing here.
                return write!(
                    f,
                    "no verdict: heavy tail, {top_runs} of {runs} runs carry {share:.0} % of the variance of block {block}"
                );
            }
        }
        write!(f, "; {comparisons} blocks, {} runs; worst block {}: ", self.runs, self.worst.block)?;
        match self.worst.relative {
            Some(relative) => write!(f, "{:+.3} %", 100.0 * relative)?,
            None => write!(f, "{:+.3e} where the reference is 0", self.worst.test.difference)?,
        }
        write!(f, ", t = {:.2}, adjusted p = {:.2e}", self.worst.test.t, self.worst.adjusted_p)?;
        if let Some(Detectable { common, single }) = self.detectable {
            let (common, single) = (100.0 * common, 100.0 * single);
            write!(f, "; would have seen {common:.3} % in all blocks or {single:.3} % in any one")?;
            write!(f, " (alpha {alpha}, power {power})")?;
        }
        Ok(())
    }
}
