//! Time to a scene that can be rendered: the files read, the tree built.

use criterion::{Criterion, criterion_group, criterion_main};
use manylight_benches::{scene_file, shared_scene_file};
use manylight_scene_io::{LoadOptions, load};
use std::time::Duration;

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("load");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(5));
    for (name, path) in [("ajar", Some(scene_file("ajar"))), ("veach-ajar", shared_scene_file("veach-ajar"))] {
        match path {
            Some(path) => {
                group.bench_function(name, |b| {
                    b.iter(|| load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}")))
                });
            }
            None => println!("load/{name}: skipped, it is not in ../shared/scenes beside this repository"),
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
