//! Lightcuts.

use crate::descent::descend;
use crate::{Growth, LightTree, Representatives};
use manylight_framework::{
    BoundCluster, BuildError, Claim, Clustered, Contribute, KnobSet, LightSet, Limited, Notes, Occlusion, Plan, Promise,
};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Which light stands for a cluster, and for whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// One drawn for the whole pass, as published: no noise within a pass, but errors that neighbouring receivers share. Of so many
    /// draws each receiver goes by one, as if there were so many trees: the errors become noise, and go with the root of their number.
    Pass(u32),
    /// One drawn by each receiver: as many trees as receivers. The same errors, as noise.
    Receiver,
    /// That of the brighter child: always the same for the same lights.
    Brightest,
}

/// Refines a cut until no cluster can be off by more than a fraction of the whole (Walter et al. 2005).
#[derive(Clone, Copy, Debug)]
pub struct Lightcuts {
    /// Largest bound of a cluster's error, relative to the estimate of all. 2 % is hardly seen.
    pub error: f32,
    /// Nodes of a cut, at most: it ends refinement where all lights are hidden.
    pub most: u32,
    /// Which light stands for a cluster.
    pub standing: Standing,
    /// How the tree is built. Lights of different edges must be kept apart where path lengths are limited.
    pub growth: Growth,
}

impl Default for Lightcuts {
    fn default() -> Self {
        Lightcuts { error: 0.02, most: 1000, standing: Standing::Pass(1), growth: Growth::default() }
    }
}

/// The tree of a pass.
pub struct CutLights<L: Clustered> {
    tree: LightTree<L>,
    /// The leaves that stand for nodes, in the draws after the tree's own.
    more: Vec<Vec<u32>>,
    plan: Lightcuts,
}

impl Promise for Lightcuts {
    /// The error of a cut is bounded cluster by cluster, and of either sign; refinement looks at the estimate.
    fn claim(&self) -> Claim {
        Claim { noisy: self.standing != Standing::Brightest, ..Claim::consistent(KnobSet::ERROR) }
    }
}
impl<L: Clustered> Plan<Vec<L>> for Lightcuts {
    type Set = CutLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, s: &mut Stream) -> Result<CutLights<L>, BuildError> {
        let representatives = match self.standing {
            Standing::Brightest => Representatives::Brightest,
            _ => Representatives::Drawn,
        };
        let tree = LightTree::new(lights, Growth { representatives, ..self.growth }, s)?;
        let more = match self.standing {
            Standing::Pass(draws) => (1..draws).map(|_| tree.represented(representatives, s.next_u64())).collect(),
            _ => Vec::new(),
        };
        Ok(CutLights { tree, more, plan: *self })
    }
    /// A representative stands for lights of other depths, unless these are kept apart.
    fn merges(&self) -> bool {
        self.growth.together == Growth::ALL_DEPTHS
    }
}

/// A node of the cut.
struct Open {
    /// Of what this cluster's estimate can be off by. [W/(m^2 sr)]
    bound: f32,
    node: u32,
    /// The leaf that stands for it.
    leaf: u32,
    /// What that light gives, for each unit of its weight.
    value: Spectrum,
}
impl Ord for Open {
    fn cmp(&self, o: &Self) -> Ordering {
        self.bound.total_cmp(&o.bound).then(o.node.cmp(&self.node))
    }
}
impl PartialOrd for Open {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl PartialEq for Open {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Open {}

impl<L: Clustered> CutLights<L> {
    /// The tree.
    pub fn tree(&self) -> &LightTree<L> {
        &self.tree
    }
    /// The draw that a receiver goes by; none is the tree's own.
    fn draw(&self, s: &mut Stream) -> Option<&[u32]> {
        if self.more.is_empty() {
            return None;
        }
        let draw = (s.next_f64() * (self.more.len() + 1) as f64) as usize;
        self.more.get(draw).map(|leaves| &leaves[..])
    }
    fn open<Q>(
        &self,
        node: u32,
        draw: Option<&[u32]>,
        known: Option<(u32, Spectrum)>,
        ask: &mut Q,
        s: &mut Stream,
    ) -> Open
    where
        Q: Contribute<L> + BoundCluster<L::Cluster>,
    {
        let (leaf, value) = known.unwrap_or_else(|| {
            let leaf = match self.plan.standing {
                Standing::Receiver => {
                    descend(&self.tree, node, s.next_f64(), |[a, b]| {
                        let (a, b) = (L::weight(a) as f64, L::weight(b) as f64);
                        Some([a / (a + b), b / (a + b)])
                    })
                    .node
                }
                _ => draw.map_or_else(|| self.tree.representative(node), |leaves| leaves[node as usize]),
            };
            (leaf, ask.contribution(self.tree.light(leaf), s) / self.tree.weight(leaf))
        });
        // One light is what it is.
        let exact = self.tree.children(node).is_none();
        let bound = if exact { 0.0 } else { ask.upper_bound(self.tree.cluster(node)) };
        Open { bound, node, leaf, value }
    }
}

impl<L: Clustered, Q> LightSet<Q> for CutLights<L>
where
    Q: Contribute<L> + BoundCluster<L::Cluster> + Limited + Notes,
{
    /// Notes `cut size`, and `error bound`: the sum of what the clusters can be off by, in luminance. It is a certificate for
    /// kernels without noise, if nothing that can be seen through partly stands between: |estimate - sum over all lights| is never
    /// larger. A noisy kernel's expectation is what it bounds.
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let mut heap = BinaryHeap::with_capacity(128);
        let mut total = 0.0f64;
        let luminance = |o: &Open| (o.value.luminance() * self.tree.weight(o.node)) as f64;
        let (left, least, draw) = (ask.edges_left(), ask.edges_least(), self.draw(s));
        for group in self.tree.groups() {
            if group.edges.is_some_and(|e| e >= left || e < least) {
                continue;
            }
            let o = self.open(group.node, draw, None, ask, s);
            total += luminance(&o);
            heap.push(o);
        }
        while heap.len() < self.plan.most as usize {
            // A total that rounding took below zero is nothing.
            let enough = (self.plan.error as f64 * total.max(0.0)) as f32;
            let Some(o) = heap.peek_mut().filter(|o| o.bound > enough) else { break };
            let o = std::collections::binary_heap::PeekMut::pop(o);
            let Some([a, b]) = self.tree.children(o.node) else { break };
            total -= luminance(&o);
            // The child that has its light keeps it: one new light a refinement, hence one shadow ray.
            let right = self.tree.side(a, self.tree.place(o.leaf));
            for (child, keeps) in [(a, !right), (b, right)] {
                let o = self.open(child, draw, keeps.then_some((o.leaf, o.value)), ask, s);
                total += luminance(&o);
                heap.push(o);
            }
        }
        ask.note("cut size", heap.len() as f32);
        ask.note("error bound", heap.iter().map(|o| o.bound).sum());
        // Not `total`, which drifts; in double precision, since lights differ by decades.
        let mut sum = [0.0f64; 3];
        for o in heap {
            let (weight, c) = (self.tree.weight(o.node) as f64, o.value.to_array());
            (0..3).for_each(|k| sum[k] += c[k] as f64 * weight);
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}
