//! What residual paths find: the composite, asked again further on.

use crate::ManyLights;
use crate::many_lights::Prepared;
use manylight_framework::{BoundingPlan, Depth, Gather, LightSet, Onward, Plan, Probe, Promise};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Scene, Vertex};

pub(crate) struct Further<'f, L, P: Plan<L>, K, B: BoundingPlan> {
    pub method: &'f ManyLights<L, P, K, B>,
    pub scene: &'f Scene,
    pub prepared: &'f Prepared<P::Set, B::Pass>,
}

impl<L, P, K, B> Onward for Further<'_, L, P, K, B>
where
    P: Plan<L>,
    K: Promise + Send + Sync,
    B: BoundingPlan,
    P::Set: for<'g> LightSet<Gather<'g, Vertex, K, B::Pass>>,
{
    fn scattered(&self, y: &Vertex, at: Depth, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let compensator = self.method.compensation.at(at.level);
        self.method.outgoing(self.scene, self.prepared, y, at, compensator, probe, s)
    }
    fn counts(&self, edges: u32) -> bool {
        self.method.counts(edges)
    }
    fn allows(&self, edges: u32) -> bool {
        edges <= self.method.max_edges
    }
}
