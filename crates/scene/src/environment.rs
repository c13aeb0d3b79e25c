//! Light from infinitely far away, by direction.

use crate::Bitmap;
use manylight_math::{DAffine3, DMat3, Spectrum, Vec2, Vec3};
use manylight_sampling::Table2d;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A latitude-longitude map of radiance around the scene. y is up in its own frame; rows run from up to down.
///
/// Texel centres lie at azimuths (i + 1/2) / width and, so that first and last row are the poles, at polar angles
/// j / (height - 1) (Mitsuba's convention). Between them radiance is bilinear, and the sampling table has one cell for each
/// such patch: wherever there is light, there is density.
#[derive(Clone, Debug)]
pub struct Environment {
    image: Arc<Bitmap>,
    scale: f32,
    to_local: DMat3,
    to_world: DMat3,
    table: Option<Table2d>,
    mean: Spectrum,
}

impl Environment {
    /// The map, unscaled.
    pub fn image(&self) -> &Arc<Bitmap> {
        &self.image
    }
    /// What multiplies the map.
    pub fn scale(&self) -> f32 {
        self.scale
    }
    /// From the map's frame.
    pub fn to_world(&self) -> DMat3 {
        self.to_world
    }
    /// Memory of its image. \[byte\]
    pub(crate) fn bytes(&self) -> usize {
        self.image.pixels.len() * size_of::<Spectrum>()
    }
    /// `None` if the map is narrower than 1 or lower than 2 pixels, or the rotation is singular.
    pub fn new(image: Arc<Bitmap>, scale: f32, to_world: &DAffine3) -> Option<Self> {
        let (w, h) = (image.width, image.height);
        let determinant = to_world.matrix3.determinant();
        if w == 0 || h < 2 || determinant == 0.0 || !determinant.is_finite() || !(scale >= 0.0) {
            return None;
        }
        let mut env = Environment {
            image,
            scale,
            to_local: to_world.matrix3.inverse(),
            to_world: to_world.matrix3,
            table: None,
            mean: Spectrum::BLACK,
        };
        let mut weights = Vec::with_capacity(w * (h - 1));
        let mut sum = [0.0f64; 3];
        let mut solid = 0.0;
        for j in 0..h - 1 {
            // Integral of sin(theta) over the row of patches.
            let edge = |j: usize| (j as f64 / (h - 1) as f64 * std::f64::consts::PI).cos();
            let measure = edge(j) - edge(j + 1);
            for i in 0..w {
                let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
                let c =
                    corners.iter().map(|&(x, y)| env.image.pixels[y * w + x % w]).sum::<Spectrum>() * (0.25 * scale);
                weights.push(c.luminance() as f64 * measure);
                solid += measure;
                for (s, x) in sum.iter_mut().zip(c.to_array()) {
                    *s += x as f64 * measure;
                }
            }
        }
        env.mean = Spectrum::from(sum.map(|s| (s / solid) as f32));
        env.table = Table2d::new(w, h - 1, &weights);
        Some(env)
    }
    /// Radiance that arrives from direction `w` (pointing away from the scene). [W/(m^2 sr)]
    pub fn radiance(&self, w: Vec3) -> Spectrum {
        let p = self.square(w);
        let (iw, ih) = (self.image.width, self.image.height);
        let (x, y) = (p.x * iw as f32, (p.y * (ih - 1) as f32).min((ih - 1) as f32));
        let (i, j) = ((x as usize).min(iw - 1), (y as usize).min(ih - 2));
        let (fx, fy) = (x - i as f32, y - j as f32);
        let pixel = |i: usize, j: usize| self.image.pixels[j * iw + i % iw];
        let row = |j| Spectrum::lerp(pixel(i, j), pixel(i + 1, j), fx);
        Spectrum::lerp(row(j), row(j + 1), fy) * self.scale
    }
    /// A direction (pointing away from the scene) and its density [1/sr]; `None` if the map is black.
    pub fn sample(&self, u: [f64; 2]) -> Option<(Vec3, f32)> {
        let (p, pdf) = self.table.as_ref()?.sample(u);
        let (sin_theta, cos_theta) = (p.y * PI).sin_cos();
        let phi = (p.x + 0.5 / self.image.width as f32) * TAU;
        let local = Vec3::new(sin_theta * phi.sin(), cos_theta, -sin_theta * phi.cos());
        let w = (self.to_world * local.as_dvec3()).normalize().as_vec3();
        (sin_theta > 0.0).then(|| (w, pdf / (TAU * PI * sin_theta)))
    }
    /// Density of `sample`. [1/sr]
    pub fn pdf_sa(&self, w: Vec3) -> f32 {
        let p = self.square(w);
        let sin_theta = (p.y * PI).sin();
        let Some(table) = &self.table else { return 0.0 };
        if sin_theta > 0.0 { table.pdf(p) / (TAU * PI * sin_theta) } else { 0.0 }
    }
    /// All numbers that make it what it is, for a hash of the scene.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f32> + '_ {
        let rotation = self.to_world.to_cols_array().map(|x| x as f32);
        let pixels = self.image.pixels.iter().flat_map(|p| p.to_array());
        rotation.into_iter().chain([self.scale, self.image.width as f32]).chain(pixels)
    }
    /// Mean radiance over all directions (exact on the patches' corners' means). [W/(m^2 sr)]
    pub fn mean(&self) -> Spectrum {
        self.mean
    }
    /// The table's square: azimuth from the first texel's centre on, polar angle.
    fn square(&self, w: Vec3) -> Vec2 {
        let v = (self.to_local * w.as_dvec3()).normalize_or(manylight_math::DVec3::Y);
        let azimuth = v.x.atan2(-v.z) / std::f64::consts::TAU - 0.5 / self.image.width as f64;
        let polar = v.y.clamp(-1.0, 1.0).acos() / std::f64::consts::PI;
        Vec2::new((azimuth - azimuth.floor()) as f32, polar as f32).min(Vec2::new(1.0 - f32::EPSILON / 2.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream, warp};

    fn map() -> Environment {
        let (w, h) = (8, 5);
        let mut s = Stream::new(3, [0; 3], Purpose::TEST);
        let pixels = (0..w * h)
            .map(|i| if i % 3 == 0 { Spectrum::BLACK } else { Spectrum::rgb(s.next_f32(), 0.5, s.next_f32() * 9.0) })
            .collect();
        let rotation = DAffine3::from_quat(glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.0, 2.0));
        Environment::new(Arc::new(Bitmap { width: w, height: h, pixels }), 2.0, &rotation).unwrap()
    }
    #[test]
    fn sampled_and_uniform_directions_agree_on_the_integral() {
        let env = map();
        let mut s = Stream::new(5, [0; 3], Purpose::TEST);
        let n = 300_000;
        let (mut a, mut a2, mut b, mut b2, mut mass) = (0.0f64, 0.0f64, 0.0f64, 0.0f64, 0.0f64);
        for _ in 0..n {
            let (w, pdf) = env.sample([s.next_f64(), s.next_f64()]).unwrap();
            assert!((pdf / env.pdf_sa(w) - 1.0).abs() < 0.05 || s.next_f32() < 0.01, "{pdf} {}", env.pdf_sa(w));
            let x = (env.radiance(w).luminance() / pdf) as f64;
            let w = warp::sphere(s.next_2d());
            let y = (env.radiance(w).luminance() / warp::SPHERE_PDF) as f64;
            mass += (env.pdf_sa(w) / warp::SPHERE_PDF) as f64;
            (a, a2, b, b2) = (a + x, a2 + x * x, b + y, b2 + y * y);
        }
        let n = n as f64;
        let (a, b, mass) = (a / n, b / n, mass / n);
        let sigma = ((a2 / n - a * a + b2 / n - b * b) / n).sqrt();
        assert!((a - b).abs() < 3.0 * sigma, "{a} {b} {sigma}");
        assert!((mass - 1.0).abs() < 0.02, "the density integrates to {mass}");
    }
    #[test]
    fn a_constant_map_is_constant_and_a_black_one_cannot_be_sampled() {
        let flat = |c: f32| {
            Environment::new(
                Arc::new(Bitmap { width: 4, height: 3, pixels: vec![Spectrum::gray(c); 12] }),
                1.0,
                &DAffine3::IDENTITY,
            )
            .unwrap()
        };
        assert!((flat(0.5).radiance(Vec3::new(0.6, 0.0, 0.8)).0.x - 0.5).abs() < 1e-6);
        assert!((flat(0.5).mean().0.x - 0.5).abs() < 1e-6);
        assert!(flat(0.0).sample([0.5, 0.5]).is_none());
    }
}
