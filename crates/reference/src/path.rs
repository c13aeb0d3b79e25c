//! Path tracing.

use manylight_framework::{Claim, Integrator, PassError, Probe, Promise};
use manylight_math::{Ray, Spectrum};
use manylight_sampling::Stream;
use manylight_scene::{Edge, EmitterPoint, EmitterSample, Mode, Scatter, Scene, Vertex};

/// A path tracer with next-event estimation and multiple importance sampling.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer {
    /// Longest path, in edges; `u32::MAX`: no limit.
    pub max_edges: u32,
    /// Shortest path that counts, in edges.
    pub min_edges: u32,
    /// Edges before Russian roulette begins.
    pub certain_edges: u32,
    /// Sample emitters at each vertex? Without, light is found by chance only: slow, and the simplest thing that is right.
    pub next_event: bool,
}

impl Default for PathTracer {
    fn default() -> Self {
        PathTracer { max_edges: u32::MAX, min_edges: 1, certain_edges: 5, next_event: true }
    }
}

impl Promise for PathTracer {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}

/// How the ray that is being traced was drawn.
enum Drawn {
    /// From the camera or a delta lobe: no other strategy finds what it meets.
    Alone,
    /// From a BSDF with this density [1/sr], at this point.
    Bsdf(f32, Vertex),
}

impl Integrator for PathTracer {
    type Prepared = ();

    fn prepare(&self, _: &Scene, _: u64, _: u64, _: &mut Probe) -> Result<(), PassError> {
        Ok(())
    }

    fn radiance(&self, scene: &Scene, _: &(), ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let (mut ray, mut beta, mut sum, mut drawn) = (*ray, Spectrum::ONE, Spectrum::BLACK, Drawn::Alone);
        // Square of the index around the path over that around the camera: what beta has been divided by.
        let mut eta2 = 1.0;
        let counts = |edges: u32| edges >= self.min_edges;
        for edges in 1..=self.max_edges {
            if edges > 1 {
                probe.path_rays += 1;
            }
            // Light of a medium is found on the way, whatever stops it: int T j dt up to the surface.
            if scene.media_emit() && counts(edges) {
                sum += beta * scene.emitted_along(&ray, s);
            }
            let (x, through) = scene.advance(&ray, Mode::Radiance, beta, s);
            beta *= through;
            if beta.is_black() {
                break;
            }
            let Some(x) = x else {
                let emitted = scene.environment(ray.dir);
                if counts(edges) && !emitted.is_black() {
                    sum += beta * emitted * self.weight(&drawn, || scene.emitters().environment_pdf_sa(ray.dir));
                }
                break;
            };
            if counts(edges) && !x.emitted().is_black() {
                sum += beta * x.emitted() * self.weight(&drawn, || self.density_of(scene, &drawn, &x, &ray));
            }
            if edges == self.max_edges {
                break;
            }
            if self.next_event && x.connects() && counts(edges + 1) {
                sum += beta * self.next_event(scene, &x, probe, s);
            }
            let Some(next) = x.sample(s.next_f32(), s.next_2d()) else { break };
            beta *= next.weight;
            eta2 *= next.eta * next.eta;
            if beta.is_black() {
                break;
            }
            if edges >= self.certain_edges {
                let survival = (beta.largest() * eta2).min(0.95);
                if !(s.next_f32() < survival) {
                    break;
                }
                beta *= 1.0 / survival;
            }
            ray = x.leave(next.dir);
            drawn = if next.delta { Drawn::Alone } else { Drawn::Bsdf(next.pdf, x) };
        }
        sum
    }
}

impl PathTracer {
    /// Weight of light that a ray met, given the density with which next-event estimation would have drawn it.
    fn weight(&self, drawn: &Drawn, light_pdf: impl Fn() -> f32) -> f32 {
        match drawn {
            Drawn::Bsdf(pdf, _) if self.next_event => heuristic(*pdf, light_pdf()),
            _ => 1.0,
        }
    }
    /// Density, per solid angle at the previous vertex, of the emitting point `y` under next-event estimation. [1/sr]
    fn density_of(&self, scene: &Scene, drawn: &Drawn, y: &Vertex, ray: &Ray) -> f32 {
        let (Drawn::Bsdf(_, x), Some(emitter), Some(n)) = (drawn, y.emitter(), y.normal()) else { return 0.0 };
        scene.emitters().pdf_area(emitter) * (y.p - x.p).length_squared() / n.dot(ray.dir).abs()
    }
    fn next_event(&self, scene: &Scene, x: &Vertex, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let Some(EmitterSample { vertex: y, flux, density, .. }) = scene.sample_emitter(s) else {
            return Spectrum::BLACK;
        };
        let (dir, edge, jacobian) = if let Scatter::Emitter(EmitterPoint::Distant { towards, .. }) = y.scatter {
            (towards, Edge::ToInfinity(x.end(), towards), 1.0)
        } else {
            let d2 = (y.p - x.p).length_squared();
            let Some(dir) = (y.p - x.p).try_normalize() else { return Spectrum::BLACK };
            (dir, Edge::Between(x.end(), y.end()), y.cosine(-dir) / d2)
        };
        // f |cos_x| x (what the emitter's sample sends per solid angle at x).
        let contribution = x.eval(dir) * y.lobe_at(-dir) * flux * jacobian;
        if contribution.is_black() {
            return contribution;
        }
        probe.shadow_rays += 1;
        let weight = density.map_or(1.0, |p| heuristic(p / jacobian, x.pdf_sa(dir)));
        contribution * scene.transmittance(&edge, s) * weight
    }
}

/// The power heuristic with exponent 2.
fn heuristic(mine: f32, other: f32) -> f32 {
    let ratio = other / mine;
    1.0 / (1.0 + ratio * ratio)
}
