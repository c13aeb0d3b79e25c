//! Many rays through the tree together, to ask which of them meet anything.
//!
//! All rays that enter a box wait for it together: a node is read once for all of them, and their tests, which do not depend on
//! each other, overlap in the processor, where a single ray waits at each step for the one before (in the manner of
//! Barringer and Akenine-Moeller 2014). Each ray does the same tests as alone, so that the answers are the same.

use super::lanes::Lanes;
use super::traverse::{AxialRay, BoxRay, Shear, Spread, WIDER, block};
use super::tree::Tree;
use manylight_math::Ray;

/// Rays that go together.
pub(crate) const STREAM: usize = 64;

/// A ray, ready for all tests.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ready {
    boxes: BoxRay,
    triangles: AxialRay,
    t_max: f32,
}

impl Ready {
    #[inline(always)]
    pub fn new(ray: &Ray, largest: f32) -> Self {
        Ready { boxes: BoxRay::new(ray, largest), triangles: AxialRay::new(ray), t_max: ray.t_max }
    }
}

/// Rays that wait for a child.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting {
    child: u32,
    /// The node that it is a child of.
    parent: u32,
    rays: [u32; 2],
}

/// Tests round primitives: (ray, id, limit) to the first distance in (0, limit).
pub(crate) trait RoundsOf: Fn(usize, u32, f32) -> Option<f32> {}
impl<T: Fn(usize, u32, f32) -> Option<f32>> RoundsOf for T {}

#[inline(always)]
fn without(rays: [u32; 2], r: usize) -> [u32; 2] {
    let mut rest = rays;
    rest[r >> 5] &= !(1 << (r & 31));
    rest
}

impl Tree {
    /// Which of up to 64 rays (those in `asked`, a bit each) meet anything in (0, t_max); `stopped` is told where.
    #[inline(always)]
    pub fn any_of<L: Lanes>(
        &self,
        l: L,
        rays: &[Ready],
        asked: u64,
        stack: &mut Vec<Waiting>,
        round: impl RoundsOf,
        mut stopped: impl FnMut(usize, u32),
    ) -> u64 {
        let mut alive = [asked as u32, (asked >> 32) as u32];
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push(Waiting { child: 0, parent: 0, rays: alive });
        }
        while let Some(w) = stack.pop() {
            let here = [w.rays[0] & alive[0], w.rays[1] & alive[1]];
            if here == [0; 2] {
                continue;
            }
            if w.child & Tree::LEAF == 0 {
                let node = &self.nodes[w.child as usize];
                let mut under = [[0; 8]; 2];
                for (half, mut left) in here.into_iter().enumerate() {
                    if left == 0 {
                        continue;
                    }
                    let mut sets = l.no_sets();
                    while left != 0 {
                        let r = left.trailing_zeros();
                        left &= left - 1;
                        let ray = &rays[half * 32 + r as usize];
                        let entered = Spread::new(l, &ray.boxes).boxes(l, node, l.splat(ray.t_max * WIDER)).1;
                        sets = l.put(sets, entered, 1 << r);
                    }
                    under[half] = l.sets(sets);
                }
                // The largest box is first on the stack's top.
                for k in (0..8).rev() {
                    let rays = [under[0][k], under[1][k]];
                    if rays != [0; 2] {
                        stack.push(Waiting { child: node.children[k], parent: w.child, rays });
                    }
                }
            } else if w.child & Tree::ROUND == 0 {
                let b = &self.blocks[(w.child & !Tree::LEAF) as usize];
                for (half, mut left) in here.into_iter().enumerate() {
                    while left != 0 {
                        let r = half * 32 + left.trailing_zeros() as usize;
                        left &= left - 1;
                        let ray = &rays[r];
                        let end = l.splat(ray.t_max);
                        if let Some(f) = block(l, b, &Shear::new(l, &ray.triangles), end)
                            && f.lanes & l.bits(l.lt(f.t, end)) != 0
                        {
                            alive = without(alive, r);
                            stopped(r, w.parent);
                        }
                    }
                }
            } else {
                let id = w.child & !(Tree::LEAF | Tree::ROUND);
                for (half, mut left) in here.into_iter().enumerate() {
                    while left != 0 {
                        let r = half * 32 + left.trailing_zeros() as usize;
                        left &= left - 1;
                        if round(r, id, rays[r].t_max).is_some() {
                            alive = without(alive, r);
                            stopped(r, w.parent);
                        }
                    }
                }
            }
        }
        asked & !(alive[0] as u64 | (alive[1] as u64) << 32)
    }

    /// Does a ray meet anything that lies in a leaf right under a node? If so it meets something in the tree: it enters all boxes above.
    #[inline(always)]
    pub fn stops_at<L: Lanes>(&self, l: L, ray: &Ready, node: u32, round: impl Fn(u32, f32) -> Option<f32>) -> bool {
        let Some(node) = self.nodes.get(node as usize) else { return false };
        let end = l.splat(ray.t_max);
        let mut entered = l.bits(Spread::new(l, &ray.boxes).boxes(l, node, l.splat(ray.t_max * WIDER)).1);
        while entered != 0 {
            let child = node.children[entered.trailing_zeros() as usize & 7];
            entered &= entered - 1;
            if child & Tree::LEAF == 0 {
                continue;
            }
            if child & Tree::ROUND != 0 {
                if round(child & !(Tree::LEAF | Tree::ROUND), ray.t_max).is_some() {
                    return true;
                }
            } else if let Some(f) =
                block(l, &self.blocks[(child & !Tree::LEAF) as usize], &Shear::new(l, &ray.triangles), end)
                && f.lanes & l.bits(l.lt(f.t, end)) != 0
            {
                return true;
            }
        }
        false
    }
}
