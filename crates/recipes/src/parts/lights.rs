//! The light set: which lights each receiver asks.

use crate::RecipeError;
use crate::params::{Kind, Param, WHOLE};
use crate::parts::{bound, compensation, sharp};
use crate::values::Values;
use manylight_compensation::BoundPlan;
use manylight_framework::{Bounds, Clustered, Generator, Kernel, Method, Plan, Reaches};
use manylight_lamps::{LampKernel, Lamps};
use manylight_light_list::{All, Power};
use manylight_light_tree::{Build, CutBy, Growth, LightBvh, Lightcuts, Standing, StochasticLightcuts};
use manylight_many_lights::ManyLights;
use manylight_scene::{Scene, Vertex};

const ON_TREES: &[&str] = &["lightcuts", "stochastic-lightcuts", "light-bvh"];

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "lights",
        Kind::Choice(&["all", "power", "lightcuts", "stochastic-lightcuts", "light-bvh"]),
        "all",
        "the light set: which lights each point asks",
    ),
    Param::new("samples", Kind::Integer { min: 1, max: 1 << 20 }, "64", "lights that each point asks")
        .part_of("lights", &["power", "light-bvh"]),
    Param::new(
        "error",
        Kind::NumberOr(&["none"]),
        "0.02",
        "largest error of a cluster, relative to all light; `none`: refine down to every light",
    )
    .part_of("lights", &["lightcuts"]),
    Param::new("max-cut", Kind::Integer { min: 1, max: WHOLE }, "1000", "clusters of a cut at most, and so shadow rays")
        .part_of("lights", &["lightcuts"]),
    Param::new(
        "representatives",
        Kind::Choice(&["pass", "receiver", "brightest"]),
        "pass",
        "the light that stands for a cluster: drawn for the whole pass, drawn by each receiver (noise instead of shared errors), \
         or always the brightest",
    )
    .part_of("lights", &["lightcuts"]),
    Param::new(
        "trees",
        Kind::Integer { min: 1, max: 64 },
        "1",
        "trees of a pass, which differ in the lights that stand for clusters; each receiver asks one: several turn errors that \
         neighbours share into noise",
    )
    .part_of("representatives", &["pass"]),
    Param::new("cut", Kind::Integer { min: 1, max: 4096 }, "10", "clusters of a cut at most, and so shadow rays")
        .part_of("lights", &["stochastic-lightcuts"]),
    Param::new(
        "cut-error",
        Kind::NumberOr(&["none"]),
        "none",
        "coarser cuts where no cluster's estimated error exceeds this part of all light: a small bias; `none`: cuts of fixed size",
    )
    .part_of("lights", &["stochastic-lightcuts"]),
    Param::new(
        "tree",
        Kind::Choice(&["fast", "greedy"]),
        "fast",
        "how the tree is built: by medians, or the cheapest pair first (time goes with the square of the number of lights)",
    )
    .part_of("lights", ON_TREES),
];

/// Lights of any kind, with a kernel that connects to them, under the light set that was asked for.
pub(crate) fn under<L, K>(
    v: &Values,
    scene: &Scene,
    generator: Box<dyn Generator<Lights = Vec<L>>>,
    kernel: K,
) -> Result<Box<dyn Method>, RecipeError>
where
    L: Clustered + 'static,
    K: Kernel<Vertex, L> + Bounds<Vertex, L::Cluster> + Reaches<Vertex, L::Cluster> + Send + 'static,
{
    let growth = growth(v, scene)?;
    let or_none = |name: &str, none: f32| if v.text(name) == "none" { Ok(none) } else { v.number(name) };
    match v.text("lights") {
        "power" => composed(v, scene, generator, Power { samples: v.integer("samples")? as u32 }, kernel),
        "light-bvh" => composed(v, scene, generator, light_bvh(v, growth)?, kernel),
        "lightcuts" => {
            let standing = match v.text("representatives") {
                "receiver" => Standing::Receiver,
                "brightest" => Standing::Brightest,
                _ => Standing::Pass(v.integer("trees")? as u32),
            };
            let (error, most) = (or_none("error", 0.0)?, v.integer("max-cut")? as u32);
            composed(v, scene, generator, Lightcuts { error, most, standing, growth }, kernel)
        }
        "stochastic-lightcuts" => composed(v, scene, generator, stochastic(v, growth)?, kernel),
        _ => composed(v, scene, generator, All, kernel),
    }
}

fn light_bvh(v: &Values, growth: Growth) -> Result<LightBvh, RecipeError> {
    Ok(LightBvh { samples: v.integer("samples")? as u32, growth })
}
fn stochastic(v: &Values, growth: Growth) -> Result<StochasticLightcuts, RecipeError> {
    let by = match v.text("cut-error") {
        "none" => CutBy::Size,
        _ => CutBy::Error(v.number("cut-error")?),
    };
    Ok(StochasticLightcuts { size: v.integer("cut")? as u32, by, growth })
}

/// Direct light alone, from the emitters themselves.
pub(crate) fn over_lamps(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let growth = growth(v, scene)?;
    match v.text("lights") {
        "light-bvh" => composed(v, scene, Box::new(Lamps), light_bvh(v, growth)?, LampKernel),
        _ => composed(v, scene, Box::new(Lamps), stochastic(v, growth)?, LampKernel),
    }
}

/// How trees grow. Where one light stands for others, lights that some receivers cannot connect to (too long a path, or too
/// short) are kept apart.
fn growth(v: &Values, scene: &Scene) -> Result<Growth, RecipeError> {
    let (min_edges, max_edges) = v.depths(scene)?;
    let build = if v.text("tree") == "greedy" { Build::Greedy } else { Build::Fast };
    let limited = max_edges != u32::MAX || min_edges > 1;
    let together = match v.text("lights") == "lightcuts" && limited {
        // Behind delta and sharp lobes, and where residual paths arrive, there are receivers of any depth: none may share.
        true if scene.has_delta_lobes()
            || scene.has_lobes_as_sharp_as(sharp::sharp(v)?)
            || compensation::asks_lights_further_on(v) =>
        {
            (u32::MAX, 0)
        }
        // All receivers are one edge from the eye.
        true => (min_edges.saturating_sub(2), max_edges.saturating_sub(2)),
        false => Growth::ALL_DEPTHS,
    };
    Ok(Growth { build, together, ..Growth::default() })
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
    let (bounding, compensation) = (bound::plan(v)?, compensation::compensation(v, scene)?);
    let sharp = sharp::sharp(v)?;
    Ok(Box::new(ManyLights { generator, plan, kernel, bounding, compensation, max_edges, min_edges, sharp }))
}
