//! Cells of a grid's cube along a ray.

use crate::volume::Grid;
use manylight_math::{DVec3, Ray};

/// Cells along each axis, of what is known of a grid cell by cell.
pub(crate) const CELLS: usize = 16;

/// The part of [from, to] of a ray that lies in a grid's cube.
pub(crate) fn inside(grid: &Grid, ray: &Ray, from: f64, to: f64) -> Option<(f64, f64)> {
    let (o, d) = (grid.local(ray.origin), grid.local_direction(ray.dir));
    let (mut t0, mut t1) = (from, to);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if !(0.0..=1.0).contains(&o[axis]) {
                return None;
            }
            continue;
        }
        let (a, b) = (-o[axis] / d[axis], (1.0 - o[axis]) / d[axis]);
        t0 = t0.max(a.min(b));
        t1 = t1.min(a.max(b));
    }
    (t0 < t1).then_some((t0, t1))
}

/// Shows the cells that [from, to] of a ray runs through, in their order, until `visit` says false: index and piece of the ray.
pub(crate) fn cells(grid: &Grid, ray: &Ray, from: f32, to: f32, mut visit: impl FnMut(usize, f64, f64) -> bool) {
    let Some((t0, t1)) = inside(grid, ray, f64::from(from), f64::from(to)) else { return };
    let n = CELLS as f64;
    let (o, d) = (grid.local(ray.origin) * n, grid.local_direction(ray.dir) * n);
    let start: DVec3 = o + d * t0;
    let mut cell: [i64; 3] = [0, 1, 2].map(|a| (start[a].floor() as i64).clamp(0, CELLS as i64 - 1));
    let step = [0, 1, 2].map(|a| if d[a] > 0.0 { 1i64 } else { -1 });
    // Where the ray leaves the cell along each axis.
    let exit = |a: usize, cell: i64| {
        if d[a] == 0.0 { f64::INFINITY } else { ((cell + i64::from(step[a] > 0)) as f64 - o[a]) / d[a] }
    };
    let mut next = [0, 1, 2].map(|a| exit(a, cell[a]));
    let mut t = t0;
    loop {
        let axis = if next[0] <= next[1] && next[0] <= next[2] {
            0
        } else if next[1] <= next[2] {
            1
        } else {
            2
        };
        let end = next[axis].min(t1);
        let index = ((cell[2] as usize * CELLS) + cell[1] as usize) * CELLS + cell[0] as usize;
        if !visit(index, t, end) || end >= t1 {
            return;
        }
        t = t.max(end);
        cell[axis] += step[axis];
        if !(0..CELLS as i64).contains(&cell[axis]) {
            return;
        }
        next[axis] = exit(axis, cell[axis]);
    }
}
