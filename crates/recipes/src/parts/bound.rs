//! What is kept of a connection.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;
use manylight_compensation::{BoundPlan, Bounded, Level};

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "bound",
        Kind::NumberOr(&["none", "auto", "progressive"]),
        "auto",
        "largest geometry term cos cos / d^2; `auto`: pi paths / (surface of the scene), so that no light brings more than the mean irradiance; `progressive`: that, times pass^(2/3)",
    )
    .unit("1/m^2"),
    Param::new(
        "bound-of",
        Kind::Choice(&["geometry", "contribution"]),
        "geometry",
        "what the bound bounds: the geometry term, or the whole contribution with its lobes, in units of white diffuse surfaces (against glossy spikes; cannot be compensated)",
    ),
];

pub(crate) fn plan(v: &Values) -> Result<BoundPlan, RecipeError> {
    let of = if v.text("bound-of") == "contribution" { Bounded::Contribution } else { Bounded::Geometry };
    if of == Bounded::Contribution && v.text("compensation") != "none" {
        return Err(RecipeError::Contrary(format!(
            "bound-of=contribution takes away what only a light knows, so that compensation={} cannot bring it back: say bound-of=geometry, or compensation=none",
            v.text("compensation")
        )));
    }
    if v.is_given("bound-of") && v.text("bound") == "none" {
        return Err(RecipeError::Contrary(
            "bound-of says what a bound bounds, and bound is `none`: leave it out, or say a bound".into(),
        ));
    }
    let level = match v.text("bound") {
        // Nothing to bound, nothing to lose.
        _ if v.text("direct") == "only" => Level::None,
        "none" => Level::None,
        "auto" => Level::Auto,
        "progressive" => Level::Progressive,
        _ => Level::Fixed(v.number("bound")?),
    };
    Ok(BoundPlan { level, of })
}
