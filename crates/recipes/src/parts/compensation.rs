//! What becomes of that which a bound takes away.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;
use manylight_compensation::{Arrival, KolligKeller};
use manylight_framework::Compensation;

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "compensation",
        Kind::Choice(&["none", "kollig-keller"]),
        "none",
        "estimates what the bound takes away; `kollig-keller`: by continued paths, and with them light through mirrors and glass",
    ),
    Param::new(
        "steps",
        Kind::IntegerOr { min: 1, max: 1 << 16, words: &["none"] },
        "none",
        "residual steps at most; `none`: no limit, unbiased",
    )
    .part_of("compensation", &["kollig-keller"]),
    Param::new(
        "arrival",
        Kind::Choice(&["path", "lights"]),
        "path",
        "how light is found where a residual path arrives: by path tracing from there on, or by all lights again as in the paper (slower, less noise)",
    )
    .part_of("compensation", &["kollig-keller"]),
];

pub(crate) fn compensation(v: &Values) -> Result<Compensation, RecipeError> {
    Ok(match v.text("compensation") {
        "kollig-keller" => {
            let steps = match v.text("steps") {
                "none" => None,
                _ => Some(v.integer("steps")? as u32),
            };
            let arrival = if v.text("arrival") == "lights" { Arrival::Lights } else { Arrival::Path };
            Compensation::Point(Box::new(KolligKeller { steps, arrival }))
        }
        _ => Compensation::None,
    })
}
