//! All lamps of a scene.

use crate::Lamp;
use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_scene::Scene;

/// Every piece of every emitter, the same in each pass: direct light only. It walks no path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lamps;

impl Promise for Lamps {
    fn claim(&self) -> Claim {
        Claim { misses: PathClasses::INDIRECT, ..Claim::UNBIASED }
    }
}
impl Generator for Lamps {
    type Lights = Vec<Lamp>;
    fn generate(&self, scene: &Scene, _: u64, _: u64, probe: &mut Probe) -> Result<Batch<Vec<Lamp>>, GenerateError> {
        let lights: Vec<Lamp> = scene.emitter_parts().iter().map(Lamp::new).collect();
        probe.lights += lights.len() as u64;
        Ok(Batch { lights, paths: 1, covers_direct: true })
    }
}
