//! Rays per second, of each kind, against a mesh of 100,352 triangles in a room.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use manylight_benches::sphere_in_a_room;
use manylight_geometry::{Geometry, Surface, offset_from, shadow_segment};
use manylight_math::{DAffine3, DVec3, Frame, Ray, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::Camera;
use std::hint::black_box;
use std::time::Duration;

const ROWS: u32 = 224;
const SIZE: u32 = 256;

struct Rays {
    primary: Vec<Ray>,
    bounce: Vec<Ray>,
    shadow: Vec<Ray>,
}

fn rays(geometry: &Geometry) -> Rays {
    let to_world = DAffine3::from_translation(DVec3::new(0.0, 0.0, -2.9));
    let camera = Camera::perspective(to_world, 60.0, (SIZE, SIZE)).expect("the camera is a usual one");
    let pixels = (0..SIZE * SIZE).map(|i| Vec2::new((i % SIZE) as f32 + 0.5, (i / SIZE) as f32 + 0.5));
    let primary: Vec<Ray> = pixels.map(|p| camera.ray(p)).collect();
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
    for ray in &primary {
        let hit = geometry.intersect(ray).expect("the room is closed");
        let Surface { p, ng, error, .. } = geometry.surface(ray, &hit);
        let n = if ng.dot(ray.dir) < 0.0 { ng } else { -ng };
        let dir = Frame::around(n).to_world(warp::cosine_hemisphere(s.next_2d()));
        bounce.push(Ray::new(offset_from(p, n, error, dir), dir));
        // Towards a lamp of 2 m x 2 m below the ceiling, where it is in front.
        let u = s.next_2d();
        let lamp = Vec3::new(2.0 * u.x - 1.0, 2.9, 2.0 * u.y - 1.0);
        if n.dot(lamp - p) > 0.0 {
            shadow.extend(shadow_segment((p, Some((n, error))), (lamp, None)));
        }
    }
    Rays { primary, bounce, shadow }
}

fn bench(c: &mut Criterion) {
    let geometry = sphere_in_a_room(ROWS).expect("the mesh is sound");
    let rays = rays(&geometry);
    let mut group = c.benchmark_group("rays");
    group.sample_size(20).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for (name, rays) in [("primary", &rays.primary), ("bounce", &rays.bounce)] {
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_with_input(BenchmarkId::from_parameter(name), rays, |b, rays| {
            b.iter(|| rays.iter().filter(|r| black_box(geometry.intersect(r)).is_some()).count())
        });
    }
    group.throughput(Throughput::Elements(rays.shadow.len() as u64));
    group.bench_with_input(BenchmarkId::from_parameter("shadow"), &rays.shadow, |b, rays| {
        b.iter(|| rays.iter().filter(|r| geometry.occluded(r)).count())
    });
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
