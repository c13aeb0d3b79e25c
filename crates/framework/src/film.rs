//! The image of one pass, filled tile by tile.

use crate::Probe;
use manylight_math::{Ray, Spectrum, Vec2};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Camera, FilterSampler};
use std::sync::Mutex;

/// Side of a tile. \[pixel\]
pub const TILE: usize = 16;

/// Linear RGB pixels, row by row from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` of them.
    pub pixels: Vec<Spectrum>,
}

impl Image {
    /// All black.
    pub fn new(width: usize, height: usize) -> Self {
        Image { width, height, pixels: vec![Spectrum::BLACK; width * height] }
    }
}

/// Runs tasks, in any order, on any threads. Nothing below the crate `render` spawns threads of its own.
pub trait Scheduler: Sync {
    /// Runs tasks 0..count; all have ended when it returns. Tasks are left out once cancelled.
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync));
    /// Has the user asked to stop?
    fn cancelled(&self) -> bool {
        false
    }
}

/// Runs tasks 0..count and collects what they return, in their order. `None`: the task was left out.
pub fn collect<T: Send>(scheduler: &dyn Scheduler, count: usize, task: &(dyn Fn(usize) -> T + Sync)) -> Vec<Option<T>> {
    let results: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    scheduler.run(count, &|i| {
        let value = task(i);
        if let Ok(mut slot) = results[i].lock() {
            *slot = Some(value);
        }
    });
    results.into_iter().map(|r| r.into_inner().ok().flatten()).collect()
}

/// One task after the other, on this thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequential;
impl Scheduler for Sequential {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(task);
    }
}

/// The film of one pass: its image and its place in the sequence.
pub struct Film<'s> {
    /// What this pass has rendered.
    pub image: Image,
    /// The camera.
    pub camera: Camera,
    /// Seed of all passes.
    pub seed: u64,
    /// Which pass.
    pub pass: u64,
    /// Camera samples a pixel.
    pub spp: u32,
    /// Means, for each pixel, of the values noted on the way ([`Probe::note`]), by name; zero where there were none.
    pub maps: Vec<(&'static str, Vec<f32>)>,
    /// The pixel that is to be explained ([`Probe::explain`]), if any.
    pub explained: Option<usize>,
    filter: &'s FilterSampler,
    scheduler: &'s dyn Scheduler,
}

impl<'s> Film<'s> {
    /// A black film.
    pub fn new(
        camera: Camera,
        filter: &'s FilterSampler,
        seed: u64,
        pass: u64,
        spp: u32,
        scheduler: &'s dyn Scheduler,
    ) -> Self {
        let image = Image::new(camera.size.0 as usize, camera.size.1 as usize);
        Film { image, camera, seed, pass, spp: spp.max(1), maps: Vec::new(), explained: None, filter, scheduler }
    }
    /// Runs tasks, see `Scheduler`.
    pub fn scheduler(&self) -> &'s dyn Scheduler {
        self.scheduler
    }
    /// The stream of a camera sample.
    pub fn stream(&self, pixel: usize, sample: u32) -> Stream {
        Stream::new(self.seed, [self.pass, pixel as u64, sample as u64], Purpose::CAMERA)
    }
    /// Draws a camera ray of a pixel, and the weight that its filter gives it.
    pub fn camera_ray(&self, pixel: usize, s: &mut Stream) -> (Ray, f32) {
        let (x, y) = (pixel % self.image.width, pixel / self.image.width);
        let (offset, weight) = self.filter.sample(s.next_2d());
        (self.camera.sample_ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + offset, s), weight)
    }
    /// Sets each pixel to the mean of `spp` samples of `radiance`. A sample that is not valid counts as black and is reported.
    pub fn fill(&mut self, probe: &mut Probe, radiance: &(dyn Fn(&Ray, &mut Probe, &mut Stream) -> Spectrum + Sync)) {
        let (w, h) = (self.image.width, self.image.height);
        let across = w.div_ceil(TILE);
        let tiles = across * h.div_ceil(TILE);
        let explain = probe.explain.is_some();
        let this: &Self = self;
        let results = collect(this.scheduler, tiles, &|tile| {
            let mut probe = Probe::default();
            probe.explain = explain.then(Default::default);
            let (x0, y0) = (tile % across * TILE, tile / across * TILE);
            let rows = y0..(y0 + TILE).min(h);
            let places = rows.flat_map(|y| (x0..(x0 + TILE).min(w)).map(move |x| y * w + x));
            // A pixel may ask a million lights: whoever cancels does not wait for the rest of the tile.
            let places = places.take_while(|_| !this.scheduler.cancelled());
            let pixels: Vec<_> = places
                .map(|pixel| {
                    let alone = this.explained.is_none_or(|e| e == pixel);
                    let explanation = probe.explain.take_if(|_| !alone);
                    let (value, notes) = probe.noted(|probe| this.pixel(pixel, probe, radiance));
                    probe.explain = if alone { probe.explain.take() } else { explanation };
                    (pixel, value, notes)
                })
                .collect();
            (pixels, probe)
        });
        for (pixels, tile) in results.into_iter().flatten() {
            for (i, value, notes) in pixels {
                self.image.pixels[i] = value;
                notes.means().for_each(|(name, mean)| self.map(name)[i] = mean);
            }
            probe.merge(&tile);
        }
    }
    fn map(&mut self, name: &'static str) -> &mut [f32] {
        let known = self.maps.iter().position(|m| m.0 == name);
        let at = known.unwrap_or_else(|| {
            self.maps.push((name, vec![0.0; self.image.pixels.len()]));
            self.maps.len() - 1
        });
        &mut self.maps[at].1
    }
    fn pixel(
        &self,
        pixel: usize,
        probe: &mut Probe,
        radiance: &dyn Fn(&Ray, &mut Probe, &mut Stream) -> Spectrum,
    ) -> Spectrum {
        let mut sum = [0.0f64; 3]; // thousands of samples in f32 would lose what they add
        for sample in 0..self.spp {
            let mut s = self.stream(pixel, sample);
            let (ray, weight) = self.camera_ray(pixel, &mut s);
            probe.camera_rays += 1;
            let value = radiance(&ray, probe, &mut s);
            if value.is_valid() {
                (value * weight).to_array().iter().zip(&mut sum).for_each(|(c, sum)| *sum += *c as f64);
            } else {
                probe.drop_sample(self.pass, pixel, sample);
            }
        }
        Spectrum::from(sum.map(|x| (x / self.spp as f64) as f32))
    }
}
