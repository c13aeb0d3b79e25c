//! The interface: one value that is any kind of medium.

use crate::{HenyeyGreenstein, Homogeneous};
use manylight_math::{Ray, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_sampling::along::Exponential;

/// Where a flight through a medium ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// At a collision.
    Collision {
        /// Distance along the ray. \[m\]
        t: f32,
        /// sigma_s T / pdf: what a path carries times this is what the collision scatters.
        weight: Spectrum,
    },
    /// At the end of the segment.
    Passed {
        /// T / (probability of getting there).
        weight: Spectrum,
    },
}

/// Why a medium cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MediumError {
    /// Coefficients that make no sense.
    #[error("coefficients of a medium must be finite, not negative, and scattering must not exceed extinction")]
    Coefficients,
}

/// A medium.
#[derive(Clone, Debug)]
pub enum Medium {
    /// The same everywhere.
    Homogeneous(Homogeneous),
}

impl From<Homogeneous> for Medium {
    fn from(m: Homogeneous) -> Self {
        Medium::Homogeneous(m)
    }
}

impl Medium {
    /// Its phase function.
    pub fn phase(&self) -> HenyeyGreenstein {
        match self {
            Medium::Homogeneous(m) => m.phase,
        }
    }
    /// sigma_s at a point. [1/m]
    pub fn scattering(&self, _p: Vec3) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.scattering,
        }
    }
    /// Never below sigma_s at any point. [1/m]
    pub fn scattering_max(&self) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.scattering,
        }
    }
    /// Mean of the channels' extinction, for densities. [1/m]
    pub fn extinction_mean(&self) -> f64 {
        match self {
            Medium::Homogeneous(m) => f64::from(m.extinction.mean()),
        }
    }
    /// How far it takes until every channel that scatters has this optical depth; infinite if nothing takes it there. \[m\]
    pub fn depth(&self, optical: f32) -> f32 {
        match self {
            Medium::Homogeneous(m) => {
                let (s, t) = (m.scattering.to_array(), m.extinction.to_array());
                let thinnest = (0..3).filter(|c| s[*c] > 0.0).map(|c| t[c]).fold(f32::INFINITY, f32::min);
                optical / thinnest
            }
        }
    }
    /// A collision on a ray up to its `t_max`, conditioned on there being one: where, and sigma_s T / pdf. `None` if it scatters
    /// nothing there.
    pub fn collide(&self, ray: &Ray, s: &mut Stream) -> Option<(f32, Spectrum)> {
        let by = Exponential::new(self.extinction_mean(), f64::from(ray.t_max));
        let t = by.sample(s.next_f64());
        let weight = self.scattering(ray.at(t as f32)) * self.transmittance(ray, 0.0, t as f32, s);
        (!weight.is_black()).then(|| (t as f32, weight * (1.0 / by.pdf(t)) as f32))
    }
    /// An estimate of T between two distances of a ray; exact where there is a closed form, and then nothing is drawn.
    pub fn transmittance(&self, _ray: &Ray, from: f32, to: f32, _s: &mut Stream) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.transmittance(to - from),
        }
    }
    /// Draws a collision between two distances of a ray. `weights` are probabilities of the channels, of which one is drawn to
    /// fly by (see [`Medium::channels`]).
    pub fn fly(&self, _ray: &Ray, from: f32, to: f32, weights: [f32; 3], s: &mut Stream) -> Flight {
        match self {
            Medium::Homogeneous(m) => match m.fly(to - from, weights, s) {
                Flight::Collision { t, weight } => Flight::Collision { t: from + t, weight },
                passed => passed,
            },
        }
    }
    /// Probabilities of the channels for a path that carries `throughput`: in proportion to it, none below 0.05, so that no
    /// weight exceeds 20. A channel without light needs no luck.
    pub fn channels(throughput: Spectrum) -> [f32; 3] {
        let c = throughput.to_array();
        let sum: f32 = c.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return [1.0 / 3.0; 3];
        }
        const LEAST: f32 = 0.05;
        c.map(|x| LEAST + (1.0 - 3.0 * LEAST) * (x / sum))
    }
}
