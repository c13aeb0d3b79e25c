//! Random walks down a tree.

use crate::LightTree;
use manylight_framework::{Clustered, Reach};

/// A walk: where it is, and in the end where it ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Descent {
    /// A leaf; or, where the branch is dead, the node below which nothing can contribute.
    pub node: u32,
    pub dead: bool,
    /// Product of the probabilities on the way.
    pub probability: f64,
    /// One number of 53 bits does for the whole way: what is left of it after each turn is uniform again, so that leaves follow it
    /// from left to right.
    pub u: f64,
}

/// Below one.
pub(crate) const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

impl Descent {
    /// At its beginning; `u` in [0, 1).
    pub fn from(node: u32, u: f64) -> Self {
        Descent { node, dead: false, probability: 1.0, u }
    }
    /// Takes a child by the probabilities of both; none: the branch is dead. Says whether the walk goes on.
    fn turn(&mut self, children: [u32; 2], odds: Option<[f64; 2]>) -> bool {
        let Some([p, q]) = odds else {
            self.dead = true;
            return false;
        };
        // Strictly: an impossible child is never taken, not even for u = 0.
        (self.node, self.u, self.probability) = if self.u < p {
            (children[0], (self.u / p).min(BELOW_ONE), self.probability * p)
        } else {
            (children[1], ((self.u - p) / q).clamp(0.0, BELOW_ONE), self.probability * q)
        };
        true
    }
}

/// Walks from a node to a leaf; at each inner node `odds` are the probabilities of its two children, or `None` in a dead branch,
/// where nothing below can contribute.
pub(crate) fn descend<L: Clustered>(
    tree: &LightTree<L>,
    node: u32,
    u: f64,
    mut odds: impl FnMut([&L::Cluster; 2]) -> Option<[f64; 2]>,
) -> Descent {
    let mut walk = Descent::from(node, u);
    while let Some(children) = tree.children(walk.node)
        && walk.turn(children, odds(children.map(|c| tree.cluster(c))))
    {}
    walk
}

/// Probability with which `descend` ends at the light of this place among the leaves, which lies below the node.
pub(crate) fn probability<L: Clustered>(
    tree: &LightTree<L>,
    mut node: u32,
    place: u32,
    mut odds: impl FnMut([&L::Cluster; 2]) -> Option<[f64; 2]>,
) -> f64 {
    let mut probability = 1.0;
    while let Some(children) = tree.children(node) {
        let Some(odds) = odds(children.map(|c| tree.cluster(c))) else { return 0.0 };
        let right = tree.side(children[0], place) as usize;
        probability *= odds[right];
        node = children[right];
    }
    probability
}

/// Probabilities of two children with weights x and y; each divided by its own, since 1 - p has no digits left near 1.
pub(crate) fn odds(x: f64, y: f64) -> Option<[f64; 2]> {
    let sum = x + y;
    (sum > 0.0).then(|| [x / sum, y / sum])
}

/// Probabilities by the mean of two forms (Yuksel 2019): with g = facing x intensity,
///
/// ```text
/// p_min = g_a / near_a^2 / (g_a / near_a^2 + g_b / near_b^2)       p_max with the largest distances
/// ```
///
/// multiplied out, so that no distance of zero divides. `None`: nothing in either can contribute.
pub(crate) fn min_max(a: &Reach, b: &Reach) -> Option<[f64; 2]> {
    let g = |r: &Reach| r.facing_max as f64 * r.intensity as f64;
    let (x, y) = (g(a), g(b));
    let own = odds(x, y)?;
    let form = |a2: f32, b2: f32| odds(x * b2 as f64, y * a2 as f64).unwrap_or(own);
    let (near, far) = (form(a.near2, b.near2), form(a.far2, b.far2));
    Some([0.5 * (near[0] + far[0]), 0.5 * (near[1] + far[1])])
}

/// Squared distance of what lies at the receiver itself: no quotient of singles by it is infinite in double precision. [m^2]
const LEAST2: f64 = 1e-60;

/// What a node is drawn by: intensity x facing / distance to the centre squared, from below clamped at half the radius of the box
/// (Conty Estevez and Kulla 2018).
///
/// Where the guess of the facing is far below the largest facing it may be wrong: then a tenth of that.
pub(crate) fn importance(r: &Reach) -> f64 {
    let facing = r.facing_guess.max(0.1 * r.facing_max) as f64;
    let d2 = (r.centre2 as f64).max(0.25 * r.radius2 as f64).max(LEAST2);
    r.intensity as f64 * facing / d2
}
