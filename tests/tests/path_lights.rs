//! The path tracer that asks a light set, and direct light from the emitters themselves, against the yardstick. Family-wise
//! significance 0.01 by Holm; what is printed says what would have been seen.

use manylight_integration::{block_runs, effort, load_scene, our_scene, recipe, rooms};
use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
use manylight_scene::{Bitmap, Emitter, Environment, Scene};
use manylight_scene_io::parametric;
use manylight_stats::{BlockTest, Reference, Runs};
use std::sync::Arc;

/// Near to one of many lamps light is rare and strong: blocks of such a scene have to be large, or have no verdict.
fn runs(scene: &Scene, method: &str, params: &[&str], seed: u64, passes: u64) -> Runs {
    let r = recipe(method, params, scene);
    let grid = if scene.emitters().len() > 100 { 1 } else { 2 };
    block_runs(scene, &*r.method, r.spp, seed, effort(passes), grid)
}
fn agree(what: &str, a: &Runs, truth: &Runs) {
    let verdict = BlockTest::default().run(a, Reference::Runs(truth)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}
/// Lamps of 200 shapes.
fn many_lamps(test: &str) -> Scene {
    let dir = std::env::temp_dir().join(format!("manylight-{test}-{}", std::process::id()));
    parametric::write("many-lamps", &[("lamps".into(), "200".into())], &dir).unwrap();
    let scene = load_scene(&dir.join("scene.xml"), (12, 8));
    std::fs::remove_dir_all(&dir).unwrap();
    scene
}
/// Every kind of emitter over a plane: a disc, a ball, a point, parallel light and a map of the sky.
fn all_kinds() -> Scene {
    let light = |b: &mut manylight_scene::SceneBuilder| {
        rooms::disc_light(b);
        rooms::ball_light(b);
        b.emitter(Emitter::Point { position: Vec3::new(1.0, 0.5, 0.8), intensity: Spectrum::rgb(0.5, 0.2, 0.1) });
        let direction = Vec3::new(0.2, 0.3, -0.9).normalize();
        b.emitter(Emitter::Directional { direction, irradiance: Spectrum::rgb(0.2, 0.3, 0.5) });
        let pixels = (0..32).map(|i| Spectrum::gray(if i % 5 == 0 { 2.0 } else { 0.1 })).collect();
        let map = Bitmap { width: 8, height: 4, pixels };
        let sky = Environment::new(Arc::new(map), 1.0, &DAffine3::from_rotation_x(0.4)).unwrap();
        b.emitter(Emitter::Environment(Box::new(sky)));
    };
    let mut b = Scene::builder();
    let material = rooms::diffuse(&mut b, Spectrum::gray(0.8));
    let floor = manylight_geometry::TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(5.0)));
    rooms::place(&mut b, manylight_geometry::ShapeGeometry::Mesh(floor), material, None);
    light(&mut b);
    b.camera(rooms::camera(DVec3::new(3.0, 0.0, 2.0), DVec3::ZERO, 60.0, (8, 8)));
    rooms::built(b)
}

const SETS: &[&[&str]] = &[
    &["lights=light-bvh"],
    &["lights=stochastic-lightcuts"],
    &["lights=power"],
    &["lights=light-bvh", "mis=off", "samples=3"],
    &["lights=stochastic-lightcuts", "mis=off", "samples=3"],
    &["lights=all", "mis=off"],
];

#[test]
fn path_tracing_by_any_light_set_is_path_tracing() {
    for (name, scene, spp) in [
        ("cornell-box", our_scene("cornell-box", (8, 8)), 64),
        ("all kinds of emitters", all_kinds(), 64),
        ("many lamps", many_lamps("paths"), 64),
    ] {
        let spp = format!("spp={spp}");
        // What is seen directly is the same in all, and in many lamps nothing but noise.
        let common = [spp.as_str(), "min-depth=2"];
        let truth = runs(&scene, "path", &common, 41, 64);
        for set in SETS {
            // As many shadow rays a vertex as there are lamps; and lamps near to a vertex as rare as the others.
            if name == "many lamps" && ["lights=all", "lights=power"].contains(&set[0]) {
                continue;
            }
            agree(&format!("{name}, {set:?}"), &runs(&scene, "path-lights", &[&common, *set].concat(), 42, 64), &truth);
        }
    }
}

#[test]
fn direct_light_alone_by_every_tree_is_that_of_the_path_tracer() {
    for (name, scene) in [("all kinds of emitters", all_kinds()), ("many lamps", many_lamps("direct"))] {
        let common = ["min-depth=2"];
        let truth = runs(&scene, "path", &["spp=64", "min-depth=2", "max-depth=2"], 43, 64);
        for (method, more) in [
            ("stochastic-lightcuts", &["cut=4", "spp=32"][..]),
            ("light-bvh", &["samples=4", "spp=32"]),
            ("lightcuts", &["paths=128", "error=none", "spp=8"]),
        ] {
            let params = [&common[..], &["direct=only"], more].concat();
            agree(&format!("{name}, {method}"), &runs(&scene, method, &params, 44, 64), &truth);
        }
    }
}
