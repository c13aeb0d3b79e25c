//! A tree of eight children a node, and rays through it.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod collapse;
mod lanes;
mod traverse;
mod tree;

use lanes::{Lanes, Portable, Task};
use manylight_math::Ray;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use traverse::{Deep, NewStack, SHALLOW, Shallow};
pub(crate) use traverse::{Met, Rounds};
pub(crate) use tree::Solid;
use tree::Tree;

/// Which vector unit traces rays. What they meet is the same, bit for bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Simd {
    /// The best that the processor has.
    #[default]
    Auto,
    /// None: what the compiler makes of arrays.
    Portable,
}

#[derive(Clone, Copy, Debug)]
enum Unit {
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    Portable,
}

impl Unit {
    fn of(simd: Simd) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let (Simd::Auto, Some(unit)) = (simd, avx2::Avx2::detect()) {
            return Unit::Avx2(unit);
        }
        let _ = simd;
        Unit::Portable
    }
    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Unit::Avx2(unit) => unit.run(task),
            Unit::Portable => Portable.run(task),
        }
    }
}

/// The tree, and who walks it.
#[derive(Debug)]
pub(crate) struct Wide {
    tree: Tree,
    unit: Unit,
}

impl Boundable for Solid {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        let b = self.bounds();
        obvhs::aabb::Aabb::new(b.lo.into(), b.hi.into())
    }
}

impl Wide {
    /// Primitives that a tree can hold.
    pub const MOST: usize = Tree::MOST;

    pub fn build(solids: &[Solid]) -> Self {
        // Leaves are made when the tree is collapsed.
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let bvh = build_bvh2(solids, parameters, &mut std::time::Duration::default());
        Wide { tree: Tree::new(solids, &bvh), unit: Unit::of(Simd::Auto) }
    }
    pub fn set_simd(&mut self, simd: Simd) {
        self.unit = Unit::of(simd);
    }
    /// \[byte\]
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
    }
    /// The first thing that is wrong with the tree.
    pub fn validate(&self, solids: &[Solid]) -> Result<(), String> {
        self.tree.validate(solids)
    }
    /// The nearest hit in (0, t_max) that `keep` lets count. A ray that is not finite meets nothing.
    #[inline]
    pub fn closest(&self, ray: &Ray, round: impl Rounds, keep: impl FnMut(&Met) -> bool) -> Option<Met> {
        if !is_finite(ray) {
            return None;
        }
        let tree = &self.tree;
        if tree.waiting <= SHALLOW {
            self.unit.run(Closest { tree, ray, stack: Shallow, round, keep })
        } else {
            self.unit.run(Closest { tree, ray, stack: Deep, round, keep })
        }
    }
    /// Is there a hit in (0, t_max) that `keep` lets count?
    #[inline]
    pub fn any(&self, ray: &Ray, round: impl Rounds, keep: impl FnMut(&Met) -> bool) -> bool {
        if !is_finite(ray) {
            return false;
        }
        let tree = &self.tree;
        if tree.waiting <= SHALLOW {
            self.unit.run(Any { tree, ray, stack: Shallow, round, keep })
        } else {
            self.unit.run(Any { tree, ray, stack: Deep, round, keep })
        }
    }
}

fn is_finite(ray: &Ray) -> bool {
    ray.origin.is_finite() && ray.dir.is_finite()
}

struct Closest<'a, S, R, K> {
    tree: &'a Tree,
    ray: &'a Ray,
    stack: S,
    round: R,
    keep: K,
}
impl<S: NewStack, R: Rounds, K: FnMut(&Met) -> bool> Task for Closest<'_, S, R, K> {
    type Output = Option<Met>;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Option<Met> {
        self.tree.closest(l, self.ray, &mut self.stack.new(), self.round, self.keep)
    }
}

struct Any<'a, S, R, K> {
    tree: &'a Tree,
    ray: &'a Ray,
    stack: S,
    round: R,
    keep: K,
}
impl<S: NewStack, R: Rounds, K: FnMut(&Met) -> bool> Task for Any<'_, S, R, K> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        self.tree.any(l, self.ray, &mut self.stack.new(), self.round, self.keep)
    }
}
