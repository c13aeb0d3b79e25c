//! Which bound each pass gets.

use crate::Bound;
use manylight_framework::{BoundingPlan, Claim, KnobSet, Promise};
use manylight_scene::Scene;

/// How the bound of a pass is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundPlan {
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
}

impl Promise for BoundPlan {
    fn claim(&self) -> Claim {
        match self {
            BoundPlan::None => Claim::EXACT,
            BoundPlan::Fixed(_) => Claim::DARKENS,
            BoundPlan::Auto => Claim { vanishes_with: KnobSet::PATHS, ..Claim::DARKENS },
        }
    }
}
impl BoundingPlan for BoundPlan {
    type Pass = Bound;
    fn at(&self, scene: &Scene, _pass: u64, paths: u64) -> Bound {
        match *self {
            BoundPlan::None => Bound::None,
            BoundPlan::Fixed(b) => Bound::Geometry(b),
            BoundPlan::Auto => {
                let b = std::f64::consts::PI * paths.max(1) as f64 / scene.area();
                if b.is_finite() { Bound::Geometry((b as f32).max(f32::MIN_POSITIVE)) } else { Bound::None }
            }
        }
    }
    fn tames(&self) -> bool {
        *self != BoundPlan::None
    }
}
