//! Which bound a pass gets.

use manylight_compensation::{Bound, BoundPlan, Bounded, Level};
use manylight_framework::{Bounding, BoundingPlan, KnobSet, Pair, Promise};
use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
use manylight_scene::{Camera, Material, Model, Scene, Shape, Source};

/// A square of side 2 and a ball of radius 1, scaled: (4 + 4 pi) scale^2.
fn scene(scale: f64, shapes: usize) -> Scene {
    let mut b = Scene::builder();
    let grey = Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.5)) };
    let material = b.material(Material::one_sided("grey", grey));
    let square = ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(scale))));
    let ball = ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, scale as f32));
    for geometry in [square, ball].into_iter().take(shapes) {
        b.shape(Shape { name: "shape".into(), geometry, material, radiance: None });
    }
    b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (2, 2)).unwrap());
    b.build().unwrap()
}
fn auto(scene: &Scene, paths: u64) -> f64 {
    match BoundPlan::AUTO.at(scene, 0, paths) {
        Bound::Geometry(b) => b as f64,
        Bound::None => f64::INFINITY,
        Bound::Contribution(_) => panic!("auto bounds the geometry term"),
    }
}

#[test]
fn auto_is_pi_paths_over_the_surface() {
    let pi = std::f64::consts::PI;
    for paths in [1, 64, 1_000_000] {
        let expected = pi * paths as f64 / (4.0 + 4.0 * pi);
        assert!((auto(&scene(1.0, 2), paths) / expected - 1.0).abs() < 1e-6);
    }
    // No path is one path; every pass has the same.
    assert_eq!(auto(&scene(1.0, 2), 0), auto(&scene(1.0, 2), 1));
    assert_eq!(BoundPlan::AUTO.at(&scene(1.0, 2), 7, 64), BoundPlan::AUTO.at(&scene(1.0, 2), 0, 64));
}

#[test]
fn auto_goes_with_one_over_a_length_squared_so_that_b_d_squared_does_not_change() {
    let one = auto(&scene(1.0, 2), 100);
    for scale in [1e-4, 0.01, 3.0, 1e4] {
        let b = auto(&scene(scale, 2), 100) * scale * scale;
        assert!((b / one - 1.0).abs() < 1e-5, "x {scale}: {b} is not {one}");
        // So the same part of the same connection is kept.
        let keep = |b: f64, d: f64| Bound::Geometry(b as f32).keep(&Pair { g: (0.5 / (d * d)) as f32, lobes: None });
        let (here, there) = (keep(one, 0.05), keep(b / (scale * scale), 0.05 * scale));
        assert!((here - there).abs() < 1e-5 && here < 1.0);
    }
}

#[test]
fn without_surface_there_is_nothing_to_bound() {
    let bound = BoundPlan::AUTO.at(&scene(1.0, 0), 0, 64);
    assert_eq!(bound, Bound::None);
    assert_eq!(bound.keep(&Pair { g: 1e30, lobes: None }), 1.0);
}

#[test]
fn plans_promise_what_they_do() {
    let scene = scene(1.0, 2);
    assert_eq!(BoundPlan::fixed(3.0).at(&scene, 0, 9), Bound::Geometry(3.0));
    assert_eq!(BoundPlan::NONE.at(&scene, 0, 9), Bound::None);
    assert!(BoundPlan::NONE.claim().is_unbiased() && !BoundPlan::NONE.tames());
    for plan in [BoundPlan::fixed(3.0), BoundPlan::AUTO] {
        assert!(plan.tames() && !plan.claim().is_unbiased() && !plan.claim().brightens);
    }
    // The cap is what is kept at most.
    let bound = Bound::Geometry(3.0);
    assert_eq!((bound.cap(), Bound::None.cap()), (3.0, f32::INFINITY));
    assert_eq!(bound.keep(&Pair { g: f32::MAX, lobes: None }), 3.0 / f32::MAX);
}

#[test]
fn the_progressive_bound_starts_as_auto_and_grows_with_the_passes() {
    let (scene, plan) = (scene(1.0, 2), BoundPlan { level: Level::Progressive, of: Bounded::Geometry });
    let at = |pass| plan.at(&scene, pass, 64).cap() as f64;
    assert_eq!(plan.at(&scene, 0, 64), BoundPlan::AUTO.at(&scene, 0, 64));
    assert!((at(7) / at(0) - 4.0).abs() < 1e-5, "8^(2/3) is 4: {}", at(7) / at(0));
    assert!(plan.claim().vanishes_with.contains(KnobSet::PASSES) && plan.tames());
}

#[test]
fn the_whole_contribution_is_bounded_at_the_same_number() {
    let (scene, plan) = (scene(1.0, 2), BoundPlan { level: Level::Auto, of: Bounded::Contribution });
    let Bound::Contribution(b) = plan.at(&scene, 0, 64) else { panic!("of the geometry term") };
    assert_eq!(b as f64, auto(&scene, 64));
    assert!(!plan.at(&scene, 0, 64).compensable());
}
