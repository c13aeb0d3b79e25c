//! Point lights and receivers of the notes' shared sets: omnidirectional lights in the unit cube, receivers on a plane below it and
//! inside.
#![allow(dead_code)]

use manylight_framework::{
    Blend, Clustered, Contribute, Limited, Located, Notes, Occlusion, Plan, Unshadowed, VirtualLight,
};
use manylight_lgh::{GridLights, Lattice, Lgh};
use manylight_math::{Aabb, DVec3, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::Edge;
use std::collections::HashMap;

/// A light that shines to all sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    pub p: Vec3,
    /// [W/sr]
    pub intensity: f32,
    pub edges: u32,
    /// Averages lie at the mean of places by splat weights alone, as the published implementations have it.
    pub plain: bool,
    /// Cannot be averaged.
    pub alone: bool,
}
pub fn lamp(p: Vec3, intensity: f32) -> Lamp {
    Lamp { p, intensity, edges: 1, plain: false, alone: false }
}

impl VirtualLight for Lamp {
    fn intensity(&self) -> f32 {
        self.intensity
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}
impl Clustered for Lamp {
    type Cluster = Aabb;
    fn position(&self) -> Vec3 {
        self.p
    }
    fn cluster(&self) -> Aabb {
        Aabb::point(self.p)
    }
    fn merge(a: &Aabb, b: &Aabb) -> Aabb {
        a.join(b)
    }
    fn weight(_: &Aabb) -> f32 {
        1.0
    }
    fn cost(_: &Aabb, _: f32) -> f32 {
        1.0
    }
}
#[derive(Clone, Default)]
pub struct Sum {
    intensity: f64,
    weight: f64,
    place: DVec3,
    edges: u32,
}
impl Blend for Lamp {
    type Synthetic = Lamp;
    type Sum = Sum;
    fn blends(&self) -> bool {
        !self.alone
    }
    fn add(&self, w: f64, sum: &mut Sum) {
        let by = if self.plain { w } else { w * self.intensity as f64 };
        sum.intensity += w * self.intensity as f64;
        sum.weight += by;
        sum.place += by * self.p.as_dvec3();
        sum.edges = self.edges;
    }
    fn join(sum: &mut Sum, o: &Sum) {
        sum.intensity += o.intensity;
        sum.weight += o.weight;
        sum.place += o.place;
        sum.edges = o.edges;
    }
    fn made(sum: &Sum) -> Option<(Vec3, Lamp)> {
        let p = (sum.place / sum.weight).as_vec3();
        (sum.intensity > 0.0).then(|| (p, Lamp { edges: sum.edges, ..lamp(p, sum.intensity as f32) }))
    }
}

const G: f64 = 1.220_744_084_605_759_6;
pub fn place(i: u64) -> [f64; 3] {
    [1.0, 2.0, 3.0].map(|k| (0.5 + G.powi(-(k as i32)) * (i + 1) as f64).fract())
}
pub fn vec3(p: [f64; 3]) -> Vec3 {
    Vec3::from_array(p.map(|x| x as f32))
}
fn u(i: u64) -> f64 {
    (0.618_033_988_749_894_9 * (i + 1) as f64).fract()
}
/// Set A: intensities between 0.5 and 1.5 over N.
pub fn set_a(n: u64) -> Vec<Lamp> {
    (0..n).map(|i| lamp(vec3(place(i)), ((0.5 + u(i)) / n as f64) as f32)).collect()
}
/// Set B: intensities over four decades.
pub fn set_b(n: u64) -> Vec<Lamp> {
    (0..n).map(|i| lamp(vec3(place(i)), (10f64.powf(4.0 * u(i) - 2.0) / n as f64) as f32)).collect()
}
/// The cube of the tables, with so many levels.
pub fn table_lattice(lights: &[Lamp]) -> Lattice {
    Lattice::around(&Aabb::around(lights.iter().map(|l| l.p)), Lattice::levels_for(lights.len()))
}

/// A receiver; with a cosine it looks up. It counts what it is asked.
#[derive(Clone)]
pub struct At {
    pub p: Vec3,
    pub cosine: bool,
    /// Added to squared distances. [m^2]
    pub soft: f64,
    /// Lights that are hidden: those with x above this.
    pub wall: f32,
    pub asked: u64,
    pub unshadowed: u64,
    pub notes: HashMap<&'static str, f32>,
    pub edges: (u32, u32),
}
impl At {
    pub fn inside(p: Vec3) -> At {
        At {
            p,
            cosine: false,
            soft: 1e-4,
            wall: f32::INFINITY,
            asked: 0,
            unshadowed: 0,
            notes: HashMap::new(),
            edges: (0, u32::MAX),
        }
    }
    /// The 512 points of the plane z = -0.1, which look up, or as many inside the unit cube.
    pub fn points(plane: bool) -> Vec<At> {
        let at = |k: u64| {
            let q = place(1_000_000 + k);
            let below = vec3([2.0 * q[0] - 0.5, 2.0 * q[1] - 0.5, -0.1]);
            At { cosine: plane, ..At::inside(if plane { below } else { vec3(q) }) }
        };
        (0..512).map(at).collect()
    }
    pub fn gives(&self, l: &Lamp) -> f64 {
        let hidden = l.p.x > self.wall || l.edges >= self.edges.1 || l.edges < self.edges.0;
        let d = (l.p - self.p).as_dvec3();
        let d2 = d.length_squared() + self.soft;
        let cosine = if self.cosine { (d.z / d2.sqrt()).max(0.0) } else { 1.0 };
        if hidden { 0.0 } else { l.intensity as f64 * cosine / d2 }
    }
    pub fn all(&self, lights: &[Lamp]) -> f64 {
        lights.iter().map(|l| self.gives(l)).sum()
    }
    /// The hierarchy's sum in double precision, and how many lights count.
    pub fn by(&self, set: &GridLights<Lamp>) -> (f64, u32) {
        let (mut sum, mut count) = (0.0, 0);
        for h in set.hierarchies() {
            h.at(self.p, |w, met| {
                count += 1;
                let l = match met {
                    manylight_lgh::Met::Given(l) => l,
                    manylight_lgh::Met::Made(l) => l,
                };
                sum += w * self.gives(l);
            });
        }
        (sum, count)
    }
    /// Relative error.
    pub fn error(&self, set: &GridLights<Lamp>, lights: &[Lamp]) -> f64 {
        self.by(set).0 / self.all(lights) - 1.0
    }
}
impl Located for At {
    fn position(&self) -> Vec3 {
        self.p
    }
}
impl Contribute<Lamp> for At {
    fn contribution(&mut self, l: &Lamp, _: &mut Stream) -> Spectrum {
        self.asked += 1;
        Spectrum::gray(self.gives(l) as f32)
    }
}
impl Unshadowed<Lamp> for At {
    fn unshadowed(&mut self, l: &Lamp, _: &mut Stream) -> Spectrum {
        self.unshadowed += 1;
        Spectrum::gray(At { wall: f32::INFINITY, ..self.clone() }.gives(l) as f32)
    }
}
impl Limited for At {
    fn edges_left(&self) -> u32 {
        self.edges.1
    }
    fn edges_least(&self) -> u32 {
        self.edges.0
    }
}
impl Notes for At {
    fn note(&mut self, aov: &'static str, value: f32) {
        self.notes.insert(aov, value);
    }
}

pub struct Clear;
impl Occlusion for Clear {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}
pub fn stream(seed: u64) -> Stream {
    Stream::new(seed, [0; 3], Purpose::TEST)
}
pub fn build(plan: &Lgh, lights: &[Lamp]) -> GridLights<Lamp> {
    plan.build(lights.to_vec(), &Clear, &mut stream(0)).unwrap()
}
/// By the published header's parameter: r_0 = alpha_h h_1.
pub fn header(alpha_h: f64) -> Lgh {
    Lgh { alpha: 2.0 * alpha_h as f32, ..Lgh::default() }
}
