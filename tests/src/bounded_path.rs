//! The path tracer with the lights' bound: what a bounded many-light method has to agree with.

use manylight_framework::{Bounding, Claim, Integrator, Pair, PassError, Probe, Promise};
use manylight_math::{Ray, Spectrum};
use manylight_reference::PathTracer;
use manylight_sampling::Stream;
use manylight_scene::{Mode, Scene};

/// The indirect light that a bound keeps: T_b of what the second vertex sends without its emission, T_b keeping min(G, b).
/// Estimated by path tracing, with nothing of the virtual lights' code. Emission and direct light (`min-depth=3` leaves them out
/// of a method) would only add noise that both sides have alike. For scenes without delta lobes on what the camera sees.
pub struct BoundedPath<B> {
    /// The bound.
    pub bounding: B,
    /// Longest path, in edges.
    pub max_edges: u32,
}

impl<B: Bounding> Promise for BoundedPath<B> {
    fn claim(&self) -> Claim {
        Claim::UNBIASED.and(self.bounding.claim())
    }
}
impl<B: Bounding> Integrator for BoundedPath<B> {
    type Prepared = ();
    fn prepare(&self, _: &Scene, _: u64, _: u64, _: &mut Probe) -> Result<(), PassError> {
        Ok(())
    }
    fn radiance(&self, scene: &Scene, _: &(), ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let kept = || -> Option<Spectrum> {
            let x = scene.intersect(ray, Mode::Radiance)?;
            let next = x.sample(s.next_f32(), s.next_2d())?;
            let ray = x.leave(next.dir);
            let y = scene.intersect(&ray, Mode::Radiance)?;
            let cosines = x.cosine(next.dir) * y.normal()?.dot(next.dir).abs();
            let pair = Pair { g: cosines / (y.p - x.p).length_squared(), lobes: None };
            // From the second vertex on: no emission of its own, one edge fewer.
            let rest =
                PathTracer { min_edges: 2, max_edges: self.max_edges.saturating_sub(1), ..PathTracer::default() };
            Some(next.weight * rest.radiance(scene, &(), &ray, probe, s) * self.bounding.keep(&pair))
        }();
        kept.unwrap_or(Spectrum::BLACK)
    }
}
