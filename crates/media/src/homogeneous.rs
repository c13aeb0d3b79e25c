//! The same everywhere.

use crate::{Flight, HenyeyGreenstein, MediumError};
use manylight_math::Spectrum;
use manylight_sampling::Stream;

/// A medium whose coefficients are the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    /// sigma_s [1/m]
    pub scattering: Spectrum,
    /// sigma_t [1/m]
    pub extinction: Spectrum,
    /// Its phase function.
    pub phase: HenyeyGreenstein,
    /// j [W/(m^3 sr)]
    pub emission: Spectrum,
}

impl Homogeneous {
    /// From sigma_s and sigma_t [1/m]: 0 <= sigma_s <= sigma_t in each channel.
    pub fn new(scattering: Spectrum, extinction: Spectrum, phase: HenyeyGreenstein) -> Result<Self, MediumError> {
        let (s, t) = (scattering.to_array(), extinction.to_array());
        let ok = scattering.is_valid() && extinction.is_valid() && (0..3).all(|c| s[c] <= t[c] * 1.000001);
        let emission = Spectrum::BLACK;
        ok.then_some(Homogeneous { scattering, extinction, phase, emission }).ok_or(MediumError::Coefficients)
    }
    /// The same, which also emits j [W/(m^3 sr)], in channels only in which it is not clear: else an endless ray were endlessly bright.
    pub fn emitting(self, emission: Spectrum) -> Result<Self, MediumError> {
        let (j, t) = (emission.to_array(), self.extinction.to_array());
        let ok = emission.is_valid() && (0..3).all(|c| j[c] == 0.0 || t[c] > 0.0);
        ok.then_some(Homogeneous { emission, ..self }).ok_or(MediumError::Emission)
    }
    /// j (1 - exp(-sigma_t t)) / sigma_t: what a run of this length emits to its beginning. [W/(m^2 sr)]
    pub fn emitted(&self, t: f32) -> Spectrum {
        let (j, sigma) = (self.emission.to_array(), self.extinction.to_array());
        Spectrum::from([0, 1, 2].map(|c| if j[c] > 0.0 { -(-sigma[c] * t).exp_m1() / sigma[c] * j[c] } else { 0.0 }))
    }
    /// exp(-sigma_t t)
    pub fn transmittance(&self, t: f32) -> Spectrum {
        self.extinction.map(|sigma| decay(sigma, t))
    }
    /// T(t) / sum_c p_c T_c(t), p = `weights`: what flights that got as far as `t` carry there.
    pub fn reached(&self, t: f32, weights: [f32; 3]) -> Spectrum {
        let through = self.relative(t);
        Spectrum::from(through) * (1.0 / (0..3).map(|c| weights[c] * through[c]).sum::<f32>())
    }
    /// T(t) over that of the thinnest channel: nothing underflows that a flight has reached.
    fn relative(&self, t: f32) -> [f32; 3] {
        let sigma = self.extinction.to_array();
        let thinnest = sigma[0].min(sigma[1]).min(sigma[2]);
        sigma.map(|x| decay(x - thinnest, t))
    }
    /// Draws a collision before `length`: a channel c with probability p_c = `weights`, then its exponential; the weight is
    /// divided by the mean of all channels' densities, sum_c p_c sigma_c exp(-sigma_c t) (one-sample multiple importance
    /// sampling by the balance heuristic).
    pub fn fly(&self, length: f32, weights: [f32; 3], s: &mut Stream) -> Flight {
        let sigma = self.extinction.to_array();
        let u = s.next_f32();
        let chosen = if u < weights[0] {
            0
        } else if u < weights[0] + weights[1] {
            1
        } else {
            2
        };
        let depth = -(-s.next_f64()).ln_1p() as f32;
        let t = depth / sigma[chosen];
        let mean = |values: [f32; 3]| (0..3).map(|c| weights[c] * values[c]).sum::<f32>();
        if t < length {
            let through = self.relative(t);
            let density = mean([0, 1, 2].map(|c| sigma[c] * through[c]));
            Flight::Collision { t, weight: self.scattering * Spectrum::from(through) * (1.0 / density) }
        } else {
            Flight::Passed { weight: self.reached(length, weights) }
        }
    }
}

/// exp(-sigma t), also for infinite t: a vacuum lets everything through, however long.
fn decay(sigma: f32, t: f32) -> f32 {
    if sigma == 0.0 { 1.0 } else { (-sigma * t).exp() }
}
