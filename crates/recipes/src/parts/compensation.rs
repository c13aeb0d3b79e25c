//! What becomes of that which a bound takes away.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;
use manylight_compensation::{Arrival, KolligKeller, LocalLights, ScreenSpace};
use manylight_framework::Compensation;
use manylight_scene::Scene;

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "compensation",
        Kind::Choice(&["none", "kollig-keller", "screen-space", "local"]),
        "none",
        "estimates what the bound takes away; `kollig-keller`: by continued paths, and with them light through mirrors and glass; `screen-space`: by what the image shows; `local`: by lights that the pixels of a tile find for each other",
    ),
    Param::new(
        "steps",
        Kind::IntegerOr { min: 1, max: 1 << 16, words: &["none"] },
        "none",
        "residual steps at most; `none`: no limit, unbiased (screen-space: 4)",
    )
    .part_of("compensation", &["kollig-keller", "screen-space"]),
    Param::new(
        "arrival",
        Kind::Choice(&["lights", "path"]),
        "lights",
        "how light is found where a residual path arrives: by all lights again as in the paper, or by path tracing from there on (fewer rays, more noise)",
    )
    .part_of("compensation", &["kollig-keller"]),
    Param::new("neighbours", Kind::Integer { min: 1, max: 4096 }, "32", "pixels that each pixel asks in a step")
        .part_of("compensation", &["screen-space"]),
    Param::new("tile", Kind::Integer { min: 1, max: 256 }, "8", "side of a tile whose pixels share their local lights")
        .unit("pixel")
        .part_of("compensation", &["local"]),
    Param::new(
        "visibility",
        Kind::Choice(&["exact", "one-sample"]),
        "exact",
        "ask whether each pixel of the tile sees a local light, or take the answer of the one that found it for all (biased, faster)",
    )
    .part_of("compensation", &["local"]),
];

/// Are the lights asked where residual paths arrive, too?
pub(crate) fn asks_lights_further_on(v: &Values) -> bool {
    match v.text("compensation") {
        "kollig-keller" => v.text("arrival") == "lights" || v.text("steps") != "none",
        name => name == "local",
    }
}

/// `None`: no limit.
pub(crate) fn steps(v: &Values) -> Result<Option<u32>, RecipeError> {
    Ok(match v.text("steps") {
        "none" => None,
        _ => Some(v.integer("steps")? as u32),
    })
}

/// By `steps` and `arrival`.
pub(crate) fn continued_paths(v: &Values) -> Result<KolligKeller, RecipeError> {
    let arrival = if v.text("arrival") == "lights" { Arrival::Lights } else { Arrival::Path };
    Ok(KolligKeller { steps: steps(v)?, arrival })
}

pub(crate) fn compensation(v: &Values, scene: &Scene) -> Result<Compensation, RecipeError> {
    let name = v.text("compensation");
    if name != "none" && scene.has_media() {
        return Err(RecipeError::Contrary(format!(
            "compensation={name} is for surfaces, and the scene has media: say compensation=none"
        )));
    }
    Ok(match name {
        "kollig-keller" => Compensation::Point(Box::new(continued_paths(v)?)),
        "screen-space" => {
            if v.is_given("min-depth") && v.integer("min-depth")? > 1 {
                return Err(RecipeError::Contrary(
                    "compensation=screen-space takes what surfaces send from the image, which min-depth leaves incomplete: leave one out"
                        .into(),
                ));
            }
            if v.integer("spp")? > 1 {
                return Err(RecipeError::Contrary(
                    "compensation=screen-space knows the first camera sample of each pixel alone: say spp=1, and more passes".into(),
                ));
            }
            let steps = if v.text("steps") == "none" { 4 } else { v.integer("steps")? as u32 };
            Compensation::Frame(Box::new(ScreenSpace { steps, samples: v.integer("neighbours")? as u32 }))
        }
        "local" => {
            let exact = v.text("visibility") == "exact";
            Compensation::Frame(Box::new(LocalLights { tile: v.integer("tile")? as u32, exact }))
        }
        _ => Compensation::None,
    })
}
