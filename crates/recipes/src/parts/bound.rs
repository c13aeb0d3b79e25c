//! What is kept of a connection.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;
use manylight_compensation::BoundPlan;

pub(crate) const PARAMS: &[Param] = &[Param::new(
    "bound",
    Kind::NumberOr(&["none", "auto"]),
    "auto",
    "largest geometry term cos cos / d^2; `auto`: pi paths / (surface of the scene), so that no light brings more than the mean irradiance",
)
.unit("1/m^2")];

pub(crate) fn plan(v: &Values) -> Result<BoundPlan, RecipeError> {
    Ok(match v.text("bound") {
        // Nothing to bound, nothing to lose.
        _ if v.text("direct") == "only" => BoundPlan::None,
        "none" => BoundPlan::None,
        "auto" => BoundPlan::Auto,
        _ => BoundPlan::Fixed(v.number("bound")?),
    })
}
