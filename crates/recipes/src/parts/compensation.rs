//! What becomes of that which a bound takes away.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;
use manylight_framework::{Compensator, NoCompensation};

pub(crate) const PARAMS: &[Param] =
    &[Param::new("compensation", Kind::Choice(&["none"]), "none", "estimates what the bound takes away")];

pub(crate) fn compensator(_: &Values) -> Result<Box<dyn Compensator>, RecipeError> {
    Ok(Box::new(NoCompensation))
}
