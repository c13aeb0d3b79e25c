//! The field of a ball that shines evenly.

use manylight_math::Spectrum;
use manylight_math::Vec3;

/// Mean of 1/|x - y|^2 over y in a ball of radius a, at distance D from its centre: with q = D / a
///
/// > 3/2 \[1 - (q^2 - 1) / (2 q) ln|(q + 1) / (q - 1)|\] / a^2 inside and outside; 3 / a^2 at the centre, 1 / D^2 far away.
///
/// \[1/m^2\]
pub fn mean_inverse_square(d2: f32, radius: f32) -> f32 {
    let a2 = radius * radius;
    if d2 >= 64.0 * a2 {
        // A point, or as good as one: the series in a / D, of which the next term is below 1e-6.
        let p2 = a2 / d2;
        return (1.0 + p2 * (0.2 + p2 * (3.0 / 35.0))) / d2;
    }
    let (d2, a2) = (f64::from(d2), f64::from(radius) * f64::from(radius));
    let q2 = d2 / a2;
    let value = if q2 < 1e-4 {
        (3.0 - q2) / a2
    } else {
        let q = q2.sqrt();
        // At the surface (q^2 - 1) ln(..) is zero.
        let edge = if q == 1.0 { 0.0 } else { (q2 - 1.0) / (2.0 * q) * ((q + 1.0) / (q - 1.0)).abs().ln() };
        1.5 * (1.0 - edge) / a2
    };
    value as f32
}

/// A piece of a shining medium, or several together: shines alike to all sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeLight {
    /// Its middle, by what shines. \[m\]
    pub p: Vec3,
    /// [W/sr]
    pub intensity: Spectrum,
    /// Standard deviation, along each axis, of where it shines from. \[m\]
    pub spread: Vec3,
    /// Of the ball that is as large. \[m\]
    pub radius: f32,
    /// Edges from the emission: 0 for the emission itself.
    pub edges: u32,
}
