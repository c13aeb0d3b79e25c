//! Virtual lights in media: point lights at collisions, and ray lights.

use crate::params::{Kind, Param, WHOLE};
use crate::parts::compensation::{continued_paths, steps};
use crate::parts::{bound, sharp};
use crate::values::Values;
use crate::{RecipeError, parts::direct};
use manylight_compensation::{BoundPlan, Engelhardt};
use manylight_framework::{Compensation, Generator, Method, Plan};
use manylight_light_list::{All, Power};
use manylight_many_lights::{InMedia, ManyLights, Sampled, Whole};
use manylight_scene::Scene;
use manylight_vpl::{Emission, Emitters, Keller, NoLights, Points, Sum, Vpl};
use manylight_vrl::{Extent, RayWalk, Rays, Vrl};

pub(crate) const PARAMS: &[Param] = &[
    Param::new("paths", Kind::Integer { min: 1, max: 1 << 24 }, "64", "light paths a pass"),
    Param::new(
        "rr-depth",
        Kind::Integer { min: 1, max: WHOLE },
        "1",
        "light path length from which Russian roulette may end a path",
    )
    .unit("edges"),
    Param::new("lights", Kind::Choice(&["all", "power"]), "all", "the light set: which lights each receiver asks"),
    Param::new("samples", Kind::Integer { min: 1, max: 1 << 20 }, "64", "lights that each receiver asks")
        .part_of("lights", &["power"]),
];

const SEGMENT: &[Param] = &[
    Param::new(
        "segment",
        Kind::Choice(&["span", "points"]),
        "span",
        "how the camera's ray through a medium is gathered: each light draws its own point on it (by angle), or all share points \
         drawn by free flight",
    ),
    Param::new("points", Kind::Integer { min: 1, max: 1024 }, "1", "points a segment").part_of("segment", &["points"]),
];

const COMPENSATION: &[Param] = &[
    Param::new(
        "compensation",
        Kind::Choice(&["none", "raab", "engelhardt"]),
        "none",
        "estimates what the bound takes away; `raab`: by continued paths, and with them light through mirrors and glass; `engelhardt`: as if the medium around each point were even and empty (biased)",
    ),
    Param::new(
        "steps",
        Kind::IntegerOr { min: 1, max: 1 << 16, words: &["none"] },
        "none",
        "residual steps at most; `none`: no limit (raab: unbiased). Of engelhardt, in media: what comes after is a geometric series",
    )
    .part_of("compensation", &["raab", "engelhardt"]),
    Param::new(
        "arrival",
        Kind::Choice(&["lights", "path"]),
        "lights",
        "how light is found where a residual path arrives: by all lights again as in the paper, or by path tracing from there on (fewer rays, more noise)",
    )
    .part_of("compensation", &["raab"]),
];

const RAYS: &[Param] = &[
    Param::new(
        "rays",
        Kind::Choice(&["short", "long"]),
        "short",
        "where ray lights end: where their light path collided, or at the next surface",
    ),
    Param::new(
        "direct",
        Kind::Choice(&["sampled", "virtual"]),
        "sampled",
        "direct light by sampling the emitters, or by virtual lights on them",
    ),
];

/// Of `vrl`.
pub(crate) const VRL: &[&[Param]] = &[PARAMS, RAYS, bound::PARAMS, sharp::PARAMS];

pub(crate) fn rays(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let power = Power { samples: v.integer("samples")? as u32 };
    match v.text("lights") {
        "power" => by_rays(v, scene, (power, power)),
        _ => by_rays(v, scene, (All, All)),
    }
}

fn by_rays<P>(v: &Values, scene: &Scene, plan: P) -> Result<Box<dyn Method>, RecipeError>
where
    P: Plan<(Vec<Vpl>, Vec<Vrl>)> + 'static,
    InMedia<(Vec<Vpl>, Vec<Vrl>), P, Rays, BoundPlan, Whole>: Method,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let generator = Box::new(ray_walk(v, max_edges, v.text("direct") == "virtual")?);
    let (bounding, compensation, sharp) = (of_geometry(v)?, Compensation::None, v.number("sharp")?);
    let lights = ManyLights { generator, plan, kernel: Rays, bounding, compensation, max_edges, min_edges, sharp };
    Ok(Box::new(InMedia { lights, segment: Whole }))
}

fn of_geometry(v: &Values) -> Result<BoundPlan, RecipeError> {
    if v.text("bound-of") != "geometry" {
        return Err(RecipeError::Contrary(
            "bound-of=contribution is for surfaces: a lobe in a medium has a unit of length. Say bound-of=geometry"
                .into(),
        ));
    }
    bound::plan(v)
}

/// The walk whose edges are ray lights, or beams.
pub(crate) fn ray_walk(v: &Values, max_edges: u32, emitters: bool) -> Result<RayWalk, RecipeError> {
    Ok(RayWalk {
        paths: v.integer("paths")?,
        max_edges: (max_edges != u32::MAX).then_some(max_edges),
        certain_edges: v.integer("rr-depth")? as u32,
        emitters,
        extent: if v.text("rays") == "long" { Extent::Long } else { Extent::Short },
    })
}

/// Of `media-vpl`.
pub(crate) const MEDIA_VPL: &[&[Param]] =
    &[PARAMS, SEGMENT, bound::PARAMS, COMPENSATION, direct::PARAMS, sharp::PARAMS];

pub(crate) fn vpls(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    match v.text("lights") {
        "power" => under(v, scene, Power { samples: v.integer("samples")? as u32 }),
        _ => under(v, scene, All),
    }
}

fn under<P: Plan<Vec<Vpl>> + 'static>(v: &Values, scene: &Scene, plan: P) -> Result<Box<dyn Method>, RecipeError>
where
    InMedia<Vec<Vpl>, P, Points, BoundPlan, Whole>: Method,
    InMedia<Vec<Vpl>, P, Points, BoundPlan, Sampled>: Method,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let (bounding, compensation, sharp) = (of_geometry(v)?, compensation(v)?, v.number("sharp")?);
    let generator = generator(v, scene)?;
    let lights = ManyLights { generator, plan, kernel: Points, bounding, compensation, max_edges, min_edges, sharp };
    Ok(match v.text("segment") {
        "points" => Box::new(InMedia { lights, segment: Sampled { points: v.integer("points")? as u32 } }),
        _ => Box::new(InMedia { lights, segment: Whole }),
    })
}

/// Of what the bound takes from lights on surfaces and in media.
fn compensation(v: &Values) -> Result<Compensation, RecipeError> {
    if v.text("compensation") == "none" {
        return Ok(Compensation::None);
    }
    if v.text("direct") == "only" {
        return Err(RecipeError::Contrary(
            "with direct=only there are no lights that a bound could take from: leave `compensation` out".into(),
        ));
    }
    Ok(Compensation::Point(match v.text("compensation") {
        "engelhardt" => Box::new(Engelhardt { steps: steps(v)? }),
        _ => Box::new(continued_paths(v)?),
    }))
}

/// Keller's walk leaves lights at collisions too.
fn generator(v: &Values, scene: &Scene) -> Result<Box<dyn Generator<Lights = Vec<Vpl>>>, RecipeError> {
    let (_, max_edges) = v.depths(scene)?;
    let paths = v.integer("paths")?;
    let keller = Keller {
        paths,
        max_edges: (max_edges != u32::MAX).then_some(max_edges),
        certain_edges: v.integer("rr-depth")? as u32,
        emission: Emission::Full,
    };
    Ok(match v.text("direct") {
        "only" => Box::new(NoLights),
        "virtual" => Box::new(Sum(vec![Box::new(keller), Box::new(Emitters { paths })])),
        _ => Box::new(keller),
    })
}
