//! The light.

use manylight_framework::VirtualLight;
use manylight_math::Spectrum;
use manylight_scene::{EmitterPoint, Scatter, Vertex};

/// A virtual point light: a vertex of a light path, and the flux that it scatters.
#[derive(Clone, Copy, Debug)]
pub struct Vpl {
    /// Where it is and how it emits: by its BSDF (as seen from the previous vertex), phase function or profile.
    pub vertex: Vertex,
    /// alpha_j / N. \[W\], or [W/m^2] for one at infinity
    pub flux: Spectrum,
    /// Edges from the emitter to here; 0 on the emitter.
    pub edges: u32,
}

impl VirtualLight for Vpl {
    fn intensity(&self) -> f32 {
        match self.vertex.scatter {
            // A flux at infinity is one per area: what arrives of it is a power.
            Scatter::Emitter(EmitterPoint::Distant { disc, .. }) => self.flux.luminance() * disc,
            _ => self.flux.luminance(),
        }
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}
