//! From a binary tree to one of eight children a node, at the least expected cost.
//!
//! The dynamic programme of Ylitie, Karras and Laine (2017, section 3): C(n, i) is the least cost of showing what lies under n
//! as at most i subtrees. A cost is the surface area of a box, times what its test costs.

use super::lanes::WIDTH;
use obvhs::bvh2::Bvh2;

/// Cost of a node of eight boxes, and of a block of eight triangles. Rays are as fast from 0.5 to 1.5 (measured).
const NODE: f32 = 1.0;
const BLOCK: f32 = 1.0;

/// What a child of a wide node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// Another node: this one of the binary tree.
    Inner(usize),
    /// All primitives under this one are one leaf.
    Leaf(usize),
}

/// The costs of all forests under all nodes.
pub(crate) struct Collapse<'a> {
    bvh: &'a Bvh2,
    /// C(n, 1), .. C(n, 7).
    costs: Vec<[f32; WIDTH - 1]>,
    /// Primitives under each node, and whether they are a leaf.
    primitives: Vec<u32>,
    leaf: Vec<bool>,
}

impl<'a> Collapse<'a> {
    /// `alone` tells the primitives (by their places in the tree's list) that share no leaf.
    pub fn new(bvh: &'a Bvh2, alone: impl Fn(usize) -> bool) -> Self {
        let n = bvh.nodes.len();
        let mut c = Collapse { bvh, costs: vec![[0.0; WIDTH - 1]; n], primitives: vec![0; n], leaf: vec![false; n] };
        let mut lonely = vec![false; n];
        for node in c.parents_first().into_iter().rev() {
            let b = &bvh.nodes[node];
            let area = b.aabb().half_area();
            if b.is_leaf() {
                let places = b.first_index as usize..(b.first_index + b.prim_count) as usize;
                assert!(places.len() == 1, "the builder was asked for leaves of one primitive");
                lonely[node] = alone(places.start);
                (c.primitives[node], c.leaf[node]) = (1, true);
                c.costs[node] = [area * BLOCK; WIDTH - 1];
                continue;
            }
            let (l, r) = c.children(node);
            c.primitives[node] = c.primitives[l].saturating_add(c.primitives[r]);
            lonely[node] = lonely[l] || lonely[r];
            let inner = area * NODE + c.split(node, WIDTH).0;
            let together = !lonely[node] && c.primitives[node] as usize <= WIDTH;
            c.leaf[node] = together && area * BLOCK <= inner;
            c.costs[node][0] = if c.leaf[node] { area * BLOCK } else { inner };
            for i in 2..WIDTH {
                c.costs[node][i - 1] = c.costs[node][i - 2].min(c.split(node, i).0);
            }
        }
        c
    }
    fn parents_first(&self) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.bvh.nodes.len());
        let mut todo = if self.bvh.nodes.is_empty() { vec![] } else { vec![0] };
        while let Some(node) = todo.pop() {
            order.push(node);
            if !self.bvh.nodes[node].is_leaf() {
                let (l, r) = self.children(node);
                todo.extend([l, r]);
            }
        }
        order
    }
    fn children(&self, node: usize) -> (usize, usize) {
        let first = self.bvh.nodes[node].first_index as usize;
        (first, first + 1)
    }
    /// The least cost of `most` subtrees of which the left child has k, and that k.
    fn split(&self, node: usize, most: usize) -> (f32, usize) {
        let (l, r) = self.children(node);
        let cost = |k: usize| (self.costs[l][k - 1] + self.costs[r][most - k - 1], k);
        (1..most).map(cost).min_by(|a, b| a.0.total_cmp(&b.0)).expect("`most` is at least two")
    }
    /// What the root is.
    pub fn root(&self) -> Option<Child> {
        (!self.leaf.is_empty()).then(|| self.kind(0))
    }
    fn kind(&self, node: usize) -> Child {
        if self.leaf[node] { Child::Leaf(node) } else { Child::Inner(node) }
    }
    /// The children of an inner node: two to eight.
    pub fn expand(&self, node: usize) -> Vec<Child> {
        let mut found = Vec::with_capacity(WIDTH);
        let (l, r) = self.children(node);
        let k = self.split(node, WIDTH).1;
        self.forest(l, k, &mut found);
        self.forest(r, WIDTH - k, &mut found);
        found
    }
    /// At most `most` subtrees.
    fn forest(&self, node: usize, mut most: usize, found: &mut Vec<Child>) {
        let costs = &self.costs[node];
        while most > 1 && costs[most - 1] == costs[most - 2] {
            most -= 1;
        }
        if most == 1 {
            return found.push(self.kind(node));
        }
        let (l, r) = self.children(node);
        let k = self.split(node, most).1;
        self.forest(l, k, found);
        self.forest(r, most - k, found);
    }
    /// Places in the tree's list of the primitives under a node.
    pub fn places(&self, node: usize) -> Vec<usize> {
        let (mut places, mut todo) = (Vec::with_capacity(WIDTH), vec![node]);
        while let Some(node) = todo.pop() {
            let b = &self.bvh.nodes[node];
            if b.is_leaf() {
                places.extend(b.first_index as usize..(b.first_index + b.prim_count) as usize);
            } else {
                let (l, r) = self.children(node);
                todo.extend([r, l]);
            }
        }
        places
    }
}
