//! Virtual spherical lights (Hasan, Krivanek, Walter and Bala 2009).
//!
//! A virtual point light's flux Phi is spread over a sphere of radius r about it; a receiver x sees it in a cone Omega of directions,
//!
//! > C = Phi / (pi r^2) V(x, y) integral over Omega of f_x(w) cos_x f_y(-w) cos_y dw,   sin(half angle) = min(1, r / d),
//!
//! so that neither 1 / d^2 nor a narrow lobe of the light makes a spike: what a bound would take away is blurred over the cone
//! instead. As r goes to zero it is the virtual point light.
//!
//! ```
//! use manylight_vsl::cone_kernel;
//! // What stands in the place of 1 / d^2: nearly that from afar, never above 2 / r^2.
//! assert!((cone_kernel(100.0, 0.1) * 1e4 - 1.0).abs() < 1e-6);
//! assert_eq!(cone_kernel(0.0, 0.5), 8.0);
//! ```

mod cluster;
mod generator;
mod kernel;
mod radius;

pub use cluster::SphereCluster;
pub use generator::Spheres;
pub use kernel::{Sampling, SphereKernel, cone_kernel};
pub use radius::Radius;

use manylight_framework::VirtualLight;
use manylight_vpl::Vpl;

/// A virtual spherical light.
#[derive(Clone, Copy, Debug)]
pub struct Vsl {
    /// Its middle: where it is, how it emits, its flux.
    pub vpl: Vpl,
    /// Zero for a point light, such as one on an emitter. \[m\]
    pub radius: f32,
}

impl VirtualLight for Vsl {
    fn intensity(&self) -> f32 {
        self.vpl.intensity()
    }
    fn edges(&self) -> u32 {
        self.vpl.edges()
    }
}
