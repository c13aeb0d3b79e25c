//! Photon maps and photon beams.

use crate::RecipeError;
use crate::params::{Kind, Param, WHOLE};
use crate::parts::{media, sharp};
use crate::values::Values;
use manylight_compensation::BoundPlan;
use manylight_framework::{Compensation, Generator, Method, Plan};
use manylight_many_lights::{InMedia, ManyLights, Parted, Segment, Whole};
use manylight_photon::{BeamSource, Estimate, Nearby, PhotonBeams, Photons, Radii};
use manylight_scene::Scene;
use manylight_vpl::{Emission, Keller};
use manylight_vrl::Vrl;

const PARAMS: &[Param] = &[
    Param::new("paths", Kind::Integer { min: 1, max: 1 << 24 }, "4096", "light paths a pass"),
    Param::new(
        "rr-depth",
        Kind::Integer { min: 1, max: WHOLE },
        "1",
        "light path length from which Russian roulette may end a path",
    )
    .unit("edges"),
    Param::new(
        "radius",
        Kind::NumberOr(&["auto"]),
        "auto",
        "within which photons count in the first pass; `auto`: a hundredth of the scene's radius",
    )
    .unit("m"),
    Param::new(
        "shrink",
        Kind::NumberOr(&["none"]),
        "0.5",
        "a number alpha below 1: radii of pass i are those of the first times i^((alpha - 1) / m), where a radius blurs in m dimensions, so that the image converges to the truth; `none`: they stay",
    ),
];
const SAMPLES: &[Param] =
    &[Param::new("points", Kind::Integer { min: 1, max: 1024 }, "4", "points of the camera's ray in each medium")];
const EXTENT: &[Param] = &[Param::new(
    "rays",
    Kind::Choice(&["short", "long"]),
    "short",
    "where beams end: where their light path collided, or at the next surface",
)];

/// Of `photon-map`.
pub(crate) const POINTS: &[&[Param]] = &[PARAMS, SAMPLES, sharp::PARAMS];
/// Of `beam-radiance`.
pub(crate) const RAYS: &[&[Param]] = &[PARAMS, sharp::PARAMS];
/// Of `photon-beams`.
pub(crate) const BEAMS: &[&[Param]] = &[PARAMS, EXTENT, sharp::PARAMS];

/// Of the scene's radius.
const AUTO: f32 = 0.01;

pub(crate) fn at_points(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let segment = Parted { points: v.integer("points")? as u32 };
    composed(v, scene, photons(v, scene, 3.0)?, Nearby, segment)
}

pub(crate) fn at_rays(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    composed(v, scene, photons(v, scene, 2.0)?, Nearby, Whole)
}

pub(crate) fn beams(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let edge = |l: Vrl| BeamSource { span: l.span, flux: l.flux, edges: l.edges, channels: l.channels };
    let rays = Box::new(media::ray_walk(v, longest(v, scene)?, false)?);
    composed(v, scene, Box::new(PhotonBeams { rays, edge, radii: radii(v, scene)? }), (Nearby, Nearby), Whole)
}

fn photons(v: &Values, scene: &Scene, dimensions: f64) -> Result<Box<Photons>, RecipeError> {
    let max_edges = longest(v, scene)?;
    let points = Box::new(Keller {
        paths: v.integer("paths")?,
        max_edges: (max_edges != u32::MAX).then_some(max_edges),
        certain_edges: v.integer("rr-depth")? as u32,
        emission: Emission::Full,
    });
    Ok(Box::new(Photons { points, radii: radii(v, scene)?, dimensions }))
}

/// No edge connects a photon to the eye's vertex: light paths are one edge longer than those of virtual lights.
fn longest(v: &Values, scene: &Scene) -> Result<u32, RecipeError> {
    Ok(v.depths(scene)?.1.saturating_add(1))
}

fn radii(v: &Values, scene: &Scene) -> Result<Radii, RecipeError> {
    let first = match v.text("radius") {
        "auto" => AUTO * (scene.emitters().disc() / std::f32::consts::PI).sqrt(),
        _ => v.number("radius")?,
    };
    let shrink = match v.text("shrink") {
        "none" => None,
        _ => Some(v.number("shrink")?),
    };
    if shrink.is_some_and(|alpha| alpha >= 1.0) {
        return Err(RecipeError::Contrary(
            "shrink: expected a number between 0 and 1, or `none`: from 1 on no radius shrinks".into(),
        ));
    }
    Ok(Radii { first, shrink })
}

fn composed<L, P, M>(
    v: &Values,
    scene: &Scene,
    generator: Box<dyn Generator<Lights = L>>,
    plan: P,
    segment: M,
) -> Result<Box<dyn Method>, RecipeError>
where
    P: Plan<L>,
    M: Segment<P::Set, Estimate, manylight_compensation::Bound> + 'static,
    InMedia<L, P, Estimate, BoundPlan, M>: Method + 'static,
{
    let (min_edges, max_edges) = v.depths(scene)?;
    let (compensation, sharp) = (Compensation::None, v.number("sharp")?);
    let (kernel, bounding) = (Estimate, BoundPlan::NONE);
    let lights = ManyLights { generator, plan, kernel, bounding, compensation, max_edges, min_edges, sharp };
    Ok(Box::new(InMedia { lights, segment }))
}
