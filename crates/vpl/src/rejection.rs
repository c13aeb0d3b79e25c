//! Rejection of unimportant lights (Georgiev and Slusallek 2010).

use crate::walk::walk;
use crate::{Importons, Keller, Vpl, walk_all};
use manylight_framework::{Batch, Claim, GenerateError, Generator, Probe, Promise};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::Scene;

/// Walks as [`Keller`] does, and keeps a light with a probability that grows with what it brings to the camera:
///
/// > p_i = min(Phi_i / (selectivity x mean Phi) + floor, 1),      flux_i / p_i
///
/// The pilot set whose mean contribution is the measure are all candidates of the pass, zeros included. Given the candidates, each
/// is kept by a number of its own, so that E\[kept / p\] = 1, and fluxes are divided by the N paths that were walked, whatever was
/// kept: unbiased, since `floor` lets no light be forgotten that the few points missed.
#[derive(Clone, Copy, Debug)]
pub struct Rejection {
    /// The candidates: N paths.
    pub walks: Keller,
    /// Of the image, that candidates are weighed by: the more, the less is overlooked.
    pub points: u32,
    /// Points, and shadow rays, that one candidate is weighed by.
    pub rays: u32,
    /// The larger, the fewer lights are kept, and the more alike they are.
    pub selectivity: f32,
    /// Smallest probability. Zero would be biased: lights that no point saw would be lost.
    pub floor: f32,
    /// Eye paths are followed through lobes of a roughness of at most this: see [`Importons::new`].
    pub sharp: f32,
}

/// A light with its importance [W/(m^2 sr)] and the number that decides about it.
type Candidate = (Vpl, f64, f64);

impl Promise for Rejection {
    fn claim(&self) -> Claim {
        let walks = self.walks.claim();
        if self.floor > 0.0 { walks } else { Claim { bias: f32::INFINITY, ..walks } }
    }
}

impl Generator for Rejection {
    type Lights = Vec<Vpl>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let paths = self.walks.paths;
        let importons = Importons::new(scene, self.points, paths, self.sharp, [seed, pass], probe);
        let candidates: Vec<Candidate> = walk_all(paths, probe, |path, probe, out| {
            let mut lights = Vec::new();
            walk(scene, seed, pass, path, self.walks.length(), probe, |step| lights.extend(self.walks.light(&step)));
            let mut s = Stream::new(seed, [pass, path, 0], Purpose::IMPORTANCE);
            for light in lights {
                let importance = importons.importance(scene, &light, self.rays, probe, &mut s);
                out.push((light, importance, s.next_f64()));
            }
        })?;
        let count = candidates.len();
        let mean = candidates.iter().map(|c| c.1).sum::<f64>() / count.max(1) as f64;
        let lights: Vec<Vpl> = candidates.into_iter().filter_map(|c| self.keep(c, mean)).collect();
        probe.lights += lights.len() as u64;
        if count > 0 {
            probe.note("acceptance", lights.len() as f32 / count as f32);
        }
        Ok(Batch { lights, paths, covers_direct: false })
    }
}

impl Rejection {
    fn keep(&self, (light, importance, u): Candidate, mean: f64) -> Option<Vpl> {
        // No point saw any light: nothing is known, all are kept.
        if !(mean > 0.0) {
            return Some(light);
        }
        let p = (importance / (self.selectivity as f64 * mean) + self.floor as f64).min(1.0);
        (u < p).then(|| Vpl { flux: light.flux * (1.0 / p) as f32, ..light })
    }
}
