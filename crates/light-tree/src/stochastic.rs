//! Stochastic lightcuts.

use crate::descent::{Descent, descend, min_max};
use crate::starts::Starts;
use crate::{Growth, LightTree};
use manylight_framework::{
    BuildError, Claim, Clustered, Contribute, KnobSet, LightSet, Notes, Occlusion, Picks, Plan, Promise, ReachCluster,
};
use manylight_math::Spectrum;
use manylight_sampling::Stream;

/// When a cut is fine enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutBy {
    /// At its size: the cut looks at no sample, and the estimate is unbiased.
    Size,
    /// Where no node's estimated error exceeds this fraction of the estimate of all, or at its size. Since samples are in that
    /// estimate they decide, a little, what is sampled: a small bias.
    Error(f32),
}

/// Draws one light for each node of a cut, by a walk down the tree whose probabilities suit the receiver (Yuksel 2019).
#[derive(Clone, Copy, Debug)]
pub struct StochasticLightcuts {
    /// Nodes of a cut, at most, and so lights asked by a receiver.
    pub size: u32,
    /// When a cut is fine enough.
    pub by: CutBy,
    /// How the tree is built.
    pub growth: Growth,
}

impl Default for StochasticLightcuts {
    fn default() -> Self {
        StochasticLightcuts { size: 10, by: CutBy::Size, growth: Growth::default() }
    }
}

/// The tree of a pass.
pub struct DescentLights<L: Clustered> {
    tree: LightTree<L>,
    plan: StochasticLightcuts,
}

impl Promise for StochasticLightcuts {
    fn claim(&self) -> Claim {
        match self.by {
            CutBy::Size => Claim::UNBIASED,
            CutBy::Error(_) => Claim::consistent(KnobSet::ERROR),
        }
    }
}
impl<L: Clustered> Plan<Vec<L>> for StochasticLightcuts {
    type Set = DescentLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, s: &mut Stream) -> Result<DescentLights<L>, BuildError> {
        let tree = LightTree::new(lights, self.growth, s)?;
        Ok(DescentLights { tree, plan: *self })
    }
}

/// A node of the cut.
struct Open {
    node: u32,
    /// What its estimate may be off by; zero for a leaf, and where nothing can contribute.
    error: f32,
    /// Squared distance below which nothing counts as nearer: of the size of all lights of its kind. None where there are several
    /// kinds, and from infinity, which has no size. [m^2]
    floor: f32,
}

/// Part of the size of all lights of a kind, squared.
const NEAR2: f32 = 1e-6;

impl<L: Clustered> DescentLights<L> {
    /// The tree.
    pub fn tree(&self) -> &LightTree<L> {
        &self.tree
    }
    fn look<Q: ReachCluster<L::Cluster>>(&self, node: u32, floor: f32, ask: &Q) -> Open {
        if self.tree.children(node).is_none() {
            return Open { node, error: 0.0, floor };
        }
        let r = ask.reach(self.tree.cluster(node));
        let floor = if floor > 0.0 { floor } else { NEAR2 * r.radius2 };
        Open { node, error: r.intensity * r.facing_max / r.near2.max(floor).max(f32::MIN_POSITIVE), floor }
    }
    /// Probabilities with which a walk takes either child of a node; `None` where nothing below can contribute.
    pub fn odds<Q: ReachCluster<L::Cluster>>(&self, ask: &Q, children: [&L::Cluster; 2]) -> Option<[f64; 2]> {
        let [a, b] = children.map(|c| ask.reach(c));
        min_max(&a, &b)
    }
    fn draw<Q: ReachCluster<L::Cluster>>(&self, node: u32, ask: &Q, s: &mut Stream) -> Descent {
        descend(&self.tree, node, s.next_f64(), |children| self.odds(ask, children))
    }
    /// The nodes of a receiver's cut, found by looking at clusters alone.
    pub fn cut_nodes<Q: ReachCluster<L::Cluster>>(&self, ask: &Q) -> Vec<u32> {
        self.tree.root().map_or(vec![], |root| self.cut(root, ask).iter().map(|o| o.node).collect())
    }
    fn cut<Q: ReachCluster<L::Cluster>>(&self, root: u32, ask: &Q) -> Vec<Open> {
        let size = self.plan.size.max(1) as usize;
        let mut cut = Vec::with_capacity(size);
        if size == 1 {
            cut.push(Open { node: root, error: 0.0, floor: 0.0 });
            return cut;
        }
        cut.push(self.look(root, 0.0, ask));
        while cut.len() < size {
            let Some(worst) = worst(&cut) else { break };
            let Some([a, b]) = self.tree.children(cut[worst].node) else { break };
            let floor = cut[worst].floor;
            cut[worst] = self.look(a, floor, ask);
            cut.push(self.look(b, floor, ask));
        }
        cut
    }
}

/// The node of largest error; `None` if there is none.
fn worst(cut: &[Open]) -> Option<usize> {
    let (mut worst, mut error) = (None, 0.0);
    for (i, o) in cut.iter().enumerate() {
        if o.error > error {
            (worst, error) = (Some(i), o.error);
        }
    }
    worst
}

impl<L: Clustered, Q> LightSet<Q> for DescentLights<L>
where
    Q: Contribute<L> + ReachCluster<L::Cluster> + Notes,
{
    /// Notes `cut size`.
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let Some(root) = self.tree.root() else { return Spectrum::BLACK };
        let samples = match self.plan.by {
            CutBy::Size => self.cut(root, ask).iter().map(|o| self.sample(o.node, ask, s)).collect(),
            CutBy::Error(error) => self.refined(root, error, ask, s),
        };
        ask.note("cut size", samples.len() as f32);
        let mut sum = [0.0f64; 3];
        for Sample { value, end } in samples {
            let c = value.to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 / end.probability);
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}

/// What was drawn for a node of the cut.
#[derive(Clone, Copy)]
struct Sample {
    end: Descent,
    /// What that light gives; black in a dead branch, which is not drawn anew: that would be biased.
    value: Spectrum,
}

impl<L: Clustered> DescentLights<L> {
    fn sample<Q>(&self, node: u32, ask: &mut Q, s: &mut Stream) -> Sample
    where
        Q: Contribute<L> + ReachCluster<L::Cluster>,
    {
        let end = self.draw(node, ask, s);
        let value = if end.dead { Spectrum::BLACK } else { ask.contribution(self.tree.light(end.node), s) };
        Sample { end, value }
    }
    /// Refines while it samples. The child that the walk from a node took keeps what it found: given that it was taken, the rest
    /// of the walk is one from that child. The other draws anew, so that there is one new light a refinement.
    fn refined<Q>(&self, root: u32, error: f32, ask: &mut Q, s: &mut Stream) -> Vec<Sample>
    where
        Q: Contribute<L> + ReachCluster<L::Cluster>,
    {
        let mut cut = vec![self.look(root, 0.0, ask)];
        let mut samples = vec![self.sample(root, ask, s)];
        let given = |x: &Sample| x.value.luminance() as f64 / x.end.probability;
        let mut total = given(&samples[0]);
        while cut.len() < self.plan.size as usize {
            let Some(worst) = worst(&cut).filter(|&i| cut[i].error as f64 > error as f64 * total.max(0.0)) else {
                break;
            };
            let Some(children) = self.tree.children(cut[worst].node) else { break };
            let Sample { end, value } = samples[worst];
            total -= given(&samples[worst]);
            let right = end.node != cut[worst].node && self.tree.side(children[0], self.tree.place(end.node));
            // Dead at the node itself: nothing in either child can contribute.
            let clusters = children.map(|c| self.tree.cluster(c));
            let taken = self.odds(ask, clusters).map_or(1.0, |odds| odds[right as usize]);
            let kept = Sample { end: Descent { probability: end.probability / taken, ..end }, value };
            let (keeper, other) = (children[right as usize], children[!right as usize]);
            let floor = cut[worst].floor;
            cut[worst] = self.look(keeper, floor, ask);
            samples[worst] = kept;
            cut.push(self.look(other, floor, ask));
            samples.push(self.sample(other, ask, s));
            total += given(&kept) + samples.last().map_or(0.0, given);
        }
        samples
    }
}

/// One walk, whatever the size of the cut.
impl<L: Clustered, Q: ReachCluster<L::Cluster>> Picks<Q> for DescentLights<L> {
    fn pick(&self, ask: &mut Q, s: &mut Stream) -> Option<(usize, f64)> {
        let d = Starts::new(&self.tree, ask).draw(s.next_f64(), |children| self.odds(ask, children))?;
        Some((self.tree.light_of(d.node), d.probability))
    }
    fn pmf(&self, ask: &mut Q, light: usize) -> f64 {
        Starts::new(&self.tree, ask).probability(light, |children| self.odds(ask, children))
    }
}
