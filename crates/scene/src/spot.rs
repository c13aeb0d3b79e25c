//! A point that shines into a cone.

use manylight_math::{Frame, Vec2, Vec3};
use std::f32::consts::TAU;

/// How a spot light shines: all its intensity within `beam` of its axis, and from there less, linearly in the angle, to nothing at
/// `cutoff` (as Mitsuba's `spot`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    axis: Vec3,
    cutoff: f32,
    beam: f32,
    /// One over the solid angle that would take the same power at full intensity. [1/sr]
    peak: f32,
}

impl Spot {
    /// Along a unit `axis`. `None` unless 0 <= `beam` <= `cutoff` <= pi and 1e-3 <= `cutoff`. \[rad\]
    pub fn new(axis: Vec3, cutoff: f32, beam: f32) -> Option<Self> {
        let unit = (axis.length() - 1.0).abs() < 1e-3;
        // Below that single precision knows no cone any more.
        let ordered = (0.0..=cutoff).contains(&beam) && (1e-3..=3.141_592_8).contains(&cutoff);
        (unit && ordered).then(|| {
            // What is unit to rounding stays as it is: normalising it again would move it.
            let axis = if (axis.length_squared() - 1.0).abs() < 1e-6 { axis } else { axis.normalize() };
            let spot = Spot { axis, cutoff, beam, peak: 0.0 };
            Spot { peak: (1.0 / (std::f64::consts::TAU * spot.mass(f64::from(cutoff)))) as f32, ..spot }
        })
    }
    /// Unit, the middle of the light.
    pub fn axis(&self) -> Vec3 {
        self.axis
    }
    /// Angle beyond which there is no light. \[rad\]
    pub fn cutoff(&self) -> f32 {
        self.cutoff
    }
    /// Angle up to which all of it is there. \[rad\]
    pub fn beam(&self) -> f32 {
        self.beam
    }
    /// Power per intensity along the axis. \[sr\]
    pub fn solid_angle(&self) -> f32 {
        1.0 / self.peak
    }
    /// Largest value of `lobe`. [1/sr]
    pub fn peak(&self) -> f32 {
        self.peak
    }
    /// Normalised emission towards a unit direction. [1/sr]
    pub fn lobe(&self, w: Vec3) -> f32 {
        // Exact for small angles too.
        let angle = 2.0 * (w - self.axis).length().atan2((w + self.axis).length());
        if angle <= self.beam {
            self.peak
        } else {
            self.peak * ((self.cutoff - angle) / (self.cutoff - self.beam)).max(0.0)
        }
    }
    /// Integral of the falloff times sin(angle) up to an angle.
    fn mass(&self, angle: f64) -> f64 {
        let (c, b) = (f64::from(self.cutoff), f64::from(self.beam));
        // 1 - cos without its cancellation.
        let versine = |x: f64| 2.0 * (0.5 * x).sin().powi(2);
        if angle <= b {
            return versine(angle);
        }
        let rest = (c - b) * b.cos() - (c - angle) * angle.cos() - angle.sin() + b.sin();
        versine(b) + rest / (c - b)
    }
    /// Draws a direction with the density `lobe`.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let target = f64::from(u.x) * self.mass(f64::from(self.cutoff));
        // The mass rises with the angle.
        let (mut low, mut high) = (0.0, f64::from(self.cutoff));
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.mass(middle) < target { low = middle } else { high = middle }
        }
        let (sin, cos) = (0.5 * (low + high)).sin_cos();
        let (y, x) = (TAU * u.y).sin_cos();
        Frame::around(self.axis).to_world(Vec3::new(sin as f32 * x, sin as f32 * y, cos as f32)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream};
    use std::f64::consts::PI;

    fn spots() -> Vec<Spot> {
        let axis = Vec3::new(0.36, 0.48, 0.8);
        let angles = [
            (0.35f32, 0.26f32),
            (0.35, 0.35),
            (1.2, 0.0),
            (2.9, 0.3),
            (0.01, 0.004),
            (std::f32::consts::PI, std::f32::consts::PI),
        ];
        angles.map(|(cutoff, beam)| Spot::new(axis, cutoff, beam).unwrap()).to_vec()
    }
    #[test]
    fn lobes_integrate_to_one() {
        for spot in spots() {
            let (n, aside) = (20_000, Frame::around(spot.axis).s);
            let mass: f64 = (0..n)
                .map(|i| {
                    let angle = f64::from(spot.cutoff) * (f64::from(i) + 0.5) / f64::from(n);
                    let w = spot.axis * angle.cos() as f32 + aside * angle.sin() as f32;
                    f64::from(spot.lobe(w)) * angle.sin() * 2.0 * PI * f64::from(spot.cutoff) / f64::from(n)
                })
                .sum();
            assert!((mass - 1.0).abs() < 1e-3, "{spot:?}: {mass}");
        }
    }
    #[test]
    fn directions_follow_the_lobe() {
        for spot in spots() {
            // Twenty rings of equal solid angle.
            let (rings, n) = (20, 100_000);
            let versine = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
            let most = versine(f64::from(spot.cutoff)) * 1.000_01;
            let (mut seen, mut s) = (vec![0u64; rings], Stream::new(3, [0; 3], Purpose::TEST));
            for _ in 0..n {
                let w = spot.sample(s.next_2d());
                assert!(spot.lobe(w) > 0.0 || s.next_f32() < 1e-3, "{spot:?} {w}");
                let v = 0.5 * f64::from((w - spot.axis).length_squared());
                seen[((v / most * rings as f64) as usize).min(rings - 1)] += 1;
            }
            let angle = |v: f64| (2.0 * (0.5 * v).sqrt().asin()).min(f64::from(spot.cutoff));
            let total = spot.mass(f64::from(spot.cutoff));
            let mass = |i: usize| spot.mass(angle(most * i as f64 / rings as f64)) / total;
            let expected: Vec<f64> = (0..rings).map(|i| (mass(i + 1) - mass(i)) * n as f64).collect();
            let p = manylight_stats::chi2_goodness_of_fit(&seen, &expected, 0).p_value;
            assert!(p > 1e-3, "{spot:?}: p = {p}");
        }
    }
    #[test]
    fn what_is_no_cone_is_refused() {
        for (axis, cutoff, beam) in [
            (Vec3::ZERO, 1.0, 0.5),
            (Vec3::Z, 0.0, 0.0),
            (Vec3::Z, 0.5, 0.6),
            (Vec3::Z, 3.2, 0.6),
            (Vec3::Z, 1.0, -0.1),
            (Vec3::Z, f32::NAN, 0.1),
            (Vec3::Z, 1.0, f32::NAN),
        ] {
            assert!(Spot::new(axis, cutoff, beam).is_none(), "{axis} {cutoff} {beam}");
        }
    }
}
