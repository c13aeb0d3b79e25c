//! One Markov chain over light paths.

use crate::{Metropolis, perturb};
use manylight_framework::Probe;
use manylight_sampling::{Numbers, Purpose, Stream};
use manylight_scene::Scene;
use manylight_vpl::{Importons, Vpl, walk_along};
use std::sync::Arc;

/// What a chain walks in.
pub(crate) struct Space<'a> {
    pub metropolis: &'a Metropolis,
    pub scene: &'a Scene,
    pub importons: &'a Importons,
    /// 1 / mean Phi of a light, by the pilot; 0 if it saw nothing.
    pub scale: f64,
}

/// A light path with its lights and their shares: the chain's state, of which the estimates of importance are a part.
#[derive(Clone)]
pub(crate) struct State {
    numbers: Numbers,
    /// Numbers that it was made of.
    drawn: u64,
    /// Each light with s_j.
    pub lights: Vec<(Vpl, f64)>,
    /// c = sum of s_j.
    pub weight: f64,
}

/// How a chain moves.
#[derive(Clone, Copy)]
enum Move {
    /// A new path.
    Large,
    /// The same path, weighed by other points of the image.
    Camera,
    /// A path nearby.
    Small,
}

impl Space<'_> {
    /// The path of some numbers, weighed by points that `s` draws.
    pub fn state(&self, numbers: Numbers, probe: &mut Probe, s: &mut Stream) -> State {
        let (walks, mut own) = (&self.metropolis.walks, Stream::of(numbers.clone()));
        let mut found = Vec::new();
        walk_along(self.scene, &mut own, walks.length(), probe, |step| found.extend(walks.light(&step)));
        let mut weight = 0.0;
        let lights = found.into_iter().map(|light| {
            let importance = self.importons.importance(self.scene, &light, self.metropolis.rays, probe, s);
            let share = importance * self.scale + self.metropolis.floor as f64;
            weight += share;
            (light, share)
        });
        let lights = lights.collect();
        State { numbers, drawn: own.drawn(), lights, weight }
    }
    /// One step: the next state, or `None` to stay. Leaves the density c invariant, whatever the move, which is drawn without
    /// looking at the state.
    pub fn step(&self, state: &mut State, probe: &mut Probe, s: &mut Stream) -> Option<State> {
        let (u, m) = (s.next_f32(), self.metropolis);
        let kind = match u {
            u if u < m.large => Move::Large,
            u if u < m.large + m.camera => Move::Camera,
            _ => Move::Small,
        };
        // What comes after the numbers of the path has no part in it: drawn afresh, as it is distributed.
        state.numbers = state.with_fresh_rest(stream(s));
        let proposed = match kind {
            Move::Large => {
                let fresh = stream(s);
                self.one(state, Arc::new(move |n| fresh.nth(n)), probe, s)
            }
            Move::Camera => self.one(state, state.numbers.clone(), probe, s),
            Move::Small => self.several(state, probe, s),
        };
        let name = match kind {
            Move::Large => "large steps accepted",
            Move::Camera => "camera steps accepted",
            Move::Small => "small steps accepted",
        };
        probe.note(name, proposed.is_some() as u32 as f32);
        proposed
    }
    /// Metropolis: min(1, c(v) / c(u)).
    fn one(&self, from: &State, numbers: Numbers, probe: &mut Probe, s: &mut Stream) -> Option<State> {
        let proposed = self.state(numbers, probe, s);
        (s.next_f64() * from.weight < proposed.weight).then_some(proposed)
    }
    /// Multiple-try Metropolis (Liu, Liang and Wong 2000) with a symmetric kernel: one of K tries v_k by its weight, accepted with
    /// min(1, sum c(v_k) / sum c(r_k)), where K - 1 references r are drawn around it, and the last is the state itself. K = 1 is
    /// Metropolis' rule. Weights are those estimated with each try; the state's own is the one it has.
    fn several(&self, from: &State, probe: &mut Probe, s: &mut Stream) -> Option<State> {
        let tries: Vec<State> = (0..self.metropolis.tries).map(|_| self.nearby(from, probe, s)).collect();
        let sum: f64 = tries.iter().map(|t| t.weight).sum();
        let mut rest = s.next_f64() * sum;
        // Where rounding leaves a rest, the last that has any weight.
        let last = tries.iter().rposition(|t| t.weight > 0.0)?;
        let chosen = tries.iter().position(|t| {
            rest -= t.weight;
            rest < 0.0
        });
        let chosen = tries.into_iter().nth(chosen.unwrap_or(last))?;
        let references: f64 = (1..self.metropolis.tries).map(|_| self.nearby(&chosen, probe, s).weight).sum();
        (s.next_f64() * (references + from.weight) < sum).then_some(chosen)
    }
    fn nearby(&self, from: &State, probe: &mut Probe, s: &mut Stream) -> State {
        let (base, by) = (from.numbers.clone(), stream(s));
        self.state(Arc::new(move |n| perturb(base(n), by.nth(n))), probe, s)
    }
}

impl State {
    /// The numbers that it was made of, and then those of `rest`.
    fn with_fresh_rest(&self, rest: Stream) -> Numbers {
        let used: Vec<u64> = (0..self.drawn).map(|n| (self.numbers)(n)).collect();
        Arc::new(move |n| used.get(n as usize).copied().unwrap_or_else(|| rest.nth(n)))
    }
    /// One light for each of `times` steps that the chain stood here, j with probability s_j / c, from as many strata: each with
    /// its number of steps.
    pub fn leave(&self, times: u64, s: &mut Stream) -> Vec<(Vpl, f64, u64)> {
        let (mut left, mut sum, mut k) = (Vec::new(), 0.0, 0);
        let offset = s.next_f64();
        for (i, (light, share)) in self.lights.iter().enumerate() {
            sum += share;
            let end = if i + 1 == self.lights.len() { f64::INFINITY } else { sum };
            let before = k;
            while k < times && (k as f64 + offset) / times as f64 * self.weight < end {
                k += 1;
            }
            if k > before {
                left.push((*light, *share, k - before));
            }
        }
        left
    }
}

/// A stream of its own for a step or a try.
fn stream(s: &mut Stream) -> Stream {
    Stream::new(s.next_u64(), [s.next_u64(), 0, 0], Purpose::CHAINS)
}
