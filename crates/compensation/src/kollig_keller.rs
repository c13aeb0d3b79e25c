//! Compensation by continued paths (Kollig and Keller 2004), in media too (Raab, Seibert and Keller 2008).

use manylight_framework::{Bounding, Claim, Compensator, Depth, Onward, Pair, PathClasses, Probe};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Mode, Scene, Vertex};

/// With T_b the transport that keeps min(G, b) and T_r what is left of it, radiance without emission is
///
/// > L(x) = direct(x) + (T_b L)(x) + (T_r L)(x),   (T_r L)(x) = E_w\[f |cos| / pdf(w) (1 - b / G(x, y)) L(y)\],
///
/// y being what a ray along the sampled direction w meets, and L(y) again such a sum: the lights are asked at y, bounded, and so
/// on. Russian roulette by the weight ends the recursion, most often at once: beyond 1 / sqrt(b) nothing is missing.
///
/// In media (Raab et al.) y is where a free flight along w ends: at a collision, or at the surface. G has no cosine where a vertex
/// lies in a medium, transmittance is no part of it (so that what is taken away does not depend on its estimate), and a flight
/// leaves a weight of albedo times 1 - b / G.
///
/// It also follows mirrors and glass from y on, with weight 1: no virtual light can shine through them, bounded or not. So with
/// it, virtual lights make caustics as well (except those of lights without extent, which no path meets).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KolligKeller {
    /// Residual steps at most; `None`: no limit, unbiased.
    pub steps: Option<u32>,
    /// How light is found where a residual path arrives.
    pub arrival: Arrival,
}

/// How light is found where a residual path arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// By all lights, as at the first vertex: what the paper does. Its cost is the light set's; few residual paths arrive, so that it is
    /// seldom the larger part.
    Lights,
    /// By path tracing from there on: a few rays. The bound is zero there, so that what it takes is everything.
    Path,
}

/// Weights of more than this are not certain to go on, so that every path ends, even between white walls.
const SURVIVAL: f32 = 0.95;
/// Residual steps, and edges, from which roulette never lets everything through.
const CERTAIN: u32 = 4;

/// Probability with which a path of this weight goes on, whose last residual step is of this number.
pub(crate) fn survival(weight: Spectrum, level: u32) -> f32 {
    weight.luminance().min(if level <= CERTAIN { 1.0 } else { SURVIVAL })
}

impl Compensator for KolligKeller {
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
        // The shortest path with a residual step has two edges from here: to y, and from y to an emitter.
        if self.steps.is_some_and(|most| at.level >= most) || !onward.allows(at.edges.saturating_add(2)) {
            return Spectrum::BLACK;
        }
        let Some(next) = x.sample(s.next_f32(), s.next_2d()).filter(|n| !n.delta) else { return Spectrum::BLACK };
        let mut ray = x.leave(next.dir);
        let cos_x = x.cosine(next.dir);
        if !scene.has_delta_lobes() {
            // G <= cos_x / d^2: beyond this distance nothing is taken away.
            ray.t_max = ray.t_max.min((cos_x / bounding.cap()).sqrt());
        }
        probe.path_rays += 1;
        let (y, through) = scene.advance(&ray, Mode::Radiance, next.weight, s);
        let Some(y) = y else { return Spectrum::BLACK };
        let (step, weight) = (Step { scene, onward, at: at.step(1) }, next.weight * through);
        let g = cos_x * y.normal().map_or(1.0, |n| n.dot(next.dir).abs()) / (y.p - x.p).length_squared();
        // At contact G is infinite, and nothing is kept.
        let lost = if g < f32::INFINITY { 1.0 - bounding.keep(&Pair { g, lobes: None }) } else { 1.0 };
        step.scattered(&y, weight * lost, probe, s) + step.behind_delta(y, weight, probe, s)
    }
    fn repairs(&self, bounding: Claim) -> Claim {
        match self.steps {
            None => Claim::UNBIASED,
            Some(_) => Claim { noisy: true, ..bounding },
        }
    }
    fn finds(&self) -> PathClasses {
        match self.steps {
            None => PathClasses::CAUSTICS,
            // A caustic of a caustic takes another step.
            Some(_) => PathClasses::NONE,
        }
    }
    fn asks_lights(&self, level: u32) -> bool {
        // Where the last step arrives nothing else would find indirect light.
        level == 0 || self.arrival == Arrival::Lights || self.steps == Some(level)
    }
}

/// One residual step.
struct Step<'a> {
    scene: &'a Scene,
    onward: &'a dyn Onward,
    at: Depth,
}

impl Step<'_> {
    /// weight x what leaves y, by Russian roulette.
    fn scattered(&self, y: &Vertex, weight: Spectrum, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let survival = survival(weight, self.at.level);
        if !y.connects() || !(s.next_f32() < survival) {
            return Spectrum::BLACK;
        }
        weight * (1.0 / survival) * self.onward.scattered(y, self.at, probe, s)
    }
    /// What comes through the delta lobes of y, which virtual lights cannot be connected through.
    fn behind_delta(&self, y: Vertex, mut weight: Spectrum, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let (mut y, mut at, mut sum) = (y, self.at, Spectrum::BLACK);
        while self.onward.allows(at.edges.saturating_add(1)) {
            let Some(next) = y.sample(s.next_f32(), s.next_2d()).filter(|n| n.delta) else { break };
            weight *= next.weight;
            let certain = at.edges < CERTAIN;
            let survival = weight.luminance().min(if certain { 1.0 } else { SURVIVAL });
            if !(s.next_f32() < survival) {
                break;
            }
            weight *= 1.0 / survival;
            probe.path_rays += 1;
            at.edges += 1;
            let counts = self.onward.counts(at.edges);
            let (z, through) = self.scene.advance(&y.leave(next.dir), Mode::Radiance, weight, s);
            weight *= through;
            let Some(z) = z else {
                if counts {
                    sum += weight * self.scene.environment(next.dir);
                }
                break;
            };
            if counts {
                sum += weight * z.emitted();
            }
            sum += Step { at, ..*self }.scattered(&z, weight, probe, s);
            y = z;
        }
        sum
    }
}
