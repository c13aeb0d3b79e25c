//! What a virtual light is, and so how a receiver is connected to it.

use crate::RecipeError;
use crate::params::{Kind, Param};
use crate::parts::{direct, generator, lights};
use crate::values::Values;
use manylight_framework::Method;
use manylight_scene::Scene;
use manylight_vpl::Points;
use manylight_vsl::{Radius, Sampling, SphereKernel, Spheres};

const OF_SPHERES: &[&str] = &["sphere"];

pub(crate) const PARAMS: &[Param] = &[
    Param::new(
        "kernel",
        Kind::Choice(&["point", "sphere"]),
        "point",
        "what a virtual light is; `sphere`: its light is spread over a radius, which blurs it and takes its spikes",
    ),
    Param::new(
        "radius",
        Kind::NumberOr(&["neighbours", "even"]),
        "neighbours",
        "of spheres; `neighbours`: by the distance to the tenth light that faces alike; `even`: each light's share of the scene's surface",
    )
    .unit("m")
    .part_of("kernel", OF_SPHERES),
    Param::new("radius-scale", Kind::Number { min: 1e-6, max: 1e6 }, "1", "times the radius of spheres")
        .part_of("kernel", OF_SPHERES),
    Param::new(
        "shrink",
        Kind::NumberOr(&["none"]),
        "none",
        "a number alpha below 1: radii of pass i are those of the first times i^((alpha - 1) / 2), so that the image converges to the truth; 0.5 suits corners, 0.67 smooth surfaces",
    )
    .part_of("kernel", OF_SPHERES),
    Param::new(
        "sphere-sampling",
        Kind::Choice(&["mis", "cone", "receiver", "light"]),
        "mis",
        "how directions to a sphere are drawn: evenly in its cone, by the receiver's BSDF, by the light's, or all combined",
    )
    .part_of("kernel", OF_SPHERES),
    Param::new(
        "sphere-samples",
        Kind::Number { min: 1e-3, max: 16.0 },
        "4",
        "directions of a kind to a sphere that fills the hemisphere; in proportion fewer to others, at least one",
    )
    .part_of("kernel", OF_SPHERES),
];

/// Neighbours by which local density is judged.
const NEIGHBOURS: u32 = 10;

/// The kernel decides the type of the lights, and so comes first.
pub(crate) fn compose(v: &Values, scene: &Scene) -> Result<Box<dyn Method>, RecipeError> {
    let points = generator::vpls(v, scene)?;
    if v.text("kernel") == "point" {
        return lights::under(v, scene, points, Points);
    }
    let scale = v.number("radius-scale")?;
    let radius = match v.text("radius") {
        "neighbours" => Radius::Neighbours { k: NEIGHBOURS, scale },
        "even" => Radius::Even { scale },
        _ => Radius::Fixed(v.number("radius")? * scale),
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
    let sampling = match v.text("sphere-sampling") {
        "cone" => Sampling::Cone,
        "receiver" => Sampling::Receiver,
        "light" => Sampling::Light,
        _ => Sampling::Mis,
    };
    let points_too = direct::adds_emitters(v) || v.has_term("generator", "emitters");
    let kernel = SphereKernel { sampling, samples: v.number("sphere-samples")?, points_too };
    lights::under(v, scene, Box::new(Spheres { points, radius, shrink }), kernel)
}
