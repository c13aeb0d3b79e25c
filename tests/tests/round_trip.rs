//! What is written is read back as it was, and Mitsuba 3 renders it alike.

#[path = "../../crates/manylight/examples/06_write_a_scene.rs"]
#[allow(missing_docs)]
mod example;

use manylight_framework::Method;
use manylight_geometry::{Disk, ShapeGeometry, Sphere, TriangleMesh};
use manylight_integration::rooms::{camera, diffuse, place};
use manylight_integration::{
    block_runs, effort, load_scene, mitsuba_blocks, our_scene, pass, recipe, scenes_folder, shared,
};
use manylight_math::{DAffine3, DVec3, Frame, Spectrum, Vec3};
use manylight_reference::PathTracer;
use manylight_scene::{Bitmap, Camera, Emitter, Environment, Scene};
use manylight_scene_io::{LoadOptions, WriteError, load, write};
use manylight_stats::{BlockTest, Reference};
use std::sync::Arc;

fn written(scene: &Scene) -> Scene {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("made");
    let files = write(scene, &folder).unwrap_or_else(|e| panic!("{e}"));
    assert!(files[0].ends_with("scene.xml") && files.iter().all(|f| f.is_file()), "{files:?}");
    // A second time it does not go over the first.
    assert!(matches!(write(scene, &folder), Err(WriteError::Exists(_))));
    let loaded = load(&files[0], &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.scene
}
fn image(scene: &Scene, method: &dyn Method) -> Vec<[f32; 3]> {
    pass(scene, method, 2, 5, 0).0.pixels.iter().map(|p| p.to_array()).collect()
}
fn comes_back(name: &str, scene: &Scene) {
    let back = written(scene);
    assert_eq!(back.emitters().kinds().collect::<Vec<_>>(), scene.emitters().kinds().collect::<Vec<_>>(), "{name}");
    let path = PathTracer::default();
    let (before, after) = (image(scene, &path), image(&back, &path));
    assert!(before.iter().flatten().any(|x| *x > 0.0), "{name} is black");
    assert!(before == after, "{name}: the image of what is read back differs");
}

#[test]
fn scenes_come_back_bit_for_bit() {
    for name in ["cornell-box", "corner", "ajar", "kitchen", "furnace"] {
        comes_back(name, &our_scene(name, (24, 16)));
    }
    for name in ["veil", "gallery"] {
        comes_back(name, &load_scene(&scenes_folder().join(format!("{name}.xml")), (24, 16)));
    }
    comes_back("example", &example::hill().unwrap());
    // Textures, meshes and materials as they are found.
    let Some(scenes) = shared("scenes") else { return };
    for name in ["modern-hall", "wooden-staircase"] {
        comes_back(name, &load_scene(&scenes.join(name).join("scene.xml"), (24, 16)));
    }
}

#[test]
fn emitters_and_cameras_of_each_kind_come_back() {
    let sky = |b: &mut manylight_scene::SceneBuilder| {
        let pixels = (0..32).map(|i| Spectrum::gray(if i % 5 == 0 { 2.0 } else { 0.1 })).collect();
        let map = Environment::new(Arc::new(Bitmap { width: 8, height: 4, pixels }), 1.5, &DAffine3::IDENTITY);
        b.emitter(Emitter::Environment(Box::new(map.unwrap())));
    };
    let constant = |b: &mut manylight_scene::SceneBuilder| b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
    let eye = || camera(DVec3::new(3.0, 0.5, 2.0), DVec3::ZERO, 50.0, (16, 12));
    let parallel = Camera::orthographic(eye().view().to_world * DAffine3::from_scale(DVec3::splat(2.0)), (16, 12));
    let shifted = Camera::perspective_shifted(eye().view().to_world, 40.0, (16, 12), [0.1, -0.05]);
    let lights: [&dyn Fn(&mut manylight_scene::SceneBuilder); 2] = [&sky, &constant];
    let cameras = [eye().with_lens(0.2, 3.0), parallel, shifted];
    for (i, eye) in cameras.into_iter().enumerate() {
        let mut b = Scene::builder();
        let grey = diffuse(&mut b, Spectrum::gray(0.6));
        let floor = TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(3.0)));
        place(&mut b, ShapeGeometry::Mesh(floor), grey, None);
        place(&mut b, ShapeGeometry::Sphere(Sphere { flipped: true, ..Sphere::new(Vec3::Z, 0.6) }), grey, None);
        let disk = Disk { centre: Vec3::Z * 1.5, radius: 0.5, frame: Frame::around(Vec3::NEG_Z) };
        place(&mut b, ShapeGeometry::Disk(disk), grey, Some(Spectrum::rgb(1.0, 2.0, 3.0)));
        b.emitter(Emitter::Point { position: Vec3::new(1.0, 0.3, 0.7), intensity: Spectrum::rgb(0.3, 0.1, 0.7) });
        let direction = Vec3::new(0.3, 0.2, -0.9).normalize();
        b.emitter(Emitter::Directional { direction, irradiance: Spectrum::ONE });
        lights[i % 2](&mut b);
        b.camera(eye.unwrap());
        comes_back(&format!("camera {i}"), &b.build().unwrap());
    }
}

#[test]
fn what_a_program_built_is_what_mitsuba_renders_of_its_file() {
    let scene = example::hill().unwrap();
    let path = recipe("path", &[], &scene);
    let runs = block_runs(&scene, &*path.method, 32, 9, effort(32), 4);
    let (mean, std_error) = mitsuba_blocks("built");
    let reference = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: 47.0 };
    let verdict = BlockTest::default().run(&runs, reference).unwrap();
    println!("{verdict}");
    assert!(verdict.passes(), "{verdict}");
}

#[test]
fn media_are_not_written() {
    let dir = tempfile::tempdir().unwrap();
    let message = write(&our_scene("fog-corridor", (8, 8)), dir.path()).unwrap_err().to_string();
    assert!(message.contains("a medium cannot be written"), "{message}");
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0, "nothing is written after a mistake");
}
