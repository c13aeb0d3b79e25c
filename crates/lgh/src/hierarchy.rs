//! The lights, and their averages at the vertices of each level.

use crate::blending::{support, weight};
use crate::lattice::{Lattice, Place, corner, trilinear};
use crate::points::Points;
use manylight_framework::{Blend, BuildError};
use manylight_math::{Aabb, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Lights, and made-up lights at the vertices of ever coarser grids, each of which stands for all of them.
///
/// Light i adds w_iv of itself to the eight vertices v of its cell, trilinearly: I_v = sum_i w_iv I_i, at the place
/// p_v = sum_i w_iv I_i p_i / I_v. That moves continuously with the lights, and far away it keeps their dipole.
pub struct Hierarchy<L: Blend> {
    lattice: Lattice,
    /// r_0 \[m\]; r_l = 2^l r_0.
    radius: f64,
    lights: Points<L>,
    /// Level l at l - 1.
    levels: Vec<Points<L::Synthetic>>,
    /// Those that cannot be averaged.
    alone: Vec<L>,
}

/// A light of a hierarchy, as a receiver meets it.
pub enum Met<'h, L: Blend> {
    /// One of those that were given.
    Given(&'h L),
    /// An average.
    Made(&'h L::Synthetic),
}
impl<L: Blend> Clone for Met<'_, L> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<L: Blend> Copy for Met<'_, L> {}

/// Lights that are summed by one thread: a fixed number, so that sums do not depend on threads.
const CHUNK: usize = 2048;

impl<L: Blend> Hierarchy<L> {
    /// Of lights on a lattice (`None`: a cube around them, with as many levels as their number deserves), with r_l = `alpha` h_l.
    pub fn new(lights: Vec<L>, lattice: Option<Lattice>, alpha: f64) -> Result<Self, BuildError> {
        if lights.len() > u32::MAX as usize {
            return Err(BuildError::TooMany { lights: lights.len(), limit: u32::MAX as usize });
        }
        let fits =
            |l: &L| l.intensity() >= 0.0 && l.intensity().is_finite() && (!l.blends() || l.position().is_finite());
        if let Some(light) = lights.iter().position(|l| !fits(l)) {
            return Err(BuildError::NotFinite { light });
        }
        let (blended, alone): (Vec<L>, Vec<L>) = lights.into_iter().partition(|l| l.blends());
        let lattice = lattice.unwrap_or_else(|| {
            let bounds = Aabb::around(blended.iter().map(|l| l.position()));
            Lattice::around(&bounds, Lattice::levels_for(blended.len()))
        });
        let placed: Vec<(Vec3, L)> = blended.into_iter().map(|l| (l.position(), l)).collect();
        let lights = Points::new(&placed);
        let levels = (1..=lattice.levels.max(1)).map(|l| Points::new(&vertices(&lights, &lattice, l))).collect();
        Ok(Hierarchy { lattice, radius: alpha * lattice.spacing(0), lights, levels, alone })
    }
    /// Where its vertices are.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }
    /// The lights of each level: first those that were given.
    pub fn sizes(&self) -> Vec<usize> {
        std::iter::once(self.lights.len()).chain(self.levels.iter().map(Points::len)).collect()
    }
    /// The made-up lights of a level, 1 or higher, and where they are.
    pub fn level(&self, level: usize) -> impl Iterator<Item = (Vec3, &L::Synthetic)> {
        self.levels[level - 1].iter()
    }
    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(Points::bytes).sum();
        self.lights.bytes() + levels + size_of_val(&self.alone[..])
    }
    /// Shows each light that counts at a point, with its weight B_l(d): nearby those that were given, far away averages.
    #[inline]
    pub fn at<'h>(&'h self, x: Vec3, mut visit: impl FnMut(f64, Met<'h, L>)) {
        let top = self.levels.len() as u32;
        self.lights.between(x, support(0, top, self.radius), |d, l| {
            let w = weight(0, top, self.radius, d);
            if w > 0.0 {
                visit(w, Met::Given(l));
            }
        });
        for (level, points) in (1..).zip(&self.levels) {
            let radius = self.radius * f64::from(1u32 << level);
            points.between(x, support(level, top, radius), |d, l| {
                let w = weight(level, top, radius, d);
                if w > 0.0 {
                    visit(w, Met::Made(l));
                }
            });
        }
        self.alone.iter().for_each(|l| visit(1.0, Met::Given(l)));
    }
}

/// The averages at the vertices of a level. Chunks of lights are summed apart, and their sums joined in their order.
fn vertices<L: Blend>(lights: &Points<L>, lattice: &Lattice, level: u32) -> Vec<(Vec3, L::Synthetic)> {
    let things: Vec<(Vec3, &L)> = lights.iter().collect();
    let parts: Vec<HashMap<Place, L::Sum>> =
        things.par_chunks(CHUNK).map(|chunk| splat::<L>(chunk, lattice, level)).collect();
    let mut sums: HashMap<Place, L::Sum> = HashMap::new();
    for part in parts {
        for (place, sum) in part {
            match sums.entry(place) {
                std::collections::hash_map::Entry::Occupied(mut all) => L::join(all.get_mut(), &sum),
                std::collections::hash_map::Entry::Vacant(none) => {
                    none.insert(sum);
                }
            }
        }
    }
    let mut sums: Vec<(Place, L::Sum)> = sums.into_iter().collect();
    sums.par_sort_unstable_by_key(|s| s.0);
    sums.iter().filter_map(|s| L::made(&s.1)).collect()
}

/// What a chunk of lights adds to vertices. Neighbours on the curve share cells: their corners are looked up once.
fn splat<L: Blend>(chunk: &[(Vec3, &L)], lattice: &Lattice, level: u32) -> HashMap<Place, L::Sum> {
    let mut sums: HashMap<Place, L::Sum> = HashMap::new();
    let mut cell: Option<(Place, [L::Sum; 8])> = None;
    let mut close = |cell: &mut Option<(Place, [L::Sum; 8])>| {
        if let Some((place, corners)) = cell.take() {
            for (c, sum) in corners.iter().enumerate() {
                L::join(sums.entry(corner(place, c)).or_default(), sum);
            }
        }
    };
    for (p, light) in chunk {
        let (place, t) = lattice.cell(level, *p);
        if cell.as_ref().is_none_or(|c| c.0 != place) {
            close(&mut cell);
        }
        let (_, corners) = cell.get_or_insert_with(|| (place, Default::default()));
        for (w, sum) in trilinear(t).into_iter().zip(corners) {
            if w > 0.0 {
                light.add(w, sum);
            }
        }
    }
    close(&mut cell);
    sums
}
