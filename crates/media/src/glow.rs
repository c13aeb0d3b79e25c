//! Media that shine of themselves.

use crate::march::{CELLS, cells};
use crate::volume::Grid;
use crate::{MediumError, blackbody};
use manylight_math::{Ray, Spectrum, Vec3};

/// What a medium emits: power per volume and solid angle, the same in all directions, by a grid. [W/(m^3 sr)]
#[derive(Clone, Debug, PartialEq)]
pub struct Glow {
    grid: Grid,
    scale: f32,
    /// Is there any in a cell?
    any: Vec<bool>,
    total: Spectrum,
}

impl Glow {
    /// `grid` x `scale`. [W/(m^3 sr)]
    pub fn new(grid: Grid, scale: f32) -> Result<Self, MediumError> {
        let total = grid.mean() * (grid.volume() * f64::from(scale)) as f32;
        if !(scale >= 0.0 && scale.is_finite() && total.is_finite()) {
            return Err(MediumError::Coefficients);
        }
        let any = grid.largest(CELLS).iter().map(|m| !m.is_black() && scale > 0.0).collect();
        Ok(Glow { grid, scale, any, total })
    }
    /// Of a glowing gas: sigma_a(y) B(T(y)), from its absorption [1/m] and a grid of kelvins, at whose voxels both are taken.
    pub fn glowing(temperature: &Grid, absorption: impl Fn(Vec3) -> Spectrum, scale: f32) -> Result<Self, MediumError> {
        Glow::new(temperature.made(|p, kelvin| absorption(p) * blackbody::radiance(kelvin.mean()))?, scale)
    }
    /// j at a point. [W/(m^3 sr)]
    pub fn at(&self, p: Vec3) -> Spectrum {
        self.grid.at(p) * self.scale
    }
    /// Its integral over all space. [W/sr]
    pub fn total(&self) -> Spectrum {
        self.total
    }
    /// Does it emit anything?
    pub fn is_black(&self) -> bool {
        self.total.is_black()
    }
    /// The grid, and what multiplies it.
    pub fn grid(&self) -> (&Grid, f32) {
        (&self.grid, self.scale)
    }
    /// Can there be any in a cell of its grid?
    pub(crate) fn any(&self, cell: usize) -> bool {
        self.any[cell]
    }
    /// Shows the pieces of a ray on which there can be emission, in their order: at most one a cell of the grid, of 1/16 of it.
    pub(crate) fn pieces(&self, ray: &Ray, from: f32, to: f32, mut visit: impl FnMut(f64, f64) -> bool) {
        cells(&self.grid, ray, from, to, |cell, a, b| !self.any[cell] || !(b > a) || visit(a, b));
    }
}
