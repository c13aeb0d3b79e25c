//! A tree of eight children a node, and rays through it.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod collapse;
mod lanes;
mod stream;
mod traverse;
mod tree;

use lanes::{Lanes, Portable, Task};
use manylight_math::{Ray, Vec3};
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use traverse::{Deep, MakeStack, SHALLOW, Shallow};
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

/// What stopped rays, to be tried first the next time: a slot of it is meant for rays that end at the same place. What it
/// holds changes no answer, only how soon it is found.
#[derive(Clone, Debug, Default)]
pub struct Occluders {
    /// A node for each slot, or `NONE`.
    nodes: Vec<u32>,
    waiting: Vec<stream::Waiting>,
    ready: Vec<stream::Ready>,
}

impl Occluders {
    const SLOTS: usize = 1 << 12;
    const NONE: u32 = u32::MAX;

    /// Nothing stopped any ray yet.
    pub fn new() -> Self {
        Self::default()
    }
    fn slot(p: Vec3) -> usize {
        let mix = |h: u32, x: f32| (h ^ x.to_bits()).wrapping_mul(0x9e37_79b1).rotate_left(15);
        (mix(mix(mix(0, p.x), p.y), p.z).wrapping_mul(0x85eb_ca6b) >> 20) as usize
    }
}

impl Wide {
    /// Which of up to 64 rays meet anything in (0, t_max), a bit for each; `shared` is the end of each that others share.
    pub fn any_of(
        &self,
        rays: &[Ray],
        shared: &[Vec3],
        occluders: &mut Occluders,
        round: impl stream::RoundsOf,
    ) -> u64 {
        self.unit.run(AnyOf { tree: &self.tree, rays, shared, occluders, round })
    }
}

struct AnyOf<'a, R> {
    tree: &'a Tree,
    rays: &'a [Ray],
    shared: &'a [Vec3],
    occluders: &'a mut Occluders,
    round: R,
}
impl<R: stream::RoundsOf> Task for AnyOf<'_, R> {
    type Output = u64;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> u64 {
        let AnyOf { tree, rays, shared, occluders: Occluders { nodes, waiting, ready }, round } = self;
        nodes.resize(Occluders::SLOTS, Occluders::NONE);
        ready.clear();
        let (mut stopped, mut asked) = (0u64, 0u64);
        for (r, ray) in rays.iter().enumerate().take(stream::STREAM) {
            let this = stream::Ready::new(ray, tree.largest);
            ready.push(this);
            if !is_finite(ray) {
                continue;
            }
            let node = nodes[Occluders::slot(shared[r])];
            let again = node != Occluders::NONE && tree.stops_at(l, &this, node, |id, limit| round(r, id, limit));
            stopped |= (again as u64) << r;
            asked |= (!again as u64) << r;
        }
        let mut found = 0;
        if asked != 0 {
            found = tree.any_of(l, ready, asked, waiting, round, |r, node| nodes[Occluders::slot(shared[r])] = node);
            let mut free = asked & !found;
            while free != 0 {
                nodes[Occluders::slot(shared[free.trailing_zeros() as usize])] = Occluders::NONE;
                free &= free - 1;
            }
        }
        stopped | found
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
impl<S: MakeStack, R: Rounds, K: FnMut(&Met) -> bool> Task for Closest<'_, S, R, K> {
    type Output = Option<Met>;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Option<Met> {
        self.tree.closest(l, self.ray, &mut self.stack.make(), self.round, self.keep)
    }
}

struct Any<'a, S, R, K> {
    tree: &'a Tree,
    ray: &'a Ray,
    stack: S,
    round: R,
    keep: K,
}
impl<S: MakeStack, R: Rounds, K: FnMut(&Met) -> bool> Task for Any<'_, S, R, K> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> bool {
        self.tree.any(l, self.ray, &mut self.stack.make(), self.round, self.keep)
    }
}
