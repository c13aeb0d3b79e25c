//! Grids of vertices, each twice as coarse as the one before, pinned in the world.

use manylight_math::{Aabb, DVec3, Vec3};

/// Vertices at `origin` + h_l (i, j, k) for all integers, with h_l = `top` / 2^(`levels` - l) on level l = 1..=`levels`. It
/// reaches to infinity; its place does not depend on the lights, lest one of them moves all vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// A vertex of every level. \[m\]
    pub origin: DVec3,
    /// Spacing of the coarsest level. \[m\]
    pub top: f64,
    /// How many levels; at least one.
    pub levels: u32,
}

/// A vertex, or the lower corner of a cell.
pub type Place = [i64; 3];

/// What is left free around what a lattice is made for, so that nothing lies on its faces by rounding.
const MARGIN: f64 = 1.01;

impl Lattice {
    /// The top level has one cell: a cube around a box.
    pub fn around(bounds: &Aabb, levels: u32) -> Lattice {
        let extent = f64::from((bounds.hi - bounds.lo).max_element()) * MARGIN;
        // A point, or nothing: any spacing will do.
        let top = if extent > 0.0 && extent.is_finite() { extent } else { 1.0 };
        let centre = 0.5 * (bounds.lo.as_dvec3() + bounds.hi.as_dvec3());
        let centre = if centre.is_finite() { centre } else { DVec3::ZERO };
        Lattice { origin: centre - 0.5 * top, top, levels: levels.max(1) }
    }
    /// Levels of a cube for so many lights: as many as have at most a quarter as many vertices, (2^(L-1) + 1)^3 <= N / 4.
    pub fn levels_for(lights: usize) -> u32 {
        let vertices = |levels: u32| ((1u64 << (levels - 1)) + 1).pow(3);
        (2..=20).take_while(|l| vertices(*l) * 4 <= lights as u64).last().unwrap_or(1)
    }
    /// h_l of a level; level 0, the lights themselves, counts as half the first. \[m\]
    pub fn spacing(&self, level: u32) -> f64 {
        self.top * 0.5f64.powi(self.levels.max(1) as i32 - level as i32)
    }
    /// The cell of a point, and where in it the point lies, in [0, 1) each.
    pub fn cell(&self, level: u32, p: Vec3) -> (Place, DVec3) {
        let local = (p.as_dvec3() - self.origin) / self.spacing(level);
        let lower = local.floor();
        ([lower.x as i64, lower.y as i64, lower.z as i64], local - lower)
    }
}

/// Weights of a cell's eight corners at a point in it; corner c lies at (c & 1, c >> 1 & 1, c >> 2). They sum to one.
pub fn trilinear(t: DVec3) -> [f64; 8] {
    std::array::from_fn(|c| {
        let along = |axis: usize| if c >> axis & 1 == 1 { t[axis] } else { 1.0 - t[axis] };
        along(0) * along(1) * along(2)
    })
}

/// A corner of a cell.
pub fn corner(cell: Place, c: usize) -> Place {
    std::array::from_fn(|axis| cell[axis].saturating_add((c >> axis & 1) as i64))
}
