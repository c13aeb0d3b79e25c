//! Refraction divides radiance by eta^2 on the way in and gives it back on the way out: roulette must not take that for a loss.

use manylight_framework::{Integrator, Probe};
use manylight_geometry::{ShapeGeometry, Sphere};
use manylight_math::{DAffine3, DVec3, Spectrum, Vec2, Vec3};
use manylight_reference::PathTracer;
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Camera, Emitter, Material, Model, Scene, Shape, Source};

/// A ball of clear glass under a white sky: radiance is one, wherever one looks.
fn clear_ball() -> Scene {
    let mut b = Scene::builder();
    let white = Source::Constant(Spectrum::ONE);
    let glass = Model::Dielectric { int_ior: 1.5, ext_ior: 1.0, reflectance: white, transmittance: white };
    let material = b.material(Material::one_sided("glass", glass));
    let geometry = ShapeGeometry::Sphere(Sphere::new(Vec3::new(0.0, 0.0, 5.0), 1.0));
    b.shape(Shape { name: "ball".into(), geometry, material, radiance: None });
    b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
    b.camera(Camera::perspective(DAffine3::from_translation(DVec3::ZERO), 10.0, (8, 8)).unwrap());
    b.build().unwrap()
}

#[test]
fn paths_through_clear_glass_survive_roulette_as_often_as_it_can_let_them() {
    let scene = clear_ball();
    let path = PathTracer { certain_edges: 1, ..Default::default() };
    let (mut mean, mut lost, n) = (0.0f64, 0, 20_000);
    for i in 0..n {
        let mut s = Stream::new(6, [0, i, 0], Purpose::TEST);
        let ray = scene.camera().ray(Vec2::splat(2.0) + s.next_2d() * 4.0);
        let value = path.radiance(&scene, &(), &ray, &mut Probe::default(), &mut s).0.x;
        mean += f64::from(value) / n as f64;
        lost += u64::from(value == 0.0);
    }
    // Two vertices on most paths, of 0.95 each; without eta^2 four in nine go on from the first.
    let share = lost as f64 / n as f64;
    println!("mean {mean:.4}, {share:.3} lost");
    assert!(share < 0.13, "{share} of the paths are ended");
    // Its standard error is 0.0025.
    assert!((mean - 1.0).abs() < 0.012, "{mean}");
}
