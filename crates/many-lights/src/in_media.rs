//! The composite where there are media.

use crate::many_lights::Prepared;
use crate::{ManyLights, direct_along};
use manylight_framework::{BoundingPlan, Claim, Depth, Gather, Integrator, LightSet, PassError, Plan, Probe, Promise};
use manylight_math::{Ray, Spectrum};
use manylight_sampling::Stream;
use manylight_sampling::along::Exponential;
use manylight_scene::{Scene, Span, Vertex};

/// What a light set is asked with along the camera's ray.
pub struct Along<'a, S, K, B> {
    /// The scene.
    pub scene: &'a Scene,
    /// The light set.
    pub set: &'a S,
    /// How light gets from a light to a receiver.
    pub kernel: &'a K,
    /// What is kept of it.
    pub bounding: &'a B,
    /// Edges that a path may still take, the connection included.
    pub edges_left: u32,
    /// Lights of fewer edges than this are left out.
    pub edges_least: u32,
}

/// How the lights are gathered along a segment of the camera's ray: it bounds the set by what it asks of a receiver.
pub trait Segment<S, K, B>: Promise + Send + Sync {
    /// What the segment scatters of the lights, as seen from its beginning. [W/(m^2 sr)]
    fn gather(&self, span: &Span, at: &Along<S, K, B>, probe: &mut Probe, s: &mut Stream) -> Spectrum;
    /// Are emission and transmittance along the camera's ray marched, with a small bias and little noise?
    fn marches(&self) -> bool {
        false
    }
}

/// The receiver is the whole segment: each light finds its own points on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Whole;
impl Promise for Whole {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<S, K, B> Segment<S, K, B> for Whole
where
    S: for<'g> LightSet<Gather<'g, Span, K, B>>,
{
    fn gather(&self, span: &Span, at: &Along<S, K, B>, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let Along { scene, set, kernel, bounding, edges_left, edges_least } = *at;
        set.radiance(&mut Gather { scene, receiver: span, kernel, bounding, edges_left, edges_least, probe }, s)
    }
}

/// Receivers are points of the segment, drawn by free flight: for sets that know receivers with a position alone. Lights next
/// to such a point are as bright as 1/d^2.
#[derive(Clone, Copy, Debug)]
pub struct Sampled {
    /// How many; at least one.
    pub points: u32,
}
impl Promise for Sampled {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<S, K, B> Segment<S, K, B> for Sampled
where
    S: for<'g> LightSet<Gather<'g, Vertex, K, B>>,
{
    fn gather(&self, span: &Span, at: &Along<S, K, B>, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let Along { scene, set, kernel, bounding, edges_left, edges_least } = *at;
        let Some(medium) = scene.medium(span.ray.medium) else { return Spectrum::BLACK };
        let n = self.points.max(1);
        let mut sum = Spectrum::BLACK;
        for _ in 0..n {
            let Some((t, weight)) = medium.collide(&span.ray, s) else { continue };
            let x = span.at(t, Spectrum::ONE);
            let probe = &mut *probe;
            let mut ask = Gather { scene, receiver: &x, kernel, bounding, edges_left, edges_least, probe };
            sum += weight * set.radiance(&mut ask, s);
        }
        sum * (1.0 / n as f32)
    }
}

/// Receivers are points of the segment, one in each of its parts: evenly where the medium varies, by free flight where it does not. For
/// sets that give radiance per scattering coefficient: where points are drawn by flight alone, thin smoke is met seldom, and then
/// counts the more.
#[derive(Clone, Copy, Debug)]
pub struct Parted {
    /// How many; at least one.
    pub points: u32,
}
impl Promise for Parted {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<S, K, B> Segment<S, K, B> for Parted
where
    S: for<'g> LightSet<Gather<'g, Vertex, K, B>>,
{
    fn gather(&self, span: &Span, at: &Along<S, K, B>, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let Along { scene, set, kernel, bounding, edges_left, edges_least } = *at;
        let Some(medium) = scene.medium(span.ray.medium) else { return Spectrum::BLACK };
        let n = self.points.max(1);
        let length = f64::from(span.ray.t_max);
        let flight = medium.homogeneous().map(|_| Exponential::new(medium.extinction_mean(), length));
        let (mut sum, mut through, mut reached) = (Spectrum::BLACK, Spectrum::ONE, 0.0f32);
        for i in 0..n {
            let u = (f64::from(i) + s.next_f64()) / f64::from(n);
            let (t, pdf) = flight.map_or((u * length, 1.0 / length), |f| (f.sample(u), f.pdf(f.sample(u))));
            let t = (t as f32).max(reached);
            // Parts do not overlap: a product of independent estimates.
            through *= medium.transmittance(&span.ray, reached, t, s);
            reached = t;
            let x = span.at(t, Spectrum::ONE);
            let weight = through * medium.scattering(x.p) * (1.0 / pdf) as f32;
            if weight.is_black() {
                continue;
            }
            let probe = &mut *probe;
            let mut ask = Gather { scene, receiver: &x, kernel, bounding, edges_left, edges_least, probe };
            sum += weight * set.radiance(&mut ask, s);
        }
        sum * (1.0 / n as f32)
    }
}

/// As [`Sampled`], with emission and transmittance along the camera's ray by ray marching.
#[derive(Clone, Copy, Debug)]
pub struct Marched(pub Sampled);
impl Promise for Marched {
    /// Of either sign, by how large voxels are.
    fn claim(&self) -> Claim {
        Claim { bias: f32::INFINITY, brightens: true, ..Claim::UNBIASED }
    }
}
impl<S, K, B> Segment<S, K, B> for Marched
where
    Sampled: Segment<S, K, B>,
{
    fn gather(&self, span: &Span, at: &Along<S, K, B>, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        self.0.gather(span, at, probe, s)
    }
    fn marches(&self) -> bool {
        true
    }
}

/// The composite where there are media: what light sets bring to surfaces, seen through the media, and what they bring to the
/// media along the camera's ray,
///
/// > L = T(0,s) L(surface) + int T(0,u) \[j(u) + sigma_s(u) (direct light + lights + residual)(u)\] du.
///
/// Lights are of a generator that knows media. Without media it is [`ManyLights`].
pub struct InMedia<L, P, K, B, M> {
    /// The composite at surfaces.
    pub lights: ManyLights<L, P, K, B>,
    /// How it gathers along segments.
    pub segment: M,
}

/// Thinner than this a medium's end cannot be seen: segments that reach to infinity are cut there.
const OPAQUE: f32 = 60.0;

impl<L, P, K, B, M> InMedia<L, P, K, B, M>
where
    P: Plan<L>,
    K: Promise + Send + Sync,
    B: BoundingPlan,
    P::Set: for<'g> LightSet<Gather<'g, Vertex, K, B::Pass>>,
    M: Segment<P::Set, K, B::Pass>,
{
    /// What the media along a ray scatter, after `edges` edges from the eye, and what they let through to its end.
    fn media(
        &self,
        scene: &Scene,
        p: &Prepared<P::Set, B::Pass>,
        ray: &Ray,
        edges: u32,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> (Spectrum, Spectrum) {
        let (mut sum, mut through) = (Spectrum::BLACK, Spectrum::ONE);
        for run in scene.runs(ray) {
            let Some(medium) = scene.medium(run.medium) else { continue };
            let marched = if self.segment.marches() { medium.marched(ray, run.from, run.to, s) } else { None };
            if medium.emits() && self.lights.counts(edges) {
                let emitted = marched.map_or_else(|| medium.emitted(ray, run.from, run.to, s), |m| m.0);
                sum += through * emitted;
            }
            if !medium.scattering_max().is_black() && edges < self.lights.max_edges {
                let ray = Ray { t_max: run.to - run.from, ..Ray::new(ray.at(run.from), ray.dir) }.within(run.medium);
                let ray = Ray { t_max: ray.t_max.min(medium.reach(&ray, OPAQUE)), ..ray };
                let span = Span { ray, scattering_max: medium.scattering_max(), phase: medium.phase() };
                if !(ray.t_max > 0.0) {
                    continue;
                }
                if !p.covers_direct && self.lights.counts(edges + 1) {
                    sum += through * direct_along(scene, &span, probe, s);
                }
                let at = Along {
                    scene,
                    set: &p.set,
                    kernel: &self.lights.kernel,
                    bounding: &p.bounding,
                    edges_left: self.lights.max_edges - edges,
                    edges_least: self.lights.min_edges.saturating_sub(edges + 1),
                };
                sum += through * self.segment.gather(&span, &at, probe, s);
                if self.lights.compensation.is_some() {
                    sum += through * self.lost(scene, p, &span, edges, probe, s);
                }
            }
            through *= marched.map_or_else(|| medium.transmittance(ray, run.from, run.to, s), |m| m.1);
            if through.is_black() {
                break;
            }
        }
        (sum, through)
    }
    /// What the bounding took away from what the lights bring to a segment: at one point of it, drawn by free flight whatever points
    /// the lights have drawn, since the expectations of all are integrals over the segment.
    fn lost(
        &self,
        scene: &Scene,
        p: &Prepared<P::Set, B::Pass>,
        span: &Span,
        edges: u32,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum {
        let Some(medium) = scene.medium(span.ray.medium) else { return Spectrum::BLACK };
        let Some((t, weight)) = medium.collide(&span.ray, s) else { return Spectrum::BLACK };
        let (x, at) = (span.at(t, Spectrum::ONE), Depth { edges, level: 0 });
        // A frame's compensation knows surfaces alone.
        let compensator = self.lights.compensation.at(1);
        weight * self.lights.lost(scene, p, &x, at, &p.bounding, compensator, probe, s)
    }
}

impl<L, P, K, B, M> Integrator for InMedia<L, P, K, B, M>
where
    P: Plan<L>,
    K: Promise + Send + Sync,
    B: BoundingPlan,
    P::Set: for<'g> LightSet<Gather<'g, Vertex, K, B::Pass>>,
    M: Segment<P::Set, K, B::Pass>,
{
    type Prepared = Prepared<P::Set, B::Pass>;

    fn prepare(&self, scene: &Scene, pass: u64, seed: u64, probe: &mut Probe) -> Result<Self::Prepared, PassError> {
        self.lights.prepare(scene, pass, seed, probe)
    }

    fn radiance(&self, scene: &Scene, p: &Self::Prepared, ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let mut media = |ray: &Ray, edges: u32, probe: &mut Probe, s: &mut Stream| {
            if scene.has_media() {
                self.media(scene, p, ray, edges, probe, s)
            } else {
                (Spectrum::BLACK, Spectrum::ONE)
            }
        };
        self.lights.walk(scene, p, ray, &mut media, probe, s)
    }
}

impl<L, P: Promise, K: Promise, B: BoundingPlan, M: Promise> Promise for InMedia<L, P, K, B, M> {
    fn claim(&self) -> Claim {
        self.lights.claim().and(self.segment.claim())
    }
}

/// The camera's ray up to a surface (all of it, if it meets none).
pub(crate) fn up_to(ray: &Ray, x: Option<&Vertex>) -> Ray {
    let t_max = x.map_or(ray.t_max, |x| (x.p - ray.origin).length());
    Ray { t_max, ..*ray }
}
