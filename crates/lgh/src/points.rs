//! Things at points, found by distance.

use manylight_math::{Aabb, Vec3};
use rayon::prelude::*;

/// Things at points, in the order of a space-filling curve, under boxes around eight of them, around eight of those, and so on. It
/// takes the room of what it holds, wherever that lies.
pub struct Points<T> {
    places: Vec<Vec3>,
    things: Vec<T>,
    /// Lowest first; the last has at most `FAN` boxes.
    boxes: Vec<Vec<Aabb>>,
}

/// Children of a box.
const FAN: usize = 8;

impl<T: Copy + Send + Sync> Points<T> {
    /// Of finite places. Where two are the same their order is kept.
    pub fn new(given: &[(Vec3, T)]) -> Points<T> {
        let bounds = Aabb::around(given.iter().map(|g| g.0));
        let extent = (bounds.hi.as_dvec3() - bounds.lo.as_dvec3()).max_element();
        let scale = if extent > 0.0 { f64::from(MOST) / extent } else { 0.0 };
        let code = |p: Vec3| {
            let at = (p.as_dvec3() - bounds.lo.as_dvec3()) * scale;
            interleave(at.x as u64) | interleave(at.y as u64) << 1 | interleave(at.z as u64) << 2
        };
        let mut order: Vec<(u64, u32)> = given.par_iter().enumerate().map(|(i, g)| (code(g.0), i as u32)).collect();
        order.par_sort_unstable();
        let places: Vec<Vec3> = order.iter().map(|o| given[o.1 as usize].0).collect();
        let things = order.iter().map(|o| given[o.1 as usize].1).collect();
        let mut boxes: Vec<Vec<Aabb>> = Vec::new();
        if !places.is_empty() {
            boxes.push(places.chunks(FAN).map(|c| Aabb::around(c.iter().copied())).collect());
        }
        while let Some(below) = boxes.last().filter(|b| b.len() > FAN) {
            boxes.push(below.chunks(FAN).map(|c| c.iter().fold(Aabb::EMPTY, |a, b| a.join(b))).collect());
        }
        Points { places, things, boxes }
    }
    /// How many there are.
    pub fn len(&self) -> usize {
        self.things.len()
    }
    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.things.is_empty()
    }
    /// The things, and where they are.
    pub fn iter(&self) -> impl Iterator<Item = (Vec3, &T)> {
        self.places.iter().copied().zip(&self.things)
    }
    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let boxes: usize = self.boxes.iter().map(|b| size_of_val(&b[..])).sum();
        size_of_val(&self.places[..]) + size_of_val(&self.things[..]) + boxes
    }
    /// Shows whatever lies between two distances of a point, in their order, with the distance: perhaps a little more. \[m\]
    #[inline]
    pub fn between<'t>(&'t self, x: Vec3, (inner, outer): (f64, f64), mut visit: impl FnMut(f64, &'t T)) {
        // Rounded outwards: whoever visits weighs by the distance.
        let near = (inner * inner * (1.0 - 1e-5)) as f32;
        let far = (outer * outer * (1.0 + 1e-5)) as f32;
        let Some(top) = self.boxes.len().checked_sub(1) else { return };
        // At most `FAN` wait on each level.
        let mut stack = [(0u32, 0u32); FAN * 12];
        let mut waiting = 0;
        for i in (0..self.boxes[top].len()).rev() {
            stack[waiting] = (top as u32, i as u32);
            waiting += 1;
        }
        let here = Aabb::point(x);
        while waiting > 0 {
            waiting -= 1;
            let (level, i) = (stack[waiting].0 as usize, stack[waiting].1 as usize);
            let (least, most) = here.distances2(&self.boxes[level][i]);
            if !(least <= far && most >= near) {
                continue;
            }
            if level > 0 {
                let end = ((i + 1) * FAN).min(self.boxes[level - 1].len());
                for child in (i * FAN..end).rev() {
                    stack[waiting] = (level as u32 - 1, child as u32);
                    waiting += 1;
                }
                continue;
            }
            let range = i * FAN..((i + 1) * FAN).min(self.places.len());
            for (p, thing) in self.places[range.clone()].iter().zip(&self.things[range]) {
                let d2 = (*p - x).length_squared();
                if d2 <= far && d2 >= near {
                    visit(f64::from(d2).sqrt(), thing);
                }
            }
        }
    }
}

/// Largest coordinate on the curve.
const MOST: u32 = (1 << 21) - 1;

/// Every third bit.
fn interleave(x: u64) -> u64 {
    let x = x.min(u64::from(MOST));
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream};

    #[test]
    fn what_is_found_is_what_lies_between_the_distances() {
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        for n in [0usize, 1, 7, 8, 9, 64, 65, 3000] {
            let mut place =
                || Vec3::new(s.next_f32(), s.next_f32() * 0.3 - 5.0, if n == 65 { 1.0 } else { s.next_f32() });
            let given: Vec<_> = (0..n).map(|i| (place(), i)).collect();
            let points = Points::new(&given);
            let x = place();
            for range in [(0.0, 0.3), (0.2, 0.5), (0.0, f64::INFINITY), (0.4, f64::INFINITY), (0.0, 0.0)] {
                let mut found = Vec::new();
                points.between(x, range, |d, i| {
                    if d >= range.0 && d <= range.1 {
                        found.push(*i);
                    }
                });
                found.sort_unstable();
                let inside = |g: &&(Vec3, usize)| {
                    let d = f64::from((g.0 - x).length_squared()).sqrt();
                    d >= range.0 && d <= range.1
                };
                let expected: Vec<_> = given.iter().filter(inside).map(|g| g.1).collect();
                assert_eq!(found, expected, "{n} points, {range:?}");
            }
        }
    }
    #[test]
    fn bits_are_interleaved() {
        assert_eq!((interleave(0b1011), interleave(u64::MAX)), (0b1_000_001_001, 0x1249_2492_4924_9249));
    }
}
