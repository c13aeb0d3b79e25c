//! The interface: one value that is any kind of medium.

use crate::{HenyeyGreenstein, Heterogeneous, Homogeneous};
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
    /// A grid that is none.
    #[error("a grid needs a value for each of its voxels, and a transform that is not singular")]
    Grid,
    /// Coefficients that make no sense.
    #[error("coefficients of a medium must be finite, not negative, and scattering must not exceed extinction")]
    Coefficients,
    /// Emission that makes no sense.
    #[error(
        "emission must be finite and not negative, and a homogeneous medium must not be clear in a channel in which it emits"
    )]
    Emission,
}

/// A medium.
#[derive(Clone, Debug)]
pub enum Medium {
    /// The same everywhere.
    Homogeneous(Homogeneous),
    /// Its density is a grid.
    Heterogeneous(Box<Heterogeneous>),
}

impl From<Heterogeneous> for Medium {
    fn from(m: Heterogeneous) -> Self {
        Medium::Heterogeneous(Box::new(m))
    }
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
            Medium::Heterogeneous(m) => m.phase,
        }
    }
    /// sigma_s at a point. [1/m]
    pub fn scattering(&self, p: Vec3) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.scattering,
            Medium::Heterogeneous(m) => m.scattering(p),
        }
    }
    /// sigma_t at a point. [1/m]
    pub fn extinction(&self, p: Vec3) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.extinction,
            Medium::Heterogeneous(m) => m.extinction(p),
        }
    }
    /// Never below sigma_s at any point. [1/m]
    pub fn scattering_max(&self) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.scattering,
            Medium::Heterogeneous(m) => m.scattering_max(),
        }
    }
    /// Does it emit?
    pub fn emits(&self) -> bool {
        match self {
            Medium::Homogeneous(m) => !m.emission.is_black(),
            Medium::Heterogeneous(m) => m.emission().is_some_and(|e| !e.is_black()),
        }
    }
    /// An estimate of what emission between two distances of a ray brings to the first, int T(from, t) j(t) dt; exact where there is
    /// a closed form, and then nothing is drawn. [W/(m^2 sr)]
    pub fn emitted(&self, ray: &Ray, from: f32, to: f32, s: &mut Stream) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.emitted(to - from),
            Medium::Heterogeneous(m) => m.emitted(ray, from, to, s),
        }
    }
    /// Both `emitted` and `transmittance` between two distances of a ray, with hardly any noise, but with a small bias where there is
    /// no closed form. `None`: not for this medium.
    pub fn marched(&self, ray: &Ray, from: f32, to: f32, s: &mut Stream) -> Option<(Spectrum, Spectrum)> {
        match self {
            Medium::Homogeneous(m) => Some((m.emitted(to - from), m.transmittance(to - from))),
            Medium::Heterogeneous(m) => m.marched(ray, from, to, s),
        }
    }
    /// Mean of the channels' extinction, for densities. [1/m]
    pub fn extinction_mean(&self) -> f64 {
        match self {
            Medium::Homogeneous(m) => f64::from(m.extinction.mean()),
            Medium::Heterogeneous(m) => f64::from(m.extinction_mean()),
        }
    }
    /// How far along a ray there is anything to be seen of it: until every channel that scatters has this optical depth, or the
    /// grid ends; infinite if it never does. \[m\]
    pub fn reach(&self, ray: &Ray, optical: f32) -> f32 {
        match self {
            Medium::Homogeneous(m) => {
                let (s, t) = (m.scattering.to_array(), m.extinction.to_array());
                let thinnest = (0..3).filter(|c| s[*c] > 0.0).map(|c| t[c]).fold(f32::INFINITY, f32::min);
                optical / thinnest
            }
            Medium::Heterogeneous(m) => m.reach(ray),
        }
    }
    /// exp(-sigma_t t) is its transmittance: the medium is the same everywhere.
    pub fn homogeneous(&self) -> Option<&Homogeneous> {
        match self {
            Medium::Homogeneous(m) => Some(m),
            Medium::Heterogeneous(_) => None,
        }
    }
    /// Is T / P known along flights, with P the probability of getting there? Not where both would have to be estimated.
    pub fn knows_flights(&self) -> bool {
        match self {
            Medium::Homogeneous(_) => true,
            Medium::Heterogeneous(m) => m.is_gray(),
        }
    }
    /// T(t) / P(t) on a ray whose end was drawn by `fly` with these weights, at a distance that it reached. Only where
    /// `knows_flights`.
    pub fn reached(&self, t: f32, weights: [f32; 3]) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.reached(t, weights),
            Medium::Heterogeneous(_) => Spectrum::ONE,
        }
    }
    /// A collision on a ray up to its `t_max`: where, and sigma_s T / pdf, in a homogeneous medium conditioned on there being one.
    /// `None`: there was none, or it scatters nothing.
    pub fn collide(&self, ray: &Ray, s: &mut Stream) -> Option<(f32, Spectrum)> {
        match self {
            Medium::Homogeneous(m) => {
                let by = Exponential::new(self.extinction_mean(), f64::from(ray.t_max));
                let t = by.sample(s.next_f64());
                let weight = m.scattering * m.transmittance(t as f32);
                (!weight.is_black()).then(|| (t as f32, weight * (1.0 / by.pdf(t)) as f32))
            }
            Medium::Heterogeneous(m) => match m.fly(ray, 0.0, ray.t_max, [1.0 / 3.0; 3], s) {
                Flight::Collision { t, weight } if !weight.is_black() => Some((t, weight)),
                _ => None,
            },
        }
    }
    /// An estimate of T between two distances of a ray; exact where there is a closed form, and then nothing is drawn.
    pub fn transmittance(&self, ray: &Ray, from: f32, to: f32, s: &mut Stream) -> Spectrum {
        match self {
            Medium::Homogeneous(m) => m.transmittance(to - from),
            Medium::Heterogeneous(m) => m.transmittance(ray, from, to, s),
        }
    }
    /// Draws a collision between two distances of a ray. `weights` are probabilities of the channels, of which one is drawn to
    /// fly by (see [`Medium::channels`]).
    pub fn fly(&self, ray: &Ray, from: f32, to: f32, weights: [f32; 3], s: &mut Stream) -> Flight {
        match self {
            Medium::Homogeneous(m) => match m.fly(to - from, weights, s) {
                Flight::Collision { t, weight } => Flight::Collision { t: from + t, weight },
                passed => passed,
            },
            Medium::Heterogeneous(m) => m.fly(ray, from, to, weights, s),
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
