//! Where walks down a tree begin.

use crate::LightTree;
use crate::descent::{BELOW_ONE, Descent, descend, importance, probability};
use manylight_framework::{Clustered, ReachCluster};

/// The groups of a tree, as a receiver sees them. What the top of the tree says of several kinds of light together has no meaning (one
/// is measured in W/sr, the other in W/m^2): walks to a light begin below it, in a group that is drawn by its importance.
pub(crate) struct Starts<'a, L: Clustered> {
    tree: &'a LightTree<L>,
    /// Importances, summed up one after the other.
    sums: Vec<f64>,
}

impl<'a, L: Clustered> Starts<'a, L> {
    pub fn new<Q: ReachCluster<L::Cluster>>(tree: &'a LightTree<L>, ask: &Q) -> Self {
        let groups = tree.groups();
        if groups.len() < 2 {
            return Starts { tree, sums: vec![1.0; groups.len()] };
        }
        let mut sum = 0.0;
        let each = groups.iter().map(|g| {
            sum += importance(&ask.reach(tree.cluster(g.node)));
            sum
        });
        Starts { tree, sums: each.collect() }
    }
    /// Probability of a group.
    fn own(&self, group: usize) -> Option<f64> {
        let total = self.sums.last().copied().filter(|t| *t > 0.0)?;
        let below = if group > 0 { self.sums[group - 1] } else { 0.0 };
        Some((self.sums[group] - below) / total)
    }
    /// A walk; `odds` as for `descend`. `None`: nothing can contribute where it ended.
    pub fn draw(&self, u: f64, odds: impl FnMut([&L::Cluster; 2]) -> Option<[f64; 2]>) -> Option<Descent> {
        let total = self.sums.last().copied().filter(|t| *t > 0.0)?;
        let group = self.sums.iter().position(|sum| u * total < *sum)?;
        let (own, below) = (self.own(group)?, if group > 0 { self.sums[group - 1] } else { 0.0 });
        let u = ((u - below / total) / own).clamp(0.0, BELOW_ONE);
        let d = descend(self.tree, self.tree.groups()[group].node, u, odds);
        (!d.dead).then_some(Descent { probability: d.probability * own, ..d })
    }
    /// Probability with which `draw` ends at a light, by its number among those given.
    pub fn probability(&self, light: usize, odds: impl FnMut([&L::Cluster; 2]) -> Option<[f64; 2]>) -> f64 {
        let Some(place) = self.tree.place_of(light) else { return 0.0 };
        // Their leaves lie one group after the other.
        let groups = self.tree.groups();
        let group = groups.iter().rposition(|g| self.tree.first(g.node) <= place).unwrap_or(0);
        let Some(own) = self.own(group) else { return 0.0 };
        own * probability(self.tree, groups[group].node, place, odds)
    }
}
