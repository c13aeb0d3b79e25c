//! Where virtual lights come from.

use crate::RecipeError;
use crate::params::{Kind, Param, WHOLE};
use crate::parts::{direct, sharp};
use crate::values::Values;
use manylight_framework::Generator;
use manylight_metropolis_ir::Metropolis;
use manylight_scene::Scene;
use manylight_vpl::{Bidirectional, Emission, Emitters, Keller, NoLights, Rejection, Sum, Vpl};

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "generator",
        Kind::Sum(&["keller", "rejection", "bidirectional", "metropolis", "emitters"]),
        "keller",
        "where the virtual lights come from; `rejection`: those that bring the camera something; `bidirectional`: such of \
         those, and of those that eye paths find; `metropolis`: Markov chains look for such; `emitters`: points of the \
         emitters, for direct light",
    ),
    Param::new("paths", Kind::Integer { min: 1, max: 1 << 24 }, "64", "light paths a pass"),
    Param::new(
        "rr-depth",
        Kind::Integer { min: 1, max: WHOLE },
        "1",
        "light path length from which Russian roulette may end a path",
    )
    .unit("edges")
    .part_of("generator", INDIRECT),
    Param::new(
        "glossy-vpls",
        Kind::Choice(&["on", "off"]),
        "on",
        "lights emit by their BSDF; `off`: as diffuse surfaces of the same albedo (keeps the energy, not its directions; rough glass keeps its own)",
    )
    .part_of("generator", INDIRECT),
    Param::new(
        "importons",
        Kind::Integer { min: 1, max: 1 << 20 },
        "1024",
        "points of the image that lights are weighed by, fresh each pass",
    )
    .part_of("generator", WEIGHING),
    Param::new("importance-rays", Kind::Integer { min: 1, max: 1 << 16 }, "32", "of those points, how many weigh one light")
        .part_of("generator", WEIGHING),
    Param::new(
        "importance-floor",
        Kind::Number { min: 1e-6, max: 1.0 },
        "0.02",
        "added to a light's importance over the mean one, so that none is lost which those points do not see",
    )
    .part_of("generator", WEIGHING),
    Param::new(
        "selectivity",
        Kind::Number { min: 1e-3, max: 1e6 },
        "1",
        "a light is kept with its importance over so many times the mean one: the larger, the fewer and the more alike",
    )
    .part_of("generator", &["rejection"]),
    Param::new("reverse", Kind::Integer { min: 1, max: 1 << 24 }, "1024", "candidates that eye paths find")
        .part_of("generator", &["bidirectional"]),
    Param::new("eyes", Kind::Integer { min: 1, max: 1 << 16 }, "32", "points of the image that those start from")
        .part_of("generator", &["bidirectional"]),
    Param::new("gathers", Kind::Integer { min: 1, max: 1 << 16 }, "16", "light path vertices that each of them gathers from")
        .part_of("generator", &["bidirectional"]),
    Param::new("resampled", Kind::Integer { min: 1, max: 1 << 24 }, "256", "lights that are taken of all candidates")
        .part_of("generator", &["bidirectional"]),
    Param::new("chains", Kind::Integer { min: 1, max: 1 << 20 }, "64", "independent chains, which share the steps: `paths`")
        .part_of("generator", CHAINS),
    Param::new(
        "bootstrap",
        Kind::Integer { min: 1, max: 1 << 24 },
        "4096",
        "independent light paths that chains start from, and that say how much light there is",
    )
    .part_of("generator", CHAINS),
    Param::new("tries", Kind::Integer { min: 1, max: 1 << 10 }, "1", "tries of a small step, of which one is proposed")
        .part_of("generator", CHAINS),
    Param::new("large-steps", Kind::Number { min: 0.0, max: 1.0 }, "0.3", "share of steps to a new path")
        .part_of("generator", CHAINS),
    Param::new(
        "camera-steps",
        Kind::Number { min: 0.0, max: 1.0 },
        "0.1",
        "share of steps that weigh the same path by other points of the image",
    )
    .part_of("generator", CHAINS),
];

/// Generators of indirect light: each brings all of it.
const INDIRECT: &[&str] = &["keller", "rejection", "bidirectional", "metropolis"];
/// Those that weigh lights by what they bring to the camera.
const WEIGHING: &[&str] = &["rejection", "bidirectional", "metropolis"];

/// A generator of point lights.
pub type Vpls = Box<dyn Generator<Lights = Vec<Vpl>>>;

/// Those that walk chains.
const CHAINS: &[&str] = &["metropolis"];

/// The generator, or the sum of several.
pub(crate) fn vpls(v: &Values, scene: &Scene) -> Result<Vpls, RecipeError> {
    if direct::by_points(v) {
        return one("emitters", v, scene);
    }
    if v.text("direct") == "only" {
        return Ok(Box::new(NoLights));
    }
    let twice: Vec<_> = INDIRECT.iter().copied().filter(|g| v.has_term("generator", g)).collect();
    if let [one, other, ..] = twice[..] {
        return Err(RecipeError::Contrary(format!(
            "generator={one}+{other} would bring all indirect light twice: choose one of them"
        )));
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
        "rejection" => Box::new(Rejection {
            walks: keller(v, scene)?,
            points: v.integer("importons")? as u32,
            rays: v.integer("importance-rays")? as u32,
            selectivity: v.number("selectivity")?,
            floor: v.number("importance-floor")?,
            sharp: sharp::sharp(v)?,
        }),
        "bidirectional" => Box::new(Bidirectional {
            walks: keller(v, scene)?,
            reverse: v.integer("reverse")?,
            eyes: v.integer("eyes")? as u32,
            gathers: v.integer("gathers")? as u32,
            points: v.integer("importons")? as u32,
            rays: v.integer("importance-rays")? as u32,
            floor: v.number("importance-floor")?,
            lights: v.integer("resampled")?,
            sharp: sharp::sharp(v)?,
        }),
        "metropolis" => Box::new(metropolis(v, scene)?),
        _ => Box::new(keller(v, scene)?),
    })
}

fn metropolis(v: &Values, scene: &Scene) -> Result<Metropolis, RecipeError> {
    let (large, camera) = (v.number("large-steps")?, v.number("camera-steps")?);
    if large + camera > 1.0 {
        return Err(RecipeError::Contrary(format!(
            "large-steps={large} and camera-steps={camera} are more than all steps: their sum is 1 at most"
        )));
    }
    Ok(Metropolis {
        chains: v.integer("chains")? as u32,
        bootstrap: v.integer("bootstrap")?,
        points: v.integer("importons")? as u32,
        rays: v.integer("importance-rays")? as u32,
        floor: v.number("importance-floor")?,
        tries: v.integer("tries")? as u32,
        large,
        camera,
        sharp: sharp::sharp(v)?,
        ..Metropolis::new(keller(v, scene)?)
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
