//! From points to spheres.

use crate::{Radius, Vsl};
use manylight_framework::{Batch, Claim, GenerateError, Generator, KnobSet, PathClasses, Probe, Promise};
use manylight_scene::Scene;
use manylight_vpl::Vpl;

/// Gives each light of another generator a radius.
pub struct Spheres {
    /// Makes the points.
    pub points: Box<dyn Generator<Lights = Vec<Vpl>>>,
    /// How large the spheres of the first pass are.
    pub radius: Radius,
    /// alpha in (0, 1): radii of pass i are those of the first times sqrt((i + 1)^(alpha - 1)), so that the mean over passes is
    /// consistent (the family of Knaus and Zwicker 2011): at a point next to an edge the variance of the mean falls as n^-alpha and
    /// its bias as n^((alpha - 1) / 2). `None`: radii stay.
    pub shrink: Option<f32>,
}

impl Promise for Spheres {
    fn claim(&self) -> Claim {
        let blur = match (self.shrink, self.radius) {
            (Some(_), _) => Claim::consistent(KnobSet::PASSES),
            (None, Radius::Fixed(_)) => Claim::consistent(KnobSet::NONE),
            (None, _) => Claim::consistent(KnobSet::PATHS),
        };
        let points = self.points.claim();
        // Without lights nothing is blurred.
        let none = points.misses.contains(PathClasses::INDIRECT) && !points.noisy;
        if none { points } else { points.and(blur) }
    }
}

impl Generator for Spheres {
    type Lights = Vec<Vsl>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Vsl>>, GenerateError> {
        let Batch { lights, paths, covers_direct } = self.points.generate(scene, pass, seed, probe)?;
        let radii = self.radius.of(scene, &lights);
        let shrunk = self.shrink.map_or(1.0, |alpha| ((pass + 1) as f64).powf(0.5 * (alpha as f64 - 1.0)) as f32);
        let spheres = lights.into_iter().zip(radii).map(|(vpl, r)| Vsl { vpl, radius: r * shrunk });
        Ok(Batch { lights: spheres.collect(), paths, covers_direct })
    }
}
