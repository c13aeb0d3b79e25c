//! Multiple importance sampling over all ways to make a path.

use crate::subpath::{Node, emission_density, per_area, scattering_density};
use manylight_scene::Vertex;

/// How the strategies are put together. (s, t): s vertices from the light, t from the eye, the pinhole included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// By the balance heuristic: p_s / sum p_i (Veach and Guibas 1995).
    Balance,
    /// By the power heuristic: p_s^2 / sum p_i^2.
    Power,
    /// One strategy alone, unweighted: all paths that it can make.
    Alone(u32, u32),
    /// t = 1 for all paths of two edges and more, unweighted; emission is seen directly.
    LightTracing,
}

/// The densities of one whole path z_0 .. z_n, light to eye, z_n being the pinhole.
pub(crate) struct Ways {
    /// Of z_i, made from z_{i-1}.
    pub forward: Vec<f64>,
    /// Of z_i, made from z_{i+1}.
    pub backward: Vec<f64>,
    /// The path passes z_i by a delta lobe.
    pub delta: Vec<bool>,
    /// Can eye paths hit the light?
    pub hit: bool,
}

impl Ways {
    /// Of the path that joins a light subpath (its nodes that are used) with an eye subpath. `light` and `eye` are the densities
    /// of z_0 as an emitter's point, and of the first vertex that the camera sees.
    pub fn new(y: &[Node], x: &[Node], first: f64, hit: bool, camera: impl Fn(&Vertex) -> f64) -> Self {
        let (s, t) = (y.len(), x.len());
        let vertex = |i: usize| if i < s { &y[i].vertex } else { &x[s + t - 1 - i].vertex };
        let n = s + t - 1;
        let mut ways = Ways { forward: vec![1.0; n + 1], backward: vec![1.0; n + 1], delta: vec![false; n + 1], hit };
        for i in 0..=n {
            // Whatever is within one subpath is known; the joint's neighbours are not, since their neighbours are new.
            ways.forward[i] = match i {
                0 => first,
                _ if i < s => y[i].ahead,
                1 => {
                    emission_density(vertex(0), crate::subpath::direction(vertex(0), vertex(1)))
                        * per_area(vertex(0), vertex(1))
                }
                _ if i == n => 1.0,
                _ if i <= s + 1 => scattering_density(vertex(i - 2), vertex(i - 1), vertex(i)),
                _ => x[n - i].back,
            };
            ways.backward[i] = match i {
                _ if i == n => 1.0,
                _ if i >= s => x[n - i].ahead,
                _ if i + 1 == n => camera(vertex(i)),
                _ if i + 2 >= s => scattering_density(vertex(i + 2), vertex(i + 1), vertex(i)),
                _ => y[i].back,
            };
            ways.delta[i] = if i < s { y[i].delta && i + 1 < s } else { x[n - i].delta && i > s };
        }
        ways
    }
    /// Can the strategy with s light vertices make it?
    fn possible(&self, s: usize) -> bool {
        let n = self.forward.len() - 1;
        match s {
            0 => self.hit,
            // The emission that the camera sees directly is left to s = 0.
            1 if n == 1 => false,
            _ => s <= n && !self.delta[s - 1] && !self.delta[s],
        }
    }
    /// Weight of the strategy with s light vertices, with exponent `beta`.
    pub fn weight(&self, s: usize, beta: i32) -> f64 {
        let n = self.forward.len() - 1;
        let (mut sum, mut ratio) = (1.0, 1.0f64);
        for i in (0..s).rev() {
            // From i + 1 light vertices to i: z_i is made from the eye.
            ratio *= self.backward[i] / self.forward[i];
            if self.possible(i) {
                sum += ratio.powi(beta);
            }
        }
        ratio = 1.0;
        for i in s + 1..=n {
            // From i - 1 to i: z_{i-1} is made from the light.
            ratio *= self.forward[i - 1] / self.backward[i - 1];
            if self.possible(i) {
                sum += ratio.powi(beta);
            }
        }
        1.0 / sum
    }
}
