//! Virtual lights seen through surfaces that are there in part: who weighs by densities has to weigh by what is let through.
//!
//! Family-wise significance 0.01 by Holm within each verdict; fixed seeds. `MANYLIGHT_EFFORT=16` takes sixteen times the passes.

use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_integration::rooms::{built, camera, diffuse, hollow_cube, place};
use manylight_integration::{block_runs, effort, recipe};
use manylight_math::{DAffine3, DVec3, Spectrum};
use manylight_scene::{Material, Model, Scene, Source};
use manylight_stats::{BlockTest, Reference, Runs};
use std::f64::consts::PI;

/// A closed room, lit from above, with half-opaque panes between floor and walls.
fn room_with_panes() -> Scene {
    let mut b = Scene::builder();
    let walls = diffuse(&mut b, Spectrum::gray(0.7));
    place(&mut b, hollow_cube(1.0), walls, None);
    let half = Material {
        opacity: Some(Source::Constant(Spectrum::gray(0.5))),
        ..Material::two_sided("pane", Model::Diffuse { reflectance: Source::Constant(Spectrum::rgb(0.6, 0.4, 0.3)) })
    };
    let pane = b.material(half);
    let rectangle = |m: DAffine3| ShapeGeometry::Mesh(TriangleMesh::rectangle(&m));
    for x in [-0.5, 0.1] {
        let upright = DAffine3::from_translation(DVec3::new(x, 0.2, -0.3))
            * DAffine3::from_rotation_y(0.5 * PI)
            * DAffine3::from_scale(DVec3::new(0.5, 0.6, 1.0));
        place(&mut b, rectangle(upright), pane, None);
    }
    let black = diffuse(&mut b, Spectrum::BLACK);
    let above = DAffine3::from_translation(DVec3::new(0.6, 0.0, 0.9))
        * DAffine3::from_rotation_x(PI)
        * DAffine3::from_scale(DVec3::splat(0.3));
    place(&mut b, rectangle(above), black, Some(Spectrum::gray(5.0)));
    b.camera(camera(DVec3::new(0.3, -0.9, 0.6), DVec3::new(-0.4, 0.5, -0.8), 70.0, (16, 16)));
    built(b)
}

fn runs(scene: &Scene, method: &str, params: &[&str], passes: u64) -> Runs {
    block_runs(scene, &*recipe(method, params, scene).method, 16, 23, passes, 2).with_mean()
}

#[test]
fn every_generator_weighs_light_through_masks_as_paths_do() {
    let scene = room_with_panes();
    let truth = runs(&scene, "path", &[], effort(96));
    let base = ["bound=2", "compensation=kollig-keller", "paths=32"];
    for more in [
        &["generator=keller"][..],
        &["generator=rejection"],
        &["generator=bidirectional"],
        &["generator=metropolis"],
        &["generator=keller", "compensation=local"],
    ] {
        let given = |p: &&str| more.iter().all(|m| m.split('=').next() != p.split('=').next());
        let params: Vec<&str> = base.iter().copied().filter(given).chain(more.iter().copied()).collect();
        let found = runs(&scene, "many-lights", &params, effort(48));
        let verdict = BlockTest::default().run(&found, Reference::Runs(&truth)).unwrap();
        println!("{params:?}: {verdict}");
        assert!(verdict.passes(), "{params:?}: {verdict}");
    }
}
