//! From a receiver to a point of a lamp.

use crate::{Lamp, LampCluster};
use manylight_framework::{Claim, Connection, Kernel, Pair, Promise, Reach, Reaches, Receiver};
use manylight_math::Vec3;
use manylight_sampling::Stream;
use manylight_scene::{Edge, EmitterPoint, EmitterSample, Scatter, Scene, Vertex};

/// Draws a point of the lamp, evenly over its area (a direction, for light from infinity).
#[derive(Clone, Copy, Debug, Default)]
pub struct LampKernel;

/// A point that was drawn, as seen from a receiver.
pub(crate) struct Seen {
    /// Unit.
    pub dir: Vec3,
    pub connection: Connection,
    /// Density per solid angle at the receiver, given the lamp; `None` if only drawing finds it. [1/sr]
    pub pdf_sa: Option<f32>,
}

/// `None` where nothing can arrive.
pub(crate) fn see(x: &Vertex, sample: &EmitterSample) -> Option<Seen> {
    let y = &sample.vertex;
    let (dir, edge, per_area, g) = match y.scatter {
        Scatter::Emitter(EmitterPoint::Distant { towards, .. }) => {
            (towards, Edge::ToInfinity(x.end(), towards), 1.0, 0.0)
        }
        _ => {
            let d = y.p - x.p;
            let d2 = d.length_squared();
            if !(d2 > f32::MIN_POSITIVE) {
                return None;
            }
            let dir = d / d2.sqrt();
            let per_area = y.cosine(-dir) / d2;
            (dir, Edge::Between(x.end(), y.end()), per_area, x.cosine(dir) * per_area)
        }
    };
    let lobes = y.lobe_at(-dir);
    let value = x.eval(dir) * lobes * sample.flux * per_area;
    let pair = Pair { g, lobes: None };
    let pdf_sa = sample.density.map(|density| density / per_area);
    (!value.is_black()).then_some(Seen { dir, connection: Connection { value, edge, pair }, pdf_sa })
}

impl Promise for LampKernel {
    /// The variance over a lamp that a receiver touches is infinite, as that of points.
    fn claim(&self) -> Claim {
        Claim { finite_variance: false, ..Claim::UNBIASED }
    }
}
impl Kernel<Vertex, Lamp> for LampKernel {
    fn connect(&self, scene: &Scene, r: &Vertex, l: &Lamp, s: &mut Stream) -> Option<Connection> {
        see(r, &scene.sample_part(l.part, s)?).map(|seen| seen.connection)
    }
}

/// Rounding of cosines.
const SLACK: f32 = 4e-6;

impl<R: Receiver> Reaches<R, LampCluster> for LampKernel {
    fn reach(&self, r: &R, c: &LampCluster, cap: f32) -> Reach {
        let (extent, least) = (r.extent(), 1.0 / cap);
        let of = |facing: f32, (near2, far2): (f32, f32), centre2: f32, radius2: f32| Reach {
            intensity: c.intensity,
            facing_max: facing,
            facing_guess: facing,
            near2,
            far2,
            centre2,
            radius2,
        };
        if c.is_mixed() {
            return of(1.0, (0.0, f32::MAX), 1.0, 0.0);
        }
        if c.is_distant() {
            return of(r.lobe_to_infinity(&c.bounds).with_cosine, (1.0, 1.0), 1.0, 0.0);
        }
        let (near2, far2) = extent.distances2(&c.bounds);
        let to = extent.minus(&c.bounds);
        let cosine = if c.half >= std::f32::consts::FRAC_PI_2 {
            1.0
        } else {
            // The greatest height along the axis over the length that belongs to it.
            let z = (c.axis * to.lo).max(c.axis * to.hi).element_sum();
            let (cos, within) = (z / if z > 0.0 { near2 } else { far2 }.sqrt(), c.half.cos());
            let sines = (1.0 - cos * cos).max(0.0).sqrt() * c.half.sin();
            if !(cos < within) { 1.0 } else { (cos * within + sines + SLACK).clamp(0.0, 1.0) }
        };
        let lobe = if cosine > 0.0 { r.lobe(&c.bounds).with_cosine } else { 0.0 };
        let centre2 = (c.bounds.centre() - extent.centre()).length_squared();
        let radius2 = 0.25 * (c.bounds.hi - c.bounds.lo).length_squared();
        of(cosine * lobe, (near2.max(least), far2.max(least)), centre2.max(least), radius2)
    }
}
