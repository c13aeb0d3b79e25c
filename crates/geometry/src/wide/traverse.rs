//! One ray through the tree.
//!
//! What is met is a property of the ray and the primitives alone: a primitive is hit if its leaf's box and its own test say
//! so, and of those hits the nearest counts, of equally near ones that of the least id. A box that a ray enters lies in boxes
//! that it enters too, in floating point as well, since each step of the test is monotone. So neither the order of children nor
//! the shape of the tree decides anything. (But for one thing: a triangle seen edge-on may be met before its box is.)

use super::lanes::{Lanes, WIDTH};
use super::tree::{Block, Node, Tree};
use crate::triangle::ShearedRay;
use arrayvec::ArrayVec;
use manylight_math::{DVec3, Ray, Vec3};

/// A hit: distance \[m\], primitive, barycentrics of the second and third vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Met {
    pub t: f32,
    pub id: u32,
    pub b1: f32,
    pub b2: f32,
}

/// Who tests round primitives: (id, limit) to the first distance in (0, limit).
pub(crate) trait Rounds: Fn(u32, f32) -> Option<f32> {}
impl<T: Fn(u32, f32) -> Option<f32>> Rounds for T {}

/// A ray against boxes: t = (plane - origin) / dir, with origins moved so far that a hit of the triangle test, which rounds
/// too, is never lost.
///
/// The triangle test is exact on corners that it moved by at most 5 u (|x| + |z|) across the ray, u = 2^-24, with x and z
/// relative to the origin and so below |o| + L for a scene whose coordinates are below L. Planes are moved by 12 u (|o| + L),
/// which leaves room for the rounding of the move. Each distance is then off by 3 u at most, relatively (Ize 2013).
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxRay {
    near: Vec3,
    far: Vec3,
    inverse: Vec3,
    /// Which planes are near: rows of a node.
    rows: [usize; 3],
}

const U: f32 = 0.5 * f32::EPSILON;
/// Widens the far distance, against 3 u in each of two.
pub(crate) const WIDER: f32 = 1.0 + 8.0 * U;
/// Smaller components of a direction move a ray less than its margin, over the whole scene.
const LEAST: f32 = 1e-18;

impl BoxRay {
    #[inline(always)]
    pub fn new(ray: &Ray, largest: f32) -> Self {
        let margin = 12.0 * U * (ray.origin.abs().max_element() + largest);
        let inverse = ray.dir.map(|d| if d.abs() < LEAST { (1.0 / LEAST).copysign(d) } else { 1.0 / d });
        let shift = Vec3::splat(margin).copysign(inverse);
        let rows = std::array::from_fn(|k| if inverse[k] < 0.0 { k + 3 } else { k });
        BoxRay { near: ray.origin + shift, far: ray.origin - shift, inverse, rows }
    }
}

/// A ray against boxes, spread over the lanes.
#[derive(Clone, Copy)]
pub(crate) struct Spread<L: Lanes> {
    near: [L::F; 3],
    far: [L::F; 3],
    inverse: [L::F; 3],
    rows: [usize; 3],
    wider: L::F,
    zero: L::F,
}

// No closures on lanes: the compiler may leave them out of line, and compile them for any processor.

impl<L: Lanes> Spread<L> {
    #[inline(always)]
    pub fn new(l: L, r: &BoxRay) -> Self {
        Spread {
            near: [l.splat(r.near.x), l.splat(r.near.y), l.splat(r.near.z)],
            far: [l.splat(r.far.x), l.splat(r.far.y), l.splat(r.far.z)],
            inverse: [l.splat(r.inverse.x), l.splat(r.inverse.y), l.splat(r.inverse.z)],
            rows: r.rows,
            wider: l.splat(WIDER),
            zero: l.splat(0.0),
        }
    }
    #[inline(always)]
    fn near(&self, l: L, node: &Node, k: usize) -> L::F {
        l.mul(l.sub(l.load(&node.planes[self.rows[k]]), self.near[k]), self.inverse[k])
    }
    #[inline(always)]
    fn far(&self, l: L, node: &Node, k: usize) -> L::F {
        // The other one of k and k + 3.
        l.mul(l.sub(l.load(&node.planes[2 * k + 3 - self.rows[k]]), self.far[k]), self.inverse[k])
    }
    /// Where the ray enters the eight boxes, not below zero, and which it enters before `limit`. \[m\]
    #[inline(always)]
    pub fn boxes(&self, l: L, node: &Node, limit: L::F) -> (L::F, L::M) {
        let near = (self.near(l, node, 0), self.near(l, node, 1), self.near(l, node, 2));
        let far = (self.far(l, node, 0), self.far(l, node, 1), self.far(l, node, 2));
        let from = l.max(l.max(near.0, near.1), l.max(near.2, self.zero));
        let to = l.min(l.mul(l.min(l.min(far.0, far.1), far.2), self.wider), limit);
        (from, l.le(from, to))
    }
}

/// What the triangle test found in a block.
pub(crate) struct Found<L: Lanes> {
    pub lanes: u32,
    pub t: L::F,
    /// Times the determinant.
    v: L::F,
    w: L::F,
    determinant: L::F,
}

/// A corner of eight triangles, with the ray as the z axis.
#[derive(Clone, Copy)]
struct Sheared<L: Lanes> {
    x: L::F,
    y: L::F,
    z: L::F,
}

/// A ray against triangles: origin and shear along its own axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxialRay {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 3],
}

impl AxialRay {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let ShearedRay { axes, origin, shear } = ShearedRay::new(ray);
        let o = origin.to_array();
        AxialRay { axes, origin: [o[axes[0]], o[axes[1]], o[axes[2]]], shear: shear.to_array() }
    }
}

/// The same, spread over the lanes.
pub(crate) struct Shear<L: Lanes> {
    axes: [usize; 3],
    origin: [L::F; 3],
    shear: [L::F; 3],
    zero: L::F,
}

impl<L: Lanes> Shear<L> {
    #[inline(always)]
    pub fn new(l: L, r: &AxialRay) -> Self {
        Shear {
            axes: r.axes,
            origin: [l.splat(r.origin[0]), l.splat(r.origin[1]), l.splat(r.origin[2])],
            shear: [l.splat(r.shear[0]), l.splat(r.shear[1]), l.splat(r.shear[2])],
            zero: l.splat(0.0),
        }
    }
    #[inline(always)]
    fn corner(&self, l: L, corner: &[[f32; WIDTH]; 3]) -> Sheared<L> {
        let z = l.sub(l.load(&corner[self.axes[2]]), self.origin[2]);
        let x = l.sub(l.sub(l.load(&corner[self.axes[0]]), self.origin[0]), l.mul(self.shear[0], z));
        let y = l.sub(l.sub(l.load(&corner[self.axes[1]]), self.origin[1]), l.mul(self.shear[1], z));
        Sheared { x, y, z }
    }
    /// Up to what distance a hit may in truth be behind the ray: a bound on its rounding error, for corners relative to the origin and
    /// edge functions u, v, w (Pharr, Jakob and Humphreys 2016, section 3.9.6). A sliver tells distances badly, and a ray that leaves
    /// one beside it must not meet it.
    #[inline(always)]
    fn doubt(&self, l: L, corners: [&Sheared<L>; 3], [u, v, w]: [L::F; 3], determinant: L::F) -> L::F {
        let [a, b, c] = corners;
        let scale = self.size(l, self.shear[2], self.shear[2], self.shear[2]);
        let (x, y) = (self.size(l, a.x, b.x, c.x), self.size(l, a.y, b.y, c.y));
        let (z, e) = (l.mul(self.size(l, a.z, b.z, c.z), scale), self.size(l, u, v, w));
        let (gamma2, gamma3, gamma5) = (l.splat(gamma(2)), l.splat(gamma(3)), l.splat(gamma(5)));
        let dz = l.mul(gamma3, z);
        let (dx, dy) = (l.mul(gamma5, l.add(x, z)), l.mul(gamma5, l.add(y, z)));
        let de = l.add(l.mul(gamma2, l.mul(x, y)), l.add(l.mul(dy, x), l.mul(dx, y)));
        let de = l.add(de, de);
        let sum = l.add(l.mul(gamma3, l.mul(e, z)), l.add(l.mul(de, z), l.mul(dz, e)));
        let d = self.size(l, determinant, determinant, determinant);
        l.div(l.mul(l.splat(3.0), sum), d)
    }
    /// The largest magnitude of three.
    #[inline(always)]
    fn size(&self, l: L, a: L::F, b: L::F, c: L::F) -> L::F {
        let (least, most) = (l.min(l.min(a, b), c), l.max(l.max(a, b), c));
        l.max(most, l.sub(self.zero, least))
    }
}

/// Bound on the relative error of n roundings.
const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * U;
    nu / (1.0 - nu)
}

#[inline(always)]
fn cross<L: Lanes>(l: L, p: &Sheared<L>, q: &Sheared<L>) -> L::F {
    l.sub(l.mul(p.x, q.y), l.mul(p.y, q.x))
}

/// Lanes where some are negative and some positive.
#[inline(always)]
fn mixed<L: Lanes>(l: L, u: L::F, v: L::F, w: L::F, zero: L::F) -> u32 {
    let (least, most) = (l.min(l.min(u, v), w), l.max(l.max(u, v), w));
    l.bits(l.and(l.lt(least, zero), l.lt(zero, most)))
}

/// The test of `ShearedRay::intersect`, operation by operation, on eight triangles: hits in (0, limit], limit included, but for those
/// that lie behind the ray in truth.
#[inline(always)]
pub(crate) fn block<L: Lanes>(l: L, block: &Block, ray: &Shear<L>, limit: L::F) -> Option<Found<L>> {
    let a = ray.corner(l, &block.corners[0]);
    let b = ray.corner(l, &block.corners[1]);
    let c = ray.corner(l, &block.corners[2]);
    let zero = ray.zero;
    let (mut u, mut v, mut w) = (cross(l, &c, &b), cross(l, &a, &c), cross(l, &b, &a));
    let mut lanes = !mixed(l, u, v, w, zero) & 0xff;
    if lanes == 0 {
        return None;
    }
    let on_edge = l.bits(l.or(l.or(l.eq(u, zero), l.eq(v, zero)), l.eq(w, zero))) & lanes;
    if on_edge != 0 {
        let corners = [[l.store(a.x), l.store(a.y)], [l.store(b.x), l.store(b.y)], [l.store(c.x), l.store(c.y)]];
        let [fu, fv, fw] = exactly(&corners, on_edge, [l.store(u), l.store(v), l.store(w)]);
        (u, v, w) = (l.load(&fu), l.load(&fv), l.load(&fw));
        lanes &= !mixed(l, u, v, w, zero);
    }
    let determinant = l.add(l.add(u, v), w);
    let depth = l.add(l.add(l.mul(u, a.z), l.mul(v, b.z)), l.mul(w, c.z));
    let t = l.div(l.mul(ray.shear[2], depth), determinant);
    // NaN (a triangle without area, or none) fails both comparisons.
    lanes &= l.bits(l.and(l.lt(zero, t), l.le(t, limit)));
    if lanes == 0 {
        return None;
    }
    let doubtful = l.bits(l.le(t, ray.doubt(l, [&a, &b, &c], [u, v, w], determinant))) & lanes;
    if doubtful != 0 {
        lanes &= !behind(l, block, ray, doubtful);
    }
    if lanes == 0 { None } else { Some(Found { lanes, t, v, w, determinant }) }
}

/// Of some triangles those whose plane the ray leaves behind, by more than its origin may be off: a ray that starts in a corner may
/// start on the wall that it is to meet, or beyond.
#[cold]
#[inline(never)]
fn behind<L: Lanes>(l: L, block: &Block, ray: &Shear<L>, lanes: u32) -> u32 {
    let [x, y, z] = [0, 1, 2].map(|k| f64::from(l.store(ray.origin[k])[0]));
    let origin = DVec3::new(x, y, z);
    let [x, y, z] = [0, 1, 2].map(|k| f64::from(l.store(ray.shear[k])[0]));
    let along = DVec3::new(x, y, 1.0) * z.signum();
    let off = 4.0 * f64::from(U) * origin.abs().max_element();
    let is_behind = |k: &usize| {
        let [a, b, c] = block.corners.map(|corner| {
            let [x, y, z] = ray.axes.map(|axis| f64::from(corner[axis][*k]));
            DVec3::new(x, y, z)
        });
        let n = (b - a).cross(c - a).normalize_or_zero();
        n.dot(a - origin) * n.dot(along).signum() < -off
    };
    (0..WIDTH).filter(|k| lanes >> k & 1 != 0).filter(is_behind).fold(0, |set, k| set | 1 << k)
}

/// Where an edge function is zero in f32: all three in f64, where the products are exact.
#[cold]
#[inline(never)]
fn exactly(p: &[[[f32; WIDTH]; 2]; 3], lanes: u32, mut uvw: [[f32; WIDTH]; 3]) -> [[f32; WIDTH]; 3] {
    for k in (0..WIDTH).filter(|k| lanes >> k & 1 != 0) {
        let [a, b, c] = [0, 1, 2].map(|i| (p[i][0][k] as f64, p[i][1][k] as f64));
        let cross = |p: (f64, f64), q: (f64, f64)| (p.0 * q.1 - p.1 * q.0) as f32;
        (uvw[0][k], uvw[1][k], uvw[2][k]) = (cross(c, b), cross(a, c), cross(b, a));
    }
    uvw
}

/// What waits: its distance in the upper half, so that numbers sort as distances do, and its name in the lower.
type Entry = u64;

#[inline(always)]
fn entry(t: f32, child: u32) -> Entry {
    (t.to_bits() as u64) << 32 | child as u64
}

pub(crate) trait Stack: AsMut<[Entry]> {
    fn push(&mut self, e: Entry);
    fn pop(&mut self) -> Option<Entry>;
    fn len(&self) -> usize;
}
/// Enough for all trees but those over very many boxes inside each other.
pub(crate) const SHALLOW: usize = 256;
impl Stack for ArrayVec<Entry, SHALLOW> {
    #[inline(always)]
    fn push(&mut self, e: Entry) {
        ArrayVec::push(self, e);
    }
    #[inline(always)]
    fn pop(&mut self) -> Option<Entry> {
        ArrayVec::pop(self)
    }
    #[inline(always)]
    fn len(&self) -> usize {
        ArrayVec::len(self)
    }
}
impl Stack for Vec<Entry> {
    fn push(&mut self, e: Entry) {
        Vec::push(self, e);
    }
    fn pop(&mut self) -> Option<Entry> {
        Vec::pop(self)
    }
    fn len(&self) -> usize {
        Vec::len(self)
    }
}

/// A stack to be made where it is used: moving one would cost more than many rays push.
pub(crate) trait MakeStack {
    fn make(self) -> impl Stack;
}
pub(crate) struct Shallow;
impl MakeStack for Shallow {
    #[inline(always)]
    fn make(self) -> impl Stack {
        ArrayVec::<Entry, SHALLOW>::new_const()
    }
}
pub(crate) struct Deep;
impl MakeStack for Deep {
    fn make(self) -> impl Stack {
        Vec::new()
    }
}

impl Tree {
    /// The nearest hit in (0, t_max) that `keep` lets count.
    #[inline(always)]
    pub fn closest<L: Lanes>(
        &self,
        l: L,
        ray: &Ray,
        stack: &mut impl Stack,
        round: impl Rounds,
        mut keep: impl FnMut(&Met) -> bool,
    ) -> Option<Met> {
        let sheared = Shear::new(l, &AxialRay::new(ray));
        let spread = Spread::new(l, &BoxRay::new(ray, self.largest));
        // No id is below zero: nothing ties with the end of the ray.
        let mut best = Met { t: ray.t_max, id: 0, b1: 0.0, b2: 0.0 };
        let mut found = false;
        let mut limit = l.splat(ray.t_max * WIDER);
        let mut current = 0;
        if self.nodes.is_empty() {
            return None;
        }
        loop {
            if current & Tree::LEAF == 0 {
                let node = &self.nodes[current as usize];
                let (from, hit) = spread.boxes(l, node, limit);
                let mut hit = l.bits(hit);
                if hit != 0 {
                    let first = hit.trailing_zeros() as usize;
                    hit &= hit - 1;
                    if hit == 0 {
                        current = node.children[first & 7];
                        continue;
                    }
                    let from = l.store(from);
                    let mut near = entry(from[first & 7], node.children[first & 7]);
                    let base = stack.len();
                    while hit != 0 {
                        let k = hit.trailing_zeros() as usize & 7;
                        hit &= hit - 1;
                        let next = entry(from[k], node.children[k]);
                        stack.push(near.max(next));
                        near = near.min(next);
                        // The farthest goes to the bottom.
                        let waiting = &mut stack.as_mut()[base..];
                        let mut i = waiting.len() - 1;
                        while i > 0 && waiting[i - 1] < waiting[i] {
                            waiting.swap(i - 1, i);
                            i -= 1;
                        }
                    }
                    current = near as u32;
                    continue;
                }
            } else if current & Tree::ROUND == 0 {
                if let Some(f) = block(l, &self.blocks[(current & !Tree::LEAF) as usize], &sheared, l.splat(best.t)) {
                    let ids = &self.blocks[(current & !Tree::LEAF) as usize].ids;
                    let (t, b1, b2) =
                        (l.store(f.t), l.store(l.div(f.v, f.determinant)), l.store(l.div(f.w, f.determinant)));
                    let mut lanes = f.lanes;
                    while lanes != 0 {
                        let k = lanes.trailing_zeros() as usize & 7;
                        lanes &= lanes - 1;
                        let met = Met { t: t[k], id: ids[k], b1: b1[k], b2: b2[k] };
                        if (met.t < best.t || met.t == best.t && met.id < best.id) && keep(&met) {
                            (best, found) = (met, true);
                        }
                    }
                    limit = l.splat(best.t * WIDER);
                }
            } else {
                let id = current & !(Tree::LEAF | Tree::ROUND);
                if let Some(t) = round(id, best.t.next_up()) {
                    let met = Met { t, id, b1: 0.0, b2: 0.0 };
                    if (t < best.t || t == best.t && id < best.id) && keep(&met) {
                        (best, found) = (met, true);
                        limit = l.splat(best.t * WIDER);
                    }
                }
            }
            loop {
                let Some(e) = stack.pop() else { return found.then_some(best) };
                if f32::from_bits((e >> 32) as u32) <= best.t * WIDER {
                    current = e as u32;
                    break;
                }
            }
        }
    }

    /// Is there a hit in (0, t_max) that `keep` lets count?
    #[inline(always)]
    pub fn any<L: Lanes>(
        &self,
        l: L,
        ray: &Ray,
        stack: &mut impl Stack,
        round: impl Rounds,
        mut keep: impl FnMut(&Met) -> bool,
    ) -> bool {
        let sheared = Shear::new(l, &AxialRay::new(ray));
        let spread = Spread::new(l, &BoxRay::new(ray, self.largest));
        let (limit, end) = (l.splat(ray.t_max * WIDER), l.splat(ray.t_max));
        let mut current = 0;
        if self.nodes.is_empty() {
            return false;
        }
        loop {
            if current & Tree::LEAF == 0 {
                let node = &self.nodes[current as usize];
                let mut hit = l.bits(spread.boxes(l, node, limit).1);
                if hit != 0 {
                    let first = hit.trailing_zeros() as usize & 7;
                    hit &= hit - 1;
                    // Larger boxes come first: what they hold is likelier to be in the way.
                    while hit != 0 {
                        let k = 31 - hit.leading_zeros();
                        hit ^= 1 << k;
                        stack.push(node.children[k as usize & 7] as u64);
                    }
                    current = node.children[first];
                    continue;
                }
            } else if current & Tree::ROUND == 0 {
                let b = &self.blocks[(current & !Tree::LEAF) as usize];
                if let Some(f) = block(l, b, &sheared, end) {
                    let (t, b1, b2) =
                        (l.store(f.t), l.store(l.div(f.v, f.determinant)), l.store(l.div(f.w, f.determinant)));
                    for k in (0..WIDTH).filter(|k| f.lanes >> k & 1 != 0) {
                        if t[k] < ray.t_max && keep(&Met { t: t[k], id: b.ids[k], b1: b1[k], b2: b2[k] }) {
                            return true;
                        }
                    }
                }
            } else {
                let id = current & !(Tree::LEAF | Tree::ROUND);
                if round(id, ray.t_max).is_some_and(|t| keep(&Met { t, id, b1: 0.0, b2: 0.0 })) {
                    return true;
                }
            }
            match stack.pop() {
                Some(e) => current = e as u32,
                None => return false,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::Portable;
    use super::*;
    use manylight_sampling::{Purpose, Stream};

    /// The block's test and the one of single triangles, bit by bit; on small whole numbers, so that rays meet edges exactly.
    fn same_as_singly<L: Lanes>(l: L) {
        let mut s = Stream::new(8, [0; 3], Purpose::TEST);
        let (mut hits, mut on_edge, mut behind) = (0, 0, 0);
        for k in 0..4000 {
            let mut number = || if k % 4 == 0 { s.next_f32() * 8.0 - 4.0 } else { s.next_below(9) as f32 - 4.0 };
            let mut point = || Vec3::new(number(), number(), number());
            let (origin, target) = (point(), point());
            let Some(dir) = (target - origin).try_normalize() else { continue };
            // Unit or not, the test is the same: whole numbers meet edges.
            let ray = Ray::new(origin, if k % 2 == 0 { dir } else { target - origin });
            let triangles: [[Vec3; 3]; WIDTH] = std::array::from_fn(|_| [point(), point(), point()]);
            let corners = [0, 1, 2].map(|c| [0, 1, 2].map(|a| std::array::from_fn(|t| triangles[t][c][a])));
            let found = block(
                l,
                &Block { corners, ids: [0; WIDTH] },
                &Shear::new(l, &AxialRay::new(&ray)),
                l.splat(f32::INFINITY),
            );
            for (t, triangle) in triangles.iter().enumerate() {
                // But for planes through the origin, up to rounding: those are told by `doubt` and `behind`.
                let [a, b, c] = triangle.map(|p| p.as_dvec3() - origin.as_dvec3());
                let n = (b - a).cross(c - a);
                let in_front = n.dot(a) * n.dot(ray.dir.as_dvec3()) >= 0.0;
                let single = ShearedRay::new(&ray).intersect(triangle, f32::INFINITY);
                if single.is_some() && !in_front {
                    assert!(single.is_some_and(|h| h.0 < 1e-4), "{single:?} {ray:?} {triangle:?}");
                    behind += 1;
                    continue;
                }
                let by_eight = found.as_ref().filter(|f| f.lanes >> t & 1 != 0).map(|f| {
                    let (b1, b2) = (l.div(f.v, f.determinant), l.div(f.w, f.determinant));
                    (l.store(f.t)[t], l.store(b1)[t], l.store(b2)[t])
                });
                let bits = |h: Option<(f32, f32, f32)>| h.map(|h| [h.0.to_bits(), h.1.to_bits(), h.2.to_bits()]);
                assert_eq!(bits(single), bits(by_eight), "{ray:?} {triangle:?}");
                hits += single.is_some() as u32;
                on_edge += single.is_some_and(|h| h.1 == 0.0 || h.2 == 0.0 || h.1 + h.2 == 1.0) as u32;
            }
        }
        assert!(hits > 1000 && on_edge > 100 && behind < 20, "{hits} hits, {on_edge} on edges, {behind} behind");
    }
    /// Slivers in a plane, and rays that leave it from closer than their distances can be told: they meet none of them.
    fn slivers_behind<L: Lanes>(l: L) {
        let mut s = Stream::new(9, [0; 3], Purpose::TEST);
        let mut doubted = 0;
        for _ in 0..20_000 {
            let width = 1e-6 * (0.1 + s.next_f32());
            let triangles: [[Vec3; 3]; WIDTH] = std::array::from_fn(|k| {
                let y = k as f32 * 0.1 * width;
                [Vec3::new(-1.0, y, 1.0), Vec3::new(1.0, y, 1.0), Vec3::new(s.next_f32() - 0.5, y + width, 1.0)]
            });
            let corners = [0, 1, 2].map(|c| [0, 1, 2].map(|a| std::array::from_fn(|t| triangles[t][c][a])));
            let block_of = Block { corners, ids: [0; WIDTH] };
            let dir = Vec3::new(s.next_f32() - 0.5, s.next_f32() - 0.5, -0.2 - s.next_f32()).normalize();
            let ray = Ray::new(Vec3::new(0.2 * s.next_f32(), width * s.next_f32(), 1.0 - 1e-6), dir);
            let found = block(l, &block_of, &Shear::new(l, &AxialRay::new(&ray)), l.splat(f32::INFINITY));
            assert!(found.is_none(), "{ray:?}");
            doubted += triangles.iter().filter(|t| ShearedRay::new(&ray).intersect(t, f32::INFINITY).is_some()).count();
        }
        assert!(doubted > 100, "{doubted}: the test tests nothing");
    }
    #[test]
    fn rays_that_leave_a_plane_meet_none_of_its_slivers() {
        slivers_behind(Portable);
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = super::super::avx2::Avx2::detect() {
            slivers_behind(avx2);
        }
    }
    #[test]
    fn blocks_meet_what_single_triangles_do() {
        same_as_singly(Portable);
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = super::super::avx2::Avx2::detect() {
            same_as_singly(avx2);
        }
    }

    /// Rays by the edges of a small triangle: what the triangle test takes for a hit, the box test lets through.
    #[test]
    fn a_triangle_that_is_hit_has_a_box_that_is_entered() {
        let (l, mut s) = (Portable, Stream::new(9, [0; 3], Purpose::TEST));
        let mut hits = 0;
        for k in 0..200_000 {
            let mut point = || Vec3::new(s.next_f32(), s.next_f32(), s.next_f32());
            let (far, at) = ([0.0f32, 1.0, 100.0, 1e4][k % 4], point());
            let origin = (point() - 0.5) * (2.0 * far + 1.0) + at;
            // Level with an axis, the box is flat.
            let axis = k % 3;
            let corners = [(); 3].map(|_| {
                let mut p = point() * 0.01 + at;
                p[axis] = at[axis];
                p
            });
            let target = if k % 2 == 0 { corners[0] } else { corners[0].lerp(corners[1], 0.3) };
            let Some(dir) = (target - origin).try_normalize() else { continue };
            let ray = Ray::new(origin, dir);
            let Some((t, ..)) = ShearedRay::new(&ray).intersect(&corners, f32::INFINITY) else { continue };
            let bounds = manylight_math::Aabb::around(corners);
            let mut node = Node { planes: [[f32::NAN; WIDTH]; 6], children: [0; WIDTH] };
            (0..3).for_each(|a| (node.planes[a][0], node.planes[a + 3][0]) = (bounds.lo[a], bounds.hi[a]));
            let largest = bounds.lo.abs().max(bounds.hi.abs()).max_element();
            let spread = Spread::new(l, &BoxRay::new(&ray, largest));
            let entered = l.bits(spread.boxes(l, &node, l.splat(t * WIDER)).1) & 1;
            assert!(entered == 1, "{ray:?} {corners:?} at {t}");
            hits += 1;
        }
        assert!(hits > 50_000, "{hits}");
    }
}
