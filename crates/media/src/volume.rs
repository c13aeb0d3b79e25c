//! Values that vary over space.

use crate::MediumError;
use manylight_math::{Aabb, DAffine3, DVec3, Spectrum, Vec3};

/// How values between the grid's are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Linear along each axis between the eight nearest.
    Trilinear,
    /// The nearest.
    Nearest,
}

/// A grid of values over the unit cube of its own frame, as Mitsuba's `gridvolume`: value (i, j, k) stands at the middle of its
/// voxel, ((i + 1/2) / n_x, ..); beyond the outermost ones it stays the same, and outside the cube it is zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    size: [usize; 3],
    values: Vec<Spectrum>,
    gray: bool,
    to_local: DAffine3,
    interpolation: Interpolation,
    bounds: Aabb,
}

impl Grid {
    /// From values in the order x fastest, z slowest; `to_world` places the unit cube.
    pub fn new(
        size: [usize; 3],
        values: Vec<Spectrum>,
        to_world: &DAffine3,
        interpolation: Interpolation,
    ) -> Result<Self, MediumError> {
        let count = size.iter().try_fold(1usize, |n, s| n.checked_mul(*s));
        if count != Some(values.len()) || values.is_empty() {
            return Err(MediumError::Grid);
        }
        if !values.iter().all(|v| v.is_valid()) {
            return Err(MediumError::Coefficients);
        }
        let to_local = to_world.inverse();
        if !to_local.is_finite() || to_world.matrix3.determinant() == 0.0 {
            return Err(MediumError::Grid);
        }
        let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let bounds = Aabb::around((0..8).map(|i| to_world.transform_point3(corner(i)).as_vec3()));
        let gray = values.iter().all(|v| v.0.x == v.0.y && v.0.x == v.0.z);
        Ok(Grid { size, values, gray, to_local, interpolation, bounds })
    }
    /// Are all channels of each value the same?
    pub fn is_gray(&self) -> bool {
        self.gray
    }
    /// The smallest box around the cube.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
    fn to_world(&self) -> DAffine3 {
        self.to_local.inverse()
    }
    /// How values between the grid's are made.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }
    /// Is its cube that of another grid?
    pub fn lies_as(&self, o: &Grid) -> bool {
        self.to_local == o.to_local
    }
    /// Voxels along each axis.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }
    /// The value of a voxel.
    pub fn value(&self, [i, j, k]: [usize; 3]) -> Spectrum {
        self.values[(k * self.size[1] + j) * self.size[0] + i]
    }
    /// The middle of a voxel. \[m\]
    pub fn centre(&self, voxel: [usize; 3]) -> DVec3 {
        let at = |axis: usize| (voxel[axis] as f64 + 0.5) / self.size[axis] as f64;
        self.to_world().transform_point3(DVec3::new(at(0), at(1), at(2)))
    }
    /// Edges of a voxel. \[m\]
    pub fn voxel(&self) -> [DVec3; 3] {
        let m = self.to_world().matrix3;
        [m.x_axis / self.size[0] as f64, m.y_axis / self.size[1] as f64, m.z_axis / self.size[2] as f64]
    }
    /// Volume of the whole cube. [m^3]
    pub fn volume(&self) -> f64 {
        self.to_world().matrix3.determinant().abs()
    }
    /// A grid of the same shape whose values are made of this one's, and of where they stand.
    pub fn made(&self, of: impl Fn(Vec3, Spectrum) -> Spectrum) -> Result<Grid, MediumError> {
        let [nx, ny, _] = self.size;
        let place = |n: usize| self.centre([n % nx, n / nx % ny, n / nx / ny]).as_vec3();
        let values = self.values.iter().enumerate().map(|(n, v)| of(place(n), *v)).collect();
        Grid::new(self.size, values, &self.to_world(), self.interpolation)
    }
    /// Mean of all values.
    pub fn mean(&self) -> Spectrum {
        let mut sum = [0.0f64; 3];
        for v in &self.values {
            let v = v.to_array();
            (0..3).for_each(|c| sum[c] += f64::from(v[c]));
        }
        Spectrum::from(sum.map(|s| (s / self.values.len() as f64) as f32))
    }
    /// World to the unit cube.
    pub(crate) fn local(&self, p: Vec3) -> DVec3 {
        self.to_local.transform_point3(p.as_dvec3())
    }
    pub(crate) fn local_direction(&self, d: Vec3) -> DVec3 {
        self.to_local.transform_vector3(d.as_dvec3())
    }
    /// The value at a point; zero outside the cube.
    pub fn at(&self, p: Vec3) -> Spectrum {
        let l = self.local(p);
        if !(l.min_element() >= 0.0 && l.max_element() <= 1.0) {
            return Spectrum::BLACK;
        }
        let place = |axis: usize| {
            let n = self.size[axis];
            let x = l[axis] * n as f64 - if self.interpolation == Interpolation::Trilinear { 0.5 } else { 0.0 };
            let i = x.floor();
            let clamped = |i: f64| (i.max(0.0) as usize).min(n - 1);
            (clamped(i), clamped(i + 1.0), (x - i) as f32)
        };
        let ((x0, x1, fx), (y0, y1, fy), (z0, z1, fz)) = (place(0), place(1), place(2));
        let value = |x: usize, y: usize, z: usize| self.values[(z * self.size[1] + y) * self.size[0] + x];
        match self.interpolation {
            Interpolation::Nearest => value(x0, y0, z0),
            Interpolation::Trilinear => {
                let along = |y: usize, z: usize| Spectrum::lerp(value(x0, y, z), value(x1, y, z), fx);
                let plane = |z: usize| Spectrum::lerp(along(y0, z), along(y1, z), fy);
                Spectrum::lerp(plane(z0), plane(z1), fz)
            }
        }
    }
    /// The largest value that there can be in each of `n` x `n` x `n` cells of the unit cube, x fastest: of all values that
    /// interpolation can reach from the cell.
    pub(crate) fn largest(&self, n: usize) -> Vec<Spectrum> {
        let reach = |axis: usize, cell: usize| {
            let size = self.size[axis] as f64;
            let margin = if self.interpolation == Interpolation::Trilinear { 0.5 } else { 0.0 };
            let low = (cell as f64 / n as f64 * size - margin).floor().max(0.0) as usize;
            let high = ((cell + 1) as f64 / n as f64 * size + margin).floor() as usize;
            low..(high + 1).min(self.size[axis])
        };
        let mut cells = Vec::with_capacity(n * n * n);
        for z in 0..n {
            for y in 0..n {
                for x in 0..n {
                    let mut largest = Vec3::ZERO;
                    for k in reach(2, z) {
                        for j in reach(1, y) {
                            for i in reach(0, x) {
                                largest = largest.max(self.values[(k * self.size[1] + j) * self.size[0] + i].0);
                            }
                        }
                    }
                    cells.push(Spectrum(largest));
                }
            }
        }
        cells
    }
}

/// A value that is the same everywhere, or a grid.
#[derive(Clone, Debug, PartialEq)]
pub enum Volume {
    /// The same everywhere.
    Constant(Spectrum),
    /// A grid.
    Grid(Grid),
}

impl Volume {
    /// The value at a point.
    pub fn at(&self, p: Vec3) -> Spectrum {
        match self {
            Volume::Constant(c) => *c,
            Volume::Grid(g) => g.at(p),
        }
    }
}
