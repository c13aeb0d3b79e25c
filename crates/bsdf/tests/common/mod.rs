//! Models and directions that the tests share.
#![allow(dead_code, reason = "each test binary uses its part")]

use manylight_bsdf::*;
use manylight_math::{DVec3, Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream};
use std::f64::consts::PI;

pub const GOLD: (Spectrum, Spectrum) = (Spectrum::rgb(0.14, 0.37, 1.44), Spectrum::rgb(3.98, 2.39, 1.60));
/// Saturated, and with a black channel.
pub const RED: Spectrum = Spectrum::rgb(0.95, 0.2, 0.0);
pub const BLUE: Spectrum = Spectrum::rgb(0.0, 0.1, 0.9);

pub fn stream(seed: u64) -> Stream {
    Stream::new(seed, [0; 3], Purpose::TEST)
}
/// The direction at a polar angle and an azimuth [rad].
pub fn polar(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}
pub fn metal(distribution: Distribution, alpha_u: f32, alpha_v: f32) -> Bsdf {
    RoughConductor::new(distribution, alpha_u, alpha_v, GOLD.0, GOLD.1, Spectrum::ONE).into()
}
/// Reflects everything that its microfacets do not shadow.
pub fn white_metal(distribution: Distribution, alpha_u: f32, alpha_v: f32) -> Bsdf {
    RoughConductor::new(distribution, alpha_u, alpha_v, Spectrum::BLACK, Spectrum::ONE, Spectrum::ONE).into()
}
pub fn rough_plastic(distribution: Distribution, alpha: f32, diffuse: Spectrum, specular: Spectrum) -> Bsdf {
    RoughPlastic::new(RoughTransmittance::of(distribution, alpha, 1.5), diffuse, specular, true).into()
}
pub fn glass() -> Bsdf {
    Dielectric::new(1.5, 1.0, Spectrum::ONE, Spectrum::ONE).into()
}

/// The principled model with these changes to its defaults and a saturated base.
pub fn principled(change: impl Fn(&mut PrincipledParameters)) -> Bsdf {
    let mut p = PrincipledParameters { base_color: RED, ..Default::default() };
    change(&mut p);
    Principled::new(&p).into()
}
/// One-sided ones: each lobe, and all of them.
pub fn principled_surfaces() -> Vec<(String, Bsdf)> {
    let with =
        |name: &str, change: &dyn Fn(&mut PrincipledParameters)| (format!("principled {name}"), principled(change));
    vec![
        with("default", &|_| {}),
        with("metal", &|p| (p.metallic, p.roughness, p.anisotropic) = (1.0, 0.4, 0.7)),
        with("cloth", &|p| (p.sheen, p.sheen_tint, p.roughness) = (1.0, 0.5, 1.0)),
        with("skin", &|p| (p.flatness, p.spec_tint) = (1.0, 1.0)),
        with("lacquer", &|p| (p.clearcoat, p.clearcoat_gloss, p.roughness) = (1.0, 0.2, 0.7)),
        with("thinner than air", &|p| (p.eta, p.metallic, p.clearcoat, p.spec_tint) = (0.7, 0.5, 0.5, 0.5)),
    ]
}
/// Those that light passes through: glass, and glass mixed with everything else.
pub fn principled_glass() -> Vec<(String, Bsdf)> {
    let with =
        |name: &str, change: &dyn Fn(&mut PrincipledParameters)| (format!("principled {name}"), principled(change));
    vec![
        with("glass", &|p| (p.spec_trans, p.roughness) = (1.0, 0.6)),
        with("thin glass", &|p| (p.spec_trans, p.roughness, p.anisotropic, p.eta) = (1.0, 0.7, 0.5, 1.0 / 1.4)),
        with("mixture", &|p| {
            (p.spec_trans, p.metallic, p.clearcoat, p.sheen, p.flatness) = (0.6, 0.3, 0.8, 0.5, 0.5);
        }),
    ]
}

/// Every model with a smooth lobe, at roughness from polished to matt.
pub fn smooth_models() -> Vec<(String, Bsdf)> {
    use Distribution::*;
    let mut models: Vec<(String, Bsdf)> = vec![
        ("diffuse".into(), Diffuse::new(RED).into()),
        ("plastic".into(), Plastic::new(1.5, 1.0, RED, BLUE, false).into()),
        ("nonlinear plastic".into(), Plastic::new(1.5, 1.0, Spectrum::ONE, Spectrum::ONE, true).into()),
    ];
    for distribution in [Beckmann, Ggx] {
        for (alpha_u, alpha_v) in [(0.05, 0.05), (0.3, 0.3), (1.0, 1.0), (0.1, 0.5)] {
            let name = format!("{distribution:?} metal {alpha_u} {alpha_v}");
            models.push((name, metal(distribution, alpha_u, alpha_v)));
        }
        for alpha in [0.1, 0.6] {
            let name = format!("{distribution:?} plastic {alpha}");
            models.push((name, rough_plastic(distribution, alpha, RED, BLUE)));
        }
    }
    models.extend(principled_surfaces());
    models
}

pub fn draw(bsdf: &Bsdf, wi: Vec3, s: &mut Stream) -> Option<BsdfSample> {
    let u_lobe = s.next_f32();
    bsdf.sample(wi, Mode::Radiance, u_lobe, s.next_2d())
}

/// A grid over the upper hemisphere, even in sqrt(1 - cos) and in the cube root of the azimuth from where the mirror of
/// `wi` is: fine where a grazing lobe is narrow.
pub struct Grid {
    pub rows: usize,
    pub columns: usize,
    pub wi: Vec3,
}

impl Grid {
    pub fn cells(&self) -> usize {
        self.rows * self.columns
    }
    fn mirror_azimuth(&self) -> f64 {
        f64::from(-self.wi.y).atan2(f64::from(-self.wi.x))
    }
    pub fn cell(&self, w: Vec3) -> usize {
        // 1 - cos without its cancellation.
        let versine = w.truncate().length_squared() / (1.0 + w.z);
        let row = ((versine.sqrt() * self.rows as f32) as usize).min(self.rows - 1);
        let from_mirror = (f64::from(w.y).atan2(f64::from(w.x)) - self.mirror_azimuth() + PI).rem_euclid(2.0 * PI) - PI;
        let t = 0.5 * (1.0 + (from_mirror / PI).cbrt());
        row * self.columns + ((t * self.columns as f64) as usize).min(self.columns - 1)
    }
    /// Integral of `f` over solid angle in each cell, by a Gauss-Legendre rule of 5 x 5 points in each of n x n parts.
    pub fn integrate(&self, parts: usize, f: impl Fn(Vec3) -> DVec3) -> Vec<DVec3> {
        let (rows, columns) = (self.rows * parts, self.columns * parts);
        let mut cells = vec![DVec3::ZERO; self.cells()];
        for i in 0..rows {
            for j in 0..columns {
                let mut sum = DVec3::ZERO;
                for (x, weight_x) in GAUSS_5 {
                    for (y, weight_y) in GAUSS_5 {
                        let r = (i as f64 + x) / rows as f64;
                        let t = 2.0 * (j as f64 + y) / columns as f64 - 1.0;
                        let (sin_phi, cos_phi) = (self.mirror_azimuth() + PI * t.powi(3)).sin_cos();
                        let sin = r * (2.0 - r * r).sqrt();
                        let w = DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - r * r).as_vec3();
                        sum += f(w) * (weight_x * weight_y * 2.0 * r * 6.0 * PI * t * t);
                    }
                }
                cells[i / parts * self.columns + j / parts] += sum / (rows * columns) as f64;
            }
        }
        cells
    }
    /// `integrate`, of a scalar.
    pub fn integrate_scalar(&self, parts: usize, f: impl Fn(Vec3) -> f32) -> Vec<f64> {
        self.integrate(parts, |w| DVec3::splat(f64::from(f(w)))).iter().map(|cell| cell.x).collect()
    }
}

/// Nodes and weights over [0, 1].
const GAUSS_5: [(f64, f64); 5] = [
    (0.046910077030668, 0.118463442528095),
    (0.230765344947158, 0.239314335249683),
    (0.5, 0.284444444444444),
    (0.769234655052842, 0.239314335249683),
    (0.953089922969332, 0.118463442528095),
];

/// Points of the unit square, even and without a pattern.
pub fn squares(n: usize) -> impl Iterator<Item = Vec2> {
    let mut s = stream(77);
    (0..n).map(move |_| s.next_2d())
}

/// With each parameter at an end or between; it may transmit.
pub fn any_principled(s: &mut Stream, transmits: bool) -> Bsdf {
    let mut part = || [0.0, 1.0, s.next_f32(), s.next_f32()][s.next_below(4)];
    let mut p = PrincipledParameters {
        base_color: Spectrum::rgb(part(), part(), part()),
        roughness: part(),
        anisotropic: part(),
        metallic: part(),
        spec_trans: 0.0,
        eta: 1.5,
        spec_tint: part(),
        sheen: part(),
        sheen_tint: part(),
        flatness: part(),
        clearcoat: part(),
        clearcoat_gloss: part(),
    };
    p.spec_trans = if transmits { part() } else { 0.0 };
    p.eta = 0.4 * 7.5f32.powf(s.next_f32());
    Principled::new(&p).into()
}
