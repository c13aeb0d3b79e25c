//! Direct light at a vertex, by sampling.

use crate::in_media::up_to;
use manylight_framework::{Bounding, Pair, Probe};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Edge, EmitterPoint, Mode, Scatter, Scene, Vertex};

/// One sample of the direct light at `x` through its lobes that are not delta lobes: a point of an emitter and a direction of
/// the BSDF, combined by the power heuristic (Veach and Guibas 1995). Unbiased.
pub fn direct_light(scene: &Scene, x: &Vertex, probe: &mut Probe, s: &mut Stream) -> Spectrum {
    let all = |_: &Pair| 1.0;
    from_emitter(scene, x, &all, probe, s) + from_bsdf(scene, x, &all, probe, s)
}

/// The part of the direct light that a bounding takes away from lights on the emitters. Light from infinity is never bounded.
pub fn lost_direct_light(
    scene: &Scene,
    x: &Vertex,
    bounding: &dyn Bounding,
    probe: &mut Probe,
    s: &mut Stream,
) -> Spectrum {
    let lost = |pair: &Pair| 1.0 - bounding.keep(pair);
    from_emitter(scene, x, &lost, probe, s) + from_bsdf(scene, x, &lost, probe, s)
}

/// Has no geometry term.
const FROM_INFINITY: Pair = Pair { g: 0.0, lobes: None };

/// The part of a connection that is asked for.
type Share<'s> = &'s dyn Fn(&Pair) -> f32;

/// a^2 / (a^2 + b^2), without overflow.
fn power_heuristic(a: f32, b: f32) -> f32 {
    let r = b / a;
    1.0 / (1.0 + r * r)
}

fn from_emitter(scene: &Scene, x: &Vertex, share: Share, probe: &mut Probe, s: &mut Stream) -> Spectrum {
    let Some(light) = scene.sample_emitter(s) else { return Spectrum::BLACK };
    let y = &light.vertex;
    let (w, edge, per_area) = match y.scatter {
        Scatter::Emitter(EmitterPoint::Distant { towards, .. }) => (towards, Edge::ToInfinity(x.end(), towards), 1.0),
        _ => {
            let d = y.p - x.p;
            let d2 = d.length_squared();
            if !(d2 > f32::MIN_POSITIVE) {
                return Spectrum::BLACK;
            }
            let w = d / d2.sqrt();
            (w, Edge::Between(x.end(), y.end()), y.cosine(-w) / d2)
        }
    };
    let distant = matches!(edge, Edge::ToInfinity(..));
    let lobes = x.lobe_at(w) * y.lobe_at(-w);
    let g = if distant { 0.0 } else { x.cosine(w) * per_area };
    let part = share(&if distant { FROM_INFINITY } else { Pair { g, lobes: Some(lobes.largest()) } });
    let value = lobes * light.flux * (x.cosine(w) * per_area * part);
    if value.is_black() {
        return value;
    }
    let weight = match light.density {
        // Per solid angle at x: what the BSDF's density has to be compared with.
        Some(density) => power_heuristic(density / per_area, x.pdf_sa(w)),
        None => 1.0,
    };
    probe.shadow_rays += 1;
    value * scene.transmittance(&edge, s) * weight
}

fn from_bsdf(scene: &Scene, x: &Vertex, share: Share, probe: &mut Probe, s: &mut Stream) -> Spectrum {
    let Some(next) = x.sample(s.next_f32(), s.next_2d()) else { return Spectrum::BLACK };
    if next.delta {
        return Spectrum::BLACK; // the eye path walks through delta lobes itself
    }
    let emitters = scene.emitters();
    probe.path_rays += 1;
    let ray = x.leave(next.dir);
    let met = scene.intersect(&ray, Mode::Radiance);
    let through = scene.through(&up_to(&ray, met.as_ref()), s);
    let (emitted, light_pdf, part) = match met {
        Some(y) => match (y.emitter(), y.normal()) {
            (Some(emitter), Some(n)) if !y.emitted().is_black() => {
                let (d2, cosine) = ((y.p - x.p).length_squared(), n.dot(next.dir).abs());
                let pair = Pair { g: x.cosine(next.dir) * cosine / d2, lobes: None };
                (y.emitted(), emitters.pdf_area(emitter) * d2 / cosine, share(&pair))
            }
            _ => return Spectrum::BLACK,
        },
        None => (scene.environment(next.dir), emitters.environment_pdf_sa(next.dir), share(&FROM_INFINITY)),
    };
    if emitted.is_black() {
        return Spectrum::BLACK;
    }
    next.weight * emitted * through * (part * power_heuristic(next.pdf, light_pdf))
}
