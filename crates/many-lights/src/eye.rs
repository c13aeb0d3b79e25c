//! What becomes of an eye path at a vertex: which lobes ask the lights, and which are walked through.

use manylight_sampling::Stream;
use manylight_scene::{Vertex, VertexSample};

/// The lobes of a vertex in two: f = f_gathers + f_walks.
pub(crate) struct Parts {
    /// What lights are connected to. Its delta lobes, that nothing can be connected to, are walked through too.
    pub gathers: Vertex,
    /// The sharp lobes, and the probability of walking on through them rather than through the delta lobes of the rest.
    sharp: Option<(Vertex, f32)>,
}

impl Parts {
    /// Lobes of a roughness of at most `sharp` are walked through.
    pub fn of(x: &Vertex, sharp: f32) -> Self {
        match if sharp > 0.0 { x.split(sharp) } else { None } {
            Some((gathers, walks, chance)) => Parts { gathers, sharp: Some((walks, chance)) },
            None => Parts { gathers: *x, sharp: None },
        }
    }
    /// The sharp lobes alone.
    pub fn sharp(&self) -> Option<&Vertex> {
        self.sharp.as_ref().map(|s| &s.0)
    }
    /// Draws where the path walks on. `None`: it ends.
    pub fn step(&self, s: &mut Stream) -> Option<VertexSample> {
        let Some((walks, chance)) = &self.sharp else { return delta(&self.gathers, s) };
        let (next, p) = if s.next_f32() < *chance {
            (walks.sample(s.next_f32(), s.next_2d()), *chance)
        } else {
            (delta(&self.gathers, s), 1.0 - chance)
        };
        next.map(|next| VertexSample { weight: next.weight * (1.0 / p), ..next })
    }
}

fn delta(x: &Vertex, s: &mut Stream) -> Option<VertexSample> {
    x.sample(s.next_f32(), s.next_2d()).filter(|next| next.delta)
}
