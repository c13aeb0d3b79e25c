//! What the benchmarks share: scenes, and how long they measure.
//!
//! ```text
//! cargo bench -p manylight-benches --profile fast
//! ```
//!
//! All of them run on one thread. `cargo test` runs each once, and measures nothing.

use manylight_geometry::{Geometry, GeometryError, ShapeGeometry, TriangleMesh};
use manylight_math::{DAffine3, DMat3, DVec3, Spectrum, Vec3};
use manylight_scene::{Camera, Material, Model, Scene, Shape, Source};
use std::f32::consts::{PI, TAU};
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

/// A displaced sphere of 2 `rows`^2 triangles, about as large as the unit sphere, in the middle of a cube of 6 m.
pub fn sphere_in_a_room(rows: u32) -> Result<Geometry, GeometryError> {
    let room = TriangleMesh::cube(&DAffine3::from_scale(DVec3::splat(3.0)));
    Geometry::build(vec![ShapeGeometry::Mesh(room), ShapeGeometry::Mesh(displaced_sphere(rows))])
}

/// Rows and columns of quads over (theta, phi). Those that touch a pole have a triangle without area.
fn displaced_sphere(rows: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for i in 0..=rows {
        for j in 0..=rows {
            let (theta, phi) = (PI * i as f32 / rows as f32, TAU * j as f32 / rows as f32);
            let bumps = (9.0 * phi).sin() * (8.0 * theta).sin() + 0.3 * (31.0 * phi).cos() * (37.0 * theta).sin();
            // Without bumps at the poles, where all columns meet.
            let radius = 1.0 + 0.1 * theta.sin() * bumps;
            let dir = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            mesh.positions.push(dir * radius);
        }
    }
    for i in 0..rows {
        for j in 0..rows {
            let (a, b) = (i * (rows + 1) + j, (i + 1) * (rows + 1) + j);
            mesh.triangles.extend([[a, a + 1, b], [b, a + 1, b + 1]]);
        }
    }
    mesh
}
