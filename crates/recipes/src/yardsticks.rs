//! Methods that are not made of parts: what the others are measured by.

use crate::RecipeError;
use crate::values::Values;
use manylight_framework::Method;
use manylight_reference::PathTracer;
use manylight_scene::Scene;

pub(crate) fn path(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let (min_edges, max_edges) = v.depths(scene)?;
    let certain_edges = match v.text("rr-depth") {
        "scene" => scene.rr_depth().unwrap_or(5),
        _ => v.integer("rr-depth")? as u32,
    };
    Ok(Box::new(PathTracer { max_edges, min_edges, certain_edges, next_event: v.text("nee") == "on" }))
}
