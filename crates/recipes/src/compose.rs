//! From values to methods.

use crate::RecipeError;
use crate::values::Values;
use manylight_compensation::BoundPlan;
use manylight_framework::{Generator, Method, NoCompensation, Plan};
use manylight_light_list::{All, Power};
use manylight_many_lights::ManyLights;
use manylight_reference::PathTracer;
use manylight_scene::Scene;
use manylight_vpl::{Emission, Emitters, Keller, NoLights, Points, Sum, Vpl};

pub(crate) fn path(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let (min_edges, max_edges) = v.depths(scene)?;
    let certain_edges = match v.text("rr-depth") {
        "scene" => scene.rr_depth().unwrap_or(5),
        _ => v.integer("rr-depth")? as u32,
    };
    Ok(Box::new(PathTracer { max_edges, min_edges, certain_edges, next_event: v.text("nee") == "on" }))
}

/// Without `direct`, these parameters would be read by nobody.
const OF_THE_LIGHTS: &[&str] =
    &["generator", "paths", "rr-depth", "glossy-vpls", "lights", "samples", "bound", "compensation"];

pub(crate) fn many_lights(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let (_, max_edges) = v.depths(scene)?;
    let limit = (max_edges != u32::MAX).then_some(max_edges);
    let paths = v.integer("paths")?;
    let emission = if v.text("glossy-vpls") == "on" { Emission::Full } else { Emission::Diffuse };
    let certain_edges = v.integer("rr-depth")? as u32;
    let keller = Keller { paths, max_edges: limit, certain_edges, emission };
    let generator: Box<dyn Generator<Lights = Vec<Vpl>>> = match v.text("direct") {
        "only" => {
            if let Some(name) = OF_THE_LIGHTS.iter().find(|n| v.is_given(n)) {
                return Err(RecipeError::Contrary(format!(
                    "direct=only makes no virtual lights, so `{name}` says nothing: leave one out"
                )));
            }
            Box::new(NoLights)
        }
        "virtual" => Box::new(Sum(vec![Box::new(keller), Box::new(Emitters { paths })])),
        _ => Box::new(keller),
    };
    if v.is_given("samples") && v.text("lights") != "power" {
        return Err(RecipeError::Contrary("`samples` is for lights=power: leave it out, or say so".into()));
    }
    match v.text("lights") {
        "power" => composed(v, scene, generator, Power { samples: v.integer("samples")? as u32 }),
        _ => composed(v, scene, generator, All),
    }
}

fn composed<P>(
    v: &Values,
    scene: &Scene,
    generator: Box<dyn Generator<Lights = Vec<Vpl>>>,
    plan: P,
) -> Result<Box<dyn Method>, RecipeError>
where
    P: Plan<Vec<Vpl>> + 'static,
    ManyLights<Vec<Vpl>, P, Points, BoundPlan>: Method,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let bounding = match v.text("bound") {
        "none" => BoundPlan::None,
        "auto" => BoundPlan::Auto,
        _ => BoundPlan::Fixed(v.number("bound")?),
    };
    // Nothing to bound, nothing to lose.
    let bounding = if v.text("direct") == "only" { BoundPlan::None } else { bounding };
    let compensator = Box::new(NoCompensation);
    Ok(Box::new(ManyLights { generator, plan, kernel: Points, bounding, compensator, max_edges, min_edges }))
}
