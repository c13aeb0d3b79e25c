//! A scene that a program builds, written as a Mitsuba 3 file: this program renders it, and so does Mitsuba.
//!
//! `cargo run --release -p manylight --example 06_write_a_scene -- DIR` writes DIR/scene.xml and what it names; then
//! `manylight render DIR/scene.xml -o ours.exr`, or `mitsuba DIR/scene.xml`.

use manylight::bsdf::Distribution;
use manylight::geometry::{Disk, ShapeGeometry, Sphere, TriangleMesh};
use manylight::math::{DAffine3, DVec3, Frame, Spectrum, Vec2, Vec3};
use manylight::scene::{
    Bitmap, Camera, Emitter, Material, Model, Scene, SceneError, Shape, Source, Spot, Texture, TextureFilter, Wrap,
};
use std::sync::Arc;

/// A hill with stripes, a ball of rough gold, a lamp above and a spot from the side.
pub fn hill() -> Result<Scene, SceneError> {
    let mut b = Scene::builder();
    let colour = |r, g, b| Source::Constant(Spectrum::rgb(r, g, b));

    // A texture of pixels made here, four times across the hill.
    let pixels = (0..64).map(|i| if i % 8 < 4 { Spectrum::rgb(0.7, 0.2, 0.1) } else { Spectrum::gray(0.6) }).collect();
    let stripes = b.texture(Texture::Bitmap {
        image: Arc::new(Bitmap { width: 8, height: 8, pixels }),
        filter: TextureFilter::Bilinear,
        wrap: Wrap::Repeat,
        to_uv: glam::Affine2::from_scale(Vec2::splat(4.0)),
    });
    let striped = Model::Diffuse { reflectance: Source::Texture(stripes) };
    let ground = b.material(Material::two_sided("stripes", striped));
    let gold = b.material(Material::one_sided(
        "gold",
        Model::RoughConductor {
            distribution: Distribution::Ggx,
            alpha_u: 0.5,
            alpha_v: 0.5,
            eta: Spectrum::rgb(0.14, 0.37, 1.44),
            k: Spectrum::rgb(3.98, 2.39, 1.60),
            reflectance: colour(1.0, 1.0, 1.0),
        },
    ));
    let black = b.material(Material::one_sided("lamp", Model::Diffuse { reflectance: colour(0.0, 0.0, 0.0) }));

    // A mesh from a formula, with smooth normals.
    let n = 24u32;
    let mut mesh = TriangleMesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let uv = Vec2::new(i as f32, j as f32) / n as f32;
            let p = (uv - 0.5) * 4.0;
            mesh.positions.push(Vec3::new(p.x, 0.6 * (-p.length_squared()).exp(), -p.y));
            mesh.uvs.push(uv);
            if i < n && j < n {
                let a = j * (n + 1) + i;
                mesh.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
            }
        }
    }
    mesh.compute_smooth_normals();
    let mut add = |name: &str, geometry, material, radiance| {
        b.shape(Shape { name: name.into(), geometry, material, radiance });
    };
    add("hill", ShapeGeometry::Mesh(mesh), ground, None);
    add("ball", ShapeGeometry::Sphere(Sphere::new(Vec3::new(0.8, 0.6, 0.5), 0.4)), gold, None);
    let lamp = Disk { centre: Vec3::new(-0.5, 2.5, 0.0), radius: 0.5, frame: Frame::around(Vec3::NEG_Y) };
    add("lamp", ShapeGeometry::Disk(lamp), black, Some(colour(8.0, 7.0, 6.0)));

    let axis = Vec3::new(-0.6, -0.64, -0.48);
    if let Some(spot) = Spot::new(axis, 0.5, 0.3) {
        b.emitter(Emitter::Spot { position: Vec3::new(2.0, 2.2, 1.5), intensity: Spectrum::rgb(6.0, 8.0, 14.0), spot });
    }
    // It looks along its own +z, with +x to the left and +y up.
    let (eye, target) = (DVec3::new(0.0, 1.6, 4.0), DVec3::new(0.0, 0.3, 0.0));
    let z = (target - eye).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let to_world = DAffine3::from_cols(x, z.cross(x), z, eye);
    b.camera(Camera::perspective(to_world, 45.0, (32, 32))?);
    b.build()
}

#[allow(dead_code)] // a test builds the scene alone
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dir = std::env::args_os().nth(1).ok_or("where to? Give it a folder")?;
    for path in manylight::scene_io::write(&hill()?, dir.as_ref())? {
        println!("wrote {}", path.display());
    }
    Ok(())
}
