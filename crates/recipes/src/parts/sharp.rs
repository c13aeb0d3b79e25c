//! Which lobes lights are not connected to.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;

pub(crate) const PARAMS: &[Param] = &[Param::new(
    "sharp",
    Kind::Number { min: 0.0, max: 1.0 },
    "0.1",
    "roughness (alpha) up to which a lobe is walked through from the eye as a mirror is, and not connected to lights, which would \
     have to be very many to show it; 0: none",
)];

/// Direct light alone is connected through every lobe: its lights are where they have to be.
pub(crate) fn sharp(v: &Values) -> Result<f32, RecipeError> {
    Ok(if v.text("direct") == "only" { 0.0 } else { v.number("sharp")? })
}
