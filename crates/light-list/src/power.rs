//! Lights drawn by their power.

use crate::all::finite;
use manylight_framework::{BuildError, Claim, Contribute, LightSet, Occlusion, Picks, Plan, Promise, VirtualLight};
use manylight_math::Spectrum;
use manylight_sampling::{Cdf, Stream};

/// Asks `samples` lights, drawn by power from as many strata of their summed power (Shirley, Wang and Zimmerman 1996).
#[derive(Clone, Copy, Debug)]
pub struct Power {
    /// Lights a receiver; at least one.
    pub samples: u32,
}

/// The lights and their summed power.
pub struct PowerLights<L> {
    lights: Vec<L>,
    /// None if there is no power at all.
    power: Option<Cdf>,
    samples: u32,
}

impl Promise for Power {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<L: VirtualLight> Plan<Vec<L>> for Power {
    type Set = PowerLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<PowerLights<L>, BuildError> {
        finite(&lights)?;
        let power = Cdf::new(lights.iter().map(|l| l.intensity() as f64));
        Ok(PowerLights { lights, power, samples: self.samples.max(1) })
    }
}
impl<L: VirtualLight, Q: Contribute<L>> LightSet<Q> for PowerLights<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let Some(power) = &self.power else { return Spectrum::BLACK };
        let n = self.samples as f64;
        let mut sum = [0.0f64; 3];
        for stratum in 0..self.samples {
            let (i, _) = power.sample((stratum as f64 + s.next_f64()) / n);
            let weight = 1.0 / (n * power.pmf(i));
            let c = ask.contribution(&self.lights[i], s).to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 * weight);
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}
impl<L: VirtualLight, Q> Picks<Q> for PowerLights<L> {
    fn pick(&self, _: &mut Q, s: &mut Stream) -> Option<(usize, f64)> {
        let power = self.power.as_ref()?;
        let (i, _) = power.sample(s.next_f64());
        Some((i, power.pmf(i)))
    }
    fn pmf(&self, _: &mut Q, light: usize) -> f64 {
        self.power.as_ref().map_or(0.0, |p| p.pmf(light))
    }
}
