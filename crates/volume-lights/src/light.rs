//! What light sets know of the lights.

use crate::VolumeLight;
use manylight_framework::{Blend, Clustered, VirtualLight};
use manylight_math::{Aabb, DVec3, Spectrum, Vec3};
use std::f32::consts::PI;

impl VirtualLight for VolumeLight {
    fn intensity(&self) -> f32 {
        self.intensity.luminance() * 4.0 * PI
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}

/// A box around lights, and what they emit together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Of their middles. \[m\]
    pub bounds: Aabb,
    /// Luminance, summed. [W/sr]
    pub intensity: f32,
    /// Radius of the smallest. \[m\]
    pub radius: f32,
}

impl Clustered for VolumeLight {
    type Cluster = Cluster;

    fn position(&self) -> Vec3 {
        self.p
    }
    fn cluster(&self) -> Cluster {
        Cluster { bounds: Aabb::point(self.p), intensity: self.intensity.luminance(), radius: self.radius }
    }
    fn merge(a: &Cluster, b: &Cluster) -> Cluster {
        Cluster {
            bounds: a.bounds.join(&b.bounds),
            intensity: a.intensity + b.intensity,
            radius: a.radius.min(b.radius),
        }
    }
    fn weight(c: &Cluster) -> f32 {
        c.intensity
    }
    fn cost(c: &Cluster, _: f32) -> f32 {
        c.intensity * (c.bounds.hi - c.bounds.lo).length_squared()
    }
}

/// Sums over lights; `place` and the like are weighed by luminance.
#[derive(Clone, Debug, Default)]
pub struct Sum {
    intensity: [f64; 3],
    weight: f64,
    place: DVec3,
    squares: DVec3,
    radius: f64,
    edges: u32,
}

impl Blend for VolumeLight {
    type Synthetic = VolumeLight;
    type Sum = Sum;

    fn add(&self, weight: f64, sum: &mut Sum) {
        let by = weight * f64::from(self.intensity.luminance());
        let (p, spread, i) = (self.p.as_dvec3(), self.spread.as_dvec3(), self.intensity.to_array());
        (0..3).for_each(|c| sum.intensity[c] += weight * f64::from(i[c]));
        sum.weight += by;
        sum.place += by * p;
        sum.squares += by * (p * p + spread * spread);
        sum.radius += by * f64::from(self.radius);
        sum.edges = sum.edges.max(self.edges);
    }
    fn join(sum: &mut Sum, o: &Sum) {
        (0..3).for_each(|c| sum.intensity[c] += o.intensity[c]);
        sum.weight += o.weight;
        sum.place += o.place;
        sum.squares += o.squares;
        sum.radius += o.radius;
        sum.edges = sum.edges.max(o.edges);
    }
    /// At the mean of places by luminance, spread by their deviation (E\[p^2\] - E\[p\]^2, never below zero).
    fn made(sum: &Sum) -> Option<(Vec3, VolumeLight)> {
        if !(sum.weight > 0.0) {
            return None;
        }
        let p = sum.place / sum.weight;
        let spread = (sum.squares / sum.weight - p * p).max(DVec3::ZERO);
        let light = VolumeLight {
            p: p.as_vec3(),
            intensity: Spectrum::from(sum.intensity.map(|x| x as f32)),
            spread: DVec3::new(spread.x.sqrt(), spread.y.sqrt(), spread.z.sqrt()).as_vec3(),
            radius: (sum.radius / sum.weight) as f32,
            edges: sum.edges,
        };
        Some((light.p, light))
    }
}
