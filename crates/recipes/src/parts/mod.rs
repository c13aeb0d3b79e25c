//! Compositions of virtual lights: generator x light set x kernel x bound x compensation.
//!
//! Each kind of part has a file: the parameters that choose it, those that only some of its values read (`Param::part_of`), and
//! the match from values to the part. A new part is a word in its table and an arm in its match.

mod bound;
mod compensation;
mod direct;
mod generator;
mod kernel;
mod lights;
pub(crate) mod media;
pub(crate) mod photon;
mod sharp;
pub(crate) mod volume;

use crate::values::Values;
use crate::{Param, RecipeError, compositions};
use manylight_framework::Method;
use manylight_scene::Scene;

/// Of every composition of virtual lights.
pub(crate) const MANY_LIGHTS: &[&[Param]] = &[
    generator::PARAMS,
    lights::PARAMS,
    kernel::PARAMS,
    bound::PARAMS,
    compensation::PARAMS,
    direct::PARAMS,
    sharp::PARAMS,
];

pub(crate) fn many_lights(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    direct::check(v)?;
    compositions::check(v)?;
    if direct::by_lamps(v) { lights::over_lamps(v, scene) } else { kernel::compose(v, scene) }
}

pub use generator::Vpls;

pub(crate) fn point_lights(v: &Values, scene: &Scene) -> Result<Vpls, RecipeError> {
    direct::check(v)?;
    generator::vpls(v, scene)
}
