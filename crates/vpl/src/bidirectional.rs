//! Bidirectional instant radiosity (after Segovia, Iehl, Mitanchey and Peroche 2006).

use crate::reverse::{Reverse, Source};
use crate::walk::walk_from;
use crate::{Importons, Keller, Step, Vpl, walk_all};
use manylight_framework::{Batch, Claim, GenerateError, Generator, Probe, Promise};
use manylight_sampling::{AliasTable, Purpose, Stream};
use manylight_scene::Scene;

/// Candidates from both ends, of which those are taken that bring the camera something.
///
/// *Standard* lights are those of N light paths; *reverse* lights lie at second vertices of eye paths, and shine by what reaches
/// them from the light paths' vertices. The same path is made both ways, and each way gets the balance heuristic's weight, with
/// the density of the eye's way exact given the points that it starts from: unbiased whatever those points are. A vertex behind a
/// delta lobe only the light's way finds. Of all candidates about `lights` are taken by systematic resampling, with probability
/// proportional to importance / mean + floor, and weighed by its inverse.
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional {
    /// The light paths: N.
    pub walks: Keller,
    /// Reverse candidates.
    pub reverse: u64,
    /// Points of the image that reverse lights are found from, each asked for the density of every candidate.
    pub eyes: u32,
    /// Vertices of light paths that a reverse light gathers from.
    pub gathers: u32,
    /// Points of the image that candidates are weighed by.
    pub points: u32,
    /// Points, and shadow rays, that one candidate is weighed by.
    pub rays: u32,
    /// What a candidate weighs that no point sees, over the mean. Positive, else such lights would be lost.
    pub floor: f32,
    /// Lights that are taken.
    pub lights: u64,
    /// Eye paths are followed through lobes of a roughness of at most this: see [`Importons::new`].
    pub sharp: f32,
}

impl Bidirectional {
    /// As many reverse lights as light paths, and as many taken.
    pub fn new(walks: Keller) -> Self {
        let n = walks.paths;
        Bidirectional {
            walks,
            reverse: n,
            eyes: 32,
            gathers: 16,
            points: 1024,
            rays: 32,
            floor: 0.1,
            lights: n,
            sharp: 0.0,
        }
    }
}

impl Promise for Bidirectional {
    fn claim(&self) -> Claim {
        let walks = self.walks.claim();
        if self.floor > 0.0 { walks } else { Claim { bias: f32::INFINITY, ..walks } }
    }
}

/// All sources, and each hit with the place of the source that the walk came from.
type Walked = (Vec<Source>, Vec<(Step, usize)>);

/// What a walk leaves: where light can be carried on from, and where it got.
enum Left {
    Source(Source),
    Step(Step),
}

impl Generator for Bidirectional {
    type Lights = Vec<Vpl>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let paths = self.walks.paths;
        let (sources, steps) = self.walked(scene, pass, seed, probe)?;
        let importons = Importons::new(scene, self.points, paths, self.sharp, [seed, pass], probe);
        let points = Importons::at(scene, self.eyes, paths, self.sharp, [seed, pass, 1], probe);
        let weigh = |light: Option<Vpl>, probe: &mut Probe, s: &mut Stream| {
            light.map(|l| (l, importons.importance(scene, &l, self.rays, probe, s)))
        };
        let mut candidates = Vec::new();
        if let Some(picks) = AliasTable::new(sources.iter().map(|y| y.power() as f64)) {
            let length = self.walks.length();
            let reverse =
                Reverse { scene, points, count: self.reverse, gathers: self.gathers, sources: &sources, picks, length };
            candidates = walk_all(steps.len() as u64, probe, |i, probe, out| {
                let (step, parent) = steps[i as usize];
                let mut s = Stream::new(seed, [pass, i, 0], Purpose::IMPORTANCE);
                let light = self.walks.light(&step).map(|l| {
                    let weight =
                        step.density.map_or(1.0, |p| reverse.forward_weight(&l.vertex, p, parent, probe, &mut s));
                    Vpl { flux: l.flux * weight, ..l }
                });
                out.extend(weigh(light, probe, &mut s));
            })?;
            candidates.extend(walk_all(self.reverse, probe, |i, probe, out| {
                let mut s = Stream::new(seed, [pass, i, 1], Purpose::IMPORTANCE);
                let light = reverse.light(probe, &mut s).and_then(|step| self.walks.light(&step));
                out.extend(weigh(light, probe, &mut s));
            })?);
        }
        let u = Stream::new(seed, [pass, 1 << 41, 0], Purpose::IMPORTANCE).next_f64();
        let lights = self.resampled(candidates, u);
        probe.lights += lights.len() as u64;
        Ok(Batch { lights, paths, covers_direct: false })
    }
}

impl Bidirectional {
    /// All vertices of the light paths: those that light can be carried on from, and the hits, each with the place of the source
    /// that the walk came from.
    fn walked(&self, scene: &Scene, pass: u64, seed: u64, probe: &mut Probe) -> Result<Walked, GenerateError> {
        let left = walk_all(self.walks.paths, probe, |path, probe, out| {
            let mut s = Stream::new(seed, [pass, path, 0], Purpose::LIGHT_PATHS);
            probe.light_paths += 1;
            let Some(emission) = scene.sample_emission(&mut s) else { return };
            let (start, y) = (emission.flux.luminance(), &emission.start);
            out.push(Left::Source(Source { vertex: y.vertex, flux: y.flux, edges: 0, start }));
            walk_from(scene, &emission, &mut s, self.walks.length(), probe, |step| {
                out.push(Left::Step(step));
                if step.vertex.connects() {
                    let Step { vertex, flux, edges, .. } = step;
                    out.push(Left::Source(Source { vertex, flux, edges, start }));
                }
            });
        })?;
        let (mut sources, mut steps) = (Vec::new(), Vec::<(Step, usize)>::new());
        for l in left {
            match l {
                Left::Source(y) => sources.push(y),
                // The last source, unless a delta lobe lies between: then nobody asks.
                Left::Step(step) => steps.push((step, sources.len().saturating_sub(1))),
            }
        }
        Ok((sources, steps))
    }
    /// Systematic resampling: n draws at (k + u) / n of the summed weights q, each of weight 1 / (n q); copies are one light.
    fn resampled(&self, candidates: Vec<(Vpl, f64)>, u: f64) -> Vec<Vpl> {
        let mean = candidates.iter().map(|c| c.1).sum::<f64>() / candidates.len().max(1) as f64;
        // Where no point sees anything, all are equal.
        let scale = if mean > 0.0 { 1.0 / mean } else { 0.0 };
        let share = |importance: f64| importance * scale + self.floor as f64;
        let step = candidates.iter().map(|c| share(c.1)).sum::<f64>() / self.lights.max(1) as f64;
        let (mut lights, mut sum, mut next) = (Vec::new(), 0.0, u * step);
        for (light, importance) in candidates {
            let own = share(importance);
            sum += own;
            let mut copies = 0u32;
            while next < sum {
                copies += 1;
                next += step;
            }
            if copies > 0 {
                lights.push(Vpl { flux: light.flux * (copies as f64 * step / own) as f32, ..light });
            }
        }
        lights
    }
}
