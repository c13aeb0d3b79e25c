//! Generators of virtual lights.

use crate::{Probe, Promise};
use manylight_scene::Scene;

/// What one generation made. Each flux is already divided by `paths`.
#[derive(Clone, Debug)]
pub struct Batch<Lights> {
    /// What the plan builds from: a `Vec` of lights, or a pair of such.
    pub lights: Lights,
    /// Light paths that were walked, those that made nothing included.
    pub paths: u64,
    /// Do the lights hold the direct light too? If not, the integrator samples it.
    pub covers_direct: bool,
}

/// Why no lights could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GenerateError {
    /// Nothing emits.
    #[error("nothing in the scene emits light: add an emitter")]
    NoEmitters,
    /// The user asked to stop.
    #[error("interrupted while light paths were walked")]
    Cancelled,
    /// More lights than memory should hold.
    #[error("{lights} virtual lights and more in one pass, the limit is {limit}: use fewer paths, and more passes")]
    TooMany {
        /// How many there were when it gave up.
        lights: usize,
        /// How many are possible.
        limit: usize,
    },
}

/// Makes lights from exactly N light paths; path `i` draws from `Stream(seed, [pass, i, ..])` alone. Never "until N lights":
/// dividing by a number of paths that depends on what they found is biased.
///
/// For every receiver, E[sum over the lights of its contribution, unbounded] is the indirect light there (and the direct light
/// too, if `covers_direct`), but for the path classes that the claim says it misses.
///
/// Object-safe: a method holds a `Box<dyn Generator<Lights = ..>>`, one call a pass.
pub trait Generator: Promise + Send + Sync {
    /// What it makes.
    type Lights;
    /// Walks this pass's paths. Rays are counted in `probe`.
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Self::Lights>, GenerateError>;
}
