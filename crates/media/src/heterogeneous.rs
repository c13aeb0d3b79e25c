//! A medium whose density varies.

use crate::volume::{Grid, Volume};
use crate::{Flight, HenyeyGreenstein, MediumError};
use manylight_math::{DVec3, Ray, Spectrum, Vec3};
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
}

/// Cells of majorants along each axis.
const CELLS: usize = 16;

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
        Ok(Heterogeneous { extinction, scale, albedo, phase, majorants, largest, mean })
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
        self.inside(ray, 0.0, f64::from(ray.t_max)).map_or(0.0, |(_, t1)| t1 as f32)
    }
    /// The part of [from, to] that lies in the unit cube.
    fn inside(&self, ray: &Ray, from: f64, to: f64) -> Option<(f64, f64)> {
        let (o, d) = (self.extinction.local(ray.origin), self.extinction.local_direction(ray.dir));
        let (mut t0, mut t1) = (from, to);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if !(0.0..=1.0).contains(&o[axis]) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-o[axis] / d[axis], (1.0 - o[axis]) / d[axis]);
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
        (t0 < t1).then_some((t0, t1))
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
        let Some((t0, t1)) = self.inside(ray, f64::from(from), f64::from(to)) else { return };
        let n = CELLS as f64;
        let (o, d) = (self.extinction.local(ray.origin) * n, self.extinction.local_direction(ray.dir) * n);
        let start: DVec3 = o + d * t0;
        let mut cell: [i64; 3] = [0, 1, 2].map(|a| (start[a].floor() as i64).clamp(0, CELLS as i64 - 1));
        let step = [0, 1, 2].map(|a| if d[a] > 0.0 { 1i64 } else { -1 });
        // Where the ray leaves the cell along each axis.
        let exit = |a: usize, cell: i64| {
            if d[a] == 0.0 { f64::INFINITY } else { ((cell + i64::from(step[a] > 0)) as f64 - o[a]) / d[a] }
        };
        let mut next = [0, 1, 2].map(|a| exit(a, cell[a]));
        let mut t = t0;
        // The optical depth, by the majorant, that is left until the next tentative collision.
        let mut left = -(-s.next_f64()).ln_1p();
        loop {
            let axis = if next[0] <= next[1] && next[0] <= next[2] {
                0
            } else if next[1] <= next[2] {
                1
            } else {
                2
            };
            let end = next[axis].min(t1);
            let majorant = self.majorants[((cell[2] as usize * CELLS) + cell[1] as usize) * CELLS + cell[0] as usize];
            while f64::from(majorant) * (end - t) > left {
                t += left / f64::from(majorant);
                let at = t as f32;
                if !visit(at, self.extinction(ray.at(at)), majorant, s) {
                    return;
                }
                left = -(-s.next_f64()).ln_1p();
            }
            left -= f64::from(majorant) * (end - t).max(0.0);
            if end >= t1 {
                return;
            }
            t = t.max(end);
            cell[axis] += step[axis];
            if !(0..CELLS as i64).contains(&cell[axis]) {
                return;
            }
            next[axis] = exit(axis, cell[axis]);
        }
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
