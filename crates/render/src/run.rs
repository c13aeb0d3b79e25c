//! The driver: passes, one after the other, until the budget is spent.

use crate::workers::Workers;
use crate::{Accumulator, Budget, RenderError};
use manylight_framework::{Film, GenerateError, Image, Method, PassError, Probe};
use manylight_scene::{FilterSampler, Scene};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// How to render, whatever the method.
#[derive(Clone, Debug)]
pub struct Settings {
    /// When to stop.
    pub budget: Budget,
    /// What all random numbers follow from, together with the number of the pass.
    pub seed: u64,
    /// Camera samples for each pixel of each pass.
    pub spp: u32,
    /// Threads; `None`: one for each core. They change the time, never the image.
    pub threads: Option<usize>,
}

/// Where a rendering stands, after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Complete passes.
    pub passes: u64,
    /// Time since the start.
    pub elapsed: Duration,
    /// Estimated relative mean squared error by noise ([`Accumulator::estimated_error`]).
    pub estimated_error: Option<f64>,
    /// Rays of all kinds so far.
    pub rays: u64,
}

/// Who is told how the rendering goes.
pub trait Observer: Send {
    /// A pass has been added to the image.
    fn after_pass(&mut self, progress: &Progress);
    /// `done` of the running pass's `tasks` (tiles) have ended. Called from the threads that end them, as often as they do;
    /// not each of them is reported.
    fn during_pass(&mut self, _done: usize, _tasks: usize) {}
}

impl<F: FnMut(&Progress) + Send> Observer for F {
    fn after_pass(&mut self, progress: &Progress) {
        self(progress)
    }
}

/// What was rendered.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Mean of the complete passes. Where there is none, as much of the first as was done when it was cancelled.
    pub image: Image,
    /// Standard error of the mean, from two passes on.
    pub standard_error: Option<Image>,
    /// Estimated relative mean squared error by noise ([`Accumulator::estimated_error`]), from two passes on.
    pub estimated_error: Option<f64>,
    /// Complete passes. 0: the image is part of the first pass.
    pub passes: u64,
    /// Whether it was cancelled before the budget was spent.
    pub interrupted: bool,
    /// From the start to the end of the last pass that is in the image.
    pub elapsed: Duration,
    /// Of that, what passed in each pass before the first tile of the image: light paths, trees.
    pub preparing: Duration,
    /// Rays, lights and rare events of the passes in the image.
    pub probe: Probe,
}

/// Renders passes 0, 1, 2 .. of `method` until the budget is spent or `cancel` is set. The image depends on the scene, the
/// method, the seed, the samples and the number of passes alone.
///
/// A pass that `cancel` cut short is thrown away, unless it is the first. Cancelled before the first pixel, there is no image:
/// [`RenderError::Interrupted`].
pub fn render(
    scene: &Scene,
    method: &dyn Method,
    settings: &Settings,
    observer: &mut dyn Observer,
    cancel: &Arc<AtomicBool>,
) -> Result<Rendering, RenderError> {
    let start = Instant::now();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads.unwrap_or(0)).build()?;
    let (camera, filter) = (*scene.camera(), FilterSampler::new(scene.filter()));
    let mut mean = Accumulator::new(camera.size.0 as usize, camera.size.1 as usize);
    let mut done = Rendering::nothing(&mean);
    loop {
        let begin = Instant::now();
        let workers = Workers::new(cancel, observer);
        let mut film = Film::new(camera, &filter, settings.seed, mean.passes(), settings.spp, &workers);
        let mut counts = Probe::default();
        counts.cancel = Some(cancel.clone());
        let outcome = pool.install(|| method.pass(scene, &mut film, &mut counts));
        let pass = film.image;
        // Cut short while the image was filled, or before that, while light paths were walked.
        let early = matches!(outcome, Err(PassError::Generate(GenerateError::Cancelled)));
        done.interrupted = early || workers.cut_short();
        if done.interrupted && mean.passes() > 0 {
            return Ok(done.with_mean(&mean));
        }
        if early {
            return Err(RenderError::Interrupted);
        }
        done.preparing += workers.first_run().unwrap_or_else(Instant::now).saturating_duration_since(begin);
        done.probe.merge(&counts);
        if done.interrupted {
            return Ok(Rendering { image: pass, elapsed: start.elapsed(), ..done });
        }
        outcome.map_err(RenderError::Pass)?;
        mean.add(&pass)?;
        done.elapsed = start.elapsed();
        observer.after_pass(&Progress {
            passes: mean.passes(),
            elapsed: done.elapsed,
            estimated_error: mean.estimated_error(),
            rays: done.probe.rays(),
        });
        if settings.budget.is_spent(mean.passes(), done.elapsed) {
            return Ok(done.with_mean(&mean));
        }
    }
}

impl Rendering {
    fn nothing(mean: &Accumulator) -> Self {
        Rendering {
            image: mean.mean(),
            standard_error: None,
            estimated_error: None,
            passes: 0,
            interrupted: false,
            elapsed: Duration::ZERO,
            preparing: Duration::ZERO,
            probe: Probe::default(),
        }
    }
    fn with_mean(self, mean: &Accumulator) -> Self {
        Rendering {
            image: mean.mean(),
            standard_error: mean.standard_error(),
            estimated_error: mean.estimated_error(),
            passes: mean.passes(),
            ..self
        }
    }
}
