//! How much light passes a rough interface, tabulated.

use crate::fresnel;
use crate::microfacet::{Distribution, Microfacets, mirror};
use crate::special::gauss_legendre;
use manylight_math::Vec3;
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

const N: usize = 64;

/// Albedos of one rough dielectric interface over the cosine of incidence: what a rough coat lets in, lets out and
/// reflects.
///
/// Tables are the same 64 cosines and the same quadratures as those of Mitsuba 3: Gauss-Legendre over the square from
/// which visible normals are drawn, 32^2 nodes (128^2 towards the thinner medium, where total reflection is a step).
#[derive(Debug, PartialEq)]
pub struct RoughTransmittance {
    pub(crate) microfacets: Microfacets,
    pub(crate) eta: f32,
    /// Reflectance from inside under diffuse light.
    pub(crate) internal_reflectance: f32,
    /// Mean of `transmitted` over the hemisphere, weighted by the cosine.
    pub(crate) mean_transmitted: f32,
    /// Fraction of light from outside that gets in.
    transmitted: [f32; N],
    /// Fraction of light from outside that is reflected back once.
    reflected: [f32; N],
}

impl RoughTransmittance {
    /// The interface of roughness `alpha` and relative index `eta` (inside over outside, not 1).
    ///
    /// A `Bsdf` is `Copy` and lives in every virtual light, so it cannot own tables nor count references to them: they
    /// live for ever. Each distinct interface is tabulated once in a process and then found again; a process keeps 0.5 KiB
    /// for each, and as the tables do not depend on textured parameters there are no more of them than rough plastics in
    /// its scenes.
    pub fn of(distribution: Distribution, alpha: f32, eta: f32) -> &'static RoughTransmittance {
        type Key = (Distribution, u32, u32);
        static TABLES: LazyLock<Mutex<HashMap<Key, &'static RoughTransmittance>>> = LazyLock::new(Mutex::default);
        // A panic while tabulating leaves the map as it was.
        let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
        tables
            .entry((distribution, alpha.to_bits(), eta.to_bits()))
            .or_insert_with(|| Box::leak(Box::new(RoughTransmittance::tabulate(distribution, alpha, eta))))
    }

    /// Which microfacets.
    pub fn distribution(&self) -> Distribution {
        self.microfacets.distribution
    }
    /// Their roughness.
    pub fn alpha(&self) -> f32 {
        self.microfacets.alpha_u
    }
    /// Index inside over outside.
    pub fn eta(&self) -> f32 {
        self.eta
    }

    fn tabulate(distribution: Distribution, alpha: f32, eta: f32) -> Self {
        let microfacets = Microfacets::new(distribution, alpha, alpha);
        let outside = Side { microfacets, eta, nodes: nodes(eta) };
        let inside = Side { microfacets, eta: 1.0 / eta, nodes: nodes(1.0 / eta) };
        let transmitted = std::array::from_fn(|i| outside.transmitted(direction(i)).clamp(0.0, 1.0));
        RoughTransmittance {
            microfacets,
            eta,
            // The mean over the cosines as Mitsuba 3 takes it, both ends with full weight. It is 1.5 % below the integral
            // for polished coats.
            internal_reflectance: 2.0 * (0..N).map(|i| inside.reflected(direction(i)) * direction(i).z).sum::<f32>()
                / N as f32,
            mean_transmitted: integral_with_cosine(&transmitted),
            transmitted,
            reflected: std::array::from_fn(|i| {
                let wi = direction(i);
                // `eval` masks by Beckmann's fit, samples are drawn without it.
                outside.reflected(wi) * microfacets.masking_over_cos(wi) / microfacets.visible_over_cos(wi)
            }),
        }
    }

    /// Fraction of light along a direction of cosine `cos` that gets in.
    pub(crate) fn transmitted(&self, cos: f32) -> f32 {
        interpolate(&self.transmitted, cos)
    }
    /// Fraction of light along a direction of cosine `cos` that is reflected back once.
    pub(crate) fn reflected(&self, cos: f32) -> f32 {
        interpolate(&self.reflected, cos)
    }
    /// Largest `transmitted` over an interval of cosines: at an end or at a node.
    pub(crate) fn transmitted_bound(&self, cos_min: f32, cos_max: f32) -> f32 {
        let first = (cos_min * (N - 1) as f32) as usize;
        let last = (cos_max * (N - 1) as f32) as usize;
        let nodes = self.transmitted[(first + 1).min(N)..(last + 1).clamp((first + 1).min(N), N)].iter();
        nodes.fold(self.transmitted(cos_min).max(self.transmitted(cos_max)), |a, &b| a.max(b))
    }
}

fn interpolate(table: &[f32; N], cos: f32) -> f32 {
    let x = cos * (N - 1) as f32;
    let i = (x as usize).min(N - 2);
    let t = x - i as f32;
    table[i] * (1.0 - t) + table[i + 1] * t
}

/// Integral of 2 cos `interpolate(table, cos)` over [0, 1], exactly.
fn integral_with_cosine(table: &[f32; N]) -> f32 {
    let step = 1.0 / (N - 1) as f32;
    let piece = |(i, v): (usize, &[f32])| {
        let x = i as f32 * step;
        step * (x * (v[0] + v[1]) + step * (v[0] + 2.0 * v[1]) / 3.0)
    };
    table.windows(2).enumerate().map(piece).sum()
}

/// The i-th direction of the tables.
fn direction(i: usize) -> Vec3 {
    let cos = (i as f32 / (N - 1) as f32).max(1e-6);
    Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
}

fn nodes(eta: f32) -> Vec<(f64, f64)> {
    gauss_legendre(if eta > 1.0 { 32 } else { 128 })
}

/// One side of the interface; `eta` is the index of the other side over that of this.
struct Side {
    microfacets: Microfacets,
    eta: f32,
    nodes: Vec<(f64, f64)>,
}

impl Side {
    fn reflected(&self, wi: Vec3) -> f32 {
        self.mean_over_visible(wi, |h| {
            let wo = mirror(wi, h);
            if wo.z > 0.0 {
                self.microfacets.masking(wo) * fresnel::dielectric(wi.dot(h), self.eta).reflected
            } else {
                0.0
            }
        })
    }
    fn transmitted(&self, wi: Vec3) -> f32 {
        self.mean_over_visible(wi, |h| {
            let cos = wi.dot(h);
            let interface = fresnel::dielectric(cos, self.eta);
            // The refracted direction, mirrored to the upper side: masking is the same on both.
            let wo = (wi - cos * h) / self.eta + interface.cos_t * h;
            if wo.z > 0.0 { self.microfacets.masking(wo) * interface.transmitted } else { 0.0 }
        })
    }
    fn mean_over_visible(&self, wi: Vec3, f: impl Fn(Vec3) -> f32) -> f32 {
        let nodes: Vec<f32> = self.nodes.iter().map(|&(x, _)| x as f32).collect();
        let normals = self.microfacets.sample_visible_grid(wi, &nodes);
        let mut sum = 0.0;
        for (row, (_, row_weight)) in normals.chunks(nodes.len()).zip(&self.nodes) {
            for (h, (_, weight)) in row.iter().zip(&self.nodes) {
                sum += row_weight * weight * f64::from(f(*h));
            }
        }
        sum as f32
    }
}
