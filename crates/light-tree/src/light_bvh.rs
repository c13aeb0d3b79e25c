//! Importance sampling of many lights by a light BVH.

use crate::descent::{BELOW_ONE, Descent, descend, importance, odds, probability};
use crate::{Growth, LightTree};
use manylight_framework::{
    BuildError, Claim, Clustered, Contribute, LightSet, Occlusion, Picks, Plan, Promise, ReachCluster,
};
use manylight_math::Spectrum;
use manylight_sampling::Stream;

/// Draws `samples` lights by independent walks from the root, by intensity, distance and orientation (Conty Estevez and Kulla
/// 2018): the light sampling of Cycles, pbrt-v4 and Arnold. The numbers that the walks start from are stratified.
#[derive(Clone, Copy, Debug)]
pub struct LightBvh {
    /// Lights that a receiver asks; at least one.
    pub samples: u32,
    /// How the tree is built.
    pub growth: Growth,
}

impl Default for LightBvh {
    fn default() -> Self {
        LightBvh { samples: 10, growth: Growth::default() }
    }
}

/// The tree of a pass.
pub struct BvhLights<L: Clustered> {
    tree: LightTree<L>,
    samples: u32,
}

impl Promise for LightBvh {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<L: Clustered> Plan<Vec<L>> for LightBvh {
    type Set = BvhLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, s: &mut Stream) -> Result<BvhLights<L>, BuildError> {
        Ok(BvhLights { tree: LightTree::new(lights, self.growth, s)?, samples: self.samples.max(1) })
    }
}

impl<L: Clustered> BvhLights<L> {
    /// The tree.
    pub fn tree(&self) -> &LightTree<L> {
        &self.tree
    }
    /// Probabilities with which a walk takes either child of a node; `None` where nothing below can contribute.
    pub fn odds<Q: ReachCluster<L::Cluster>>(&self, ask: &Q, children: [&L::Cluster; 2]) -> Option<[f64; 2]> {
        let [a, b] = children.map(|c| ask.reach(c));
        odds(importance(&a), importance(&b))
    }
    /// Importances of the groups, summed up one after the other. What the top of the tree says of several kinds of light together has
    /// no meaning (one is measured in W/sr, the other in W/m^2): walks begin below it.
    fn groups<Q: ReachCluster<L::Cluster>>(&self, ask: &Q) -> Vec<f64> {
        let groups = self.tree.groups();
        if groups.len() < 2 {
            return vec![1.0; groups.len()];
        }
        let each = groups.iter().map(|g| importance(&ask.reach(self.tree.cluster(g.node))));
        let sums = each.scan(0.0, |sum, x| {
            *sum += x;
            Some(*sum)
        });
        sums.collect()
    }
    /// A walk from a group that is drawn by these sums.
    fn draw<Q: ReachCluster<L::Cluster>>(&self, sums: &[f64], u: f64, ask: &Q) -> Option<Descent> {
        let total = sums.last().copied().filter(|t| *t > 0.0)?;
        let group = sums.iter().position(|sum| u * total < *sum)?;
        let below = if group > 0 { sums[group - 1] } else { 0.0 };
        let own = (sums[group] - below) / total;
        let u = ((u - below / total) / own).clamp(0.0, BELOW_ONE);
        let d = descend(&self.tree, self.tree.groups()[group].node, u, |children| self.odds(ask, children));
        (!d.dead).then_some(Descent { probability: d.probability * own, ..d })
    }
}

impl<L: Clustered, Q: Contribute<L> + ReachCluster<L::Cluster>> LightSet<Q> for BvhLights<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let (n, groups) = (self.samples as f64, self.groups(ask));
        let mut sum = [0.0f64; 3];
        for stratum in 0..self.samples {
            let u = (stratum as f64 + s.next_f64()) / n;
            let Some(d) = self.draw(&groups, u, ask) else { continue };
            let c = ask.contribution(self.tree.light(d.node), s).to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 / (n * d.probability));
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}

impl<L: Clustered, Q: ReachCluster<L::Cluster>> Picks<Q> for BvhLights<L> {
    fn pick(&self, ask: &mut Q, s: &mut Stream) -> Option<(usize, f64)> {
        let d = self.draw(&self.groups(ask), s.next_f64(), ask)?;
        Some((self.tree.light_of(d.node), d.probability))
    }
    fn pmf(&self, ask: &mut Q, light: usize) -> f64 {
        let Some(place) = self.tree.place_of(light) else { return 0.0 };
        let (groups, sums) = (self.tree.groups(), self.groups(ask));
        let Some(total) = sums.last().copied().filter(|t| *t > 0.0) else { return 0.0 };
        // Their leaves lie one group after the other.
        let group = groups.iter().rposition(|g| self.tree.first(g.node) <= place).unwrap_or(0);
        let own = (sums[group] - if group > 0 { sums[group - 1] } else { 0.0 }) / total;
        own * probability(&self.tree, groups[group].node, place, |children| self.odds(ask, children))
    }
}
