//! The interface: one value that is any kind of medium.

use crate::{HenyeyGreenstein, Homogeneous};
use manylight_math::{Ray, Spectrum, Vec3};
use manylight_sampling::Stream;

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
