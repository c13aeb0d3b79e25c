//! What the benchmarks share: scenes, and how long they measure.
//!
//! ```text
//! cargo bench -p manylight-benches --profile fast
//! ```
//!
//! All of them run on one thread. `cargo test` runs each once, and measures nothing.

use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_math::{DAffine3, DMat3, DVec3, Spectrum};
use manylight_scene::{Camera, Material, Model, Scene, Shape, Source};
use std::path::{Path, PathBuf};

/// The file of a scene of this repository.
pub fn scene_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).join("scene.xml")
}

/// The file of a scene that is too large for this repository: it lies beside it, or is `None`.
pub fn shared_scene_file(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes").join(name).join("scene.xml");
    path.exists().then_some(path)
}

/// A closed room of 10 x 3 x 10 m with four pillars, seen from a corner by a camera of `side`^2 pixels.
pub fn room_with_pillars(side: u32) -> Scene {
    let mut b = Scene::builder();
    let white = Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.7)) };
    let material = b.material(Material::two_sided("white", white));
    let mut add = |scale: DVec3, at: DVec3| {
        let to_world = DAffine3::from_translation(at) * DAffine3::from_scale(scale);
        let geometry = ShapeGeometry::Mesh(TriangleMesh::cube(&to_world));
        b.shape(Shape { name: "box".into(), geometry, material, radiance: None });
    };
    add(DVec3::new(5.0, 1.5, 5.0), DVec3::ZERO);
    for (x, z) in [(-2.0, -2.0), (2.0, -2.0), (-2.0, 2.0), (2.0, 2.0)] {
        add(DVec3::new(0.3, 1.5, 0.3), DVec3::new(x, 0.0, z));
    }
    let look = DMat3::from_rotation_y(0.7);
    let to_world = DAffine3 { matrix3: look, translation: DVec3::new(-4.0, 0.2, -4.5) };
    b.camera(Camera::perspective(to_world, 70.0, (side, side)).unwrap_or_else(|e| panic!("{e}")));
    b.build().unwrap_or_else(|e| panic!("{e}"))
}
