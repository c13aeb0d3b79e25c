//! Surfaces that are there only in part: rays meet them by a coin, shadow rays by what is left.

use crate::{Scene, Source};
use manylight_geometry::{Hit, offset_from};
use manylight_math::Ray;

/// Surfaces that a ray may pass; the next one is opaque. No scene has so many, but rounding could keep a ray at one for ever.
const MOST_PASSED: u32 = 4096;

impl Scene {
    /// The first surface along a ray that is there. Where only a part of one is, a coin decides, a function of the ray and the
    /// hit: the same ray always meets the same.
    pub(crate) fn first(&self, ray: &Ray) -> Option<Hit> {
        let mut hit = self.geometry.intersect(ray)?;
        if !self.masked {
            return Some(hit);
        }
        let (mut rest, mut passed) = (*ray, 0.0);
        for through in 0.. {
            let opacity = self.opacity(&rest, &hit);
            if opacity >= 1.0 || through == MOST_PASSED || coin(&rest, &hit, 0) < opacity {
                return Some(Hit { t: passed + hit.t, ..hit });
            }
            rest = self.beyond(&rest, &hit);
            passed = (rest.origin - ray.origin).dot(ray.dir);
            hit = self.geometry.intersect(&rest)?;
        }
        None
    }
    /// The fraction of a surface that is there.
    fn opacity(&self, ray: &Ray, hit: &Hit) -> f32 {
        match &self.materials[self.shapes[hit.shape as usize].material.0 as usize].opacity {
            None => 1.0,
            Some(Source::Constant(c)) => c.luminance(),
            Some(texture) => texture.at(&self.textures, self.geometry.surface(ray, hit).uv).luminance(),
        }
    }
    /// What is left of a ray behind a surface.
    fn beyond(&self, ray: &Ray, hit: &Hit) -> Ray {
        let x = self.geometry.surface(ray, hit);
        let origin = offset_from(x.p, x.ng, x.error, ray.dir);
        Ray { origin, t_max: ray.t_max - (origin - ray.origin).dot(ray.dir), ..*ray }
    }
    /// The fraction of light that surfaces let through along a segment: the product of what is not there of each.
    pub(crate) fn clearance(&self, ray: &Ray) -> f32 {
        if !self.masked {
            return if self.geometry.occluded(ray) { 0.0 } else { 1.0 };
        }
        let (mut rest, mut clear) = (*ray, 1.0);
        for through in 0.. {
            let Some(hit) = self.geometry.intersect(&rest) else { break };
            if through == MOST_PASSED {
                return 0.0;
            }
            clear *= 1.0 - self.opacity(&rest, &hit).clamp(0.0, 1.0);
            if clear <= 0.0 {
                return 0.0;
            }
            rest = self.beyond(&rest, &hit);
        }
        clear
    }
}

/// A number in [0, 1) that is a function of a ray and what it meets, and as good as random over rays.
pub(crate) fn coin(ray: &Ray, hit: &Hit, purpose: u32) -> f32 {
    let [o, d] = [ray.origin, ray.dir].map(|v| v.to_array().map(f32::to_bits));
    let words = [o[0], o[1], o[2], d[0], d[1], d[2], hit.t.to_bits(), hit.shape, hit.triangle, purpose];
    // SplitMix64's mixing after each word.
    let mixed = words.iter().fold(0u64, |state, word| {
        let z = (state ^ u64::from(*word)).wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    });
    (mixed >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
}
