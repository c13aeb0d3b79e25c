//! Every light.

use manylight_framework::{BATCH, BuildError, Claim, Contribute, LightSet, Occlusion, Plan, Promise, VirtualLight};
use manylight_math::Spectrum;
use manylight_sampling::Stream;

/// Asks every light: exact.
#[derive(Clone, Copy, Debug, Default)]
pub struct All;

/// The lights, in the order they were given.
pub struct AllLights<L>(Vec<L>);

impl Promise for All {
    fn claim(&self) -> Claim {
        Claim::EXACT
    }
}
impl<L: VirtualLight> Plan<Vec<L>> for All {
    type Set = AllLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<AllLights<L>, BuildError> {
        finite(&lights)?;
        Ok(AllLights(lights))
    }
}
impl<L: VirtualLight, Q: Contribute<L>> LightSet<Q> for AllLights<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let mut sum = [0.0f64; 3]; // f32 loses more than three digits over a million lights
        let mut out = [Spectrum::BLACK; BATCH];
        for lights in self.0.chunks(BATCH) {
            let out = &mut out[..lights.len()];
            ask.contributions(lights, out, s);
            for c in out {
                let c = c.to_array();
                (0..3).for_each(|k| sum[k] += c[k] as f64);
            }
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}

/// All lights are finite and of positive power, else which one is not.
pub(crate) fn finite<L: VirtualLight>(lights: &[L]) -> Result<(), BuildError> {
    match lights.iter().position(|l| !(l.intensity() >= 0.0 && l.intensity().is_finite())) {
        Some(light) => Err(BuildError::NotFinite { light }),
        None => Ok(()),
    }
}
