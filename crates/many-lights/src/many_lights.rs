//! The composite.

use crate::eye::Parts;
use crate::frame;
use crate::further::Further;
use crate::in_media::up_to;
use crate::{direct_light, lost_direct_light};
use manylight_framework::{
    Bounding, BoundingPlan, Claim, Compensation, Compensator, Depth, Film, Gather, Generator, Integrator, KeepNothing,
    LightSet, Occlusion, PassError, PathClasses, Plan, Probe, Promise,
};
use manylight_math::{Aabb, Ray, Spectrum};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, Mode, Scene, Vertex};
use std::sync::atomic::{AtomicU64, Ordering};

/// generator x light set x kernel x bounding x compensation. Only light set x kernel x kind of end is monomorphised: the
/// generator and the compensation are trait objects, of one call a pass or a receiver.
pub struct ManyLights<L, P, K, B> {
    /// Makes the lights of each pass.
    pub generator: Box<dyn Generator<Lights = L>>,
    /// Builds the light set from them.
    pub plan: P,
    /// Connects a receiver to a light.
    pub kernel: K,
    /// What is kept of a connection.
    pub bounding: B,
    /// Estimates what was not.
    pub compensation: Compensation,
    /// Longest path, in edges; `u32::MAX`: no limit.
    pub max_edges: u32,
    /// Shortest path, in edges: shorter ones (1: emission seen directly, 2: direct light) are left out.
    pub min_edges: u32,
    /// Lobes of a roughness (alpha) of at most this are walked through on the eye's side, as delta lobes are, and not connected
    /// to lights; 0: none.
    pub sharp: f32,
}

/// The lights of a pass.
pub struct Prepared<S, B> {
    pub(crate) set: S,
    pub(crate) bounding: B,
    pub(crate) covers_direct: bool,
}

/// What media along a ray scatter into it, and what they let through; after so many edges from the eye.
type Media<'m> = dyn FnMut(&Ray, u32, &mut Probe, &mut Stream) -> (Spectrum, Spectrum) + 'm;

/// From this edge on a chain of delta lobes is ended by Russian roulette (in glass, total reflection may go on for ever).
const CERTAIN_EDGES: u32 = 8;
const SURVIVAL: f32 = 0.95;

impl<L, P, K, B> ManyLights<L, P, K, B>
where
    P: Plan<L>,
    K: Promise + Send + Sync,
    B: BoundingPlan,
    P::Set: for<'g> LightSet<Gather<'g, Vertex, K, B::Pass>>,
{
    pub(crate) fn counts(&self, edges: u32) -> bool {
        (self.min_edges..=self.max_edges).contains(&edges)
    }
    /// Walks from the eye through delta and sharp lobes until the first vertex that has no others.
    pub(crate) fn walk(
        &self,
        scene: &Scene,
        p: &Prepared<P::Set, B::Pass>,
        ray: &Ray,
        media: &mut Media,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum {
        let (mut ray, mut throughput, mut sum, mut eta2) = (*ray, Spectrum::ONE, Spectrum::BLACK, 1.0);
        // A frame's compensation is for the first vertex that gathers: behind it, in the reflection of a smooth coat, points are
        // compensated one by one.
        let mut framed = true;
        // Is the emission that the walk meets not yet in the direct light of the vertex before?
        let mut emission = true;
        for edges in 1..=self.max_edges {
            if edges > 1 {
                probe.path_rays += 1;
            }
            let x = scene.intersect(&ray, Mode::Radiance);
            let (scattered, through) = media(&up_to(&ray, x.as_ref()), edges, probe, s);
            sum += throughput * scattered;
            throughput *= through;
            let Some(x) = x else {
                if emission && self.counts(edges) {
                    sum += throughput * scene.environment(ray.dir);
                }
                break;
            };
            if emission && self.counts(edges) {
                sum += throughput * x.emitted();
            }
            let parts = Parts::of(&x, self.sharp);
            let at = Depth { edges, level: 0 };
            // Of all lobes, sharp ones too: emission is not counted behind those. Where lights bring direct light, which are
            // connected to the others alone, of the sharp ones.
            let sampled = if p.covers_direct { parts.sharp() } else { Some(&x) };
            sum += throughput * sampled.map_or(Spectrum::BLACK, |x| self.direct(scene, x, edges, probe, s));
            framed &= edges <= frame::MOST_EDGES;
            let compensator = self.compensation.at(if framed { 0 } else { 1 });
            sum += throughput * self.gathered(scene, p, &parts.gathers, at, compensator, probe, s);
            framed &= !parts.gathers.connects();
            let Some(next) = parts.step(s) else { break };
            emission = next.delta;
            throughput *= next.weight;
            eta2 *= next.eta * next.eta;
            if throughput.is_black() {
                break;
            }
            // Refraction divides radiance by the square of the index: that is no loss.
            let lossless = throughput.largest() * eta2;
            let survival = if edges < CERTAIN_EDGES { 1.0 } else { lossless.min(SURVIVAL) };
            if !(s.next_f32() < survival) {
                break;
            }
            throughput *= 1.0 / survival;
            ray = x.leave(next.dir);
        }
        sum
    }
    /// What leaves `x` without its emission: direct light, what the lights bring, and what the bounding took away.
    pub(crate) fn outgoing(
        &self,
        scene: &Scene,
        p: &Prepared<P::Set, B::Pass>,
        x: &Vertex,
        at: Depth,
        compensator: Option<&dyn Compensator>,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum {
        let direct = if p.covers_direct { Spectrum::BLACK } else { self.direct(scene, x, at.edges, probe, s) };
        direct + self.gathered(scene, p, x, at, compensator, probe, s)
    }
    /// Sampled direct light at a vertex of so many edges.
    fn direct(&self, scene: &Scene, x: &Vertex, edges: u32, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        if !self.counts(edges + 1) || !x.connects() {
            return Spectrum::BLACK;
        }
        direct_light(scene, x, probe, s)
    }
    /// What the lights bring to `x`, and what the bounding took away.
    pub(crate) fn gathered(
        &self,
        scene: &Scene,
        p: &Prepared<P::Set, B::Pass>,
        x: &Vertex,
        at: Depth,
        compensator: Option<&dyn Compensator>,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum {
        if at.edges >= self.max_edges || !x.connects() {
            return Spectrum::BLACK;
        }
        let lights = compensator.is_none_or(|c| c.asks_lights(at.level));
        let bounding: &dyn Bounding = if lights { &p.bounding } else { &KeepNothing };
        let mut sum = Spectrum::BLACK;
        if lights {
            let mut ask = Gather {
                scene,
                receiver: x,
                kernel: &self.kernel,
                bounding: &p.bounding,
                edges_left: self.max_edges - at.edges,
                edges_least: self.min_edges.saturating_sub(at.edges + 1),
                probe: &mut *probe,
            };
            sum += p.set.radiance(&mut ask, s);
        }
        sum + self.lost(scene, p, x, at, bounding, compensator, probe, s)
    }
    /// What the bounding took away from what the lights bring to `x`.
    pub(crate) fn lost(
        &self,
        scene: &Scene,
        p: &Prepared<P::Set, B::Pass>,
        x: &Vertex,
        at: Depth,
        bounding: &dyn Bounding,
        compensator: Option<&dyn Compensator>,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum {
        let mut sum = Spectrum::BLACK;
        if p.covers_direct && self.compensation.is_some() && self.counts(at.edges + 1) {
            // Virtual lights on the emitters are bounded too. Emitters can be sampled: no residual path need find them.
            sum += lost_direct_light(scene, x, bounding, probe, s);
        }
        if let Some(c) = compensator {
            let onward = Further { method: self, scene, prepared: p };
            // Of the lights that are asked further on, only the sum is told.
            let explanation = probe.explain.take();
            let residual = c.residual(scene, x, at, bounding, &onward, probe, s);
            probe.explain = explanation;
            probe.explain_residual(at, residual);
            sum += residual;
        }
        sum
    }
}

impl<L, P, K, B> Integrator for ManyLights<L, P, K, B>
where
    P: Plan<L>,
    K: Promise + Send + Sync,
    B: BoundingPlan,
    P::Set: for<'g> LightSet<Gather<'g, Vertex, K, B::Pass>>,
{
    type Prepared = Prepared<P::Set, B::Pass>;

    fn prepare(&self, scene: &Scene, pass: u64, seed: u64, probe: &mut Probe) -> Result<Self::Prepared, PassError> {
        if self.plan.merges() && (self.max_edges != u32::MAX || self.min_edges > 1) {
            return Err(PassError::MergesDepths);
        }
        let batch = self.generator.generate(scene, pass, seed, probe)?;
        let counted = Counted { scene, rays: AtomicU64::new(0) };
        let set = self.plan.build(batch.lights, &counted, &mut Stream::new(seed, [pass, 0, 0], Purpose::BUILD))?;
        probe.shadow_rays += counted.rays.into_inner();
        let bounding = self.bounding.at(scene, pass, batch.paths);
        if self.compensation.is_some() && !bounding.compensable() {
            return Err(PassError::NotCompensable);
        }
        Ok(Prepared { set, bounding, covers_direct: batch.covers_direct })
    }

    fn radiance(&self, scene: &Scene, p: &Self::Prepared, ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        self.walk(scene, p, ray, &mut |_, _, _, _| (Spectrum::BLACK, Spectrum::ONE), probe, s)
    }

    fn render_pass(&self, scene: &Scene, p: &Self::Prepared, film: &mut Film, probe: &mut Probe) {
        film.fill(probe, &|ray, probe, s| self.radiance(scene, p, ray, probe, s));
        if let Compensation::Frame(c) = &self.compensation {
            let onward = Further { method: self, scene, prepared: p };
            frame::add_residual(&**c, scene, &p.bounding, &onward, self.sharp, film, probe);
        }
    }
}

impl<L, P: Promise, K: Promise, B: BoundingPlan> Promise for ManyLights<L, P, K, B> {
    fn claim(&self) -> Claim {
        let bounded = self.compensation.repairs(self.bounding.claim());
        let generated = self.generator.claim();
        if generated == (Claim { misses: PathClasses::INDIRECT, ..Claim::EXACT }) {
            // No lights: only direct light is left, which is sampled.
            return Claim { noisy: true, ..generated };
        }
        let kernel = self.kernel.claim();
        let kernel = Claim { finite_variance: kernel.finite_variance || self.bounding.tames(), ..kernel };
        let all = generated.and(self.plan.claim()).and(kernel).and(bounded);
        // Camera samples are noisy whatever the parts.
        let indirect = !all.misses.contains(PathClasses::INDIRECT);
        let finds = if indirect { self.compensation.finds() } else { PathClasses::NONE };
        Claim { noisy: true, misses: all.misses.without(finds), ..all }
    }
}

/// The scene as a light set may see it while it is built, counting its rays.
struct Counted<'a> {
    scene: &'a Scene,
    rays: AtomicU64,
}
impl Occlusion for Counted<'_> {
    fn transmittance(&self, edge: &Edge, s: &mut Stream) -> Spectrum {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.scene.transmittance(edge, s)
    }
    fn extent(&self) -> Aabb {
        self.scene.bounds()
    }
}
