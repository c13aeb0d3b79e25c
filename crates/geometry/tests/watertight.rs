//! No ray leaves a closed mesh, none hits the surface it starts on, whatever the scale.

use manylight_geometry::{Geometry, ShapeGeometry, Sphere, TriangleMesh, offset_from, shadow_segment};
use manylight_math::{DAffine3, DVec3, Ray, Vec3};
use manylight_sampling::{Purpose, Stream, warp};

fn effort(n: usize) -> usize {
    std::env::var("MANYLIGHT_EFFORT").map_or(n, |e| n * e.parse::<usize>().expect("MANYLIGHT_EFFORT is a whole number"))
}

/// A sphere of triangles: a cube whose faces are cut n x n times and pushed out.
fn ball(n: u32, centre: Vec3, radius: f32) -> TriangleMesh {
    let cube = TriangleMesh::cube(&DAffine3::IDENTITY);
    let mut mesh = TriangleMesh::default();
    for face in 0..6 {
        let c: Vec<Vec3> = (0..4).map(|k| cube.positions[face * 4 + k]).collect();
        let base = mesh.positions.len() as u32;
        for j in 0..=n {
            for i in 0..=n {
                let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
                let at = |k: usize| c[k].as_dvec3();
                let p: DVec3 =
                    at(0) * (1.0 - u) * (1.0 - v) + at(1) * u * (1.0 - v) + at(2) * u * v + at(3) * (1.0 - u) * v;
                // The same corner must round to the same point whichever face it is computed from.
                let p = p.to_array().map(|x| (x * 1e6).round() / 1e6);
                mesh.positions.push(centre + (DVec3::from_array(p).normalize() * radius as f64).as_vec3());
            }
        }
        for j in 0..n {
            for i in 0..n {
                let q = base + j * (n + 1) + i;
                mesh.triangles.extend([[q, q + 1, q + n + 2], [q, q + n + 2, q + n + 1]]);
            }
        }
    }
    mesh
}

#[test]
fn no_ray_leaves_a_closed_mesh_not_even_through_its_edges() {
    for scale in [1e-5f32, 1e-4, 1.0, 1e4, 1e5] {
        let mesh = ball(12, Vec3::new(0.3, -0.2, 0.1) * scale, scale);
        let geometry = Geometry::build(vec![ShapeGeometry::Mesh(mesh.clone())]).unwrap();
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        let mut leaks = 0;
        for i in 0..effort(60_000) {
            let origin = Vec3::new(0.3, -0.2, 0.1) * scale + warp::sphere(s.next_2d()) * (0.9 * scale * s.next_f32());
            // Every other ray is aimed at a vertex or a point of an edge.
            let dir = if i % 2 == 0 {
                warp::sphere(s.next_2d())
            } else {
                let c = mesh.corners(s.next_below(mesh.triangles.len()));
                let (a, b) = (c[0], c[1 + s.next_below(2)]);
                let target = if i % 4 == 1 { a } else { a.lerp(b, s.next_f32()) };
                (target - origin).normalize()
            };
            leaks += geometry.intersect(&Ray::new(origin, dir)).is_none() as u32;
        }
        assert_eq!(leaks, 0, "at scale {scale}");
    }
}

/// Rays from far away round a scene: the farther the origin, the more every test rounds.
#[test]
fn no_ray_from_far_away_passes_through_a_closed_mesh() {
    for (scale, far) in [(1e-3f32, 1.0), (1.0, 3.0), (1.0, 1e2), (1.0, 1e4), (1e3, 30.0)] {
        let mesh = ball(12, Vec3::new(0.3, -0.2, 0.1) * scale, scale);
        let geometry = Geometry::build(vec![ShapeGeometry::Mesh(mesh.clone())]).unwrap();
        let mut s = Stream::new(9, [0; 3], Purpose::TEST);
        let mut leaks = 0;
        for i in 0..effort(30_000) {
            // Through a point of an edge, and through one well inside.
            let c = mesh.corners(s.next_below(mesh.triangles.len()));
            let p = if i % 2 == 0 { c[s.next_below(3)] } else { c[0].lerp(c[1], s.next_f32()) };
            let q = Vec3::new(0.3, -0.2, 0.1) * scale + warp::sphere(s.next_2d()) * (0.5 * scale);
            let origin = p + (p - q).normalize() * (far * scale);
            leaks += geometry.intersect(&Ray::new(origin, (p - origin).normalize())).is_none() as u32;
        }
        assert_eq!(leaks, 0, "from {far} times the radius, at scale {scale}");
    }
}

#[test]
fn a_walk_inside_closed_shapes_never_escapes_and_never_stands_still() {
    for (far, scale) in [(0.0, 1e-4f32), (0.0, 1.0), (10.0, 1.0), (1000.0, 1.0), (0.0, 1e4)] {
        let centre = Vec3::new(1.0, -0.5, 0.25) * far * scale;
        let mesh = ShapeGeometry::Mesh(ball(6, centre, scale));
        let cube = ShapeGeometry::Mesh(TriangleMesh::cube(&DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale as f64),
            tilt(),
            centre.as_dvec3(),
        )));
        for shape in [mesh, cube, ShapeGeometry::Sphere(Sphere::new(centre, scale))] {
            let geometry = Geometry::build(vec![shape]).unwrap();
            let mut s = Stream::new(2, [0; 3], Purpose::TEST);
            let mut ray = Ray::new(centre, Vec3::X);
            for bounce in 0..20_000 {
                let hit = geometry
                    .intersect(&ray)
                    .unwrap_or_else(|| panic!("escaped at bounce {bounce}, far {far}, scale {scale}"));
                let x = geometry.surface(&ray, &hit);
                assert!((x.p - centre).length() < 1.8 * scale);
                // Leave at any angle on the inner side, grazing ones too.
                let inside = if x.ng.dot(ray.dir) < 0.0 { x.ng } else { -x.ng };
                let dir = warp::sphere(s.next_2d());
                let dir = if dir.dot(inside) < 0.0 { -dir } else { dir };
                ray = Ray::new(offset_from(x.p, x.ng, x.error, dir), dir);
            }
        }
    }
}
fn tilt() -> glam::DQuat {
    glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.7)
}

#[test]
fn points_of_a_convex_room_see_each_other_and_nothing_sees_through_a_wall() {
    for scale in [1e-4f32, 1.0, 1e4] {
        let to_world =
            DAffine3::from_scale_rotation_translation(DVec3::splat(scale as f64), tilt(), DVec3::splat(scale as f64));
        let geometry = Geometry::build(vec![ShapeGeometry::Mesh(TriangleMesh::cube(&to_world))]).unwrap();
        let mut s = Stream::new(3, [0; 3], Purpose::TEST);
        let mut on_wall = || geometry.surface_on_triangle(0, s.next_below(12) as u32, warp::triangle(s.next_2d()));
        let (mut blocked, mut coplanar) = (0, 0);
        for _ in 0..50_000 {
            let (x, y) = (on_wall(), on_wall());
            if x.ng.dot(y.ng) > 0.9 {
                coplanar += 1; // the same wall: they see each other at grazing angle, which no cosine lets through
                continue;
            }
            let ray = shadow_segment((x.p, Some((x.ng, x.error))), (y.p, Some((y.ng, y.error)))).unwrap();
            blocked += geometry.occluded(&ray) as u32;
        }
        assert_eq!(blocked, 0, "at scale {scale} ({coplanar} pairs on one wall left out)");
        let outside = (to_world.translation.as_vec3() + Vec3::splat(10.0 * scale), None);
        for _ in 0..10_000 {
            let x = on_wall();
            let end = (to_world.translation.as_vec3(), None);
            assert!(geometry.occluded(&shadow_segment(end, outside).unwrap()));
            assert!(!geometry.occluded(&shadow_segment(end, (x.p, Some((x.ng, x.error)))).unwrap()));
        }
    }
}

#[test]
fn thousands_of_coincident_triangles_do_no_harm() {
    let mut mesh = TriangleMesh::rectangle(&DAffine3::IDENTITY);
    let first = mesh.triangles[0];
    mesh.triangles.extend(std::iter::repeat_n(first, 5000));
    mesh.triangles.push([0, 0, 1]);
    let geometry = Geometry::build(vec![ShapeGeometry::Mesh(mesh)]).unwrap();
    assert_eq!(geometry.primitive_count(), 2);
    assert!(geometry.intersect(&Ray::new(Vec3::new(0.5, -0.5, 1.0), Vec3::NEG_Z)).is_some());
}

#[test]
fn an_empty_scene_and_rays_that_are_not_finite_meet_nothing() {
    let empty = Geometry::build(vec![]).unwrap();
    assert!(empty.intersect(&Ray::new(Vec3::ZERO, Vec3::X)).is_none() && empty.bounds().is_empty());
    let quad = Geometry::build(vec![ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::IDENTITY))]).unwrap();
    assert!(quad.intersect(&Ray::new(Vec3::NAN, Vec3::X)).is_none());
    assert!(!quad.occluded(&Ray::new(Vec3::ZERO, Vec3::NAN)));
}
