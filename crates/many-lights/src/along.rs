//! Direct light along a segment in a medium, by sampling.

use manylight_framework::Probe;
use manylight_math::{Ray, Spectrum};
use manylight_sampling::Stream;
use manylight_sampling::along::{Angular, Exponential};
use manylight_scene::{Edge, EmitterPoint, Medium, Scatter, Scene, Span};

/// One sample of the light that a segment in a medium scatters of the emitters' own, as seen from its beginning: a point of an
/// emitter, and towards it a point of the segment (Kulla and Fajardo 2012), mixed with free flight where the medium is dense.
/// Unbiased.
pub fn direct_along(scene: &Scene, span: &Span, probe: &mut Probe, s: &mut Stream) -> Spectrum {
    let Some(medium) = scene.medium(span.ray.medium) else { return Spectrum::BLACK };
    let Some(light) = scene.sample_emitter(s) else { return Spectrum::BLACK };
    let y = &light.vertex;
    let distant = matches!(y.scatter, Scatter::Emitter(EmitterPoint::Distant { .. }));
    let towards = if distant { None } else { Angular::new(&span.ray, y.p.as_dvec3()) };
    let Some((t, weight)) = draw(medium, &span.ray, towards, s) else { return Spectrum::BLACK };
    let x = span.at(t, Spectrum::ONE);
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
    let value = weight * x.eval(w) * y.lobe_at(-w) * light.flux * g;
    if value.is_black() {
        return value;
    }
    probe.shadow_rays += 1;
    value * scene.transmittance(&edge, s)
}

/// A point of a ray, and sigma_s T / pdf there: by its angle towards a point of a lamp, and by free flight, the more so the
/// denser the medium.
fn draw(medium: &Medium, ray: &Ray, towards: Option<Angular>, s: &mut Stream) -> Option<(f32, Spectrum)> {
    let Some(towards) = towards else { return medium.collide(ray, s) };
    let Some(homogeneous) = medium.homogeneous() else {
        // The density of a flight is not known: each technique for itself, half of the time.
        if s.next_f32() < 0.5 {
            return medium.collide(ray, s);
        }
        let t = towards.sample(s.next_f64()).t;
        let weight = medium.scattering(ray.at(t as f32)) * medium.transmittance(ray, 0.0, t as f32, s);
        return Some((t as f32, weight * (1.0 / towards.pdf(t)) as f32));
    };
    let flight = Exponential::new(medium.extinction_mean(), f64::from(ray.t_max));
    let flights = 0.5 * flight.reached();
    let u = s.next_f64();
    let t = if u < flights { flight.sample(u / flights) } else { towards.sample((u - flights) / (1.0 - flights)).t };
    let pdf = flights * flight.pdf(t) + (1.0 - flights) * towards.pdf(t);
    let weight = homogeneous.scattering * homogeneous.transmittance(t as f32);
    Some((t as f32, weight * (1.0 / pdf) as f32))
}
