//! Lights of the media of a scene.

use crate::VolumeLight;
use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_math::{Aabb, DVec3, MediumId, Spectrum};
use manylight_scene::{Glow, Interpolation, Medium, Scene};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Why media cannot be made lights.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VolumeError {
    /// A medium that emits everywhere alike.
    #[error(
        "a homogeneous medium emits, and only grids can be divided into lights: give the medium a grid as `emission`, or use \
         `path`"
    )]
    Homogeneous,
}

/// The emission of a scene's media as lights: one for each block of voxels, of all that the block emits, in its middle by what
/// shines. They are made once and are the same in every pass. Direct light of other emitters is left to the integrator.
#[derive(Clone, Debug)]
pub struct VolumeLights {
    lights: Vec<VolumeLight>,
    bounds: Aabb,
    spacing: f64,
}

impl VolumeLights {
    /// Of blocks of `block`^3 voxels, counted from the first voxel of each grid.
    pub fn new(scene: &Scene, block: usize) -> Result<VolumeLights, VolumeError> {
        let mut all = VolumeLights { lights: Vec::new(), bounds: Aabb::EMPTY, spacing: f64::INFINITY };
        for (id, medium) in scene.media().filter(|m| m.1.emits()) {
            let emission = match medium {
                Medium::Homogeneous(_) => return Err(VolumeError::Homogeneous),
                Medium::Heterogeneous(m) => m.emission(),
            };
            let Some(emission) = emission else { continue };
            all.lights.extend(blocks(scene, id, emission, block.max(1)));
            let (grid, _) = emission.grid();
            all.bounds = all.bounds.join(&grid.bounds());
            let edges = grid.voxel().map(|e| e.length() * block.max(1) as f64);
            all.spacing = edges.into_iter().fold(all.spacing, f64::min);
        }
        Ok(all)
    }
    /// The lights.
    pub fn lights(&self) -> &[VolumeLight] {
        &self.lights
    }
    /// The box of all grids that emit, whatever they do in it; empty if there is none. \[m\]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
    /// h_0, the shortest edge of a block; infinite if there is none. \[m\]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
}

impl Promise for VolumeLights {
    /// Blocks are lights at points, and light is scattered once. Where nothing emits nothing is lost.
    fn claim(&self) -> Claim {
        if self.lights.is_empty() {
            return Claim { misses: PathClasses::INDIRECT, ..Claim::EXACT };
        }
        Claim { bias: f32::INFINITY, brightens: true, misses: PathClasses::INDIRECT, ..Claim::EXACT }
    }
}

impl Generator for VolumeLights {
    type Lights = Vec<VolumeLight>;
    fn generate(&self, _: &Scene, _: u64, _: u64, probe: &mut Probe) -> Result<Batch<Vec<VolumeLight>>, GenerateError> {
        probe.lights += self.lights.len() as u64;
        Ok(Batch { lights: self.lights.clone(), paths: 1, covers_direct: false })
    }
}

/// One light for each block that emits anything, in the order of the grid.
fn blocks(scene: &Scene, id: MediumId, emission: &Glow, block: usize) -> Vec<VolumeLight> {
    let (grid, scale) = emission.grid();
    let size = grid.size();
    let count = size.map(|n| n.div_ceil(block));
    let edges = grid.voxel();
    let volume = edges[0].cross(edges[1]).dot(edges[2]).abs();
    // Of what a voxel's value makes shine: evenly in the voxel, or falling to nothing at its neighbours' middles.
    let parts = if grid.interpolation() == Interpolation::Nearest { 12.0 } else { 6.0 };
    let own = edges.into_iter().map(|e| e * e).fold(DVec3::ZERO, |a, b| a + b) / parts;
    let light = |n: usize| {
        let first = [n % count[0], n / count[0] % count[1], n / count[0] / count[1]].map(|b| b * block);
        let range = |axis: usize| first[axis]..(first[axis] + block).min(size[axis]);
        let (mut total, mut weight, mut squares) = ([0.0f64; 3], 0.0f64, 0.0f64);
        let (mut place, mut place2) = (DVec3::ZERO, DVec3::ZERO);
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    let value = grid.value([i, j, k]);
                    if value.is_black() {
                        continue;
                    }
                    let p = grid.centre([i, j, k]);
                    // What lies beyond the medium's boundary is not there.
                    if scene.medium_at(p.as_vec3()) != id {
                        continue;
                    }
                    let (v, w) = (value.to_array(), f64::from(value.luminance()));
                    (0..3).for_each(|c| total[c] += f64::from(v[c]));
                    weight += w;
                    squares += w * w;
                    place += w * p;
                    place2 += w * (p * p + own);
                }
            }
        }
        let intensity = Spectrum::from(total.map(|t| (t * volume * f64::from(scale)) as f32));
        if intensity.is_black() || !(weight > 0.0) {
            return None;
        }
        let p = place / weight;
        let spread = (place2 / weight - p * p).max(DVec3::ZERO);
        // As many voxels as share it, weighed: it moves with the emission, and does not jump.
        let shared = volume * weight * weight / squares;
        Some(VolumeLight {
            p: p.as_vec3(),
            intensity,
            spread: DVec3::new(spread.x.sqrt(), spread.y.sqrt(), spread.z.sqrt()).as_vec3(),
            radius: (0.75 * shared / PI).cbrt() as f32,
            edges: 0,
        })
    };
    let places = 0..count.iter().product::<usize>();
    places.into_par_iter().map(light).collect::<Vec<_>>().into_iter().flatten().collect()
}
