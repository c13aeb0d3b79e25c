//! Scenes whose radiance is known in closed form.

use manylight_geometry::{Disk, ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DMat3, DVec3, Frame, Spectrum, Vec3};
use manylight_scene::{Camera, Emitter, Material, MaterialId, Model, Scene, SceneBuilder, Shape, Source};

/// A camera at `from` that looks at `to`.
pub fn camera(from: DVec3, to: DVec3, fov: f64, size: (u32, u32)) -> Camera {
    let dir = (to - from).normalize();
    let left = dir.any_orthonormal_vector();
    let to_world = DAffine3 { matrix3: DMat3::from_cols(left, dir.cross(left), dir), translation: from };
    Camera::perspective(to_world, fov, size).unwrap_or_else(|e| panic!("{e}"))
}

/// Adds a one-sided diffuse material.
pub fn diffuse(b: &mut SceneBuilder, albedo: Spectrum) -> MaterialId {
    b.material(Material::one_sided("diffuse", Model::Diffuse { reflectance: Source::Constant(albedo) }))
}

/// Adds a shape.
pub fn place(b: &mut SceneBuilder, geometry: ShapeGeometry, material: MaterialId, radiance: Option<Spectrum>) {
    b.shape(Shape { name: "shape".into(), geometry, material, radiance: radiance.map(Source::Constant) });
}

/// Builds. Panics if it cannot.
pub fn built(b: SceneBuilder) -> Scene {
    b.build().unwrap_or_else(|e| panic!("{e}"))
}

/// The inside of a sphere.
pub fn hollow_ball(radius: f32) -> ShapeGeometry {
    ShapeGeometry::Sphere(Sphere { flipped: true, ..Sphere::new(Vec3::ZERO, radius) })
}

/// The inside of a cube of side two, as triangles.
pub fn hollow_cube(scale: f64) -> ShapeGeometry {
    let mut mesh = TriangleMesh::cube(&DAffine3::from_scale(DVec3::splat(scale)));
    mesh.flip_normals();
    ShapeGeometry::Mesh(mesh)
}

/// A closed room whose walls reflect `albedo` and emit `emitted`: radiance is emitted / (1 - albedo) everywhere.
pub fn furnace(walls: ShapeGeometry, scale: f64, albedo: Spectrum, emitted: Spectrum, size: (u32, u32)) -> Scene {
    let mut b = Scene::builder();
    let material = diffuse(&mut b, albedo);
    place(&mut b, walls, material, Some(emitted));
    b.camera(camera(DVec3::new(0.2, 0.1, 0.3) * scale, DVec3::new(0.1, 0.0, -1.0) * scale, 70.0, size));
    built(b)
}

/// A point light of 1 W/sr in the middle of a sphere of radius 1 and albedo `albedo`: irradiance 1, direct radiance
/// albedo / pi, all together albedo / (pi (1 - albedo)).
pub fn lantern(albedo: f32, size: (u32, u32)) -> Scene {
    let mut b = Scene::builder();
    let material = diffuse(&mut b, Spectrum::gray(albedo));
    place(&mut b, hollow_ball(1.0), material, None);
    b.emitter(Emitter::Point { position: Vec3::ZERO, intensity: Spectrum::ONE });
    b.camera(camera(DVec3::new(0.2, 0.1, 0.3), DVec3::new(0.1, 0.0, -1.0), 70.0, size));
    built(b)
}

/// The point of a plane of albedo 0.8 under a light, seen through a narrow angle. The light is added by `light`.
pub fn plane_under(light: impl FnOnce(&mut SceneBuilder), size: (u32, u32)) -> Scene {
    let mut b = Scene::builder();
    let material = diffuse(&mut b, Spectrum::gray(0.8));
    place(
        &mut b,
        ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(5.0)))),
        material,
        None,
    );
    light(&mut b);
    b.camera(camera(DVec3::new(3.0, 0.0, 0.5), DVec3::ZERO, 0.005, size));
    built(b)
}

/// A disc of radius 1 at height 1 over the plane, radiance 1: irradiance pi / 2 below its middle.
pub fn disc_light(b: &mut SceneBuilder) {
    let black = diffuse(b, Spectrum::BLACK);
    let disc = Disk { centre: Vec3::Z, radius: 1.0, frame: Frame::around(Vec3::NEG_Z) };
    place(b, ShapeGeometry::Disk(disc), black, Some(Spectrum::ONE));
}

/// A ball of radius 0.5 at height 2 over the plane, radiance 1: irradiance pi / 16 below its middle.
pub fn ball_light(b: &mut SceneBuilder) {
    let black = diffuse(b, Spectrum::BLACK);
    place(b, ShapeGeometry::Sphere(Sphere::new(Vec3::Z * 2.0, 0.5)), black, Some(Spectrum::ONE));
}
