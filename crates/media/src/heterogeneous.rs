//! A medium whose density varies.

use crate::march::{CELLS, cells, inside};
use crate::volume::{Grid, Volume};
use crate::{Flight, Glow, HenyeyGreenstein, MediumError};
use manylight_math::{Ray, Spectrum, Vec3};
use manylight_sampling::Stream;

/// A medium whose extinction is a grid: free flight by delta tracking, transmittance by ratio tracking, both below a coarse
/// grid of majorants, so that empty cells cost nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Heterogeneous {
    extinction: Grid,
    /// Multiplies the grid. [1/m]
    scale: f32,
    albedo: Volume,
    /// Its phase function.
    pub phase: HenyeyGreenstein,
    /// Largest channel of the extinction in each cell. [1/m]
    majorants: Vec<f32>,
    largest: f32,
    mean: f32,
    emission: Option<Glow>,
}

impl Heterogeneous {
    /// Extinction `grid` x `scale` [1/m], and an albedo in [0, 1].
    pub fn new(extinction: Grid, scale: f32, albedo: Volume, phase: HenyeyGreenstein) -> Result<Self, MediumError> {
        let white = match &albedo {
            Volume::Constant(c) => c.largest() <= 1.0 && c.is_valid(),
            Volume::Grid(g) => g.largest(1)[0].largest() <= 1.0,
        };
        if !(scale >= 0.0 && scale.is_finite() && white) {
            return Err(MediumError::Coefficients);
        }
        // Rounded up: interpolation rounds too.
        let majorants: Vec<f32> =
            extinction.largest(CELLS).iter().map(|m| m.largest() * scale * (1.0 + 4.0 * f32::EPSILON)).collect();
        let largest = majorants.iter().copied().fold(0.0, f32::max);
        if !largest.is_finite() {
            return Err(MediumError::Coefficients);
        }
        let mean = extinction.mean().mean() * scale;
        Ok(Heterogeneous { extinction, scale, albedo, phase, majorants, largest, mean, emission: None })
    }
    /// The same, which also emits.
    pub fn emitting(self, emission: Glow) -> Self {
        Heterogeneous { emission: Some(emission), ..self }
    }
    /// What it emits, if anything.
    pub fn emission(&self) -> Option<&Glow> {
        self.emission.as_ref()
    }
    /// sigma_a at a point. [1/m]
    pub fn absorption(&self, p: Vec3) -> Spectrum {
        self.extinction(p) * (Spectrum::ONE - self.albedo.at(p))
    }
    /// int T(from, t) j(t) dt: a point for each cell on the way that emits, with the transmittance of the way to it.
    pub fn emitted(&self, ray: &Ray, from: f32, to: f32, s: &mut Stream) -> Spectrum {
        let Some(emission) = &self.emission else { return Spectrum::BLACK };
        let (mut sum, mut through, mut reached) = (Spectrum::BLACK, Spectrum::ONE, from);
        emission.pieces(ray, from, to, |a, b| {
            let t = (a + s.next_f64() * (b - a)) as f32;
            let here = emission.at(ray.at(t));
            if !here.is_black() {
                // Pieces do not overlap: a product of independent estimates.
                through *= self.transmittance(ray, reached, t.max(reached), s);
                reached = t.max(reached);
                sum += through * here * (b - a) as f32;
            }
            !through.is_black()
        });
        sum
    }
    /// Is its extinction the same in all channels? Then flights have no weights but the albedo.
    pub fn is_gray(&self) -> bool {
        self.extinction.is_gray()
    }
    /// sigma_t at a point. [1/m]
    pub fn extinction(&self, p: Vec3) -> Spectrum {
        self.extinction.at(p) * self.scale
    }
    /// sigma_s at a point. [1/m]
    pub fn scattering(&self, p: Vec3) -> Spectrum {
        self.extinction(p) * self.albedo.at(p)
    }
    /// Never below sigma_s. [1/m]
    pub fn scattering_max(&self) -> Spectrum {
        match &self.albedo {
            Volume::Constant(c) => *c * self.largest,
            Volume::Grid(_) => Spectrum::gray(self.largest),
        }
    }
    /// Mean extinction over the grid's cube. [1/m]
    pub fn extinction_mean(&self) -> f32 {
        self.mean
    }
    /// How far along a ray the grid's cube reaches; zero if the ray misses it. \[m\]
    pub fn reach(&self, ray: &Ray) -> f32 {
        inside(&self.extinction, ray, 0.0, f64::from(ray.t_max)).map_or(0.0, |(_, t1)| t1 as f32)
    }
    /// Shows the tentative collisions on a ray, of density equal to the majorant, until `visit` says false: distance, sigma_t
    /// there and the majorant.
    fn track(
        &self,
        ray: &Ray,
        from: f32,
        to: f32,
        s: &mut Stream,
        mut visit: impl FnMut(f32, Spectrum, f32, &mut Stream) -> bool,
    ) {
        // The optical depth, by the majorant, that is left until the next tentative collision.
        let mut left = None;
        cells(&self.extinction, ray, from, to, |cell, begin, end| {
            let (majorant, mut t) = (self.majorants[cell], begin);
            let left = left.get_or_insert_with(|| -(-s.next_f64()).ln_1p());
            while f64::from(majorant) * (end - t) > *left {
                t += *left / f64::from(majorant);
                let at = t as f32;
                if !visit(at, self.extinction(ray.at(at)), majorant, s) {
                    return false;
                }
                *left = -(-s.next_f64()).ln_1p();
            }
            *left -= f64::from(majorant) * (end - t).max(0.0);
            true
        });
    }
    /// What `emitted` and `transmittance` estimate, by steps of a voxel from a random start: hardly any noise, but a bias, of second
    /// order in the voxels' optical depth. `None` where the emission is a grid of another place.
    pub fn marched(&self, ray: &Ray, from: f32, to: f32, s: &mut Stream) -> Option<(Spectrum, Spectrum)> {
        let glow = self.emission.as_ref();
        if glow.is_some_and(|g| !g.grid().0.lies_as(&self.extinction)) {
            return None;
        }
        let [a, b, c] = self.extinction.voxel().map(|e| e.length());
        let (step, start) = (a.min(b).min(c), s.next_f64());
        let (mut sum, mut depth, mut through) = (Spectrum::BLACK, Spectrum::BLACK, Spectrum::ONE);
        cells(&self.extinction, ray, from, to, |cell, a, b| {
            let dense = self.majorants[cell] > 0.0;
            if !(dense || glow.is_some_and(|g| g.any(cell))) || !(b > a) {
                return true;
            }
            let steps = ((b - a) / step).ceil().max(1.0);
            let dt = ((b - a) / steps) as f32;
            for i in 0..steps as u32 {
                let p = ray.at((a + (f64::from(i) + start) / steps * (b - a)) as f32);
                let sigma = if dense { self.extinction(p) } else { Spectrum::BLACK };
                // Of an even step: (1 - exp(-sigma dt)) / sigma.
                let seen =
                    sigma.map(|x| if x * dt > 1e-4 { -(-x * dt).exp_m1() / x } else { dt * (1.0 - 0.5 * x * dt) });
                sum += through * glow.map_or(Spectrum::BLACK, |g| g.at(p)) * seen;
                depth += sigma * dt;
                through = depth.map(|x| (-x).exp());
            }
            through.largest() > 1e-6
        });
        Some((sum, through))
    }
    /// Ratio tracking: the product of 1 - sigma_t / majorant over tentative collisions (Novak et al. 2014).
    pub fn transmittance(&self, ray: &Ray, from: f32, to: f32, s: &mut Stream) -> Spectrum {
        let mut through = Spectrum::ONE;
        self.track(ray, from, to, s, |_, sigma, majorant, _| {
            through *= passing(sigma, majorant);
            !through.is_black()
        });
        through
    }
    /// Delta tracking (Woodcock et al. 1965) by a channel drawn with probability p_c = `weights`. With q_c the product of
    /// 1 - sigma_c / majorant over the collisions that were none, a collision weighs sigma_s q / sum_c p_c sigma_c q_c and
    /// passing q / sum_c p_c q_c (one-sample multiple importance sampling; Miller et al. 2019).
    pub fn fly(&self, ray: &Ray, from: f32, to: f32, weights: [f32; 3], s: &mut Stream) -> Flight {
        let u = s.next_f32();
        let chosen = usize::from(u >= weights[0]) + usize::from(u >= weights[0] + weights[1]);
        let mut through = Spectrum::ONE;
        let mut collision = None;
        self.track(ray, from, to, s, |t, sigma, majorant, s| {
            if s.next_f32() * majorant < sigma.to_array()[chosen] {
                collision = Some((t, sigma));
                return false;
            }
            through *= passing(sigma, majorant);
            true
        });
        let mean = |x: Spectrum| (0..3).map(|c| weights[c] * x.to_array()[c]).sum::<f32>();
        match collision {
            Some((t, sigma)) => {
                let scattered = sigma * self.albedo.at(ray.at(t));
                Flight::Collision { t, weight: scattered * through * (1.0 / mean(sigma * through)) }
            }
            None => Flight::Passed { weight: through * (1.0 / mean(through)) },
        }
    }
}

/// The part that a tentative collision lets pass.
fn passing(sigma: Spectrum, majorant: f32) -> Spectrum {
    debug_assert!(sigma.largest() <= majorant * 1.0001, "{sigma:?} exceeds the majorant {majorant}");
    sigma.map(|x| (1.0 - x / majorant).max(0.0))
}
