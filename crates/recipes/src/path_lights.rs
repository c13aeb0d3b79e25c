//! The path tracer that asks a light set.

use crate::RecipeError;
use crate::params::{Kind, Param, WHOLE};
use crate::values::Values;
use manylight_framework::{Method, Plan};
use manylight_lamps::{ByPicks, BySum, Lamp, NextEvent, PathLights};
use manylight_light_list::{All, Power};
use manylight_light_tree::{CutBy, Growth, LightBvh, StochasticLightcuts};
use manylight_scene::Scene;

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "lights",
        Kind::Choice(&["light-bvh", "stochastic-lightcuts", "power", "all"]),
        "light-bvh",
        "the light set over the emitters: which of them each vertex asks",
    ),
    Param::new(
        "mis",
        Kind::Choice(&["on", "off"]),
        "on",
        "one emitter a vertex, combined with directions drawn by the BSDF; `off`: `samples` emitters a vertex, alone. `all` has no \
         probability of picking one, and so needs `off`",
    ),
    Param::new(
        "samples",
        Kind::Integer { min: 1, max: 4096 },
        "1",
        "emitters that each vertex asks (the size of a cut, for stochastic lightcuts)",
    )
    .part_of("mis", &["off"]),
    Param::new(
        "rr-depth",
        Kind::IntegerOr { min: 1, max: WHOLE, words: &["scene"] },
        "scene",
        "path length from which Russian roulette may end a path; `scene`: what the file says, or 5",
    )
    .unit("edges"),
];

pub(crate) fn path_lights(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let samples = v.integer("samples")? as u32;
    let growth = Growth::default();
    let cut = StochasticLightcuts { size: samples, by: CutBy::Size, growth };
    let (bvh, power) = (LightBvh { samples, growth }, Power { samples });
    match (v.text("lights"), v.text("mis")) {
        ("stochastic-lightcuts", "on") => made(v, scene, cut, ByPicks),
        ("power", "on") => made(v, scene, power, ByPicks),
        ("light-bvh", "on") => made(v, scene, bvh, ByPicks),
        ("stochastic-lightcuts", _) => made(v, scene, cut, BySum),
        ("power", _) => made(v, scene, power, BySum),
        ("light-bvh", _) => made(v, scene, bvh, BySum),
        (_, "on") => Err(RecipeError::Contrary(
            "lights=all asks every emitter and picks none, which mis=on needs: say mis=off, or another light set"
                .into(),
        )),
        _ if v.is_given("samples") => {
            Err(RecipeError::Contrary("lights=all asks every emitter: leave `samples` out".into()))
        }
        _ => made(v, scene, All, BySum),
    }
}

fn made<P, N>(v: &Values, scene: &Scene, plan: P, next_event: N) -> Result<Box<dyn Method>, RecipeError>
where
    P: Plan<Vec<Lamp>> + 'static,
    N: NextEvent<P::Set> + 'static,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let certain_edges = match v.text("rr-depth") {
        "scene" => scene.rr_depth().unwrap_or(5),
        _ => v.integer("rr-depth")? as u32,
    };
    Ok(Box::new(PathLights { plan, next_event, max_edges, min_edges, certain_edges }))
}
