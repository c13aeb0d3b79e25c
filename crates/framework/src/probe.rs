//! What is counted and shown on the way.

use crate::Depth;
use manylight_math::Spectrum;
use manylight_scene::{Edge, Occluders};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Counters and notes of a tile, merged in the tiles' order: no global counters.
#[derive(Clone, Debug, Default)]
pub struct Probe {
    /// Rays from the camera.
    pub camera_rays: u64,
    /// Rays of paths: those of light paths, those of eye paths after their first, and those of eye paths that only weigh lights.
    pub path_rays: u64,
    /// Rays that ask only whether an edge is clear: those to lights, those of direct light, and those of building a light set.
    pub shadow_rays: u64,
    /// Light paths walked.
    pub light_paths: u64,
    /// Light paths that were ended because their flux was NaN or infinite: a fault of a generator.
    pub broken_paths: u64,
    /// Virtual lights made.
    pub lights: u64,
    /// Lights asked for their contribution, with its shadow or without: the same light, if it is asked twice, counts twice.
    pub evaluations: u64,
    /// Samples that were NaN, infinite or negative: left out of the image (as black) and reported.
    pub non_finite: NonFinite,
    notes: Noted,
    /// Set when the user asks to stop: whatever takes long looks at it.
    pub cancel: Option<Arc<AtomicBool>>,
    /// What stopped shadow rays: looked at first by the next ones. It changes no answer, and is not counted.
    pub occluders: Occluders,
    /// What made one sample, where that is asked for.
    pub explain: Option<Explanation>,
}

/// Sums and counts of named values.
#[derive(Clone, Debug, Default)]
pub(crate) struct Noted(Vec<(&'static str, f64, u64)>);

impl Noted {
    fn add(&mut self, name: &'static str, sum: f64, count: u64) {
        match self.0.iter_mut().find(|a| a.0 == name) {
            Some(a) => {
                a.1 += sum;
                a.2 += count;
            }
            None => self.0.push((name, sum, count)),
        }
    }
    fn merge(&mut self, o: &Noted) {
        o.0.iter().for_each(|&(name, sum, count)| self.add(name, sum, count));
    }
    pub fn means(&self) -> impl Iterator<Item = (&'static str, f32)> {
        self.0.iter().map(|a| (a.0, (a.1 / a.2 as f64) as f32))
    }
}

/// Samples that were not fit for an image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    /// How many.
    pub count: u64,
    /// The first few: (pass, pixel index, sample), by which each can be replayed.
    pub first: Vec<(u64, usize, u32)>,
}

impl NonFinite {
    const KEPT: usize = 8;
    fn merge(&mut self, o: &NonFinite) {
        self.count += o.count;
        let room = Self::KEPT - self.first.len().min(Self::KEPT);
        self.first.extend(o.first.iter().take(room));
    }
}

/// What made one sample.
#[derive(Clone, Debug, Default)]
pub struct Explanation {
    /// The lights that were asked with a shadow ray, at what the eye sees: not where residual paths arrive.
    pub lights: Vec<Explained>,
    /// What compensation gave at each point, and where along the path that is.
    pub residuals: Vec<(Depth, Spectrum)>,
}

/// One light of an explanation.
#[derive(Clone, Copy, Debug)]
pub struct Explained {
    /// Ends on the light.
    pub edge: Edge,
    /// What it gave, bounded, its shadow included, before the light set weighed it. [W/(m^2 sr)]
    pub contribution: Spectrum,
    /// Geometry term. [1/m^2]
    pub g: f32,
    /// The part that the bounding kept.
    pub keep: f32,
    /// Edges of the light from the emitter.
    pub edges: u32,
}

impl Probe {
    /// Has the user asked to stop?
    pub fn cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(|c| c.load(Ordering::Relaxed))
    }
    /// Notes what compensation gave at a point, where explanations are asked for.
    pub fn explain_residual(&mut self, at: Depth, residual: Spectrum) {
        if let Some(e) = &mut self.explain {
            e.residuals.push((at, residual));
        }
    }
    /// Counts a sample that is not fit for an image.
    pub fn drop_sample(&mut self, pass: u64, pixel: usize, sample: u32) {
        self.non_finite.merge(&NonFinite { count: 1, first: vec![(pass, pixel, sample)] });
    }
    /// Notes a named value.
    pub fn note(&mut self, aov: &'static str, value: f32) {
        self.notes.add(aov, value as f64, 1);
    }
    /// What `work` notes, which is counted here too.
    pub(crate) fn noted<T>(&mut self, work: impl FnOnce(&mut Probe) -> T) -> (T, Noted) {
        let before = std::mem::take(&mut self.notes);
        let value = work(self);
        let notes = std::mem::replace(&mut self.notes, before);
        self.notes.merge(&notes);
        (value, notes)
    }
    /// Mean of the values noted under a name.
    pub fn mean(&self, aov: &str) -> Option<f64> {
        self.notes.0.iter().find(|a| a.0 == aov).map(|a| a.1 / a.2 as f64)
    }
    /// Names under which values were noted.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.notes.0.iter().map(|a| a.0)
    }
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera_rays + self.path_rays + self.shadow_rays
    }
    /// Adds what another one counted; in the order of the tiles, so that the sums do not depend on threads.
    pub fn merge(&mut self, o: &Probe) {
        self.camera_rays += o.camera_rays;
        self.path_rays += o.path_rays;
        self.shadow_rays += o.shadow_rays;
        self.light_paths += o.light_paths;
        self.broken_paths += o.broken_paths;
        self.lights += o.lights;
        self.evaluations += o.evaluations;
        self.non_finite.merge(&o.non_finite);
        self.notes.merge(&o.notes);
        if let Some(more) = &o.explain {
            let all = self.explain.get_or_insert_default();
            all.lights.extend(&more.lights);
            all.residuals.extend(&more.residuals);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merging_adds_counts_and_keeps_the_first_bad_samples_only() {
        let (mut a, mut b) = (Probe::default(), Probe::default());
        for i in 0..6 {
            a.drop_sample(0, i, 0);
            b.drop_sample(1, i, 0);
        }
        a.note("cut", 2.0);
        b.note("cut", 4.0);
        b.shadow_rays = 5;
        a.merge(&b);
        assert_eq!((a.non_finite.count, a.non_finite.first.len(), a.shadow_rays), (12, 8, 5));
        assert_eq!((a.mean("cut"), a.mean("bound")), (Some(3.0), None));
    }
}
