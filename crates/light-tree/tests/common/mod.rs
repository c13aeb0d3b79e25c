//! Point lights and receivers of the notes' shared sets: omnidirectional lights in the unit cube, receivers on a plane below it.
#![allow(dead_code)]

use manylight_framework::{
    BoundCluster, Clustered, Contribute, Limited, Notes, Occlusion, Plan, Reach, ReachCluster, VirtualLight,
};
use manylight_math::{Aabb, Frame, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::Edge;
use std::collections::HashMap;

/// A light that shines to all sides.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    pub p: Vec3,
    /// [W/sr]
    pub intensity: f32,
    pub edges: u32,
}

#[derive(Clone, Copy, Debug)]
pub struct Lamps {
    pub bounds: Aabb,
    pub intensity: f32,
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
    type Cluster = Lamps;
    fn position(&self) -> Vec3 {
        self.p
    }
    fn cluster(&self) -> Lamps {
        Lamps { bounds: Aabb::point(self.p), intensity: self.intensity }
    }
    fn merge(a: &Lamps, b: &Lamps) -> Lamps {
        Lamps { bounds: a.bounds.join(&b.bounds), intensity: a.intensity + b.intensity }
    }
    fn weight(c: &Lamps) -> f32 {
        c.intensity
    }
    fn cost(c: &Lamps, _: f32) -> f32 {
        c.intensity * (c.bounds.hi - c.bounds.lo).length_squared()
    }
}
pub fn holds(outer: &Lamps, inner: &Lamps) -> bool {
    outer.bounds.join(&inner.bounds) == outer.bounds && outer.intensity >= inner.intensity
}

const G: f64 = 1.220_744_084_605_759_6;
fn place(i: u64) -> [f64; 3] {
    [1.0, 2.0, 3.0].map(|k| (0.5 + G.powi(-(k as i32)) * (i + 1) as f64).fract())
}
fn vec3(p: [f64; 3]) -> Vec3 {
    Vec3::from_array(p.map(|x| x as f32))
}
fn u(i: u64) -> f64 {
    (0.618_033_988_749_894_9 * (i + 1) as f64).fract()
}
/// Set A: intensities between 0.5 and 1.5 over N.
pub fn set_a(n: u64) -> Vec<Lamp> {
    let lamp = |i| Lamp { p: vec3(place(i)), intensity: ((0.5 + u(i)) / n as f64) as f32, edges: 1 };
    (0..n).map(lamp).collect()
}
/// Set B: intensities over four decades.
pub fn set_b(n: u64) -> Vec<Lamp> {
    let lamp = |i| Lamp { p: vec3(place(i)), intensity: (10f64.powf(4.0 * u(i) - 2.0) / n as f64) as f32, edges: 1 };
    (0..n).map(lamp).collect()
}
/// Points of the plane z = -0.1 that look up.
pub fn plane_points(count: u64) -> Vec<At> {
    let at = |k| {
        let q = place(1_000_000 + k);
        At::new(vec3([2.0 * q[0] - 0.5, 2.0 * q[1] - 0.5, -0.1]))
    };
    (0..count).map(at).collect()
}

/// By what a child is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odds {
    MinMax,
    /// The same without the receiver's cosine.
    MinMaxWithoutCosine,
    Min,
    Max,
    Centre,
    Intensity,
}

/// A receiver that looks up, and counts what it is asked.
#[derive(Clone)]
pub struct At {
    pub p: Vec3,
    pub odds: Odds,
    /// Lights that are hidden: those with x above this.
    pub wall: f32,
    pub asked: u64,
    pub notes: HashMap<&'static str, f32>,
    pub edges: (u32, u32),
}
impl At {
    pub fn new(p: Vec3) -> At {
        At { p, odds: Odds::MinMax, wall: f32::INFINITY, asked: 0, notes: HashMap::new(), edges: (0, u32::MAX) }
    }
    /// What a light gives: I cos / d^2, in double precision.
    pub fn gives(&self, l: &Lamp) -> f64 {
        let hidden = l.p.x > self.wall || l.edges >= self.edges.1 || l.edges < self.edges.0;
        let d = (l.p - self.p).as_dvec3();
        let d2 = d.length_squared();
        if hidden || d.z <= 0.0 { 0.0 } else { l.intensity as f64 * d.z / (d2 * d2.sqrt()) }
    }
    pub fn all(&self, lights: &[Lamp]) -> f64 {
        lights.iter().map(|l| self.gives(l)).sum()
    }
    fn cosine(&self, c: &Lamps) -> f32 {
        let up = Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z };
        c.bounds.minus(&Aabb::point(self.p)).largest_cosine(&up).max(0.0)
    }
}
impl Contribute<Lamp> for At {
    fn contribution(&mut self, l: &Lamp, _: &mut Stream) -> Spectrum {
        self.asked += 1;
        Spectrum::gray(self.gives(l) as f32)
    }
}
impl BoundCluster<Lamps> for At {
    fn upper_bound(&self, c: &Lamps) -> f32 {
        c.intensity * self.cosine(c) / Aabb::point(self.p).distances2(&c.bounds).0
    }
}
impl ReachCluster<Lamps> for At {
    fn reach(&self, c: &Lamps) -> Reach {
        let (near2, far2) = Aabb::point(self.p).distances2(&c.bounds);
        let centre2 = (c.bounds.centre() - self.p).length_squared();
        let cosine = self.cosine(c);
        let facing = |f: f32| Reach {
            intensity: c.intensity,
            facing_max: f,
            facing_guess: f,
            near2,
            far2,
            centre2,
            radius2: c.bounds.radius().powi(2),
        };
        let always = if cosine > 0.0 { 1.0 } else { 0.0 };
        match self.odds {
            Odds::MinMax => facing(cosine),
            Odds::MinMaxWithoutCosine => facing(always),
            Odds::Min => Reach { far2: near2, ..facing(cosine) },
            Odds::Max => Reach { near2: far2, ..facing(cosine) },
            Odds::Centre => Reach { near2: centre2, far2: centre2, ..facing(cosine) },
            Odds::Intensity => Reach { near2: 1.0, far2: 1.0, ..facing(always) },
        }
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
pub fn build<P: Plan<Vec<Lamp>>>(plan: &P, lights: &[Lamp], seed: u64) -> P::Set {
    plan.build(lights.to_vec(), &Clear, &mut stream(seed)).unwrap()
}
