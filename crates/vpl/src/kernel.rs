//! Point to point transport.

use crate::Vpl;
use manylight_framework::{Claim, Connection, Kernel, Pair, Promise};
use manylight_math::{Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_sampling::along::{Angular, Seen};
use manylight_scene::{Edge, EmitterPoint, HenyeyGreenstein, Scatter, Scene, Span, Vertex};

/// Points nearer than a femtometre count as coincident: 1 / d^2 would overflow, and a bound could not bring it back. [m^2]
const COINCIDENT2: f32 = 1e-30;

/// The one formula for every pair of vertices: f(x) G(x, y) f(y) flux, with G = cos cos / |x - y|^2 towards a point and cos_x
/// towards infinity. `None` where nothing can arrive, or where the two points coincide.
#[inline]
pub fn connect_vertices(x: &Vertex, y: &Vertex, flux: Spectrum) -> Option<Connection> {
    if let Scatter::Emitter(EmitterPoint::Distant { towards, .. }) = y.scatter {
        let value = x.eval(towards) * flux;
        let pair = Pair { g: 0.0, lobes: None };
        return (!value.is_black()).then(|| Connection { value, edge: Edge::ToInfinity(x.end(), towards), pair });
    }
    let d = y.p - x.p;
    if x.turns_away(d) || y.turns_away(-d) {
        return None;
    }
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
    let lobe = x.lobe_at(w);
    if lobe.is_black() {
        return None;
    }
    let lobes = lobe * y.lobe_at(-w);
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
    #[inline]
    fn connect(&self, _: &Scene, r: &Vertex, l: &Vpl, _: &mut Stream) -> Option<Connection> {
        connect_vertices(r, &l.vertex, l.flux)
    }
}

/// Along a segment of the camera's ray, one point drawn per light: equiangular, and where lobes are not isotropic by a table of
/// their product too. `None` where nothing can arrive.
///
/// L = int T(0,u) sigma_s(u) f_u G(u, y) f_y flux du, unbiased; the 1/d^2 of a light near the segment is left as 1/D.
impl Kernel<Span, Vpl> for Points {
    fn connect(&self, scene: &Scene, r: &Span, l: &Vpl, s: &mut Stream) -> Option<Connection> {
        let medium = scene.medium(r.ray.medium)?;
        let y = &l.vertex;
        let (t, weight) = if let Scatter::Emitter(EmitterPoint::Distant { .. }) = y.scatter {
            // No distance to go by: by the length alone.
            (s.next_f64() * r.ray.t_max as f64, f64::from(r.ray.t_max))
        } else {
            let even = r.phase == HenyeyGreenstein::ISOTROPIC && is_even(y);
            let mut along = Angular::new(&r.ray, y.p.as_dvec3())?;
            if !even {
                let lobe = |at: &Seen| {
                    let w = at.direction.as_vec3();
                    f64::from(r.phase.eval(-r.ray.dir, -w) * y.eval(w).luminance())
                };
                let axis = y.normal().unwrap_or(match &y.scatter {
                    Scatter::Medium(m) => -m.wi,
                    Scatter::Emitter(EmitterPoint::Spot(spot)) => spot.axis(),
                    _ => Vec3::Z,
                });
                along = along.following(lobe, along.nearest(axis.as_dvec3()));
            }
            let drawn = along.sample(s.next_f64());
            (drawn.t, drawn.inverse * (r.ray.at(drawn.t as f32) - y.p).as_dvec3().length_squared())
        };
        let t = t as f32;
        let x = r.at(t, medium.scattering(r.ray.at(t)));
        let through = medium.transmittance(&r.ray, 0.0, t, s);
        let c = connect_vertices(&x, y, l.flux * through)?;
        Some(Connection { value: c.value * weight as f32, ..c })
    }
}

/// Does it send the same in all directions?
fn is_even(y: &Vertex) -> bool {
    match &y.scatter {
        Scatter::Medium(m) => m.phase == HenyeyGreenstein::ISOTROPIC,
        Scatter::Emitter(EmitterPoint::Isotropic) => true,
        _ => false,
    }
}
