//! Rays per second, of each kind, against a mesh of 100,352 triangles in a room.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use manylight_embree::rays::{RayKinds, sphere_in_a_room};
use manylight_geometry::Geometry;
use std::hint::black_box;
use std::time::Duration;

const ROWS: u32 = 224;
const SIDE: u32 = 256;

fn bench(c: &mut Criterion) {
    let geometry = Geometry::build(sphere_in_a_room(ROWS)).expect("the mesh is sound");
    let kinds = RayKinds::new(&geometry, SIDE);
    let mut group = c.benchmark_group("rays");
    group.sample_size(20).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for (name, rays, shadow) in kinds.all() {
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_with_input(BenchmarkId::from_parameter(name), rays, |b, rays| {
            if shadow {
                b.iter(|| rays.iter().filter(|r| geometry.occluded(r)).count())
            } else {
                b.iter(|| rays.iter().filter(|r| black_box(geometry.intersect(r)).is_some()).count())
            }
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
