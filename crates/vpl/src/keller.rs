//! Instant radiosity's generator (Keller 1997), in its Monte Carlo form.

use crate::walk::walk;
use crate::{Length, Step, Vpl};
use manylight_bsdf::{Bsdf, Diffuse};
use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_scene::{Scatter, Scene};
use rayon::prelude::*;

/// How a light on a surface emits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emission {
    /// By its BSDF: unbiased, with spikes where the lobe is narrow.
    Full,
    /// As a diffuse surface of the same albedo: keeps the energy, not its directions.
    Diffuse,
}

/// Leaves a light at every vertex of N light paths, the emitter's own excepted: indirect light only.
#[derive(Clone, Copy, Debug)]
pub struct Keller {
    /// N.
    pub paths: u64,
    /// Longest path from emitter to eye, in edges; `None`: no limit.
    pub max_edges: Option<u32>,
    /// Edges before Russian roulette may end a path: 1 plays it at every vertex.
    pub certain_edges: u32,
    /// How lights emit.
    pub emission: Emission,
}

/// Paths that a thread walks at a time.
const CHUNK: u64 = 256;
/// Chunks between two looks at what has been made so far.
const ROUND: u64 = 64;
/// Lights that a pass may make: about 4 GB of them.
const MOST_LIGHTS: usize = 1 << 24;

impl Promise for Keller {
    fn claim(&self) -> Claim {
        let exact = Claim { misses: PathClasses::CAUSTICS, ..Claim::UNBIASED };
        match self.emission {
            Emission::Full => exact,
            Emission::Diffuse => Claim { bias: f32::INFINITY, brightens: true, ..exact },
        }
    }
}

impl Generator for Keller {
    type Lights = Vec<Vpl>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let lights = walk_all(self.paths, probe, |path, probe, out| {
            walk(scene, seed, pass, path, self.length(), probe, |step| out.extend(self.light(&step)));
        })?;
        probe.lights += lights.len() as u64;
        Ok(Batch { lights, paths: self.paths, covers_direct: false })
    }
}

impl Keller {
    /// How long its paths get: the connection and the eye's own edge come on top of a light's.
    pub fn length(&self) -> Length {
        let max_edges = self.max_edges.map_or(u32::MAX, |m| m.saturating_sub(2));
        Length { max_edges, certain_edges: self.certain_edges }
    }
    /// The light at a vertex of one of its paths; `None` where it would light nothing.
    pub fn light(&self, step: &Step) -> Option<Vpl> {
        let mut vertex = step.vertex;
        // Of rough glass there is no diffuse likeness: it stays what it is.
        if let (Emission::Diffuse, Scatter::Surface(x)) = (self.emission, &mut vertex.scatter)
            && x.bsdf.is_one_sided()
        {
            let wi = x.frame.to_local(x.wi);
            x.bsdf = if wi.z > 0.0 { Diffuse::new(x.bsdf.albedo(wi)).into() } else { Bsdf::Black };
        }
        let flux = step.flux * (1.0 / self.paths as f32);
        let worth = vertex.connects() && flux.luminance() > 0.0;
        worth.then_some(Vpl { vertex, flux, edges: step.edges })
    }
}

/// Walks paths 0..n in parallel; what they make (lights, or what is to become of them) and counts come out in the order of the
/// paths, whatever the threads.
pub fn walk_all<T: Send>(
    n: u64,
    probe: &mut Probe,
    walk: impl Fn(u64, &mut Probe, &mut Vec<T>) + Sync,
) -> Result<Vec<T>, GenerateError> {
    let mut lights = Vec::new();
    let chunks = n.div_ceil(CHUNK);
    for first in (0..chunks).step_by(ROUND as usize) {
        if probe.cancelled() {
            return Err(GenerateError::Cancelled);
        }
        let made: Vec<(Vec<T>, Probe)> = (first..(first + ROUND).min(chunks))
            .into_par_iter()
            .map(|chunk| {
                let (mut lights, mut probe) = (Vec::new(), Probe::default());
                for path in chunk * CHUNK..((chunk + 1) * CHUNK).min(n) {
                    walk(path, &mut probe, &mut lights);
                }
                (lights, probe)
            })
            .collect();
        for (made, counted) in made {
            lights.extend(made);
            probe.merge(&counted);
        }
        if lights.len() > MOST_LIGHTS {
            return Err(GenerateError::TooMany { lights: lights.len(), limit: MOST_LIGHTS });
        }
    }
    Ok(lights)
}
