//! Scenes with media.

use crate::rooms::{built, camera, diffuse, hollow_cube, place};
use manylight_geometry::{Disk, ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DVec3, Frame, MediumId, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{
    Boundary, Emitter, Grid, HenyeyGreenstein, Heterogeneous, Homogeneous, Interpolation, Material, Model, Scene,
    SceneBuilder, Shape, Sides, Source, Volume,
};

/// A medium of albedo x extinction.
pub fn fog(b: &mut SceneBuilder, albedo: Spectrum, extinction: Spectrum, g: f32) -> MediumId {
    let phase = HenyeyGreenstein::new(g).unwrap();
    b.medium(Homogeneous::new(albedo * extinction, extinction, phase).unwrap().into())
}
/// A box [lo, hi] that parts `inside` from `outside` and does nothing else.
pub fn part(b: &mut SceneBuilder, lo: DVec3, hi: DVec3, inside: MediumId, outside: MediumId) {
    let placed = DAffine3::from_translation(0.5 * (lo + hi)) * DAffine3::from_scale(0.5 * (hi - lo));
    let geometry = ShapeGeometry::Mesh(TriangleMesh::cube(&placed));
    b.boundary(Boundary { name: "box".into(), geometry, sides: Sides { outside, inside } });
}

/// A point light of 1 W in an endless fog; the camera looks along +x past it at distance `d`, the foot `t0` ahead.
pub fn endless(albedo: f32, extinction: f32, g: f32, d: f64, t0: f64) -> Scene {
    let mut b = Scene::builder();
    let medium = fog(&mut b, Spectrum::gray(albedo), Spectrum::gray(extinction), g);
    b.emitter(Emitter::Point { position: Vec3::ZERO, intensity: Spectrum::gray((0.25 / std::f64::consts::PI) as f32) });
    let eye = DVec3::new(-t0, d, 0.0);
    b.camera(camera(eye, eye + DVec3::X, 1e-3, (4, 4)).within(medium));
    built(b)
}

/// A closed room full of coloured fog under a lamp, with a denser box in it.
pub fn foggy_room(g: f32) -> Scene {
    let thin = (Spectrum::rgb(0.9, 0.7, 0.5), Spectrum::rgb(0.3, 0.6, 0.9), g);
    room_of_fogs(thin, (Spectrum::rgb(0.5, 0.8, 0.9), Spectrum::rgb(3.0, 2.0, 1.0), -0.3))
}
/// The same of given albedo, extinction and g: that in the room, and that in the box.
pub fn room_of_fogs(room: (Spectrum, Spectrum, f32), cube: (Spectrum, Spectrum, f32)) -> Scene {
    let mut b = Scene::builder();
    let thin = fog(&mut b, room.0, room.1, room.2);
    let dense = fog(&mut b, cube.0, cube.1, cube.2);
    part(&mut b, DVec3::new(-0.8, -0.8, -0.8), DVec3::new(0.0, 0.0, 0.0), dense, thin);
    let wall = diffuse(&mut b, Spectrum::rgb(0.7, 0.5, 0.3));
    place(&mut b, hollow_cube(1.0), wall, None);
    let black = diffuse(&mut b, Spectrum::BLACK);
    let lamp = Disk { centre: Vec3::new(0.2, 0.1, 0.95), radius: 0.4, frame: Frame::around(Vec3::NEG_Z) };
    place(&mut b, ShapeGeometry::Disk(lamp), black, Some(Spectrum::rgb(5.0, 4.0, 3.0)));
    b.camera(camera(DVec3::new(0.7, -0.85, 0.3), DVec3::new(-0.3, 0.3, -0.2), 70.0, (8, 8)).within(thin));
    built(b)
}

/// A room with a cube of clumpy smoke in it, and a lamp.
pub fn smoky_cube() -> Scene {
    let mut b = Scene::builder();
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    let values = (0..512).map(|_| Spectrum::gray(if s.next_f32() < 0.5 { 0.0 } else { 2.0 })).collect();
    let placed = DAffine3::from_translation(DVec3::splat(-0.8)) * DAffine3::from_scale(DVec3::splat(1.4));
    let grid = Grid::new([8; 3], values, &placed, Interpolation::Trilinear).unwrap();
    let albedo = Volume::Constant(Spectrum::rgb(0.9, 0.8, 0.5));
    let phase = HenyeyGreenstein::new(0.3).unwrap();
    let smoke = b.medium(Heterogeneous::new(grid, 1.5, albedo, phase).unwrap().into());
    part(&mut b, DVec3::splat(-0.85), DVec3::splat(0.65), smoke, MediumId::VACUUM);
    let wall = diffuse(&mut b, Spectrum::rgb(0.7, 0.5, 0.3));
    place(&mut b, hollow_cube(1.0), wall, None);
    let black = diffuse(&mut b, Spectrum::BLACK);
    let lamp = Disk { centre: Vec3::new(0.2, 0.1, 0.95), radius: 0.4, frame: Frame::around(Vec3::NEG_Z) };
    place(&mut b, ShapeGeometry::Disk(lamp), black, Some(Spectrum::rgb(5.0, 4.0, 3.0)));
    b.camera(camera(DVec3::new(0.7, -0.9, 0.3), DVec3::new(-0.3, 0.3, -0.2), 70.0, (8, 8)));
    built(b)
}

/// A fog with a ball of glass in it, under a wide lamp: light is gathered in the fog behind the ball.
pub fn glass_in_fog() -> Scene {
    let mut b = Scene::builder();
    let haze = fog(&mut b, Spectrum::rgb(0.9, 0.8, 0.7), Spectrum::gray(0.5), 0.0);
    let glass = b.material(Material::one_sided(
        "glass",
        Model::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            reflectance: Source::Constant(Spectrum::ONE),
            transmittance: Source::Constant(Spectrum::ONE),
        },
    ));
    let ball = b.shape(Shape {
        name: "ball".into(),
        geometry: ShapeGeometry::Sphere(Sphere::new(Vec3::new(0.0, 0.0, 0.2), 0.4)),
        material: glass,
        radiance: None,
    });
    // The same fog under another name, as scene files have it.
    let again = fog(&mut b, Spectrum::rgb(0.9, 0.8, 0.7), Spectrum::gray(0.5), 0.0);
    b.parts(ball, Sides { outside: again, inside: MediumId::VACUUM });
    let wall = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, hollow_cube(1.0), wall, None);
    let black = diffuse(&mut b, Spectrum::BLACK);
    let lamp = Disk { centre: Vec3::new(0.0, 0.0, 0.95), radius: 0.6, frame: Frame::around(Vec3::NEG_Z) };
    place(&mut b, ShapeGeometry::Disk(lamp), black, Some(Spectrum::gray(3.0)));
    b.camera(camera(DVec3::new(0.85, -0.85, -0.6), DVec3::new(-0.2, 0.2, -0.2), 60.0, (8, 8)).within(haze));
    built(b)
}
