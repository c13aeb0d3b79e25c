//! Which bound each pass gets.

use crate::Bound;
use manylight_framework::{BoundingPlan, Claim, KnobSet, Promise};
use manylight_scene::Scene;

/// How the bound of a pass is chosen, and what it bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundPlan {
    /// The number b.
    pub level: Level,
    /// What is kept below it.
    pub of: Bounded,
}

/// What a bound bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounded {
    /// The geometry term: [`Bound::Geometry`].
    Geometry,
    /// The whole contribution: [`Bound::Contribution`].
    Contribution,
}

/// How high a bound lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// No bound.
    None,
    /// The same always. [1/m^2]
    Fixed(f32),
    /// b = pi N / A, for N light paths in a scene of surface A.
    ///
    /// Of N lights that share the flux Phi, one brings the irradiance G Phi / (pi N) to a surface that it faces; the scene's
    /// mean irradiance is Phi / A. So this bound lets no light bring more than the mean irradiance, and the distance below which
    /// light is lost, 1 / sqrt(b), is the radius of the disc of surface that each path has to itself. It shrinks with the number
    /// of paths: the bias vanishes with them.
    Auto,
    /// That of `Auto`, times (pass + 1)^(2/3): the bias vanishes with the passes as well. In an edge of the scene the bias of a
    /// pass falls as b^(-1/2) and its variance grows as b^(1/2), so that this exponent balances the two: the error of the mean of
    /// n passes falls as n^(-1/3).
    Progressive,
}

/// Of `Progressive`.
const GROWTH: f64 = 2.0 / 3.0;

impl BoundPlan {
    /// No bound.
    pub const NONE: BoundPlan = BoundPlan { level: Level::None, of: Bounded::Geometry };
    /// [`Level::Auto`] of the geometry term.
    pub const AUTO: BoundPlan = BoundPlan { level: Level::Auto, of: Bounded::Geometry };
    /// The same bound of the geometry term always. [1/m^2]
    pub fn fixed(b: f32) -> BoundPlan {
        BoundPlan { level: Level::Fixed(b), of: Bounded::Geometry }
    }
}

impl Promise for BoundPlan {
    fn claim(&self) -> Claim {
        match self.level {
            Level::None => Claim::EXACT,
            Level::Fixed(_) => Claim::DARKENS,
            Level::Auto => Claim { vanishes_with: KnobSet::PATHS, ..Claim::DARKENS },
            Level::Progressive => Claim { vanishes_with: KnobSet::PASSES, ..Claim::DARKENS },
        }
    }
}
impl BoundingPlan for BoundPlan {
    type Pass = Bound;
    fn at(&self, scene: &Scene, pass: u64, paths: u64) -> Bound {
        let auto = || std::f64::consts::PI * paths.max(1) as f64 / scene.area();
        let b = match self.level {
            Level::None => return Bound::None,
            Level::Fixed(b) => b as f64,
            Level::Auto => auto(),
            Level::Progressive => auto() * ((pass + 1) as f64).powf(GROWTH),
        };
        if !b.is_finite() {
            return Bound::None; // a scene without surfaces
        }
        let b = (b as f32).clamp(f32::MIN_POSITIVE, f32::MAX);
        match self.of {
            Bounded::Geometry => Bound::Geometry(b),
            Bounded::Contribution => Bound::Contribution(b),
        }
    }
    fn tames(&self) -> bool {
        self.level != Level::None
    }
}
