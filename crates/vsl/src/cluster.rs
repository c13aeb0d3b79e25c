//! What is known of many spherical lights together.

use crate::{SphereKernel, Vsl, cone_kernel};
use manylight_framework::{Bounds, Clustered, Reach, Reaches, Receiver};
use manylight_math::{Aabb, Vec3};
use manylight_vpl::{Cluster, Points, Vpl};

/// A cluster of their middles, and their radii. 56 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereCluster {
    /// Of the middles.
    pub points: Cluster,
    /// Largest radius. \[m\]
    pub largest: f32,
    /// Smallest radius. \[m\]
    pub smallest: f32,
}

impl SphereCluster {
    /// The cluster of the spheres' points: whatever direction the kernel looks into leads to one of them.
    fn grown(&self) -> Cluster {
        let r = Vec3::splat(self.largest * (1.0 + 1e-6));
        let b = &self.points.bounds;
        if b.is_empty() { self.points } else { Cluster { bounds: Aabb { lo: b.lo - r, hi: b.hi + r }, ..self.points } }
    }
}

impl Clustered for Vsl {
    type Cluster = SphereCluster;

    fn position(&self) -> Vec3 {
        self.vpl.position()
    }
    fn axis(&self) -> Vec3 {
        self.vpl.axis()
    }
    fn kind(&self) -> u32 {
        // Points know nothing of a radius, nor spheres of a bound.
        2 * self.vpl.kind() + (self.radius == 0.0) as u32
    }
    fn cluster(&self) -> SphereCluster {
        SphereCluster { points: self.vpl.cluster(), largest: self.radius, smallest: self.radius }
    }
    fn merge(a: &SphereCluster, b: &SphereCluster) -> SphereCluster {
        SphereCluster {
            points: Vpl::merge(&a.points, &b.points),
            largest: a.largest.max(b.largest),
            smallest: a.smallest.min(b.smallest),
        }
    }
    fn weight(c: &SphereCluster) -> f32 {
        Vpl::weight(&c.points)
    }
    fn cost(c: &SphereCluster, scale: f32) -> f32 {
        Vpl::cost(&c.points, scale)
    }
}

/// Bounds the expectation: the kernel itself is noisy.
impl<R: Receiver> Bounds<R, SphereCluster> for SphereKernel {
    fn upper_bound(&self, r: &R, c: &SphereCluster, cap: f32) -> f32 {
        // Points; or light from infinity among them, of which nothing is known.
        if c.largest == 0.0 || c.points.bounds.is_empty() {
            return Points.upper_bound(r, &c.points, cap);
        }
        let reach = Points.reach(r, &c.grown(), cap);
        let near = r.extent().distances2(&c.points.bounds).0.sqrt();
        // Falls with the distance; at a distance above the radius it grows with it, and is never above 2 / max(d, r)^2.
        let kernel = if near > c.largest { cone_kernel(near, c.largest) } else { 2.0 / near.max(c.smallest).powi(2) };
        let facing = reach.facing_max;
        // A facing of zero is a promise, and never 0 x infinity.
        if facing > 0.0 { c.points.peak * facing * kernel * (1.0 + 1e-4) } else { 0.0 }
    }
}

impl<R: Receiver> Reaches<R, SphereCluster> for SphereKernel {
    fn reach(&self, r: &R, c: &SphereCluster, cap: f32) -> Reach {
        let reach = Points.reach(r, &c.grown(), cap);
        // Within the radius nearness brings nothing more.
        let least = (c.smallest * c.smallest).max(1.0 / cap);
        let (near2, far2) = r.extent().distances2(&c.points.bounds);
        let centre2 = (c.points.bounds.centre() - r.extent().centre()).length_squared();
        if c.largest == 0.0 || c.points.bounds.is_empty() {
            return reach;
        }
        Reach { near2: near2.max(least), far2: far2.max(least), centre2: centre2.max(least), ..reach }
    }
}
