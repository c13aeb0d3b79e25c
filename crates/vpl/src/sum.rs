//! Light adds, so generators add.

use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_scene::Scene;

/// The lights of several generators together. They must draw from places of their own, and must not make the same paths.
pub struct Sum<L>(pub Vec<Box<dyn Generator<Lights = Vec<L>>>>);

impl<L> Promise for Sum<L> {
    fn claim(&self) -> Claim {
        let claims = self.0.iter().map(|g| g.claim());
        // Each makes paths that the others do not: only what none of them makes is missed.
        let misses = claims.clone().map(|c| c.misses).reduce(PathClasses::common).unwrap_or(PathClasses::INDIRECT);
        Claim { misses, ..claims.fold(Claim::EXACT, Claim::and) }
    }
}
impl<L> Generator for Sum<L> {
    type Lights = Vec<L>;
    fn generate(&self, scene: &Scene, pass: u64, seed: u64, probe: &mut Probe) -> Result<Batch<Vec<L>>, GenerateError> {
        let mut sum = Batch { lights: vec![], paths: u64::MAX, covers_direct: false };
        for g in &self.0 {
            let b = g.generate(scene, pass, seed, probe)?;
            sum.lights.extend(b.lights);
            // A bound that looks at the number of paths goes by the coarsest part.
            sum.paths = sum.paths.min(b.paths);
            sum.covers_direct |= b.covers_direct;
        }
        Ok(sum)
    }
}

/// Makes nothing: direct light alone.
pub struct NoLights;
impl Promise for NoLights {
    fn claim(&self) -> Claim {
        Claim { misses: PathClasses::INDIRECT, ..Claim::EXACT }
    }
}
impl Generator for NoLights {
    type Lights = Vec<crate::Vpl>;
    fn generate(&self, _: &Scene, _: u64, _: u64, _: &mut Probe) -> Result<Batch<Vec<crate::Vpl>>, GenerateError> {
        Ok(Batch { lights: vec![], paths: 0, covers_direct: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Emission, Emitters, Keller};

    #[test]
    fn a_sum_misses_what_each_of_its_terms_misses() {
        let keller = Keller { paths: 1, max_edges: None, certain_edges: 1, emission: Emission::Full };
        let sum = Sum(vec![Box::new(keller), Box::new(Emitters { paths: 1 })]);
        assert_eq!(sum.claim(), Claim { misses: PathClasses::CAUSTICS, ..Claim::UNBIASED });
        assert!(Sum(vec![Box::new(Emitters { paths: 1 })]).claim().misses.contains(PathClasses::INDIRECT));
    }
}
