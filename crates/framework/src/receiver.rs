//! What bounds and reaches need of a receiver, be it a vertex or a span.

use manylight_math::{Aabb, Vec3};
use manylight_scene::{Lobe, Span, Vertex};

/// One end of a connection, seen from the eye.
pub trait Receiver: Sync {
    /// The smallest box around it.
    fn extent(&self) -> Aabb;
    /// Largest channel of what it scatters from anywhere in a box, never below the truth; a span's is integrated over its
    /// length. [1/sr]
    fn lobe(&self, towards: &Aabb) -> Lobe;
    /// The same towards a box of directions, for light from infinity: as a box so far away that neither where in its extent the receiver
    /// is, nor how long a metre is, make a difference.
    fn lobe_to_infinity(&self, directions: &Aabb) -> Lobe {
        let extent = self.extent();
        let size = extent.lo.abs().max(extent.hi.abs()).max_element();
        let far = if size > 0.0 { 1024.0 * size } else { 1.0 };
        let pad = Vec3::splat(1e-6 * far);
        self.lobe(&Aabb { lo: extent.lo + directions.lo * far - pad, hi: extent.hi + directions.hi * far + pad })
    }
    /// Largest channel of eval towards one point: a guess, good enough for a probability. [1/sr]
    fn guess(&self, towards: Vec3) -> f32;
}

impl Receiver for Vertex {
    fn extent(&self) -> Aabb {
        Aabb::point(self.p)
    }
    fn lobe(&self, towards: &Aabb) -> Lobe {
        self.bound(towards)
    }
    fn guess(&self, towards: Vec3) -> f32 {
        self.eval((towards - self.p).normalize_or_zero()).largest()
    }
}

impl Receiver for Span {
    fn extent(&self) -> Aabb {
        Span::extent(self)
    }
    fn lobe(&self, _: &Aabb) -> Lobe {
        self.bound()
    }
    fn guess(&self, towards: Vec3) -> f32 {
        let foot = (towards - self.ray.origin).dot(self.ray.dir).clamp(0.0, self.ray.t_max);
        let nearest = self.at(foot, self.scattering_max);
        nearest.eval((towards - nearest.p).normalize_or_zero()).largest() * self.ray.t_max
    }
}
