//! Who brings direct light.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::parts::{MANY_LIGHTS, lights};
use crate::values::Values;

pub(crate) const PARAMS: &[Param] = &[Param::new(
    "direct",
    Kind::Choice(&["sampled", "virtual", "only"]),
    "sampled",
    "direct light by sampling the emitters, by virtual lights on them (adds generator `emitters`), or direct light alone: \
     sampled; with lights=light-bvh and stochastic-lightcuts from a tree over the emitters themselves; with lights=lightcuts by \
     virtual lights on them",
)];

/// Does `direct` add the generator `emitters` to those that were named?
pub(crate) fn adds_emitters(v: &Values) -> bool {
    v.text("direct") == "virtual" && !v.has_term("generator", "emitters")
}

/// Is direct light taken from the emitters themselves, by a light set that is able to?
pub(crate) fn by_lamps(v: &Values) -> bool {
    v.text("direct") == "only" && ["light-bvh", "stochastic-lightcuts"].contains(&v.text("lights"))
}
/// Is it taken from virtual lights on the emitters, and nothing else?
pub(crate) fn by_points(v: &Values) -> bool {
    v.text("direct") == "only" && v.text("lights") == "lightcuts"
}

/// Refuses what says contrary things about direct light.
pub(crate) fn check(v: &Values) -> Result<(), RecipeError> {
    let own = |name: &str| {
        let of_lights = (by_lamps(v) || by_points(v)) && lights::PARAMS.iter().any(|p| p.name == name);
        of_lights || (by_points(v) && name == "paths") || PARAMS.iter().any(|p| p.name == name)
    };
    if v.text("direct") == "only" {
        let idle = MANY_LIGHTS.iter().copied().flatten().find(|p| !own(p.name) && v.is_given(p.name));
        if let Some(p) = idle {
            return Err(RecipeError::Contrary(format!(
                "with direct=only and lights={} `{}` says nothing: leave one out",
                v.text("lights"),
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
