//! How large the spheres are.

use manylight_math::Vec3;
use manylight_scene::{Scatter, Scene, Vertex};
use manylight_vpl::Vpl;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// How large the spheres are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// The distance to the k-th nearest light whose surface faces alike (normals within 60 degrees), times `scale`: local density.
    Neighbours {
        /// k.
        k: u32,
        /// Times that distance.
        scale: f32,
    },
    /// scale x sqrt(A / (pi n)), for n lights in a scene of surface A: each light's share of it, were they spread evenly.
    Even {
        /// Times that radius.
        scale: f32,
    },
    /// The same for all. \[m\]
    Fixed(f32),
}

/// Of the radius of the scene's bounding sphere: spheres of coincident lights, which else would spike. Only those: a floor for all would
/// leave a blur that more paths do not take away.
const COINCIDENT: f32 = 1e-4;
/// Likewise: no sphere is larger, before `scale`, so that the only light of a room does not light all of it at once.
const LARGEST: f32 = 0.05;
/// Normals of neighbours make at most 60 degrees.
const ALIKE: f32 = 0.5;
/// Neighbours that are looked at, in multiples of k.
const LOOK: usize = 4;

impl Radius {
    /// A radius for each light; zero for those on emitters and in media, which stay points.
    pub(crate) fn of(&self, scene: &Scene, lights: &[Vpl]) -> Vec<f32> {
        let extent = scene.bounds().radius();
        let within = |r: f32| if r > 0.0 { r.min(LARGEST * extent) } else { COINCIDENT * extent };
        match *self {
            Radius::Fixed(r) => lights.iter().map(|l| if normal(l).is_some() { r } else { 0.0 }).collect(),
            Radius::Even { scale } => {
                let n = lights.iter().filter(|l| normal(l).is_some()).count().max(1);
                let r = scale * within((scene.area() / (std::f64::consts::PI * n as f64)).sqrt() as f32);
                lights.iter().map(|l| if normal(l).is_some() { r } else { 0.0 }).collect()
            }
            Radius::Neighbours { k, scale } => {
                let tree = RTree::bulk_load(lights.iter().filter_map(place).collect());
                let one = |l: &Vpl| normal(l).map_or(0.0, |n| scale * within(distance(&tree, l.vertex.p, n, k)));
                lights.par_iter().map(one).collect()
            }
        }
    }
}

type Place = GeomWithData<[f32; 3], Vec3>;

fn place(light: &Vpl) -> Option<Place> {
    Some(GeomWithData::new(light.vertex.p.to_array(), normal(light)?))
}

/// The normal of the side that a light on a surface shines to.
fn normal(light: &Vpl) -> Option<Vec3> {
    let Vertex { scatter: Scatter::Surface(x), .. } = &light.vertex else { return None };
    Some(x.ng * x.ng.dot(x.wi).signum())
}

/// To the k-th nearest alike, by the density of those that were found among 4 k; infinity if none were.
fn distance(tree: &RTree<Place>, p: Vec3, n: Vec3, k: u32) -> f32 {
    let k = k.max(1) as usize;
    let (mut alike, mut farthest) = (0, f32::INFINITY);
    // The light itself comes first, at distance zero.
    for (other, d2) in tree.nearest_neighbor_iter_with_distance_2(p.to_array()).skip(1).take(LOOK * k) {
        if n.dot(other.data) < ALIKE {
            continue;
        }
        alike += 1;
        farthest = d2.sqrt();
        if alike == k {
            break;
        }
    }
    // Too few alike were near: as if they were as dense further on.
    if alike == 0 { f32::INFINITY } else { farthest * (k as f32 / alike as f32).sqrt() }
}
