//! Where virtual lights come from.

use crate::params::{Kind, Param, WHOLE};
use crate::values::Values;
use crate::{RecipeError, parts::direct};
use manylight_framework::Generator;
use manylight_scene::Scene;
use manylight_vpl::{Emission, Emitters, Keller, NoLights, Sum, Vpl};

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "generator",
        Kind::Sum(&["keller", "emitters"]),
        "keller",
        "where the virtual lights come from; `emitters`: points of the emitters, for direct light",
    ),
    Param::new("paths", Kind::Integer { min: 1, max: 1 << 24 }, "64", "light paths a pass"),
    Param::new(
        "rr-depth",
        Kind::Integer { min: 1, max: WHOLE },
        "1",
        "light path length from which Russian roulette may end a path",
    )
    .unit("edges")
    .part_of("generator", &["keller"]),
    Param::new(
        "glossy-vpls",
        Kind::Choice(&["on", "off"]),
        "on",
        "lights emit by their BSDF; `off`: as diffuse surfaces of the same albedo (keeps the energy, not its directions)",
    )
    .part_of("generator", &["keller"]),
];

pub(crate) type Vpls = Box<dyn Generator<Lights = Vec<Vpl>>>;

/// The generator, or the sum of several.
pub(crate) fn vpls(v: &Values, scene: &Scene) -> Result<Vpls, RecipeError> {
    if v.text("direct") == "only" {
        return Ok(Box::new(NoLights));
    }
    let mut terms = v.text("generator").split('+').map(|t| one(t, v, scene)).collect::<Result<Vec<_>, _>>()?;
    if direct::adds_emitters(v) {
        terms.push(one("emitters", v, scene)?);
    }
    Ok(if terms.len() == 1 { terms.remove(0) } else { Box::new(Sum(terms)) })
}

fn one(name: &str, v: &Values, scene: &Scene) -> Result<Vpls, RecipeError> {
    let paths = v.integer("paths")?;
    Ok(match name {
        "emitters" => Box::new(Emitters { paths }),
        _ => Box::new(keller(v, scene)?),
    })
}

/// The walks that other generators start from, too.
fn keller(v: &Values, scene: &Scene) -> Result<Keller, RecipeError> {
    let (_, max_edges) = v.depths(scene)?;
    Ok(Keller {
        paths: v.integer("paths")?,
        max_edges: (max_edges != u32::MAX).then_some(max_edges),
        certain_edges: v.integer("rr-depth")? as u32,
        emission: if v.text("glossy-vpls") == "on" { Emission::Full } else { Emission::Diffuse },
    })
}
