//! The lighting grid hierarchy over the number of lights: time to build, memory, lights and time of a query, and how many times
//! faster than the sum over all lights that is; without shadows, on the plane points and inside points of the notes' set A.

use manylight_framework::{Contribute, LightSet, Limited, Located, Notes, Occlusion, Plan, Unshadowed, VirtualLight};
use manylight_lgh::{GridLights, Lgh};
use manylight_light_list::All;
use manylight_math::{Aabb, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::Edge;
use manylight_volume_lights::VolumeLight;
use std::hint::black_box;
use std::time::Instant;

struct Clear;
impl Occlusion for Clear {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}

const G: f64 = 1.220_744_084_605_759_6;
fn place(i: u64) -> Vec3 {
    Vec3::from_array([1, 2, 3].map(|k| (0.5 + G.powi(-k) * (i + 1) as f64).fract() as f32))
}
fn lights(n: u64) -> Vec<VolumeLight> {
    let light = |i: u64| {
        let u = (0.618_033_988_749_894_9 * (i + 1) as f64).fract();
        let intensity = Spectrum::gray(((0.5 + u) / n as f64) as f32);
        VolumeLight { p: place(i), intensity, spread: Vec3::ZERO, radius: 0.0, edges: 0 }
    };
    (0..n).map(light).collect()
}

/// Looks up from the plane, or to all sides from inside.
struct At {
    p: Vec3,
    cosine: bool,
    count: f32,
}
impl At {
    fn gives(&self, l: &VolumeLight) -> Spectrum {
        let d = l.p - self.p;
        let d2 = d.length_squared() + 1e-4;
        l.intensity * (if self.cosine { (d.z / d2.sqrt()).max(0.0) } else { 1.0 } / d2)
    }
}
impl Located for At {
    fn position(&self) -> Vec3 {
        self.p
    }
}
impl Limited for At {
    fn edges_left(&self) -> u32 {
        u32::MAX
    }
}
impl Notes for At {
    fn note(&mut self, _: &'static str, value: f32) {
        self.count += value;
    }
}
impl Contribute<VolumeLight> for At {
    fn contribution(&mut self, l: &VolumeLight, _: &mut Stream) -> Spectrum {
        self.gives(l)
    }
}
impl Unshadowed<VolumeLight> for At {
    fn unshadowed(&mut self, l: &VolumeLight, _: &mut Stream) -> Spectrum {
        self.gives(l)
    }
}

/// Seconds a query, the mean of all answers, and lights a query.
fn query(set: &impl LightSet<At>, points: u64, plane: bool, s: &mut Stream) -> (f64, Vec<f32>, f32) {
    let at = |k: u64| {
        let q = place(1_000_000 + k);
        let below = Vec3::new(2.0 * q.x - 0.5, 2.0 * q.y - 0.5, -0.1);
        At { p: if plane { below } else { q }, cosine: plane, count: 0.0 }
    };
    let mut ask: Vec<At> = (0..points).map(at).collect();
    let start = Instant::now();
    let values = ask.iter_mut().map(|a| black_box(set.radiance(a, s)).luminance()).collect();
    let time = start.elapsed().as_secs_f64() / points as f64;
    (time, values, ask.iter().map(|a| a.count).sum::<f32>() / points as f32)
}

fn main() {
    // `cargo test` runs it once, small.
    let whole = std::env::args().any(|a| a == "--bench");
    let (most, points) = if whole { (6, 512) } else { (3, 8) };
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    println!("     lights  alpha  build ms   MB   points   lights/query   query us   all us   faster   mean error");
    for n in (3..=most).map(|e| 10u64.pow(e)) {
        let given = lights(n);
        let all = All.build(given.clone(), &Clear, &mut s).expect("lights are finite");
        let few = points.min(20_000_000 / n);
        let truths = [true, false].map(|plane| query(&all, few, plane, &mut s));
        for alpha in [2.0f32, 4.0] {
            // The second build: memory is warm.
            let build = || {
                let start = Instant::now();
                let plan = Lgh { alpha, ..Lgh::default() };
                let set: GridLights<VolumeLight> = plan
                    .build(given.clone(), &Clear, &mut Stream::new(1, [0; 3], Purpose::TEST))
                    .expect("lights are finite");
                (start.elapsed().as_secs_f64(), set)
            };
            build();
            let (built, set) = build();
            let bytes: usize = set.hierarchies().map(|h| h.bytes()).sum();
            for (plane, (all_time, truth, _)) in [true, false].into_iter().zip(&truths) {
                let (time, values, met) = query(&set, few, plane, &mut s);
                let error = values.iter().zip(truth).map(|(v, t)| (v / t - 1.0).abs()).sum::<f32>() / few as f32;
                println!(
                    "{n:>11} {alpha:>6} {:>9.2} {:>4.1} {:>8} {met:>14.1} {:>10.2} {:>8.1} {:>8.2} {:>11.3} %",
                    1e3 * built,
                    bytes as f64 / 1e6,
                    if plane { "plane" } else { "inside" },
                    1e6 * time,
                    1e6 * all_time,
                    all_time / time,
                    100.0 * error
                );
            }
        }
    }
    black_box(lights(1)[0].intensity());
}
