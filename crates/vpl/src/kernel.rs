//! Point to point transport.

use crate::Vpl;
use manylight_framework::{Claim, Connection, Kernel, Pair, Promise};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Edge, EmitterPoint, Scatter, Scene, Vertex};

/// Points nearer than a femtometre count as coincident: 1 / d^2 would overflow, and a bound could not bring it back. [m^2]
const COINCIDENT2: f32 = 1e-30;

/// The one formula for every pair of vertices: f(x) G(x, y) f(y) flux, with G = cos cos / |x - y|^2 towards a point and cos_x
/// towards infinity. `None` where nothing can arrive, or where the two points coincide.
pub fn connect_vertices(x: &Vertex, y: &Vertex, flux: Spectrum) -> Option<Connection> {
    if let Scatter::Emitter(EmitterPoint::Distant { towards, .. }) = y.scatter {
        let value = x.eval(towards) * flux;
        let pair = Pair { g: 0.0, lobes: None };
        return (!value.is_black()).then(|| Connection { value, edge: Edge::ToInfinity(x.end(), towards), pair });
    }
    let d = y.p - x.p;
    let d2 = d.length_squared();
    // NaN fails too.
    if !(d2 > COINCIDENT2) {
        return None;
    }
    let w = d / d2.sqrt();
    let cosines = x.cosine(w) * y.cosine(-w);
    if !(cosines > 0.0) {
        return None;
    }
    let lobes = x.lobe_at(w) * y.lobe_at(-w);
    let g = cosines / d2;
    let value = lobes * flux * g;
    let pair = Pair { g, lobes: Some(lobes.largest()) };
    (!value.is_black()).then(|| Connection { value, edge: Edge::Between(x.end(), y.end()), pair })
}

/// Connects vertices to virtual point lights. Exact; its variance over the lights' positions is infinite wherever a receiver
/// and a light can touch, unless it is bounded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Points;

impl Promise for Points {
    fn claim(&self) -> Claim {
        Claim { finite_variance: false, ..Claim::EXACT }
    }
}
impl Kernel<Vertex, Vpl> for Points {
    fn connect(&self, _: &Scene, r: &Vertex, l: &Vpl, _: &mut Stream) -> Option<Connection> {
        connect_vertices(r, &l.vertex, l.flux)
    }
}
