//! What was found.

use manylight_framework::Claim;
use std::fmt;

/// How a check ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Nothing speaks against the claim.
    Holds {
        /// The smallest relative bias of the whole image that would have been seen, where that is what was looked for.
        would_have_seen: Option<f64>,
    },
    /// The claim is wrong.
    Fails,
    /// The numbers do not allow a verdict.
    NoVerdict,
    /// There was nothing to check.
    Skipped,
}

impl Outcome {
    /// In a word or two.
    pub fn word(&self) -> &'static str {
        match self {
            Outcome::Holds { .. } => "holds",
            Outcome::Fails => "FAILS",
            Outcome::NoVerdict => "no verdict",
            Outcome::Skipped => "skipped",
        }
    }
}

/// One check of a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Where.
    pub place: String,
    /// What was asked.
    pub check: String,
    /// How it ended.
    pub outcome: Outcome,
    /// The numbers, or the reason.
    pub detail: String,
}

/// All checks of a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What was checked.
    pub subject: String,
    /// What it claims, where it could be built at all.
    pub claim: Option<Claim>,
    /// The checks.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Is any claim shown to be wrong?
    pub fn fails(&self) -> bool {
        self.findings.iter().any(|f| f.outcome == Outcome::Fails)
    }
    /// Was anything looked at that could have failed?
    pub fn says_something(&self) -> bool {
        self.findings.iter().any(|f| matches!(f.outcome, Outcome::Holds { .. } | Outcome::Fails))
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:<10} {:<8} {}: {}", self.outcome.word(), self.place, self.check, self.detail)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match &self.claim {
            Some(claim) => writeln!(f, "{}: {claim}", self.subject)?,
            None => writeln!(f, "{}", self.subject)?,
        }
        self.findings.iter().try_for_each(|finding| writeln!(f, "  {finding}"))
    }
}
