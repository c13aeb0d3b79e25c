//! Methods that are not made of parts: what the others are measured by.

use crate::RecipeError;
use crate::values::Values;
use manylight_framework::Method;
use manylight_reference::{BidirectionalPathTracer, Combine, PathTracer};
use manylight_scene::Scene;

pub(crate) fn path(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let (min_edges, max_edges) = v.depths(scene)?;
    let certain_edges = certain_edges(v, scene)?;
    Ok(Box::new(PathTracer { max_edges, min_edges, certain_edges, next_event: v.text("nee") == "on" }))
}

pub(crate) fn light_tracing(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    both_ends(v, scene, Combine::LightTracing)
}

pub(crate) fn bidirectional(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    both_ends(v, scene, if v.text("heuristic") == "power" { Combine::Power } else { Combine::Balance })
}

fn both_ends(v: &Values, scene: &Scene, combine: Combine) -> Result<Box<dyn Method>, RecipeError> {
    let (min_edges, max_edges) = v.depths(scene)?;
    let certain_edges = certain_edges(v, scene)?;
    Ok(Box::new(BidirectionalPathTracer { max_edges, min_edges, certain_edges, combine }))
}

fn certain_edges(v: &Values, scene: &Scene) -> Result<u32, RecipeError> {
    Ok(match v.text("rr-depth") {
        "scene" => scene.rr_depth().unwrap_or(5),
        _ => v.integer("rr-depth")? as u32,
    })
}
