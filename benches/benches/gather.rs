//! Virtual point lights gathered per second, and how much of that time the shadow rays take.
//!
//! The same receivers ask the same lights with shadows and without (`unshadowed`); what the shadows cost is the difference.
//! It holds what the compiler can leave out where nobody asks for an edge, so two more times stand beside it: those of the
//! same shadow tests alone (`transmittance`), and of their rays in the tree alone, both over edges and rays made beforehand.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use manylight_benches::scene_file;
use manylight_compensation::{Bound, BoundPlan};
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
const TRIES: u32 = 9;

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
        let bound = BoundPlan::AUTO.at(&self.scene, 0, LIGHTS as u64);
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
    /// What `shadowed` asks to be clear.
    fn edges(&self) -> Vec<Edge> {
        let mut probe = Probe::default();
        probe.explain = Some(Default::default());
        self.shadowed(&mut probe);
        probe.explain.into_iter().flat_map(|e| e.lights).map(|e| e.edge).collect()
    }
}

/// The ray of an edge. These lights are all near.
fn ray(edge: &Edge) -> Option<Ray> {
    match edge {
        Edge::Between(a, b) => shadow_segment((a.p, a.surface), (b.p, b.surface)),
        Edge::ToInfinity(..) => None,
    }
}

fn seconds<T>(f: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    black_box(f());
    start.elapsed().as_secs_f64()
}

fn print_share(name: &str, setting: &Setting) {
    let scene = &setting.scene;
    let edges = setting.edges();
    let rays: Vec<Ray> = edges.iter().filter_map(ray).collect();
    let mut s = Stream::new(0, [0; 3], Purpose::TEST);
    // In turn, so that a busy machine slows all of them; of each the best.
    let [shadowed, unshadowed, tests, tree] = (0..TRIES).fold([f64::INFINITY; 4], |best, _| {
        let times = [
            seconds(|| setting.shadowed(&mut Probe::default())),
            seconds(|| setting.unshadowed(&mut Probe::default())),
            seconds(|| edges.iter().map(|e| scene.transmittance(e, &mut s)).sum::<Spectrum>()),
            seconds(|| rays.iter().filter(|r| scene.geometry().occluded(r)).count()),
        ];
        std::array::from_fn(|i| best[i].min(times[i]))
    });
    println!(
        "{name}: {:.2} M gathers/s, {:.2} shadow rays each; of the time, shadows take {:.0} %, the shadow tests alone {:.0} %, \
         their rays in the tree {:.0} %",
        setting.pairs() as f64 / shadowed * 1e-6,
        edges.len() as f64 / setting.pairs() as f64,
        100.0 * (1.0 - unshadowed / shadowed),
        100.0 * tests / shadowed,
        100.0 * tree / shadowed,
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
