//! The generator: pilot, bootstrap, chains.

use crate::chain::{Space, State};
use manylight_framework::{Batch, Claim, GenerateError, Generator, KnobSet, Probe, Promise};
use manylight_sampling::{Cdf, Purpose, Stream};
use manylight_scene::Scene;
use manylight_vpl::{Importons, Keller, Vpl, walk_all};
use rayon::prelude::*;
use std::sync::Arc;

/// Where chains start among the samples of the bootstrap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// With probability proportional to c: unbiased from the first step on.
    Weighted,
    /// Anywhere there is a light: biased until the chains have forgotten it. What is wrong without a burn-in, to be seen.
    Uniform,
}

/// Leaves the lights of many short chains over light paths.
#[derive(Clone, Copy, Debug)]
pub struct Metropolis {
    /// What a light path is; its `paths` are the steps N of all chains together, rounded up to equally many for each.
    pub walks: Keller,
    /// Independent chains.
    pub chains: u32,
    /// Independent light paths that the chains start from, and that say how much light there is.
    pub bootstrap: u64,
    /// Points of the image that lights are weighed by.
    pub points: u32,
    /// Points, and shadow rays, that one light is weighed by.
    pub rays: u32,
    /// What a light weighs that no point sees, over the mean light. Positive, else such lights would be lost.
    pub floor: f32,
    /// Tries of a small step, K.
    pub tries: u32,
    /// Probability of a large step.
    pub large: f32,
    /// Probability of a camera step; all others are small.
    pub camera: f32,
    /// Where chains start.
    pub start: Start,
    /// Eye paths are followed through lobes of a roughness of at most this: see [`Importons::new`].
    pub sharp: f32,
}

impl Metropolis {
    /// With what has proved good.
    pub fn new(walks: Keller) -> Self {
        let (chains, bootstrap, points, rays, floor) = (64, 4096, 1024, 32, 0.02);
        let (tries, large, camera, start) = (1, 0.3, 0.1, Start::Weighted);
        Metropolis { walks, chains, bootstrap, points, rays, floor, tries, large, camera, start, sharp: 0.0 }
    }
    /// Numbers and weighing of an independent path: `kind` 2 for the bootstrap, 3 for the pilot.
    fn independent(space: &Space, seed: u64, at: [u64; 3], probe: &mut Probe) -> State {
        let numbers = Stream::new(seed, at, Purpose::LIGHT_PATHS);
        space.state(Arc::new(move |n| numbers.nth(n)), probe, &mut Stream::new(seed, at, Purpose::IMPORTANCE))
    }
    /// 1 / mean Phi of a light. The pilot is independent of all that follows, so it may go on until it has seen enough.
    fn scale(&self, space: &Space, pass: u64, seed: u64, probe: &mut Probe) -> Result<f64, GenerateError> {
        let (mut sum, mut count, mut seen, mut first) = (0.0, 0u64, 0u64, 0);
        let mut paths = PILOT;
        while seen < ENOUGH && first < MOST_PILOTS * PILOT {
            let shares = walk_all(paths, probe, |path, probe, out: &mut Vec<f64>| {
                let state = Metropolis::independent(space, seed, [pass, first + path, 3], probe);
                out.extend(state.lights.iter().map(|l| l.1 - self.floor as f64));
            })?;
            count += shares.len() as u64;
            seen += shares.iter().filter(|s| **s > 0.0).count() as u64;
            sum += shares.iter().sum::<f64>();
            (first, paths) = (first + paths, first + paths);
        }
        Ok(if sum > 0.0 { count as f64 / sum } else { 0.0 })
    }
}

/// Paths of the first pilot; it is doubled until so many lights were seen, or so many times the paths were walked.
const PILOT: u64 = 256;
const ENOUGH: u64 = 32;
const MOST_PILOTS: u64 = 64;

impl Promise for Metropolis {
    fn claim(&self) -> Claim {
        let walks = self.walks.claim();
        match self.start {
            Start::Weighted if self.floor > 0.0 => walks,
            Start::Weighted => Claim { bias: f32::INFINITY, ..walks },
            Start::Uniform => walks.and(Claim::consistent(KnobSet::PATHS)),
        }
    }
}

impl Generator for Metropolis {
    type Lights = Vec<Vpl>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let chains = (self.chains as u64).clamp(1, self.walks.paths.max(1));
        let steps = self.walks.paths.max(1).div_ceil(chains);
        let paths = chains * steps;
        let importons = Importons::new(scene, self.points, paths, self.sharp, [seed, pass], probe);
        // A light of one path: the normalisation is b's.
        let one = Metropolis { walks: Keller { paths: 1, ..self.walks }, ..*self };
        let mut space = Space { metropolis: &one, scene, importons: &importons, scale: 1.0 };
        space.scale = self.scale(&space, pass, seed, probe)?;

        let bootstrap = walk_all(self.bootstrap.max(1), probe, |i, probe, out| {
            out.push(Metropolis::independent(&space, seed, [pass, i, 2], probe));
        })?;
        let weights = bootstrap.iter().map(|s| s.weight);
        let b = weights.clone().sum::<f64>() / bootstrap.len() as f64;
        let cdf = match self.start {
            Start::Weighted => Cdf::new(weights),
            Start::Uniform => Cdf::new(weights.map(|w| if w > 0.0 { 1.0 } else { 0.0 })),
        };
        // No path left any light.
        let Some(cdf) = cdf else { return Ok(Batch { lights: vec![], paths, covers_direct: false }) };
        let offset = Stream::new(seed, [pass, 0, 0], Purpose::CHAINS).next_f64();
        let made: Vec<(Vec<Vpl>, Probe)> = (0..chains)
            .into_par_iter()
            .map(|chain| {
                let mut own = Probe::default();
                own.cancel = probe.cancel.clone();
                let start = &bootstrap[cdf.sample((chain as f64 + offset) / chains as f64).0];
                let mut s = Stream::new(seed, [pass, chain, 1], Purpose::CHAINS);
                (walk_chain(&space, start, steps, b / paths as f64, &mut own, &mut s), own)
            })
            .collect();
        if probe.cancelled() {
            return Err(GenerateError::Cancelled);
        }
        let mut lights = Vec::new();
        for (own, counted) in made {
            lights.extend(own);
            probe.merge(&counted);
        }
        probe.lights += lights.len() as u64;
        Ok(Batch { lights, paths, covers_direct: false })
    }
}

/// The lights of a chain of some steps, the start being the first; `power` is b / N.
fn walk_chain(space: &Space, start: &State, steps: u64, power: f64, probe: &mut Probe, s: &mut Stream) -> Vec<Vpl> {
    let (mut state, mut lights, mut stood) = (start.clone(), Vec::new(), 1);
    let mut leave = |state: &State, stood: u64, s: &mut Stream| {
        let left = state.leave(stood, s);
        lights.extend(
            left.into_iter()
                .map(|(light, share, times)| Vpl { flux: light.flux * (power * times as f64 / share) as f32, ..light }),
        );
    };
    for _ in 1..steps {
        if probe.cancelled() {
            break;
        }
        match space.step(&mut state, probe, s) {
            Some(next) => {
                leave(&state, stood, s);
                (state, stood) = (next, 1);
            }
            None => stood += 1,
        }
    }
    leave(&state, stood, s);
    lights
}
