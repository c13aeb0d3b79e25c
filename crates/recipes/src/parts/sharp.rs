//! Which lobes lights are not connected to.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;

pub(crate) const PARAMS: &[Param] = &[Param::new(
    "sharp",
    Kind::Number { min: 0.0, max: 1.0 },
    "0.1",
    "roughness (alpha) up to which a lobe is walked through from the eye as a mirror is, and not connected to lights, which would \
     have to be very many to show it; 0: none (and with compensation=screen-space)",
)];

/// Direct light alone is connected through every lobe: its lights are where they have to be.
pub(crate) fn sharp(v: &Values) -> Result<f32, RecipeError> {
    let alpha = v.number("sharp")?;
    if v.text("compensation") != "screen-space" {
        return Ok(if v.text("direct") == "only" { 0.0 } else { alpha });
    }
    if v.is_given("sharp") && alpha > 0.0 {
        return Err(RecipeError::Contrary(
            "compensation=screen-space takes what a pixel shows for what its surface sends, which the reflection of a sharp lobe is \
             not: say sharp=0, or compensation=local"
                .into(),
        ));
    }
    Ok(0.0)
}
