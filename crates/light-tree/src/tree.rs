//! A binary tree of lights.

use crate::{TreeError, fast, greedy};
use manylight_framework::{BuildError, Clustered};
use manylight_sampling::{Purpose, Stream};
use rayon::prelude::*;

/// A node: a leaf is one light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<C> {
    pub cluster: C,
    /// The left child, the right one follows it; 0 (the root is nobody's child) in a leaf.
    pub child: u32,
    /// Place of its first light among all leaves, from left to right.
    pub first: u32,
    /// The leaf that stands for it.
    pub representative: u32,
}

/// A binary tree over lights that can be summarised. Nodes are numbered; 0 is the root, and the two children of a node are
/// neighbours. Lights are numbered as they were given.
///
/// A leaf is one light. Lights that weigh nothing, and so can give nothing, are in no leaf.
pub struct LightTree<L: Clustered> {
    nodes: Vec<Node<L::Cluster>>,
    /// The light of each leaf, from left to right.
    lights_of_leaves: Vec<u32>,
    /// The place of each light among the leaves; `u32::MAX` for those that are in none.
    places: Vec<u32>,
    groups: Vec<Group>,
    /// In the order of the leaves, where walks that end nearby find them nearby.
    lights: Vec<L>,
}

/// The largest subtree of lights of one kind (and, where asked for, of one number of edges).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Its root.
    pub node: u32,
    /// Edges of its lights, if they were kept apart by that.
    pub edges: Option<u32>,
}

/// How lights are brought together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// Halved at medians of places and directions, from the top, in parallel.
    Fast,
    /// The cheapest pair first, from the bottom (Walter et al. 2005): time goes with the square of the number of lights.
    Greedy,
}

/// Which light stands for a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Representatives {
    /// One drawn by weight, anew with each build: without bias over builds for a given cut.
    Drawn,
    /// That of the child of larger weight, the left one's where they are equal: always the same, and biased.
    Brightest,
}

/// What a tree is built by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Growth {
    /// How lights are brought together.
    pub build: Build,
    /// The least and the largest number of edges of lights that every receiver may connect to. Lights of others are kept apart by
    /// their edges, below the top: only sets in which one light stands for others need that.
    pub together: (u32, u32),
    /// Which lights stand for clusters.
    pub representatives: Representatives,
}

impl Default for Growth {
    fn default() -> Self {
        Growth { build: Build::Fast, together: Growth::ALL_DEPTHS, representatives: Representatives::Drawn }
    }
}

impl Growth {
    /// Lights of all depths share clusters.
    pub const ALL_DEPTHS: (u32, u32) = (0, u32::MAX);
    /// What lights of one group have in common: their kind, and their edges where these are kept apart.
    fn key<L: Clustered>(&self, light: &L) -> (u32, Option<u32>) {
        let (least, most) = self.together;
        let edges = light.edges();
        (light.kind(), (edges < least || edges > most).then_some(edges))
    }
}

/// Lights that a tree can hold: its nodes are counted in 32 bits.
const MOST_LIGHTS: usize = 1 << 30;

impl<L: Clustered> LightTree<L> {
    /// Builds it. The same lights and the same stream give the same tree, whatever the threads.
    pub fn new(lights: Vec<L>, growth: Growth, s: &mut Stream) -> Result<Self, BuildError> {
        if lights.len() > MOST_LIGHTS {
            return Err(BuildError::TooMany { lights: lights.len(), limit: MOST_LIGHTS });
        }
        let seed = s.next_u64();
        let mut items = Vec::with_capacity(lights.len());
        // What a BSDF makes of all directions may take long.
        let weights: Vec<f32> = lights.par_iter().map(|l| L::weight(&l.cluster())).collect();
        for (i, (l, weight)) in lights.iter().zip(weights).enumerate() {
            let finite = l.intensity().is_finite() && weight.is_finite() && l.position().is_finite();
            if !(finite && l.intensity() >= 0.0 && weight >= 0.0) {
                return Err(BuildError::NotFinite { light: i });
            }
            if weight > 0.0 {
                items.push(i as u32);
            }
        }
        items.sort_by_key(|&i| growth.key(&lights[i as usize]));
        let mut tree = LightTree {
            nodes: Vec::new(),
            lights_of_leaves: Vec::new(),
            places: vec![u32::MAX; lights.len()],
            groups: Vec::new(),
            lights,
        };
        let Some(&some) = items.first() else {
            tree.lights.clear();
            return Ok(tree);
        };
        let cluster = tree.lights[some as usize].cluster();
        tree.nodes = vec![Node { cluster, child: 0, first: 0, representative: 0 }; 2 * items.len() - 1];
        let key = |i: u32| growth.key(&tree.lights[i as usize]);
        let sizes: Vec<usize> = items.chunk_by(|a, b| key(*a) == key(*b)).map(|g| g.len()).collect();
        tree.grow_groups(&mut items, &sizes, growth);
        tree.lights = items.iter().map(|&i| tree.lights[i as usize]).collect();
        tree.lights_of_leaves = items;
        for (place, &light) in tree.lights_of_leaves.iter().enumerate() {
            tree.places[light as usize] = place as u32;
        }
        let leaves = tree.represented(growth.representatives, seed);
        tree.nodes.iter_mut().zip(leaves).for_each(|(node, leaf)| node.representative = leaf);
        Ok(tree)
    }
    /// The top of the tree is a list: a group, and the rest.
    fn grow_groups(&mut self, items: &mut [u32], sizes: &[usize], growth: Growth) {
        let (mut at, mut below, mut first) = (0u32, 1u32, 0u32);
        let mut spine = Vec::new();
        let mut rest = items;
        for (k, &size) in sizes.iter().enumerate() {
            let (group, others) = std::mem::take(&mut rest).split_at_mut(size);
            let (_, edges) = growth.key(&self.lights[group[0] as usize]);
            let root = if others.is_empty() {
                at
            } else {
                spine.push(at);
                let node = &mut self.nodes[at as usize];
                (node.child, node.first) = (below, first);
                at = below + 1;
                below += 2;
                below - 2
            };
            self.groups.push(Group { node: root, edges });
            let descendants = 2 * (size - 1);
            let (upper, lower) = self.nodes.split_at_mut(below as usize);
            let place = Place { root: &mut upper[root as usize], below: &mut lower[..descendants], base: below, first };
            match growth.build {
                Build::Greedy => greedy::grow(&self.lights, group, place),
                Build::Fast => fast::grow(&self.lights, group, place),
            }
            below += descendants as u32;
            first += size as u32;
            rest = others;
            debug_assert!(k + 1 == sizes.len() || !rest.is_empty());
        }
        for node in spine.into_iter().rev() {
            let child = self.nodes[node as usize].child as usize;
            let [a, b] = [child, child + 1].map(|c| self.nodes[c].cluster);
            self.nodes[node as usize].cluster = L::merge(&a, &b);
        }
    }
    /// The leaf that stands for each node. Children come after their parents, so that going backwards each finds its children's ready.
    pub(crate) fn represented(&self, which: Representatives, seed: u64) -> Vec<u32> {
        let mut leaves: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for i in (0..self.nodes.len()).rev() {
            let Some(children) = self.children(i as u32) else { continue };
            let [wa, wb] = children.map(|c| self.weight(c) as f64);
            let left = match which {
                Representatives::Drawn => {
                    let u = Stream::new(seed, [i as u64, 0, 0], Purpose::BUILD).next_f64();
                    u * (wa + wb) < wa
                }
                Representatives::Brightest => wa >= wb,
            };
            leaves[i] = leaves[children[!left as usize] as usize];
        }
        leaves
    }

    /// The root; `None` if there is no light.
    pub fn root(&self) -> Option<u32> {
        (!self.nodes.is_empty()).then_some(0)
    }
    /// The largest subtrees of lights of one kind: a cut.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }
    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }
    /// Is there no light?
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
    /// Both children; `None` of a leaf.
    pub fn children(&self, node: u32) -> Option<[u32; 2]> {
        let child = self.nodes[node as usize].child;
        (child != 0).then_some([child, child + 1])
    }
    /// What is known of a node's lights together.
    pub fn cluster(&self, node: u32) -> &L::Cluster {
        &self.nodes[node as usize].cluster
    }
    /// What a node's lights are weighed by.
    pub fn weight(&self, node: u32) -> f32 {
        L::weight(self.cluster(node))
    }
    /// The leaf that stands for a node.
    pub fn representative(&self, node: u32) -> u32 {
        self.nodes[node as usize].representative
    }
    /// Which light a leaf is, by its place among those that were given.
    pub fn light_of(&self, leaf: u32) -> usize {
        self.lights_of_leaves[self.place(leaf) as usize] as usize
    }
    /// The light of a leaf.
    pub fn light(&self, leaf: u32) -> &L {
        &self.lights[self.place(leaf) as usize]
    }
    /// The child of an inner node in which a light lies that lies in that node. Lights are told by their places among the leaves.
    pub(crate) fn side(&self, child: u32, place: u32) -> bool {
        place >= self.nodes[child as usize + 1].first
    }
    /// Place of a node's first leaf among the leaves, from left to right.
    pub(crate) fn first(&self, node: u32) -> u32 {
        self.nodes[node as usize].first
    }
    /// Place of a leaf among the leaves, from left to right.
    pub(crate) fn place(&self, leaf: u32) -> u32 {
        self.nodes[leaf as usize].first
    }
    /// Place of a light among the leaves; `None` if it can give nothing.
    pub(crate) fn place_of(&self, light: usize) -> Option<u32> {
        self.places.get(light).copied().filter(|p| *p != u32::MAX)
    }
    /// The lights that weigh anything, by their places among the leaves, from left to right.
    pub fn lights(&self) -> &[L] {
        &self.lights
    }
    /// Bytes of the tree, without the lights themselves.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.lights_of_leaves[..]) + size_of_val(&self.places[..])
    }
    /// Levels below the root.
    pub fn depth(&self) -> usize {
        let mut depths = vec![0usize; self.nodes.len()];
        for i in 0..self.nodes.len() {
            for c in self.children(i as u32).into_iter().flatten() {
                depths[c as usize] = depths[i] + 1;
            }
        }
        depths.into_iter().max().unwrap_or(0)
    }
    /// Checks that it is a tree: each light that weighs anything is one leaf, leaves are numbered from left to right, each node's
    /// representative is one of its leaves, and its cluster holds those of its children, as `holds(outer, inner)` sees it.
    pub fn validate(&self, holds: impl Fn(&L::Cluster, &L::Cluster) -> bool) -> Result<(), TreeError> {
        let (mut stack, mut place, mut seen) = (vec![], 0u32, 0usize);
        stack.extend(self.root());
        while let Some(node) = stack.pop() {
            seen += 1;
            let n = &self.nodes[node as usize];
            if n.first != place {
                return Err(TreeError::Order { node });
            }
            match self.children(node) {
                None => {
                    let light = self.lights_of_leaves.get(place as usize).copied().unwrap_or(u32::MAX);
                    if self.place_of(light as usize) != Some(place) || n.representative != node {
                        return Err(TreeError::Leaf { node });
                    }
                    place += 1;
                }
                Some([a, b]) => {
                    if !(a > node && (b as usize) < self.nodes.len()) {
                        return Err(TreeError::Order { node });
                    }
                    if [a, b].iter().all(|&c| self.representative(c) != n.representative) {
                        return Err(TreeError::Representative { node });
                    }
                    if ![a, b].iter().all(|&c| holds(&n.cluster, self.cluster(c))) {
                        return Err(TreeError::Cluster { node });
                    }
                    stack.extend([b, a]);
                }
            }
        }
        let leaves = self.places.iter().filter(|p| **p != u32::MAX).count();
        if seen != self.nodes.len() || place as usize != leaves || leaves != self.lights_of_leaves.len() {
            return Err(TreeError::Count { nodes: self.nodes.len(), seen });
        }
        Ok(())
    }
}

/// Where a subtree goes: its root, and the slots of all that lies below it.
pub(crate) struct Place<'t, C> {
    pub root: &'t mut Node<C>,
    /// As many as there are nodes below the root: 2 (lights - 1).
    pub below: &'t mut [Node<C>],
    /// Number of the first of these nodes.
    pub base: u32,
    /// Place of the subtree's first leaf.
    pub first: u32,
}

impl<'t, C> Place<'t, C> {
    /// Makes the root an inner node whose left subtree has `left` lights: the places of both.
    pub fn split(self, left: usize) -> (&'t mut Node<C>, Place<'t, C>, Place<'t, C>) {
        let (children, rest) = self.below.split_at_mut(2);
        let (l, r) = rest.split_at_mut(2 * (left - 1));
        let [a, b] = children else { unreachable!("two were split off") };
        let base = self.base + 2;
        (self.root.child, self.root.first) = (self.base, self.first);
        let right = Place { root: b, below: r, base: base + l.len() as u32, first: self.first + left as u32 };
        (self.root, Place { root: a, below: l, base, first: self.first }, right)
    }
    /// Makes the root a leaf.
    pub fn leaf(self, cluster: C) {
        (self.root.cluster, self.root.child, self.root.first) = (cluster, 0, self.first);
    }
}
