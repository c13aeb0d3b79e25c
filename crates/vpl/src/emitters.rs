//! Emitters turned to points: direct light as virtual lights.

use crate::Vpl;
use crate::keller::walk_all;
use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::Scene;

/// Draws N points of the emitters (directions, for light from infinity) by power: direct light only.
#[derive(Clone, Copy, Debug)]
pub struct Emitters {
    /// N.
    pub paths: u64,
}

impl Promise for Emitters {
    fn claim(&self) -> Claim {
        Claim { misses: PathClasses::INDIRECT, ..Claim::UNBIASED }
    }
}

impl Generator for Emitters {
    type Lights = Vec<Vpl>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let lights = walk_all(self.paths, probe, |path, probe, out| {
            // The walks of the same path number draw from [.., 0].
            let mut s = Stream::new(seed, [pass, path, 1], Purpose::LIGHT_PATHS);
            probe.light_paths += 1;
            let Some(sample) = scene.sample_emitter(&mut s) else { return };
            let flux = sample.flux * (1.0 / self.paths as f32);
            if !flux.is_valid() {
                probe.broken_paths += 1;
            } else if !flux.is_black() {
                out.push(Vpl { vertex: sample.vertex, flux, edges: 0 });
            }
        })?;
        probe.lights += lights.len() as u64;
        Ok(Batch { lights, paths: self.paths, covers_direct: true })
    }
}
