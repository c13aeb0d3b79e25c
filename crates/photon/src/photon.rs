//! Photons: where light paths collide.

use crate::Near;
use manylight_framework::VirtualLight;
use manylight_math::{Aabb, Spectrum, Vec3};
use manylight_scene::Vertex;

/// A photon: a vertex of a light path, and how far around it counts.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Where it is, and where it came from (`wi`).
    pub vertex: Vertex,
    /// Of N paths, alpha / N: what arrives at a surface; what is scattered in a medium (sigma_s / sigma_t inside). \[W\]
    pub flux: Spectrum,
    /// Edges from the emitter to the vertex *before*: no edge connects a photon to its receiver, so that paths count as with
    /// virtual lights.
    pub edges: u32,
    /// R. \[m\]
    pub radius: f32,
}

impl VirtualLight for Photon {
    fn intensity(&self) -> f32 {
        self.flux.luminance()
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}
impl Near for Photon {
    fn place(&self) -> Aabb {
        let r = Vec3::splat(self.radius);
        Aabb { lo: self.vertex.p - r, hi: self.vertex.p + r }
    }
}
