//! Virtual point lights gathered per second, and how much of that time the shadow rays take.
//!
//! The same receivers ask the same lights three times over: with shadows; without (`unshadowed`: all but the rays); and the
//! shadow rays alone, prepared beforehand. The first less the second is the cost of the shadow tests, the third that of the
//! tree within it.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use manylight_benches::scene_file;
use manylight_compensation::{Bound, BoundPlanKind};
use manylight_framework::{BoundingPlan, Gather, Generator, LightSet, Occlusion, Plan, Probe, Unshadowed};
use manylight_geometry::shadow_segment;
use manylight_light_list::{All, AllLights};
use manylight_math::{Aabb, Ray, Spectrum, Vec2};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, Mode, Scene, Vertex};
use manylight_scene_io::{LoadOptions, load};
use manylight_vpl::{Emission, Keller, Points, Vpl};
use std::hint::black_box;
use std::time::{Duration, Instant};

const LIGHTS: usize = 256;
const SIZE: u32 = 32;
/// Each time is the best of so many.
const TRIES: u32 = 7;

/// One receiver a pixel, and the lights.
struct Setting {
    scene: Scene,
    receivers: Vec<Vertex>,
    lights: Vec<Vpl>,
    set: AllLights<Vpl>,
}

/// `All` asks nothing while it is built.
struct Nothing;
impl Occlusion for Nothing {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}

fn stream() -> Stream {
    Stream::new(1, [0; 3], Purpose::TEST)
}

impl Setting {
    fn new(name: &str) -> Self {
        let options = LoadOptions { size: Some((SIZE, SIZE)), ..LoadOptions::default() };
        let scene = load(&scene_file(name), &options).unwrap_or_else(|e| panic!("{e}")).scene;
        let keller = Keller { paths: LIGHTS as u64, max_edges: None, certain_edges: 1, emission: Emission::Full };
        let batch = keller.generate(&scene, 0, 1, &mut Probe::default()).expect("the scene has lamps");
        let lights: Vec<Vpl> = batch.lights.into_iter().take(LIGHTS).collect();
        assert_eq!(lights.len(), LIGHTS, "{name} has too few lights");
        let pixels = (0..SIZE * SIZE).map(|i| Vec2::new((i % SIZE) as f32 + 0.5, (i / SIZE) as f32 + 0.5));
        let seen = pixels.filter_map(|p| scene.intersect(&scene.camera().ray(p), Mode::Radiance));
        let receivers: Vec<Vertex> = seen.filter(Vertex::connects).collect();
        let set = All.build(lights.clone(), &Nothing, &mut stream()).expect("the lights are finite");
        Setting { scene, receivers, lights, set }
    }
    fn pairs(&self) -> u64 {
        (self.receivers.len() * self.lights.len()) as u64
    }
    /// What `ask` finds at all receivers together.
    fn sum(&self, probe: &mut Probe, ask: impl Fn(&mut Gather<'_, Vertex, Points, Bound>) -> Spectrum) -> Spectrum {
        let bound = BoundPlanKind::Auto.at(&self.scene, 0, LIGHTS as u64);
        let mut sum = Spectrum::BLACK;
        for receiver in &self.receivers {
            let (edges_left, edges_least) = (u32::MAX, 0);
            let (scene, kernel, bounding) = (&self.scene, &Points, &bound);
            sum += ask(&mut Gather { scene, receiver, kernel, bounding, edges_left, edges_least, probe });
        }
        sum
    }
    fn shadowed(&self, probe: &mut Probe) -> Spectrum {
        self.sum(probe, |g| self.set.radiance(g, &mut stream()))
    }
    fn unshadowed(&self, probe: &mut Probe) -> Spectrum {
        self.sum(probe, |g| {
            let mut s = stream();
            self.lights.iter().map(|l| g.unshadowed(l, &mut s)).sum()
        })
    }
    /// The shadow rays of `shadowed`.
    fn rays(&self) -> Vec<Ray> {
        let mut probe = Probe::default();
        probe.explain = Some(Vec::new());
        self.shadowed(&mut probe);
        let asked = probe.explain.into_iter().flatten();
        let segments = asked.filter_map(|e| match e.edge {
            Edge::Between(a, b) => shadow_segment((a.p, a.surface), (b.p, b.surface)),
            Edge::ToInfinity(..) => None, // these lights are all near
        });
        segments.collect()
    }
}

fn best<T>(mut f: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        black_box(f());
        start.elapsed().as_secs_f64()
    };
    (0..TRIES).map(time).fold(f64::INFINITY, f64::min)
}

fn print_share(name: &str, setting: &Setting) {
    let rays = setting.rays();
    let shadowed = best(|| setting.shadowed(&mut Probe::default()));
    let unshadowed = best(|| setting.unshadowed(&mut Probe::default()));
    let traversal = best(|| rays.iter().filter(|r| setting.scene.geometry().occluded(r)).count());
    println!(
        "{name}: {:.2} M gathers/s, {:.2} shadow rays each; shadow tests take {:.0} % of the time, the tree alone {:.0} %",
        setting.pairs() as f64 / shadowed * 1e-6,
        rays.len() as f64 / setting.pairs() as f64,
        100.0 * (1.0 - unshadowed / shadowed),
        100.0 * traversal / shadowed,
    );
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("gather");
    group.sample_size(20).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for name in ["cornell-box", "ajar"] {
        let setting = Setting::new(name);
        print_share(name, &setting);
        group.throughput(Throughput::Elements(setting.pairs()));
        group.bench_function(format!("{name}/shadowed"), |b| b.iter(|| setting.shadowed(&mut Probe::default())));
        group.bench_function(format!("{name}/unshadowed"), |b| b.iter(|| setting.unshadowed(&mut Probe::default())));
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
