//! Direct light along a segment in a medium, by sampling.

use manylight_framework::Probe;
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_sampling::along::{Angular, Exponential};
use manylight_scene::{Edge, EmitterPoint, Scatter, Scene, Span};

/// One sample of the light that a segment in a medium scatters of the emitters' own, as seen from its beginning: a point of an
/// emitter, and towards it a point of the segment (Kulla and Fajardo 2012), mixed with free flight where the medium is dense.
/// Unbiased.
pub fn direct_along(scene: &Scene, span: &Span, probe: &mut Probe, s: &mut Stream) -> Spectrum {
    let Some(medium) = scene.medium(span.ray.medium) else { return Spectrum::BLACK };
    let Some(light) = scene.sample_emitter(s) else { return Spectrum::BLACK };
    let y = &light.vertex;
    let distant = matches!(y.scatter, Scatter::Emitter(EmitterPoint::Distant { .. }));
    let towards = if distant { None } else { Angular::new(&span.ray, y.p.as_dvec3()) };
    let by_distance = Exponential::new(medium.extinction_mean(), f64::from(span.ray.t_max));
    // Equiangular for a thin medium, half of each for a dense one.
    let flights = if towards.is_some() { 0.5 * by_distance.reached() } else { 1.0 };
    let u = s.next_f64();
    let t = match &towards {
        Some(towards) if u >= flights => towards.sample((u - flights) / (1.0 - flights)).t,
        _ => by_distance.sample(u / flights),
    };
    let pdf = flights * by_distance.pdf(t) + towards.map_or(0.0, |a| (1.0 - flights) * a.pdf(t));
    let t = t as f32;
    let x = span.at(t, medium.scattering(span.ray.at(t)));
    let (w, edge, g) = match y.scatter {
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
    let value = x.eval(w) * y.lobe_at(-w) * light.flux * (f64::from(g) / pdf) as f32;
    if value.is_black() {
        return value;
    }
    probe.shadow_rays += 1;
    value * medium.transmittance(&span.ray, 0.0, t, s) * scene.transmittance(&edge, s)
}
