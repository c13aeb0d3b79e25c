//! Nodes of eight children, and triangles in blocks of eight.

use super::collapse::{Child, Collapse};
use super::lanes::WIDTH;
use manylight_math::{Aabb, Vec3};
use obvhs::bvh2::Bvh2;

/// What a primitive is to the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solid {
    /// Three corners.
    Triangle([Vec3; 3]),
    /// Something in a box, tested by who knows it.
    Round(Aabb),
}

impl Solid {
    pub fn bounds(&self) -> Aabb {
        match self {
            Solid::Triangle(corners) => Aabb::around(*corners),
            Solid::Round(bounds) => *bounds,
        }
    }
}

/// Eight boxes side by side. Absent ones are empty (from +inf to -inf): nothing meets them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Least x, y, z, then largest x, y, z. \[m\]
    pub planes: [[f32; WIDTH]; 6],
    /// See `Tree::LEAF`. Larger boxes come first.
    pub children: [u32; WIDTH],
}

/// Up to eight triangles side by side. Absent ones are NaN: nothing meets them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Block {
    /// Corner, axis, triangle. \[m\]
    pub corners: [[[f32; WIDTH]; 3]; 3],
    /// Which primitives they are.
    pub ids: [u32; WIDTH],
}

/// A tree over primitives, which it names by their places in the list it was built from.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    /// The root first; none if there is nothing, or nothing but one leaf's worth: then the root has one child.
    pub nodes: Vec<Node>,
    pub blocks: Vec<Block>,
    /// Largest magnitude of a coordinate. \[m\]
    pub largest: f32,
    /// Children that can wait on the way down.
    pub waiting: usize,
}

impl Tree {
    /// Marks a child that is a leaf: the rest of its number is that of a block, or with `ROUND` that of a primitive.
    pub const LEAF: u32 = 1 << 31;
    /// Marks a leaf that is one round primitive.
    pub const ROUND: u32 = 1 << 30;
    /// Primitives that a tree can name: one less, since a round one of the last number would be named as an absent child is.
    pub const MOST: usize = (1 << 30) - 1;

    /// Of primitives of finite coordinates, at most `MOST`, and the binary tree over them, of one a leaf.
    pub fn new(solids: &[Solid], bvh: &Bvh2) -> Self {
        let id = |place: usize| bvh.primitive_indices[place] as usize;
        let collapse = Collapse::new(bvh, |place| matches!(solids[id(place)], Solid::Round(_)));
        let mut tree = Tree { largest: largest(solids), ..Tree::default() };
        // What is yet to be made, and where.
        let mut todo = Vec::new();
        match collapse.root() {
            None => return tree,
            Some(Child::Inner(n)) => todo.push((collapse.expand(n), 0)),
            Some(leaf) => todo.push((vec![leaf], 0)),
        }
        tree.nodes.push(Node::EMPTY);
        while let Some((mut children, at)) = todo.pop() {
            let (Child::Inner(n) | Child::Leaf(n)) = children[0];
            let area = |c: &Child| {
                let (Child::Inner(n) | Child::Leaf(n)) = *c;
                bvh.nodes[n].aabb().half_area()
            };
            debug_assert!(n < bvh.nodes.len() && children.len() <= WIDTH);
            children.sort_by(|a, b| area(b).total_cmp(&area(a)));
            for (k, child) in children.into_iter().enumerate() {
                let (bounds, name) = match child {
                    Child::Inner(n) => {
                        let name = tree.nodes.len();
                        tree.nodes.push(Node::EMPTY);
                        todo.push((collapse.expand(n), name));
                        let b = bvh.nodes[n].aabb();
                        (Aabb { lo: b.min.into(), hi: b.max.into() }, name as u32)
                    }
                    Child::Leaf(n) => {
                        let ids: Vec<usize> = collapse.places(n).into_iter().map(id).collect();
                        let bounds = ids.iter().fold(Aabb::EMPTY, |b, i| b.join(&solids[*i].bounds()));
                        (bounds, tree.leaf(&ids, solids))
                    }
                };
                tree.nodes[at].set(k, &bounds, name);
            }
        }
        tree.waiting = tree.count_waiting();
        tree
    }
    fn leaf(&mut self, ids: &[usize], solids: &[Solid]) -> u32 {
        if let Solid::Round(_) = solids[ids[0]] {
            return Self::LEAF | Self::ROUND | ids[0] as u32;
        }
        let mut block = Block { corners: [[[f32::NAN; WIDTH]; 3]; 3], ids: [u32::MAX; WIDTH] };
        for (lane, &id) in ids.iter().enumerate() {
            let Solid::Triangle(corners) = solids[id] else { continue };
            block.ids[lane] = id as u32;
            for (corner, p) in corners.iter().enumerate() {
                (0..3).for_each(|axis| block.corners[corner][axis][lane] = p[axis]);
            }
        }
        self.blocks.push(block);
        Self::LEAF | (self.blocks.len() - 1) as u32
    }
    /// Nodes come after their parents, so that this walks backwards.
    fn count_waiting(&self) -> usize {
        let mut most = vec![0; self.nodes.len()];
        for (n, node) in self.nodes.iter().enumerate().rev() {
            let below = node.inner().map(|c| most[c]).max().unwrap_or(0);
            most[n] = below + node.count() - 1;
        }
        most.first().copied().unwrap_or(0)
    }
    /// \[byte\]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.blocks.len() * size_of::<Block>()
    }
    /// Does every primitive lie in one leaf, in all boxes above it, and is every number in range? The first thing wrong, if not.
    pub fn validate(&self, solids: &[Solid]) -> Result<(), String> {
        let mut seen = vec![false; solids.len()];
        let mut reached = vec![false; self.nodes.len()];
        let everything = Aabb { lo: Vec3::NEG_INFINITY, hi: Vec3::INFINITY };
        let mut todo = if self.nodes.is_empty() { vec![] } else { vec![(0, everything, 0)] };
        while let Some((n, outer, waiting)) = todo.pop() {
            let node = self.nodes.get(n).ok_or(format!("node {n} is not there"))?;
            if std::mem::replace(&mut reached[n], true) {
                return Err(format!("node {n} has two parents"));
            }
            let waiting = waiting + node.count() - 1;
            if waiting > self.waiting {
                return Err(format!("{waiting} children wait at node {n}, of {} that may", self.waiting));
            }
            for k in 0..node.count() {
                let (bounds, child) = (node.bounds(k), node.children[k]);
                if !contains(&outer, &bounds) {
                    return Err(format!("child {k} of node {n} lies outside its parent's box"));
                }
                if child & Self::LEAF == 0 {
                    todo.push((child as usize, bounds, waiting));
                    continue;
                }
                let ids = if child & Self::ROUND != 0 {
                    vec![child & !(Self::LEAF | Self::ROUND)]
                } else {
                    let block = self.blocks.get((child & !Self::LEAF) as usize).ok_or("a block is not there")?;
                    block.ids.iter().copied().filter(|id| *id != u32::MAX).collect()
                };
                for id in ids {
                    let solid = solids.get(id as usize).ok_or(format!("primitive {id} is not there"))?;
                    if std::mem::replace(&mut seen[id as usize], true) {
                        return Err(format!("primitive {id} lies in two leaves"));
                    }
                    if !contains(&bounds, &solid.bounds()) {
                        return Err(format!("primitive {id} lies outside its leaf's box"));
                    }
                }
            }
        }
        match seen.iter().position(|s| !s) {
            Some(id) => Err(format!("primitive {id} lies in no leaf")),
            None => Ok(()),
        }
    }
}

impl Node {
    const EMPTY: Node = {
        let (lo, hi) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Node { planes: [lo, lo, lo, hi, hi, hi], children: [u32::MAX; WIDTH] }
    };
    fn set(&mut self, k: usize, bounds: &Aabb, child: u32) {
        for axis in 0..3 {
            self.planes[axis][k] = bounds.lo[axis];
            self.planes[axis + 3][k] = bounds.hi[axis];
        }
        self.children[k] = child;
    }
    fn bounds(&self, k: usize) -> Aabb {
        let p = &self.planes;
        Aabb { lo: Vec3::new(p[0][k], p[1][k], p[2][k]), hi: Vec3::new(p[3][k], p[4][k], p[5][k]) }
    }
    fn count(&self) -> usize {
        self.children.iter().filter(|c| **c != u32::MAX).count()
    }
    fn inner(&self) -> impl Iterator<Item = usize> {
        self.children.iter().filter(|c| **c & Tree::LEAF == 0).map(|c| *c as usize)
    }
}

fn contains(outer: &Aabb, inner: &Aabb) -> bool {
    outer.lo.cmple(inner.lo).all() && outer.hi.cmpge(inner.hi).all()
}

fn largest(solids: &[Solid]) -> f32 {
    solids.iter().fold(0.0, |m: f32, s| {
        let b = s.bounds();
        m.max(b.lo.abs().max(b.hi.abs()).max_element())
    })
}
