//! What an estimate promises, as data: composed by `and`, read by whoever tests it.

use std::fmt;

/// A set of knobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnobSet(u8);

impl KnobSet {
    /// No knob.
    pub const NONE: KnobSet = KnobSet(0);
    /// Light paths a pass.
    pub const PATHS: KnobSet = KnobSet(1);
    /// Passes.
    pub const PASSES: KnobSet = KnobSet(2);
    /// The error threshold of a cut.
    pub const ERROR: KnobSet = KnobSet(4);
    /// The blending radius of a grid hierarchy.
    pub const ALPHA: KnobSet = KnobSet(8);

    /// Knobs in either.
    pub fn union(self, o: KnobSet) -> KnobSet {
        KnobSet(self.0 | o.0)
    }
    /// Is every knob of `o` in it?
    pub fn contains(self, o: KnobSet) -> bool {
        self.0 & o.0 == o.0
    }
    /// Names of the knobs.
    pub fn names(self) -> Vec<&'static str> {
        let all = [
            (KnobSet::PATHS, "paths"),
            (KnobSet::PASSES, "passes"),
            (KnobSet::ERROR, "error"),
            (KnobSet::ALPHA, "alpha"),
        ];
        all.into_iter().filter(|k| self.contains(k.0)).map(|k| k.1).collect()
    }
}

/// Classes of paths that an estimator cannot make. Letters from the light to the eye: L light, D a vertex that scatters into
/// all directions, S a delta lobe (a smooth mirror, glass), E eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathClasses(u8);

impl PathClasses {
    /// None missed.
    pub const NONE: PathClasses = PathClasses(0);
    /// ..S D S* E: a caustic on the last surface that scatters. The light that a virtual light would have to be is behind a
    /// delta lobe.
    pub const CAUSTICS: PathClasses = PathClasses(1);

    /// ..D S+ E: whatever is seen in a mirror or through glass.
    pub const MIRRORED: PathClasses = PathClasses(4);
    /// Everything that is scattered more than once, caustics too.
    pub const INDIRECT: PathClasses = PathClasses(3);

    /// Classes in either.
    pub fn union(self, o: PathClasses) -> PathClasses {
        PathClasses(self.0 | o.0)
    }
    /// Classes in both: what the sum of two estimators of different paths still misses.
    pub fn common(self, o: PathClasses) -> PathClasses {
        PathClasses(self.0 & o.0)
    }
    /// Without the classes of `o`.
    pub fn without(self, o: PathClasses) -> PathClasses {
        PathClasses(self.0 & !o.0)
    }
    /// Are all classes of `o` in it?
    pub fn contains(self, o: PathClasses) -> bool {
        self.0 & o.0 == o.0
    }
    /// Is none missed?
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// What an estimate promises. Each part speaks for itself, as if all others were exact; `and` makes the whole. A light set that
/// draws lights at random, say, is [`Claim::UNBIASED`], whatever becomes of its lights' bounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// Does the estimate vary from pass to pass?
    pub noisy: bool,
    /// Largest |bias| as a fraction of the truth. 0: unbiased. Infinity: no promise.
    pub bias: f32,
    /// Can the expectation exceed the truth?
    pub brightens: bool,
    /// The knobs that together take the bias to zero; none if nothing does.
    pub vanishes_with: KnobSet,
    /// No: a test has to say "heavy tail, no verdict" rather than pass.
    pub finite_variance: bool,
    /// Paths that are missing from the estimate.
    pub misses: PathClasses,
}

impl Claim {
    /// No noise and no bias.
    pub const EXACT: Claim = Claim {
        noisy: false,
        bias: 0.0,
        brightens: false,
        vanishes_with: KnobSet::NONE,
        finite_variance: true,
        misses: PathClasses::NONE,
    };
    /// Noise without bias.
    pub const UNBIASED: Claim = Claim { noisy: true, ..Claim::EXACT };
    /// Never brighter than the truth, by how much is not said.
    pub const DARKENS: Claim = Claim { bias: f32::INFINITY, ..Claim::EXACT };

    /// A bias, of either sign, that goes to zero along some knobs.
    pub const fn consistent(knobs: KnobSet) -> Claim {
        Claim { noisy: true, bias: f32::INFINITY, brightens: true, vanishes_with: knobs, ..Claim::EXACT }
    }
    /// Is the expectation the truth?
    pub fn is_unbiased(&self) -> bool {
        self.bias == 0.0
    }
    /// The promise of two parts together: a product of factors, or a sum of terms.
    pub fn and(self, o: Claim) -> Claim {
        let vanishes_with = match (self.is_unbiased(), o.is_unbiased()) {
            (true, _) => o.vanishes_with,
            (_, true) => self.vanishes_with,
            // Both have to vanish: if one never does, the two together never do.
            _ if self.vanishes_with == KnobSet::NONE || o.vanishes_with == KnobSet::NONE => KnobSet::NONE,
            _ => self.vanishes_with.union(o.vanishes_with),
        };
        Claim {
            noisy: self.noisy || o.noisy,
            bias: self.bias + o.bias,
            brightens: self.brightens || o.brightens,
            vanishes_with,
            finite_variance: self.finite_variance && o.finite_variance,
            misses: self.misses.union(o.misses),
        }
    }
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.is_unbiased(), self.vanishes_with.names()) {
            (true, _) if self.noisy => f.write_str("unbiased")?,
            (true, _) => f.write_str("exact")?,
            (false, knobs) if knobs.is_empty() => f.write_str("biased")?,
            (false, knobs) => write!(f, "consistent: the bias vanishes with {}", knobs.join(" and "))?,
        }
        if !self.is_unbiased() {
            f.write_str(if self.brightens { ", of either sign" } else { ", never too bright" })?;
            if self.bias.is_finite() {
                write!(f, ", at most {}%", 100.0 * self.bias)?;
            }
        }
        if !self.finite_variance {
            f.write_str("; infinite variance")?;
        }
        if self.misses.contains(PathClasses::INDIRECT) {
            f.write_str("; no indirect light")?;
        } else if self.misses.contains(PathClasses::CAUSTICS) {
            f.write_str("; no caustics on the last surface that scatters")?;
        }
        if self.misses.contains(PathClasses::MIRRORED) {
            f.write_str("; nothing that is seen in mirrors or through glass")?;
        }
        Ok(())
    }
}

/// Every part says what it promises.
pub trait Promise {
    /// What this part promises.
    fn claim(&self) -> Claim;
}
impl<T: Promise + ?Sized> Promise for Box<T> {
    fn claim(&self) -> Claim {
        (**self).claim()
    }
}
impl<A: Promise, B: Promise> Promise for (A, B) {
    fn claim(&self) -> Claim {
        self.0.claim().and(self.1.claim())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_biases_vanish_only_along_both_knobs_and_never_if_one_never_does() {
        let (a, b) = (Claim::consistent(KnobSet::PATHS), Claim::consistent(KnobSet::ERROR));
        assert_eq!(a.and(b).vanishes_with, KnobSet::PATHS.union(KnobSet::ERROR));
        assert_eq!(a.and(Claim::DARKENS).vanishes_with, KnobSet::NONE);
        assert_eq!(Claim::UNBIASED.and(a), a);
        assert_eq!(Claim::EXACT.and(Claim::EXACT), Claim::EXACT);
    }
    #[test]
    fn claims_read_as_sentences() {
        assert_eq!(Claim::UNBIASED.to_string(), "unbiased");
        assert_eq!(Claim::DARKENS.to_string(), "biased, never too bright");
        let c = Claim { misses: PathClasses::CAUSTICS, finite_variance: false, ..Claim::UNBIASED };
        assert_eq!(c.to_string(), "unbiased; infinite variance; no caustics on the last surface that scatters");
        assert!(Claim::consistent(KnobSet::PATHS).to_string().contains("vanishes with paths"));
    }
}
