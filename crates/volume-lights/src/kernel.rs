//! From a receiver to a light in a volume.

use crate::light::Cluster;
use crate::{VolumeLight, mean_inverse_square};
use manylight_framework::{Bounds, Claim, Connection, Kernel, Pair, Promise, Reach, Reaches, Receiver};
use manylight_math::Vec3;
use manylight_sampling::Stream;
use manylight_scene::{Edge, End, Scene, Sides, Vertex};

/// Connects vertices to lights in volumes: as if all of a light came from its middle, but for 1/d^2, which is that of a ball, and for
/// the shadow, which is asked of a point drawn in a box of the light's spread. No spikes where lights are near, and soft shadows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Balls;

impl Promise for Balls {
    /// A light is not a ball with one shadow: what is lost is not bounded.
    fn claim(&self) -> Claim {
        Claim { noisy: true, bias: f32::INFINITY, brightens: true, ..Claim::EXACT }
    }
}

impl Kernel<Vertex, VolumeLight> for Balls {
    fn connect(&self, _: &Scene, r: &Vertex, l: &VolumeLight, s: &mut Stream) -> Option<Connection> {
        let d = l.p - r.p;
        let d2 = d.length_squared();
        // In the very middle, light comes from all sides: any will do.
        let w = d.try_normalize().unwrap_or(Vec3::Z);
        let inverse = mean_inverse_square(d2, l.radius);
        let value = r.eval(w) * l.intensity * inverse;
        if value.is_black() || !inverse.is_finite() {
            return None;
        }
        // A box of standard deviation sigma reaches to sqrt(3) sigma.
        let bits = s.next_u64();
        let part = |k: u32| ((bits >> (21 * k)) & 0x1f_ffff) as f32 * (2.0 / 2_097_151.0) - 1.0;
        let u = Vec3::new(part(0), part(1), part(2));
        let from = l.p + u * l.spread * 3f32.sqrt();
        let end = End { p: from, surface: None, sides: Sides::VACUUM };
        let pair = Pair { g: r.cosine(w) * inverse, lobes: None };
        Some(Connection { value, edge: Edge::Between(r.end(), end), pair })
    }
}

/// A ball is at most so much brighter than a point as far away, outside of it.
const NEAR: f32 = 1.5;
/// Rounding of what is bounded.
const ROUNDING: f32 = 1.0 + 2e-5;

/// Never below the mean of 1/d^2 over any ball of a cluster. [1/m^2]
fn largest_inverse(c: &Cluster, near2: f32) -> f32 {
    (NEAR / near2).min(3.0 / (c.radius * c.radius))
}

impl<R: Receiver> Bounds<R, Cluster> for Balls {
    fn upper_bound(&self, r: &R, c: &Cluster, cap: f32) -> f32 {
        let (near2, _) = r.extent().distances2(&c.bounds);
        let lobe = r.lobe(&c.bounds);
        let full = if lobe.with_cosine > 0.0 { lobe.with_cosine * largest_inverse(c, near2) } else { 0.0 };
        let capped = if lobe.without_cosine > 0.0 { lobe.without_cosine * cap } else { 0.0 };
        c.intensity * full.min(capped) * ROUNDING
    }
}
impl<R: Receiver> Reaches<R, Cluster> for Balls {
    fn reach(&self, r: &R, c: &Cluster, cap: f32) -> Reach {
        let extent = r.extent();
        let least = (1.0 / cap).max(c.radius * c.radius / 3.0);
        let (near2, far2) = extent.distances2(&c.bounds);
        let facing = r.lobe(&c.bounds).with_cosine;
        Reach {
            intensity: c.intensity,
            facing_max: facing,
            facing_guess: facing,
            near2: near2.max(least),
            far2: far2.max(least),
            centre2: (c.bounds.centre() - extent.centre()).length_squared().max(least),
            radius2: 0.25 * (c.bounds.hi - c.bounds.lo).length_squared(),
        }
    }
}
