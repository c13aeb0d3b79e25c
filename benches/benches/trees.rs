//! Light sets over the number of lights: time, shadow rays and error of a receiver, from 1e2 to 1e6 lights in one room; and what
//! building the tree costs.
//!
//! Lamps that shine to one side or to all hang in a closed room with pillars; all together have the same power. The error is the
//! root of the mean, over receivers and draws, of (estimate / truth - 1)^2 in luminance, truth being the sum over all lights.
//! Receivers are those that see any light.

use manylight_benches::room_with_pillars;
use manylight_compensation::Bound;
use manylight_framework::{Contribute, Gather, LightSet, Occlusion, Plan, Probe};
use manylight_light_list::Power;
use manylight_light_tree::{Build, Growth, LightBvh, LightTree, Lightcuts, Standing, StochasticLightcuts};
use manylight_math::{Aabb, Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Edge, EmitterPoint, Mode, Scatter, Scene, Vertex};
use manylight_vpl::{Points, Vpl};
use std::hint::black_box;
use std::time::Instant;

struct Nothing;
impl Occlusion for Nothing {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}

fn lamps(n: usize) -> Vec<Vpl> {
    let mut s = Stream::new(1, [n as u64, 0, 0], Purpose::TEST);
    (0..n)
        .map(|_| {
            let p = (Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * 2.0 - 1.0) * Vec3::new(4.0, 1.3, 4.0);
            let n_ = warp::sphere(s.next_2d());
            let point =
                if s.next_f32() < 0.5 { EmitterPoint::Isotropic } else { EmitterPoint::Lambert { n: n_, error: 0.0 } };
            let flux = Spectrum::rgb(1.0, s.next_f32(), s.next_f32()) * ((0.2 + s.next_f32()) * 100.0 / n as f32);
            Vpl { vertex: Vertex { p, scatter: Scatter::Emitter(point) }, flux, edges: 0 }
        })
        .collect()
}

struct Setting {
    scene: Scene,
    receivers: Vec<Vertex>,
}

impl Setting {
    fn new(side: u32) -> Setting {
        let scene = room_with_pillars(side);
        let pixels = (0..side * side).map(|i| Vec2::new((i % side) as f32 + 0.5, (i / side) as f32 + 0.5));
        let receivers = pixels.filter_map(|p| scene.intersect(&scene.camera().ray(p), Mode::Radiance)).collect();
        Setting { scene, receivers }
    }
    fn gather<'a>(&'a self, x: &'a Vertex, probe: &'a mut Probe) -> Gather<'a, Vertex, Points, Bound> {
        let (scene, receiver) = (&self.scene, x);
        Gather { scene, receiver, kernel: &Points, bounding: &BOUND, edges_left: u32::MAX, edges_least: 0, probe }
    }
    /// Some receivers with the sum over all lights.
    fn truths(&self, lights: &[Vpl], count: usize) -> Vec<(&Vertex, f64)> {
        let some = self.receivers.iter().step_by((self.receivers.len() / count).max(1));
        let mut s = Stream::new(2, [0; 3], Purpose::TEST);
        some.map(|x| {
            let mut probe = Probe::default();
            let mut ask = self.gather(x, &mut probe);
            (x, lights.iter().map(|l| ask.contribution(l, &mut s).luminance() as f64).sum())
        })
        .filter(|t: &(&Vertex, f64)| t.1 > 0.0)
        .collect()
    }
    fn measure<P: Plan<Vec<Vpl>>>(&self, name: &str, plan: P, lights: &[Vpl], truths: &[(&Vertex, f64)])
    where
        P::Set: for<'g> LightSet<Gather<'g, Vertex, Points, Bound>>,
    {
        let mut s = Stream::new(3, [0; 3], Purpose::TEST);
        let start = Instant::now();
        let set = plan.build(lights.to_vec(), &Nothing, &mut s).expect("lights are finite");
        let build = start.elapsed().as_secs_f64();
        let mut probe = Probe::default();
        let start = Instant::now();
        for x in &self.receivers {
            black_box(set.radiance(&mut self.gather(x, &mut probe), &mut s));
        }
        let time = start.elapsed().as_secs_f64() / self.receivers.len() as f64;
        let rays = probe.shadow_rays as f64 / self.receivers.len() as f64;
        let (mut error, draws) = (0.0, 8);
        for (x, truth) in truths {
            for _ in 0..draws {
                let estimate = set.radiance(&mut self.gather(x, &mut probe), &mut s).luminance() as f64;
                error += (estimate / truth - 1.0).powi(2);
            }
        }
        let error = (error / (truths.len() * draws) as f64).sqrt();
        println!(
            "{:8} {name:28} {:9.2} {rays:8.1} {:9.3} {:9.3} {:9.1}",
            lights.len(),
            time * 1e6,
            100.0 * error,
            error * error * time * 1e6,
            build * 1e3
        );
    }
}

const BOUND: Bound = Bound::Geometry(4.0);

fn trees(n: usize) {
    let lights = lamps(n);
    for by in [Build::Fast, Build::Greedy] {
        if by == Build::Greedy && n > 10_000 {
            continue;
        }
        let growth = Growth { build: by, ..Growth::default() };
        let (mut best, mut bytes) = (f64::INFINITY, 0);
        for _ in 0..3 {
            let copy = lights.clone();
            let start = Instant::now();
            let tree = LightTree::new(copy, growth, &mut Stream::new(0, [0; 3], Purpose::TEST));
            best = best.min(start.elapsed().as_secs_f64());
            bytes = tree.expect("lights are finite").bytes();
        }
        println!("{n:8} {by:?}: {:9.1} ms, {:.1} bytes a light", best * 1e3, bytes as f64 / n as f64);
    }
}

fn main() {
    // Without `--bench` it runs once, so that it cannot rot.
    let full = std::env::args().any(|a| a == "--bench");
    let (sizes, side): (&[usize], u32) =
        if full { (&[100, 1000, 10_000, 100_000, 1_000_000], 48) } else { (&[100], 4) };
    println!("building, of three the best:");
    sizes.iter().for_each(|&n| trees(n));
    let setting = Setting::new(side);
    println!("  lights set                          us/point  rays/pt  error %  err^2 x t  build ms");
    for &n in sizes {
        let lights = lamps(n);
        let truths = setting.truths(&lights, if full { 32 } else { 4 });
        let slc = |size| StochasticLightcuts { size, ..StochasticLightcuts::default() };
        setting.measure("power 16", Power { samples: 16 }, &lights, &truths);
        setting.measure("light-bvh 16", LightBvh { samples: 16, ..LightBvh::default() }, &lights, &truths);
        setting.measure("stochastic-lightcuts 1", slc(1), &lights, &truths);
        setting.measure("stochastic-lightcuts 16", slc(16), &lights, &truths);
        setting.measure("stochastic-lightcuts 64", slc(64), &lights, &truths);
        setting.measure("lightcuts 2 %", Lightcuts::default(), &lights, &truths);
        let brightest = Lightcuts { standing: Standing::Brightest, ..Lightcuts::default() };
        setting.measure("lightcuts 2 %, brightest", brightest, &lights, &truths);
    }
}
