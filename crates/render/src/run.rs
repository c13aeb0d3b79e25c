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
    /// For each pixel, means over the complete passes of what the method noted there, such as the size of a cut; by name.
    pub maps: Vec<(String, Vec<f32>)>,
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
    let mut session = Session::new(scene, method, settings)?;
    while let Some(_pass) = session.step(observer, cancel)? {
        if settings.budget.is_spent(session.passes(), session.elapsed()) {
            break;
        }
    }
    Ok(session.rendering())
}

/// A rendering that goes on pass by pass, so that several can take turns: what disturbs the machine then disturbs all alike.
pub struct Session<'s> {
    scene: &'s Scene,
    method: &'s dyn Method,
    settings: Settings,
    filter: FilterSampler,
    pool: rayon::ThreadPool,
    mean: Accumulator,
    /// Sums over passes.
    maps: Vec<(&'static str, Vec<f64>)>,
    done: Rendering,
}

impl<'s> Session<'s> {
    /// Nothing rendered yet. The settings' budget is for whoever steps.
    pub fn new(scene: &'s Scene, method: &'s dyn Method, settings: &Settings) -> Result<Self, RenderError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads.unwrap_or(0)).build()?;
        let (width, height) = scene.camera().size;
        let mean = Accumulator::new(width as usize, height as usize);
        let (filter, done) = (FilterSampler::new(scene.filter()), Rendering::nothing(&mean));
        Ok(Session { scene, method, settings: settings.clone(), filter, pool, mean, maps: Vec::new(), done })
    }
    /// Complete passes.
    pub fn passes(&self) -> u64 {
        self.mean.passes()
    }
    /// The time of all steps that gave a pass: what passes between the steps does not count.
    pub fn elapsed(&self) -> Duration {
        self.done.elapsed
    }
    /// All passes so far.
    pub fn rendering(&self) -> Rendering {
        match self.mean.passes() {
            0 => self.done.clone(),
            passes => Rendering {
                image: self.mean.mean(),
                standard_error: self.mean.standard_error(),
                estimated_error: self.mean.estimated_error(),
                passes,
                maps: self.maps.iter().map(|(name, sums)| (name.to_string(), mean_of(sums, passes))).collect(),
                ..self.done.clone()
            },
        }
    }
    /// Renders the next pass and returns it. `None`: it was cut short, and nothing more is to be rendered.
    pub fn step(
        &mut self,
        observer: &mut dyn Observer,
        cancel: &Arc<AtomicBool>,
    ) -> Result<Option<Image>, RenderError> {
        let begin = Instant::now();
        let workers = Workers::new(cancel, observer);
        let (camera, seed, spp) = (*self.scene.camera(), self.settings.seed, self.settings.spp);
        let mut film = Film::new(camera, &self.filter, seed, self.mean.passes(), spp, &workers);
        let mut counts = Probe::default();
        counts.cancel = Some(cancel.clone());
        let outcome = self.pool.install(|| self.method.pass(self.scene, &mut film, &mut counts));
        let (pass, maps) = (film.image, film.maps);
        // Cut short while the image was filled, or before that, while light paths were walked.
        let early = matches!(outcome, Err(PassError::Generate(GenerateError::Cancelled)));
        self.done.interrupted = early || workers.cut_short();
        if self.done.interrupted && self.mean.passes() > 0 {
            return Ok(None);
        }
        if early {
            return Err(RenderError::Interrupted);
        }
        self.done.preparing += workers.first_run().unwrap_or_else(Instant::now).saturating_duration_since(begin);
        self.done.probe.merge(&counts);
        if self.done.interrupted {
            (self.done.image, self.done.elapsed) = (pass, begin.elapsed());
            return Ok(None);
        }
        outcome.map_err(RenderError::Pass)?;
        self.mean.add(&pass)?;
        for (name, values) in maps {
            let known = self.maps.iter().position(|m| m.0 == name);
            let at = known.unwrap_or_else(|| {
                self.maps.push((name, vec![0.0; values.len()]));
                self.maps.len() - 1
            });
            self.maps[at].1.iter_mut().zip(values).for_each(|(sum, v)| *sum += f64::from(v));
        }
        self.done.elapsed += begin.elapsed();
        observer.after_pass(&Progress {
            passes: self.mean.passes(),
            elapsed: self.done.elapsed,
            estimated_error: self.mean.estimated_error(),
            rays: self.done.probe.rays(),
        });
        Ok(Some(pass))
    }
}

fn mean_of(sums: &[f64], passes: u64) -> Vec<f32> {
    sums.iter().map(|sum| (sum / passes as f64) as f32).collect()
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
            maps: Vec::new(),
        }
    }
}
