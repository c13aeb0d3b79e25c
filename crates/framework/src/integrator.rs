//! Integrators: one pass after another.

use crate::{BuildError, Film, GenerateError, Probe, Promise};
use manylight_math::{Ray, Spectrum};
use manylight_sampling::Stream;
use manylight_scene::Scene;

/// Why a pass could not be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PassError {
    /// The generator made no lights.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The light set could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// This bounding cannot be compensated.
    #[error(
        "this bound cannot be compensated: it depends on what only a light knows; choose another bound, or compensation=none"
    )]
    NotCompensable,
    /// This light set merges lights of different depths.
    #[error("this light set merges lights of different depths: give it no max-depth, or one set an edge count")]
    MergesDepths,
}

/// One way to estimate an image. Passes are independent: the pass, not the sample, is the unit of every statistic.
///
/// Pass `i` depends on (scene, method, seed, i) only, so that any pass can be rendered anywhere.
pub trait Integrator: Promise + Send + Sync {
    /// What a pass shares among its samples: its virtual lights.
    type Prepared: Sync;
    /// Makes what the pass shares.
    fn prepare(&self, scene: &Scene, pass: u64, seed: u64, probe: &mut Probe) -> Result<Self::Prepared, PassError>;
    /// Radiance along a camera ray: one sample. [W/(m^2 sr)]
    fn radiance(
        &self,
        scene: &Scene,
        prepared: &Self::Prepared,
        ray: &Ray,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum;
    /// A whole pass. Light tracing, photon passes and frame compensation override it.
    fn render_pass(&self, scene: &Scene, prepared: &Self::Prepared, film: &mut Film, probe: &mut Probe) {
        film.fill(probe, &|ray, probe, s| self.radiance(scene, prepared, ray, probe, s));
    }
}

/// Every integrator's object-safe face: what a list of methods holds (`Prepared` makes `dyn Integrator` one type per method).
pub trait Method: Promise + Send + Sync {
    /// Prepares and renders the film's pass.
    fn pass(&self, scene: &Scene, film: &mut Film, probe: &mut Probe) -> Result<(), PassError>;
}
impl<I: Integrator> Method for I {
    fn pass(&self, scene: &Scene, film: &mut Film, probe: &mut Probe) -> Result<(), PassError> {
        let prepared = self.prepare(scene, film.pass, film.seed, probe)?;
        self.render_pass(scene, &prepared, film, probe);
        Ok(())
    }
}
