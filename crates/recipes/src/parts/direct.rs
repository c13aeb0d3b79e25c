//! Who brings direct light.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::parts::MANY_LIGHTS;
use crate::values::Values;

pub(crate) const PARAMS: &[Param] = &[Param::new(
    "direct",
    Kind::Choice(&["sampled", "virtual", "only"]),
    "sampled",
    "direct light by sampling the emitters, by virtual lights on them (adds generator `emitters`), or direct light alone",
)];

/// Does `direct` add the generator `emitters` to those that were named?
pub(crate) fn adds_emitters(v: &Values) -> bool {
    v.text("direct") == "virtual" && !v.has_term("generator", "emitters")
}

/// Refuses what says contrary things about direct light.
pub(crate) fn check(v: &Values) -> Result<(), RecipeError> {
    let own = |name: &str| PARAMS.iter().any(|p| p.name == name);
    if v.text("direct") == "only" {
        let idle = MANY_LIGHTS.iter().copied().flatten().find(|p| !own(p.name) && v.is_given(p.name));
        if let Some(p) = idle {
            return Err(RecipeError::Contrary(format!(
                "direct=only makes no virtual lights, so `{}` says nothing: leave one out",
                p.name
            )));
        }
    } else if v.is_given("direct") && v.text("direct") == "sampled" && v.has_term("generator", "emitters") {
        return Err(RecipeError::Contrary(
            "generator=emitters brings direct light by virtual lights, direct=sampled without: leave one out".into(),
        ));
    }
    Ok(())
}
