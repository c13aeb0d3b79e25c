//! Radii, pass by pass.

use manylight_framework::{Claim, KnobSet};

/// How far photons reach, pass by pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// R of the first pass. \[m\]
    pub first: f32,
    /// alpha in (0, 1): with a blur of m dimensions R_i^m = R_0^m (i + 1)^(alpha - 1), so that the variance of the mean of n passes
    /// falls as n^-alpha, and its bias as n^(2 (alpha - 1) / m) within a medium (Knaus and Zwicker 2011, whose product this power
    /// is in the limit). `None`: R stays.
    pub shrink: Option<f32>,
}

impl Radii {
    /// R of a pass, for a blur of so many dimensions. \[m\]
    pub fn at(&self, pass: u64, dimensions: f64) -> f32 {
        let exponent = self.shrink.map_or(0.0, |alpha| (f64::from(alpha) - 1.0) / dimensions);
        (f64::from(self.first) * ((pass + 1) as f64).powf(exponent)) as f32
    }
    /// What it does to the truth.
    pub fn claim(&self) -> Claim {
        Claim::consistent(if self.shrink.is_some() { KnobSet::PASSES } else { KnobSet::NONE })
    }
}
