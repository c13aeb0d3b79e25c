//! Sharp lobes that are walked through instead of being connected to lights leave the mean as it is.
//!
//! Family-wise significance 0.01 by Holm within each verdict; fixed seeds. `MANYLIGHT_EFFORT=16` takes sixteen times the passes.

use manylight_bsdf::{Distribution, RoughTransmittance};
use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_integration::rooms::{built, camera, diffuse, place};
use manylight_integration::{block_runs, effort, recipe};
use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
use manylight_scene::{Emitter, Material, Model, Scene, Source};
use manylight_stats::{BlockTest, Reference, Runs, Verdict};
use std::f64::consts::FRAC_PI_2;

/// What lights the room.
#[derive(Clone, Copy)]
enum Light {
    Lamp,
    /// Without extent: no ray finds them.
    Point,
    Sun,
}

/// A coated floor between a brushed wall and a diffuse one, under a light that both show.
fn polished_room(light: Light) -> Scene {
    let mut b = Scene::builder();
    let rectangle = |m: DAffine3| ShapeGeometry::Mesh(TriangleMesh::rectangle(&m));
    let coated = b.material(Material::two_sided(
        "coated",
        Model::RoughPlastic {
            coat: RoughTransmittance::of(Distribution::Ggx, 0.12, 1.5),
            diffuse: Source::Constant(Spectrum::rgb(0.6, 0.3, 0.2)),
            specular: Source::Constant(Spectrum::ONE),
            nonlinear: true,
        },
    ));
    place(&mut b, rectangle(DAffine3::IDENTITY), coated, None);
    let brushed = b.material(Material::two_sided(
        "brushed",
        Model::RoughConductor {
            distribution: Distribution::Ggx,
            alpha_u: 0.1,
            alpha_v: 0.2,
            eta: Spectrum::gray(0.15),
            k: Spectrum::gray(4.0),
            reflectance: Source::Constant(Spectrum::rgb(1.0, 0.8, 0.6)),
        },
    ));
    let upright = |x: f64| {
        rectangle(DAffine3::from_translation(DVec3::new(x, 0.0, 1.0)) * DAffine3::from_rotation_y(-x * FRAC_PI_2))
    };
    place(&mut b, upright(-1.0), brushed, None);
    let white =
        b.material(Material::two_sided("white", Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.7)) }));
    place(&mut b, upright(1.0), white, None);
    match light {
        Light::Lamp => {
            let black = diffuse(&mut b, Spectrum::BLACK);
            let above = DAffine3::from_translation(DVec3::new(0.2, 0.3, 2.0))
                * DAffine3::from_rotation_x(std::f64::consts::PI)
                * DAffine3::from_scale(DVec3::splat(0.4));
            place(&mut b, rectangle(above), black, Some(Spectrum::gray(6.0)));
        }
        Light::Point => {
            b.emitter(Emitter::Point { position: Vec3::new(0.2, 0.3, 1.8), intensity: Spectrum::gray(4.0) });
        }
        Light::Sun => {
            let towards = Vec3::new(-0.3, 0.2, 1.0).normalize();
            b.emitter(Emitter::Directional { direction: -towards, irradiance: Spectrum::gray(3.0) });
        }
    }
    b.camera(camera(DVec3::new(0.4, -3.2, 1.6), DVec3::new(-0.3, 0.0, 0.4), 40.0, (16, 16)));
    built(b)
}

fn runs(scene: &Scene, method: &str, params: &[&str], passes: u64) -> Runs {
    block_runs(scene, &*recipe(method, params, scene).method, 64, 21, passes, 2).with_mean()
}
fn verdict(what: &str, a: &Runs, b: &Runs) -> Verdict {
    let verdict = BlockTest::default().run(a, Reference::Runs(b)).unwrap();
    println!("{what}: {verdict}");
    verdict
}

/// Bounded, and what the bound takes brought back: unbiased, with finite variance.
const BASE: [&str; 3] = ["bound=2", "paths=16", "compensation=kollig-keller"];

#[test]
fn walking_through_sharp_lobes_leaves_the_mean_as_it_is() {
    let scene = polished_room(Light::Lamp);
    let truth = runs(&scene, "path", &[], effort(96));
    for more in [
        &["sharp=0"][..],
        &["sharp=0.2"],
        &["sharp=0.13"], // the floor's alone
        &["sharp=0.2", "direct=virtual"],
        &["sharp=0.2", "lights=stochastic-lightcuts"],
    ] {
        let found = runs(&scene, "many-lights", &[&BASE[..], more].concat(), effort(64));
        assert!(verdict(&format!("{more:?}"), &found, &truth).passes(), "{more:?}");
    }
    // Not walked, half of what is seen is missing.
    let bounded = runs(&scene, "many-lights", &["bound=2", "paths=16", "sharp=0.2", "max-depth=2"], 32);
    assert!(verdict("direct light alone", &bounded, &truth).rejected());
}

#[test]
fn sharp_lobes_show_lights_without_extent_whoever_brings_direct_light() {
    for (name, light) in [("point", Light::Point), ("sun", Light::Sun)] {
        let scene = polished_room(light);
        let truth = runs(&scene, "path", &["max-depth=2"], effort(96));
        for more in [&["direct=sampled"][..], &["direct=virtual"], &["direct=virtual", "lights=stochastic-lightcuts"]] {
            let params =
                [&["bound=2", "compensation=kollig-keller", "paths=16", "max-depth=2", "sharp=0.2"][..], more].concat();
            let found = runs(&scene, "many-lights", &params, effort(64));
            assert!(verdict(&format!("{name} {more:?}"), &found, &truth).passes(), "{name} {more:?}");
        }
    }
}

#[test]
fn path_lengths_are_counted_through_sharp_lobes() {
    let scene = polished_room(Light::Lamp);
    for depths in [&["max-depth=2"][..], &["max-depth=3"], &["min-depth=3", "max-depth=4"]] {
        let truth = runs(&scene, "path", depths, effort(96));
        for more in [&["sharp=0.2"][..], &["sharp=0.2", "lights=lightcuts"]] {
            let params = [&BASE[..], depths, more].concat();
            let found = runs(&scene, "many-lights", &params, effort(64));
            assert!(verdict(&format!("{params:?}"), &found, &truth).passes(), "{params:?}");
        }
    }
}

#[test]
fn the_whole_frame_is_compensated_behind_sharp_lobes_too() {
    let scene = polished_room(Light::Lamp);
    let truth = runs(&scene, "path", &[], effort(96));
    let params = ["bound=2", "paths=16", "compensation=local", "sharp=0.2"];
    let found = block_runs(&scene, &*recipe("many-lights", &params, &scene).method, 64, 22, effort(96), 2).with_mean();
    assert!(verdict("local", &found, &truth).passes());
}
