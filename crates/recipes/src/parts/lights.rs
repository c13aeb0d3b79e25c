//! The light set: which lights each receiver asks.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::parts::{bound, compensation};
use crate::values::Values;
use manylight_compensation::BoundPlan;
use manylight_framework::{Generator, Kernel, Method, Plan, VirtualLight};
use manylight_light_list::{All, Power};
use manylight_many_lights::ManyLights;
use manylight_scene::{Scene, Vertex};

pub(crate) const PARAMS: &[Param] = &[
    Param::new("lights", Kind::Choice(&["all", "power"]), "all", "the light set: which lights each point asks"),
    Param::new("samples", Kind::Integer { min: 1, max: 1 << 20 }, "64", "lights that each point asks")
        .part_of("lights", &["power"]),
];

/// Lights of any kind, with a kernel that connects to them, under the light set that was asked for.
pub(crate) fn under<L, K>(
    v: &Values,
    scene: &Scene,
    generator: Box<dyn Generator<Lights = Vec<L>>>,
    kernel: K,
) -> Result<Box<dyn Method>, RecipeError>
where
    L: VirtualLight + 'static,
    K: Kernel<Vertex, L> + Send + 'static,
{
    match v.text("lights") {
        "power" => composed(v, scene, generator, Power { samples: v.integer("samples")? as u32 }, kernel),
        _ => composed(v, scene, generator, All, kernel),
    }
}

fn composed<L, P, K>(
    v: &Values,
    scene: &Scene,
    generator: Box<dyn Generator<Lights = Vec<L>>>,
    plan: P,
    kernel: K,
) -> Result<Box<dyn Method>, RecipeError>
where
    L: 'static,
    P: Plan<Vec<L>> + 'static,
    K: 'static,
    ManyLights<Vec<L>, P, K, BoundPlan>: Method,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let (bounding, compensator) = (bound::plan(v)?, compensation::compensator(v)?);
    Ok(Box::new(ManyLights { generator, plan, kernel, bounding, compensator, max_edges, min_edges }))
}
