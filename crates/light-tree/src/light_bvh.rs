//! Importance sampling of many lights by a light BVH.

use crate::descent::{importance, odds};
use crate::starts::Starts;
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
}

impl<L: Clustered, Q: Contribute<L> + ReachCluster<L::Cluster>> LightSet<Q> for BvhLights<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let (n, starts) = (self.samples as f64, Starts::new(&self.tree, ask));
        let mut sum = [0.0f64; 3];
        for stratum in 0..self.samples {
            let u = (stratum as f64 + s.next_f64()) / n;
            let Some(d) = starts.draw(u, |children| self.odds(ask, children)) else { continue };
            let c = ask.contribution(self.tree.light(d.node), s).to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 / (n * d.probability));
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}

impl<L: Clustered, Q: ReachCluster<L::Cluster>> Picks<Q> for BvhLights<L> {
    fn pick(&self, ask: &mut Q, s: &mut Stream) -> Option<(usize, f64)> {
        let d = Starts::new(&self.tree, ask).draw(s.next_f64(), |children| self.odds(ask, children))?;
        Some((self.tree.light_of(d.node), d.probability))
    }
    fn pmf(&self, ask: &mut Q, light: usize) -> f64 {
        Starts::new(&self.tree, ask).probability(light, |children| self.odds(ask, children))
    }
}
