//! Transport from ray lights, and from the point lights beside them.

use crate::Vrl;
use manylight_framework::{Claim, Connection, Kernel, Pair, Promise};
use manylight_math::Ray;
use manylight_sampling::Stream;
use manylight_sampling::along::{Across, Angular, Seen};
use manylight_scene::{Edge, HenyeyGreenstein, Medium, Scene, Span, Vertex};
use manylight_vpl::{Points, Vpl};

/// Connects vertices and segments to ray lights (and to point lights: by [`Points`]), one sample a pair. Unbiased; the variance
/// over the lights is finite between segments, and grows with a logarithm where a surface, or a point light, meets a ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rays;

impl Promise for Rays {
    fn claim(&self) -> Claim {
        Claim { finite_variance: false, ..Claim::UNBIASED }
    }
}

impl Kernel<Vertex, Vpl> for Rays {
    fn connect(&self, scene: &Scene, r: &Vertex, l: &Vpl, s: &mut Stream) -> Option<Connection> {
        Points.connect(scene, r, l, s)
    }
}
impl Kernel<Span, Vpl> for Rays {
    fn connect(&self, scene: &Scene, r: &Span, l: &Vpl, s: &mut Stream) -> Option<Connection> {
        Points.connect(scene, r, l, s)
    }
}

/// A point on each of two segments.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    /// On the camera's. \[m\]
    pub u: f64,
    /// On the light's. \[m\]
    pub v: f64,
    /// 1 / (w^2 pdf(v) pdf(u|v)), w the distance between the two points. Dimensionless
    pub inverse: f64,
}

/// Draws v across the camera's line, then u by its angle at r(v): Delta A Delta phi / s is all that is left of 1/w^2, unless
/// `follow` gives the angle a further density. `None` where the segments have no length, or lie on one line.
pub fn draw_pair(
    camera: &Ray,
    light: &Ray,
    follow: impl FnOnce(Angular, f64) -> Angular,
    xi: [f64; 2],
) -> Option<Drawn> {
    let across = Across::new(light, camera)?;
    let v = across.sample(xi[0]);
    let y = light.origin.as_dvec3() + light.dir.as_dvec3() * v;
    let along = follow(Angular::new(camera, y)?, v);
    let drawn = along.sample(xi[1]);
    let inverse = drawn.inverse / across.pdf(v);
    (inverse.is_finite()).then_some(Drawn { u: drawn.t, v, inverse })
}

/// Thinner than this, transmittance is left out of densities.
const THIN: f64 = 0.5;

impl Kernel<Span, Vrl> for Rays {
    fn connect(&self, scene: &Scene, r: &Span, l: &Vrl, s: &mut Stream) -> Option<Connection> {
        let (here, there) = (scene.medium(r.ray.medium)?, scene.medium(l.span.ray.medium)?);
        let sigma = here.extinction_mean();
        let even = r.phase == HenyeyGreenstein::ISOTROPIC && l.span.phase == HenyeyGreenstein::ISOTROPIC;
        let thin = sigma * f64::from(r.ray.t_max) < THIN;
        let follow = |along: Angular, _: f64| {
            if even && thin {
                return along;
            }
            let back = -r.ray.dir;
            let travel = l.span.ray.dir;
            let target = |at: &Seen| {
                let w = at.direction.as_vec3();
                let lobes = if even { 1.0 } else { r.phase.eval(back, -w) * l.span.phase.eval(-travel, w) };
                f64::from(lobes * ((-sigma * (at.t + at.distance)) as f32).exp())
            };
            let peak = if l.span.phase.g() < 0.0 { -travel } else { travel };
            along.following(target, along.nearest(peak.as_dvec3()))
        };
        let Drawn { u, v, inverse } = draw_pair(&r.ray, &l.span.ray, follow, [s.next_f64(), s.next_f64()])?;
        let (u, v) = (u as f32, v as f32);
        let x = r.at(u, here.scattering(r.ray.at(u)));
        let y = l.span.at(v, there.scattering(l.span.ray.at(v)));
        connect(&x, &y, l, there, inverse, v, s).map(|c| {
            let seen = here.transmittance(&r.ray, 0.0, u, s);
            Connection { value: c.value * seen, ..c }
        })
    }
}

impl Kernel<Vertex, Vrl> for Rays {
    fn connect(&self, scene: &Scene, r: &Vertex, l: &Vrl, s: &mut Stream) -> Option<Connection> {
        let there = scene.medium(l.span.ray.medium)?;
        let along = Angular::new(&l.span.ray, r.p.as_dvec3())?;
        let sigma = there.extinction_mean();
        let travel = l.span.ray.dir;
        let target = |at: &Seen| {
            let w = at.direction.as_vec3();
            let before = if l.channels.is_some() { 0.0 } else { at.t };
            let through = ((-sigma * (before + at.distance)) as f32).exp();
            f64::from(r.eval(w).luminance() * l.span.phase.eval(-travel, -w) * through)
        };
        let axis = r.normal().unwrap_or(-travel);
        let along = along.following(target, along.nearest(axis.as_dvec3()));
        let drawn = along.sample(s.next_f64());
        let v = drawn.t as f32;
        let y = l.span.at(v, there.scattering(l.span.ray.at(v)));
        connect(r, &y, l, there, drawn.inverse, v, s)
    }
}

/// Two vertices, with 1 / (w^2 pdf) for 1 / w^2.
fn connect(
    x: &Vertex,
    y: &Vertex,
    l: &Vrl,
    medium: &Medium,
    inverse: f64,
    v: f32,
    s: &mut Stream,
) -> Option<Connection> {
    let d = y.p - x.p;
    let d2 = d.length_squared();
    // NaN fails too; and a pair's 1 / d^2 must be a number.
    if !(d2 > f32::MIN_POSITIVE) {
        return None;
    }
    let w = d / d2.sqrt();
    let (cosine, lobes) = (x.cosine(w), x.lobe_at(w) * y.lobe_at(-w));
    let value = lobes * l.flux * l.arrives(medium, v, s) * (f64::from(cosine) * inverse) as f32;
    let pair = Pair { g: cosine / d2, lobes: Some(lobes.largest()) };
    (!value.is_black()).then(|| Connection { value, edge: Edge::Between(x.end(), y.end()), pair })
}
