//! Phase functions.

use manylight_math::{Frame, INV_4PI, Vec2, Vec3};

/// f(mu) = (1 - g^2) / (4 pi (1 + g^2 - 2 g mu)^(3/2)), mu the cosine between the travel of light before and after
/// (Henyey and Greenstein 1941). g is the mean cosine; 0 is isotropic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// The same in all directions.
    pub const ISOTROPIC: Self = HenyeyGreenstein { g: 0.0 };

    /// `None` unless -1 < g < 1.
    pub fn new(g: f32) -> Option<Self> {
        (g.abs() < 1.0).then_some(HenyeyGreenstein { g })
    }
    /// Mean cosine.
    pub fn g(&self) -> f32 {
        self.g
    }
    /// Density of light's new direction `to`, where `wi` points back to where it came from (both unit). [1/sr]
    pub fn eval(&self, wi: Vec3, to: Vec3) -> f32 {
        let g = self.g.abs();
        // 1 + g^2 - 2 |g| mu = (1 - |g|)^2 + 2 |g| (1 - mu), and 1 - mu = |travel - to|^2 / 2 without cancellation at the peak;
        // backward scattering has its peak at -travel.
        let off = if self.g >= 0.0 { (wi + to).length_squared() } else { (wi - to).length_squared() };
        let d = (1.0 - g) * (1.0 - g) + g * off;
        INV_4PI * (1.0 - g) * (1.0 + g) / (d * d.sqrt())
    }
    /// The same by the cosine mu between the two directions of travel. Rounds where `mu` does: near a narrow peak use `eval`.
    pub fn of_cosine(&self, mu: f32) -> f32 {
        let g = self.g;
        let d = ((1.0 - g.abs()) * (1.0 - g.abs()) + 2.0 * (g.abs() - g * mu)).max(0.0);
        INV_4PI * (1.0 - g) * (1.0 + g) / (d * d.sqrt())
    }
    /// Its largest value. [1/sr]
    pub fn largest(&self) -> f32 {
        let g = self.g.abs();
        INV_4PI * (1.0 + g) / ((1.0 - g) * (1.0 - g))
    }
    /// Draws a direction of travel with density `eval`.
    pub fn sample(&self, wi: Vec3, u: Vec2) -> Vec3 {
        let g = self.g.abs();
        // The inverse without a division by g, and 1 - mu and 1 + mu without cancellation.
        let q = 1.0 - g + 2.0 * g * u.x;
        let below_one = 2.0 * (1.0 - u.x) * (1.0 - g) * (1.0 - g) * (1.0 + g * u.x) / (q * q);
        let above_minus_one = 2.0 * u.x * (1.0 + g) * (1.0 + g) * (1.0 - g + g * u.x) / (q * q);
        let sin = (below_one * above_minus_one).max(0.0).sqrt();
        let mu = if below_one < 1.0 { 1.0 - below_one } else { above_minus_one - 1.0 };
        let axis = if self.g >= 0.0 { -wi } else { wi };
        let (s, c) = (std::f32::consts::TAU * u.y).sin_cos();
        Frame::around(axis).to_world(Vec3::new(sin * c, sin * s, mu)).normalize()
    }
}
