//! What a virtual light is, and so how a receiver is connected to it.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::parts::{generator, lights};
use crate::values::Values;
use manylight_framework::Method;
use manylight_scene::Scene;
use manylight_vpl::Points;

pub(crate) const PARAMS: &[Param] =
    &[Param::new("kernel", Kind::Choice(&["point"]), "point", "what a virtual light is")];

/// The kernel decides the type of the lights, and so comes first.
pub(crate) fn compose(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    lights::under(v, scene, generator::vpls(v, scene)?, Points)
}
