//! Media that shine, as lights.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::values::Values;
use manylight_compensation::BoundPlan;
use manylight_framework::{Compensation, Method, Plan};
use manylight_lgh::{Lattice, Lgh, Shadows};
use manylight_light_list::{All, Power};
use manylight_light_tree::{CutBy, Growth, StochasticLightcuts};
use manylight_many_lights::{InMedia, ManyLights, Marched, Sampled};
use manylight_scene::Scene;
use manylight_volume_lights::{Balls, VolumeLight, VolumeLights};

const PARAMS: &[Param] = &[
    Param::new(
        "block",
        Kind::Integer { min: 1, max: 256 },
        "1",
        "voxels along each edge of what becomes one light: coarser, faster, and more biased",
    ),
    Param::new(
        "lights",
        Kind::Choice(&["grid", "all", "power", "stochastic-lightcuts"]),
        "grid",
        "the light set: which lights each receiver asks",
    ),
    Param::new(
        "alpha",
        Kind::Number { min: 0.1, max: 1000.0 },
        "2",
        "reach of each level of the grid in its own spacings: the larger, the slower and the less biased (half of it is alpha by the \
         released header's convention)",
    )
    .part_of("lights", &["grid"]),
    Param::new(
        "shadow-rays",
        Kind::IntegerOr { min: 1, max: 1 << 16, words: &["all"] },
        "8",
        "lights of the grid that each receiver asks for shadows, drawn by what they would bring; `all`: every one",
    )
    .part_of("lights", &["grid"]),
    Param::new("samples", Kind::Integer { min: 1, max: 1 << 20 }, "16", "lights that each receiver asks")
        .part_of("lights", &["power"]),
    Param::new("cut", Kind::Integer { min: 1, max: 4096 }, "10", "clusters of a cut at most, and so shadow rays")
        .part_of("lights", &["stochastic-lightcuts"]),
    Param::new("points", Kind::Integer { min: 1, max: 1024 }, "2", "receivers on the camera's way through a medium"),
    Param::new(
        "march",
        Kind::Choice(&["on", "off"]),
        "on",
        "emission and transmittance along the camera's ray by steps of a voxel: hardly any noise, and a small bias; `off`: drawn, unbiased",
    ),
];

/// Of `lgh`.
pub(crate) const LGH: &[&[Param]] = &[PARAMS];

pub(crate) fn lgh(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let block = v.integer("block")? as usize;
    let lights = VolumeLights::new(scene, block).map_err(|e| RecipeError::Contrary(e.to_string()))?;
    match v.text("lights") {
        "all" => under(v, scene, lights, All),
        "power" => under(v, scene, lights, Power { samples: v.integer("samples")? as u32 }),
        "stochastic-lightcuts" => {
            let (size, by) = (v.integer("cut")? as u32, CutBy::Size);
            under(v, scene, lights, StochasticLightcuts { size, by, growth: Growth::default() })
        }
        _ => {
            let shadows = match v.text("shadow-rays") {
                "all" => Shadows::All,
                _ => Shadows::Drawn(v.integer("shadow-rays")? as u32),
            };
            let plan = Lgh { alpha: v.number("alpha")?, lattice: lattice(&lights), shadows, apart: true };
            under(v, scene, lights, plan)
        }
    }
}

/// Pinned to the grids' boxes, which stay while what is in them moves. h_1 is two blocks.
fn lattice(lights: &VolumeLights) -> Option<Lattice> {
    let (bounds, finest) = (lights.bounds(), 2.0 * lights.spacing());
    if bounds.is_empty() || !finest.is_finite() {
        return None;
    }
    let least = Lattice::around(&bounds, 1);
    let levels = 1 + (least.top / finest).log2().ceil().clamp(0.0, 20.0) as u32;
    let top = finest * 0.5f64.powi(1 - levels as i32);
    Some(Lattice { origin: least.origin + 0.5 * (least.top - top), top, levels })
}

fn under<P>(v: &Values, scene: &Scene, lights: VolumeLights, plan: P) -> Result<Box<dyn Method>, RecipeError>
where
    P: Plan<Vec<VolumeLight>> + 'static,
    InMedia<Vec<VolumeLight>, P, Balls, BoundPlan, Sampled>: Method,
    InMedia<Vec<VolumeLight>, P, Balls, BoundPlan, Marched>: Method,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let (bounding, compensation) = (BoundPlan::NONE, Compensation::None);
    // Sharp lobes too are lit by the lights: what media emit behind them would be counted on the way.
    let (generator, sharp) = (Box::new(lights), 0.0);
    let lights = ManyLights { generator, plan, kernel: Balls, bounding, compensation, max_edges, min_edges, sharp };
    let segment = Sampled { points: v.integer("points")? as u32 };
    Ok(match v.text("march") {
        // (Where nothing emits there is nothing that marching would be worth its bias for.)
        "on" if scene.media_emit() => Box::new(InMedia { lights, segment: Marched(segment) }),
        _ => Box::new(InMedia { lights, segment }),
    })
}
