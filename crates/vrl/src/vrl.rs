//! The light.

use manylight_framework::VirtualLight;
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Medium, Span};

/// A virtual ray light: flux that enters a span, and is scattered all along it.
#[derive(Clone, Copy, Debug)]
pub struct Vrl {
    /// Where it runs, along the light, with a finite length.
    pub span: Span,
    /// Phi / N: what a light path carries into the span. \[W\]
    pub flux: Spectrum,
    /// Edges from the emitter to a point on it: 1 on a path's first edge.
    pub edges: u32,
    /// Of a short one: the probabilities of the channels that its end was drawn by. `None`: it is long, and attenuated.
    pub channels: Option<[f32; 3]>,
}

impl Vrl {
    /// T(v) of a long ray; T(v) / P(v) of a short one, which reaches v with probability P(v) = sum_c p_c T_c(v) only.
    pub fn arrives(&self, medium: &Medium, v: f32, s: &mut Stream) -> Spectrum {
        match self.channels {
            None => medium.transmittance(&self.span.ray, 0.0, v, s),
            Some(weights) => medium.reached(v, weights),
        }
    }
}

impl VirtualLight for Vrl {
    /// What it scatters, if the medium were as dense everywhere as where it is densest.
    fn intensity(&self) -> f32 {
        (self.flux * self.span.scattering_max).luminance() * self.span.ray.t_max
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}
