//! Approximate compensation in media (Engelhardt, Novak, Schmidt and Dachsbacher 2012).

use crate::kollig_keller::survival;
use crate::{Arrival, KolligKeller};
use manylight_framework::{Bounding, Claim, Compensator, Depth, Onward, Pair, Probe};
use manylight_math::{Ray, Spectrum};
use manylight_sampling::Stream;
use manylight_sampling::along::Exponential;
use manylight_scene::{MediumPoint, Scatter, Scene, Vertex};

/// The residual at a point of a medium as if the medium were the same all around and nothing stood in it:
///
/// > R(x, w) = sigma_s E_w'\[int_0^r_b exp(-sigma_t r) (1 - r^2 / r_b^2) L(x + r w') dr\],    r_b = b^(-1/2),
///
/// w' drawn by the phase function and r, where the ball of radius r_b is thin, with density 3 / (2 r_b) (1 - r^2 / r_b^2), whose
/// inverse is r = 2 r_b sin(asin(xi) / 3); where it is thick by free flight within it. No ray is traced from x to x + r w' and
/// nothing is tracked: the medium's boundary alone is looked for. L is what the lights bring there, and the residual again; after
/// `steps` of these the rest is a geometric series of ratio f = albedo (1 - 2 / u^2 (1 - (1 + u) exp(-u))), u = sigma_t r_b, which
/// takes L to be the same throughout the ball.
///
/// Biased, of either sign: by how much the medium varies within r_b, by what stands in it (surfaces within r_b of a point in a medium
/// neither shade it nor give back what the bound took of their light), and with `steps` by how much L varies. Without `steps`, in
/// a homogeneous medium, far from surfaces it has the expectation of Raab et al. At surfaces paths are continued exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Engelhardt {
    /// Steps after which the rest is a geometric series; `None`: all of them are taken.
    pub steps: Option<u32>,
}

/// Thinner than this, distances are drawn without the medium. Optical depth.
const THIN: f32 = 1.5;
/// Of the series' ratio: further orders are forty times the first at most.
const MOST: f32 = 0.975;
/// Orders beyond which the ratio's powers are nothing (0.975^400 = 4e-5).
const ENDLESS: u32 = 400;
/// Surfaces' paths go on as Kollig and Keller's.
const AT_SURFACES: KolligKeller = KolligKeller { steps: None, arrival: Arrival::Lights };

impl Compensator for Engelhardt {
    fn residual(
        &self,
        scene: &Scene,
        x: &Vertex,
        at: Depth,
        bounding: &dyn Bounding,
        onward: &dyn Onward,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum {
        let radius = 1.0 / bounding.cap().sqrt();
        let onward = &Summed { onward, scene, radius, steps: self.steps };
        let Scatter::Medium(point) = &x.scatter else {
            return AT_SURFACES.residual(scene, x, at, bounding, onward, probe, s);
        };
        // Of a bound of zero, where no lights are asked, the ball is all of space.
        let bounded = radius > 0.0 && radius < f32::INFINITY;
        if onward.is_last(at) || !bounded || !onward.allows(at.edges.saturating_add(2)) {
            return Spectrum::BLACK;
        }
        let (Some(medium), Some(next)) = (scene.medium(point.medium), x.sample(s.next_f32(), s.next_2d())) else {
            return Spectrum::BLACK;
        };
        let (r, inverse) = distance(medium.extinction(x.p), radius, s);
        let ray = Ray { t_max: r, ..x.leave(next.dir) };
        // The medium's end is no surface: it is looked for among the boundaries alone.
        if scene.runs(&ray).first().is_none_or(|run| run.medium != point.medium || run.to < r) {
            return Spectrum::BLACK;
        }
        let through = medium.extinction(x.p).map(|sigma| (-sigma * r).exp());
        let lost = 1.0 - bounding.keep(&Pair { g: 1.0 / (r * r), lobes: None });
        let weight = next.weight * medium.scattering(x.p) * through * (inverse * lost);
        let at = at.step(1);
        let survival = survival(weight, at.level);
        if !(s.next_f32() < survival) {
            return Spectrum::BLACK;
        }
        let point = MediumPoint { wi: -next.dir, scattering: Spectrum::ONE, ..*point };
        let y = Vertex { p: ray.at(r), scatter: Scatter::Medium(point) };
        weight * (1.0 / survival) * onward.scattered(&y, at, probe, s)
    }
    fn repairs(&self, _: Claim) -> Claim {
        Claim { bias: f32::INFINITY, brightens: true, ..Claim::UNBIASED }
    }
}

/// A distance within a radius, and 1 / pdf. \[m\]
fn distance(extinction: Spectrum, radius: f32, s: &mut Stream) -> (f32, f32) {
    let u = s.next_f64();
    let mean = extinction.mean();
    if mean * radius < THIN {
        let t = 2.0 * (u.asin() / 3.0).sin();
        let r = t as f32 * radius;
        // At the rim, where nothing is lost, the density is zero.
        return (r, (2.0 / 3.0) * radius / (1.0 - t * t).max(1e-12) as f32);
    }
    let flight = Exponential::new(f64::from(mean), f64::from(radius));
    let r = flight.sample(u);
    (r as f32, (1.0 / flight.pdf(r)) as f32)
}

/// What a bound takes of light scattered once in an endless medium, as a fraction: f(u) = 1 - 2 / u^2 (1 - (1 + u) exp(-u)), u being
/// the radius 1 / sqrt(b) in mean free paths.
pub fn lost_fraction(u: f32) -> f32 {
    let x = f64::from(u);
    if x < 1e-3 {
        return (x * (2.0 / 3.0 - 0.25 * x)) as f32;
    }
    if !(x < 1e6) {
        return 1.0;
    }
    // The difference cancels: in f64 what is left has nine digits.
    (1.0 - 2.0 / (x * x) * (1.0 - (1.0 + x) * (-x).exp())) as f32
}

/// The sum of q^0 .. q^more; `None`: without end.
fn orders(q: f32, more: Option<i32>) -> f32 {
    more.map_or(1.0, |more| 1.0 - q.powi(more + 1)) / (1.0 - q)
}

/// Onward, with the series of all further orders at points of media where the last step has arrived.
struct Summed<'a> {
    onward: &'a dyn Onward,
    scene: &'a Scene,
    radius: f32,
    steps: Option<u32>,
}
impl Summed<'_> {
    fn is_last(&self, at: Depth) -> bool {
        self.steps.is_some_and(|most| at.level >= most)
    }
    /// 1 / (1 - albedo f(u)) of each channel; where a path may not have so many more edges, the sum of what it may have.
    fn series(&self, y: &Vertex, at: Depth) -> Spectrum {
        let allows = |more: u32| self.onward.allows(at.edges.saturating_add(1).saturating_add(more));
        let more = (!allows(ENDLESS)).then(|| (1..ENDLESS).take_while(|more| allows(*more)).count() as i32);
        let Scatter::Medium(point) = &y.scatter else { return Spectrum::ONE };
        let Some(medium) = self.scene.medium(point.medium) else { return Spectrum::ONE };
        let (sigma_s, sigma_t) = (medium.scattering(y.p).to_array(), medium.extinction(y.p).to_array());
        Spectrum::from([0, 1, 2].map(|c| {
            let albedo = if sigma_t[c] > 0.0 { sigma_s[c] / sigma_t[c] } else { 0.0 };
            orders((albedo * lost_fraction(sigma_t[c] * self.radius)).min(MOST), more)
        }))
    }
}
impl Onward for Summed<'_> {
    fn scattered(&self, y: &Vertex, at: Depth, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let once = self.onward.scattered(y, at, probe, s);
        if self.is_last(at) { once * self.series(y, at) } else { once }
    }
    fn counts(&self, edges: u32) -> bool {
        self.onward.counts(edges)
    }
    fn allows(&self, edges: u32) -> bool {
        self.onward.allows(edges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::Purpose;

    #[test]
    fn what_a_bound_takes_of_an_endless_medium_is_the_quadrature_of_its_definition() {
        for u in [1e-4f32, 0.99e-3, 1.01e-3, 0.05, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 100.0] {
            let n = 200_000;
            let f = |r: f64| (1.0 - r * r) * f64::from(u) * (-f64::from(u) * r).exp();
            let sum: f64 = (0..n).map(|i| f((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n);
            assert!((f64::from(lost_fraction(u)) - sum).abs() < 2e-5 * sum + 1e-9, "{u}: {} {sum}", lost_fraction(u));
        }
        assert_eq!((lost_fraction(0.0), lost_fraction(f32::INFINITY)), (0.0, 1.0));
    }
    #[test]
    fn orders_end_where_paths_do() {
        let sums = [Some(0), Some(1), Some(2), None].map(|more| orders(0.5, more));
        assert_eq!(sums, [1.0, 1.5, 1.75, 2.0]);
        assert_eq!(orders(0.0, Some(3)), 1.0);
    }
    #[test]
    fn distances_have_the_density_that_they_say() {
        for (sigma, radius) in [(0.0f32, 2.0f32), (0.4, 2.0), (1.0, 0.1), (3.0, 2.0), (50.0, 1.0)] {
            let mut s = Stream::new(5, [0; 3], Purpose::TEST);
            let n = 200_000;
            // E[inverse g(r)] = int_0^radius g, for g that vanish at the rim.
            let (mut zeroth, mut second) = (0.0, 0.0);
            for _ in 0..n {
                let (r, inverse) = distance(Spectrum::gray(sigma), radius, &mut s);
                assert!(r >= 0.0 && r <= radius && inverse.is_finite());
                let t = f64::from(r / radius);
                let g = f64::from(inverse) * (1.0 - t * t) * (-f64::from(sigma * r)).exp();
                zeroth += g / f64::from(n);
                second += g * g / f64::from(n);
            }
            let truth = if sigma > 0.0 { lost_fraction(sigma * radius) / sigma } else { 2.0 * radius / 3.0 };
            let error = ((second - zeroth * zeroth).max(0.0) / f64::from(n)).sqrt();
            assert!(
                (zeroth - f64::from(truth)).abs() < 4.5 * error + 1e-5,
                "{sigma} {radius}: {zeroth} {truth} +- {error}"
            );
        }
    }
}
