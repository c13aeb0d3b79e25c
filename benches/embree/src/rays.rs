//! Triangles and rays to measure with: a bumpy ball in a room.

use manylight_geometry::{Geometry, ShapeGeometry, Surface, TriangleMesh, offset_from, shadow_segment};
use manylight_math::{DAffine3, DVec3, Frame, Ray, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use std::f32::consts::{PI, TAU};

/// A displaced sphere of 2 `rows`^2 triangles, about as large as the unit sphere, in the middle of a cube of 6 m.
pub fn sphere_in_a_room(rows: u32) -> Vec<ShapeGeometry> {
    let room = TriangleMesh::cube(&DAffine3::from_scale(DVec3::splat(3.0)));
    vec![ShapeGeometry::Mesh(room), ShapeGeometry::Mesh(displaced_sphere(rows))]
}

/// Rays of each kind that a renderer traces, in that scene.
pub struct RayKinds {
    /// Through the pixels of a camera, row by row.
    pub primary: Vec<Ray>,
    /// From where those arrive, cosine distributed.
    pub bounce: Vec<Ray>,
    /// From there to a lamp of 2 m x 2 m below the ceiling, where it is in front.
    pub shadow: Vec<Ray>,
    /// From a point of every 32nd pixel to the same 256 points on all surfaces, where those are in front.
    pub many_to_one: Vec<Ray>,
    /// Those ends of these that are shared.
    pub lights_of_many: Vec<Vec3>,
    /// From each of 64 points to points of neighbouring pixels.
    pub one_to_many: Vec<Ray>,
    /// Those ends of these that are shared.
    pub light_of_each: Vec<Vec3>,
}

impl RayKinds {
    /// For a camera of `side`^2 pixels, `side` divisible by 8.
    pub fn new(geometry: &Geometry, side: u32) -> Self {
        // An angle of view of 60 degrees.
        let across = |i: u32| (60f32.to_radians() / 2.0).tan() * ((2 * i + 1) as f32 / side as f32 - 1.0);
        let pixels = (0..side * side).map(|i| Vec3::new(-across(i % side), -across(i / side), 1.0).normalize());
        let primary: Vec<Ray> = pixels.map(|dir| Ray::new(Vec3::new(0.0, 0.0, -2.9), dir)).collect();
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        let facing = |ray: &Ray| {
            let hit = geometry.intersect(ray).expect("the room is closed");
            let x = geometry.surface(ray, &hit);
            Surface { ng: if x.ng.dot(ray.dir) < 0.0 { x.ng } else { -x.ng }, ..x }
        };
        let seen: Vec<Surface> = primary.iter().map(facing).collect();
        let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
        for x in &seen {
            let dir = Frame::around(x.ng).to_world(warp::cosine_hemisphere(s.next_2d()));
            bounce.push(Ray::new(offset_from(x.p, x.ng, x.error, dir), dir));
            let u = s.next_2d();
            let lamp = Vec3::new(2.0 * u.x - 1.0, 2.9, 2.0 * u.y - 1.0);
            if x.ng.dot(lamp - x.p) > 0.0 {
                shadow.extend(shadow_segment((x.p, Some((x.ng, x.error))), (lamp, None)));
            }
        }
        let lights: Vec<Surface> = bounce.iter().step_by((bounce.len() / 256).max(1)).take(256).map(facing).collect();
        let connect = |x: &Surface, y: &Surface| {
            let towards = y.p - x.p;
            let facing = x.ng.dot(towards) > 0.0 && y.ng.dot(towards) < 0.0;
            let ends = ((x.p, Some((x.ng, x.error))), (y.p, Some((y.ng, y.error))));
            if facing { shadow_segment(ends.0, ends.1).map(|ray| (ray, y.p)) } else { None }
        };
        let some = seen.iter().step_by(32);
        let (many_to_one, lights_of_many) = some.flat_map(|x| lights.iter().filter_map(move |y| connect(x, y))).unzip();
        // Blocks of 8 x 8 pixels.
        let block = |i: u32| (0..64).map(move |k| (i * 8 + k / 8, k % 8));
        let near = |i: u32| block(i).filter_map(|(y, x)| seen.get((y % side * side + x) as usize));
        let each = lights.iter().step_by(4);
        let (one_to_many, light_of_each) =
            each.flat_map(|y| (0..side / 8).flat_map(move |i| near(i).filter_map(move |x| connect(x, y)))).unzip();
        RayKinds { primary, bounce, shadow, many_to_one, lights_of_many, one_to_many, light_of_each }
    }
    /// Name, rays, and whether to ask only for occlusion.
    pub fn all(&self) -> [(&'static str, &[Ray], bool); 5] {
        [
            ("primary", &self.primary, false),
            ("bounce", &self.bounce, false),
            ("shadow", &self.shadow, true),
            ("many-to-one", &self.many_to_one, true),
            ("one-to-many", &self.one_to_many, true),
        ]
    }
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
