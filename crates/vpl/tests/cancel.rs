//! A generator can be stopped, and does not take all memory.

use manylight_framework::{GenerateError, Generator, Probe};
use manylight_geometry::{ShapeGeometry, Sphere};
use manylight_math::{DAffine3, Spectrum, Vec3};
use manylight_scene::{Camera, Emitter, Material, Model, Scene, Shape, Source};
use manylight_vpl::{Emission, Emitters, Keller};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn room() -> Scene {
    let mut b = Scene::builder();
    let model = Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.5)) };
    let material = b.material(Material::two_sided("wall", model));
    let geometry = ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0));
    b.shape(Shape { name: "room".into(), geometry, material, radiance: None });
    b.emitter(Emitter::Point { position: Vec3::ZERO, intensity: Spectrum::ONE });
    b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (4, 4)).unwrap());
    b.build().unwrap()
}

#[test]
fn a_cancelled_generator_stops_instead_of_walking_a_thousand_million_paths() {
    let mut probe = Probe::default();
    probe.cancel = Some(Arc::new(AtomicBool::new(true)));
    let keller = Keller { paths: 1_000_000_000, max_edges: None, certain_edges: 1, emission: Emission::Full };
    assert_eq!(keller.generate(&room(), 0, 0, &mut probe).err(), Some(GenerateError::Cancelled));
    let emitters = Emitters { paths: 1_000_000_000 };
    assert_eq!(emitters.generate(&room(), 0, 0, &mut probe).err(), Some(GenerateError::Cancelled));
}
