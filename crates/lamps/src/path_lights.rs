//! A path tracer that asks a light set.

use crate::kernel::see;
use crate::{Lamp, LampKernel, Lamps};
use manylight_framework::{
    Bounding, Claim, Gather, Generator, Integrator, LightSet, Occlusion, Pair, PassError, Picks, Plan, Probe, Promise,
};
use manylight_math::{Aabb, Ray, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, Mode, Part, Scene, Vertex};
use std::collections::HashMap;

/// Keeps all of every connection.
#[derive(Clone, Copy, Debug, Default)]
pub struct Whole;
impl Promise for Whole {
    fn claim(&self) -> Claim {
        Claim::EXACT
    }
}
impl Bounding for Whole {
    fn keep(&self, _: &Pair) -> f32 {
        1.0
    }
}

/// How a path tracer takes direct light from a light set.
pub trait NextEvent<S>: Send + Sync {
    /// An estimate of the direct light at `x`, as far as `hit` leaves it. [W/(m^2 sr)]
    fn direct(&self, scene: &Scene, lamps: &Prepared<S>, x: &Vertex, probe: &mut Probe, s: &mut Stream) -> Spectrum;
    /// Weight of light that a direction met which the BSDF at `x` drew with density `pdf` [1/sr].
    fn hit(&self, scene: &Scene, lamps: &Prepared<S>, x: &Vertex, met: &Met, pdf: f32, probe: &mut Probe) -> f32;
}

/// What a ray met that shines.
pub struct Met {
    part: Part,
    dir: Vec3,
    /// Density per area to density per solid angle: d^2 / cos; one at infinity.
    jacobian: f32,
}

/// The light set of a pass, and where each lamp is in it.
pub struct Prepared<S> {
    set: S,
    lamps: Vec<Lamp>,
    places: HashMap<(u32, u32), usize>,
}

fn key(part: Part) -> (u32, u32) {
    (part.emitter, part.triangle.unwrap_or(u32::MAX))
}

fn gather<'a>(scene: &'a Scene, x: &'a Vertex, probe: &'a mut Probe) -> Gather<'a, Vertex, LampKernel, Whole> {
    let (edges_left, edges_least) = (u32::MAX, 0);
    Gather { scene, receiver: x, kernel: &LampKernel, bounding: &Whole, edges_left, edges_least, probe }
}

/// By one lamp that the set picks, and a point of it, combined with directions of the BSDF by the power heuristic (Veach and
/// Guibas 1995).
#[derive(Clone, Copy, Debug, Default)]
pub struct ByPicks;
impl<S> NextEvent<S> for ByPicks
where
    S: for<'g> Picks<Gather<'g, Vertex, LampKernel, Whole>>,
{
    fn direct(&self, scene: &Scene, p: &Prepared<S>, x: &Vertex, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let Some((lamp, pmf)) = p.set.pick(&mut gather(scene, x, probe), s) else { return Spectrum::BLACK };
        probe.evaluations += 1;
        let seen = scene.sample_part(p.lamps[lamp].part, s).and_then(|sample| see(x, &sample));
        let Some(seen) = seen else { return Spectrum::BLACK };
        let pmf = pmf as f32;
        let weight = seen.pdf_sa.map_or(1.0, |pdf| heuristic(pdf * pmf, x.pdf_sa(seen.dir)));
        probe.shadow_rays += 1;
        seen.connection.value * scene.transmittance(&seen.connection.edge, s) * (weight / pmf)
    }
    fn hit(&self, scene: &Scene, p: &Prepared<S>, x: &Vertex, met: &Met, pdf: f32, probe: &mut Probe) -> f32 {
        let Some(&lamp) = p.places.get(&key(met.part)) else { return 1.0 };
        let pmf = p.set.pmf(&mut gather(scene, x, probe), lamp) as f32;
        let of_lamp = scene.pdf_of_part(met.part, met.dir).unwrap_or(0.0) * met.jacobian;
        heuristic(pdf, pmf * of_lamp)
    }
}

/// By the set's own estimate of the sum; what the BSDF's directions meet does not count. For sets that cannot say the probability
/// of a lamp, and for several lamps a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub struct BySum;
impl<S> NextEvent<S> for BySum
where
    S: for<'g> LightSet<Gather<'g, Vertex, LampKernel, Whole>>,
{
    fn direct(&self, scene: &Scene, p: &Prepared<S>, x: &Vertex, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        p.set.radiance(&mut gather(scene, x, probe), s)
    }
    fn hit(&self, _: &Scene, _: &Prepared<S>, _: &Vertex, _: &Met, _: f32, _: &mut Probe) -> f32 {
        0.0
    }
}

/// The power heuristic with exponent 2.
fn heuristic(mine: f32, other: f32) -> f32 {
    let ratio = other / mine;
    1.0 / (1.0 + ratio * ratio)
}

/// Path tracing with next-event estimation by a light set over the lamps. Unbiased, if the set is.
#[derive(Clone, Copy, Debug)]
pub struct PathLights<P, N> {
    /// Builds the light set of a pass.
    pub plan: P,
    /// How it is asked.
    pub next_event: N,
    /// Longest path, in edges; `u32::MAX`: no limit.
    pub max_edges: u32,
    /// Shortest path that counts, in edges.
    pub min_edges: u32,
    /// Edges before Russian roulette begins.
    pub certain_edges: u32,
}

impl<P: Promise, N> Promise for PathLights<P, N> {
    fn claim(&self) -> Claim {
        Claim::UNBIASED.and(self.plan.claim())
    }
}

/// Light sets over lamps ask for no shadow while they are built.
struct Unasked(Aabb);
impl Occlusion for Unasked {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        self.0
    }
}

impl<P, N> Integrator for PathLights<P, N>
where
    P: Plan<Vec<Lamp>>,
    N: NextEvent<P::Set>,
{
    type Prepared = Prepared<P::Set>;

    fn prepare(&self, scene: &Scene, pass: u64, seed: u64, probe: &mut Probe) -> Result<Self::Prepared, PassError> {
        let lamps = Lamps.generate(scene, pass, seed, probe)?.lights;
        let places = lamps.iter().enumerate().map(|(i, l)| (key(l.part), i)).collect();
        let mut s = Stream::new(seed, [pass, 0, 0], Purpose::BUILD);
        let set = self.plan.build(lamps.clone(), &Unasked(scene.bounds()), &mut s)?;
        Ok(Prepared { set, lamps, places })
    }

    fn radiance(&self, scene: &Scene, p: &Self::Prepared, ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let (mut ray, mut beta, mut sum, mut eta2) = (*ray, Spectrum::ONE, Spectrum::BLACK, 1.0);
        // The vertex at which the BSDF drew the ray, and its density; none for the camera's, and for delta lobes.
        let mut drawn: Option<(Vertex, f32)> = None;
        for edges in 1..=self.max_edges {
            if edges > 1 {
                probe.path_rays += 1;
            }
            let (x, through) = scene.advance(&ray, Mode::Radiance, beta, s);
            beta *= through;
            if beta.is_black() {
                break;
            }
            let emitted = x.map_or_else(|| scene.environment(ray.dir), |x| x.emitted());
            if edges >= self.min_edges && !emitted.is_black() {
                let weight = match drawn {
                    None => 1.0,
                    Some((from, pdf)) => match met(scene, &from, x.as_ref(), &ray) {
                        Some(met) => self.next_event.hit(scene, p, &from, &met, pdf, probe),
                        None => 1.0,
                    },
                };
                sum += beta * emitted * weight;
            }
            let Some(x) = x else { break };
            if edges == self.max_edges {
                break;
            }
            if x.connects() && edges + 1 >= self.min_edges {
                sum += beta * self.next_event.direct(scene, p, &x, probe, s);
            }
            let Some(next) = x.sample(s.next_f32(), s.next_2d()) else { break };
            beta *= next.weight;
            eta2 *= next.eta * next.eta;
            if beta.is_black() {
                break;
            }
            if edges >= self.certain_edges {
                // Refraction divides radiance by the square of the index: that is no loss.
                let survival = (beta.largest() * eta2).min(0.95);
                if !(s.next_f32() < survival) {
                    break;
                }
                beta *= 1.0 / survival;
            }
            ray = x.leave(next.dir);
            drawn = (!next.delta).then_some((x, next.pdf));
        }
        sum
    }
}

/// The lamp that a ray from `x` met, at `y` or at infinity.
fn met(scene: &Scene, x: &Vertex, y: Option<&Vertex>, ray: &Ray) -> Option<Met> {
    let Some(y) = y else {
        let emitter = scene.emitters().environment_emitter()?;
        return Some(Met { part: Part { emitter, triangle: None }, dir: ray.dir, jacobian: 1.0 });
    };
    // From just before it: nothing lies between.
    let part = scene.part_along(&Ray::new(y.leave(-ray.dir).origin, ray.dir))?;
    let cos = y.normal()?.dot(ray.dir).abs();
    Some(Met { part, dir: ray.dir, jacobian: (y.p - x.p).length_squared() / cos })
}
