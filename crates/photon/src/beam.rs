//! Photon beams: the edges of light paths.

use crate::Near;
use manylight_framework::VirtualLight;
use manylight_math::{Aabb, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::{Medium, Span};

/// A piece of an edge of a light path in a medium, and how wide it counts.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// The whole edge, along the light.
    pub span: Span,
    /// The piece of it, as distances. \[m\]
    pub piece: (f32, f32),
    /// Phi / N: what the path carries into the span. \[W\]
    pub flux: Spectrum,
    /// Edges from the emitter to the vertex before the edge. (See [`crate::Photon`].)
    pub edges: u32,
    /// Of a short beam, whose end was drawn by free flight: the probabilities of the channels. `None`: it is long.
    pub channels: Option<[f32; 3]>,
    /// R: half its width. \[m\]
    pub radius: f32,
}

impl Beam {
    /// T(v) of a long beam; T(v) / P(v) of a short one, which reaches v with probability P(v) only.
    pub fn arrives(&self, medium: &Medium, v: f32, s: &mut Stream) -> Spectrum {
        match self.channels {
            None => medium.transmittance(&self.span.ray, 0.0, v, s),
            Some(weights) => medium.reached(v, weights),
        }
    }
}

impl VirtualLight for Beam {
    fn intensity(&self) -> f32 {
        (self.flux * self.span.scattering_max).luminance() * (self.piece.1 - self.piece.0)
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}
impl Near for Beam {
    fn place(&self) -> Aabb {
        let ends = Aabb::around([self.span.ray.at(self.piece.0), self.span.ray.at(self.piece.1)]);
        let r = Vec3::splat(self.radius);
        Aabb { lo: ends.lo - r, hi: ends.hi + r }
    }
}
