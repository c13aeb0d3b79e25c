//! What made one pixel of one pass.

use crate::workers::Workers;
use crate::{Progress, RenderError, Settings};
use manylight_framework::{Explanation, Film, GenerateError, Method, PassError, Probe};
use manylight_math::Spectrum;
use manylight_scene::{FilterSampler, Scene};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A pixel of a pass, and what made it.
#[derive(Clone, Debug)]
pub struct Explained {
    /// The pixel of this pass. [W/(m^2 sr)]
    pub value: Spectrum,
    /// The lights and residuals of all its camera samples, each before the mean over samples is taken.
    pub explanation: Explanation,
}

/// Renders one pass, and notes what makes pixel number `pixel` (row by row from the upper left). The pass is the same as that of
/// [`render`](crate::render); its budget is not looked at.
pub fn explain(
    scene: &Scene,
    method: &dyn Method,
    settings: &Settings,
    (pass, pixel): (u64, usize),
    cancel: &Arc<AtomicBool>,
) -> Result<Explained, RenderError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads.unwrap_or(0)).build()?;
    let filter = FilterSampler::new(scene.filter());
    let mut silent = |_: &Progress| {};
    let workers = Workers::new(cancel, &mut silent);
    let mut film = Film::new(*scene.camera(), &filter, settings.seed, pass, settings.spp, &workers);
    film.explained = Some(pixel);
    let mut probe = Probe::default();
    (probe.explain, probe.cancel) = (Some(Explanation::default()), Some(cancel.clone()));
    match pool.install(|| method.pass(scene, &mut film, &mut probe)) {
        Err(PassError::Generate(GenerateError::Cancelled)) => return Err(RenderError::Interrupted),
        outcome => outcome.map_err(RenderError::Pass)?,
    }
    let value = film.image.pixels[pixel];
    if workers.cut_short() {
        return Err(RenderError::Interrupted);
    }
    Ok(Explained { value, explanation: probe.explain.unwrap_or_default() })
}
