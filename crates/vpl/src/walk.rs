//! The random walk of a light path.

use manylight_framework::Probe;
use manylight_math::Spectrum;
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Mode, Scene, Vertex};

/// A vertex of a light path.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Seen from the previous vertex.
    pub vertex: Vertex,
    /// alpha_j, before the vertex's own roulette. \[W\]
    pub flux: Spectrum,
    /// Edges from the emitter: 1 for the first hit.
    pub edges: u32,
}

/// From this edge on the roulette never lets everything through, so that a walk ends even between white walls.
const WHITE_EDGES: u32 = 16;
const SURVIVAL: f32 = 0.95;

/// How long light paths get.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Length {
    /// Edges at most, from the emitter to the last light.
    pub max_edges: u32,
    /// Edges before Russian roulette begins: 1 plays it at every vertex.
    pub certain_edges: u32,
}

/// Walks light path `path` of a pass, and shows each hit to `visit`.
///
/// alpha_1 = emitted flux / density; alpha_{j+1} = alpha_j f |cos| / (pdf q_j), with q_j = min(1, lum(alpha_{j+1}) / lum(alpha_1)),
/// the survival probability of Russian roulette, which keeps all lights of a path equally strong.
///
/// A vertex is shown before its roulette and before its continuation is drawn: neither can take a light away.
pub fn walk(
    scene: &Scene,
    seed: u64,
    pass: u64,
    path: u64,
    length: Length,
    probe: &mut Probe,
    visit: impl FnMut(Step),
) {
    walk_along(scene, &mut Stream::new(seed, [pass, path, 0], Purpose::LIGHT_PATHS), length, probe, visit);
}

/// The walk as a function of its random numbers alone.
pub fn walk_along(scene: &Scene, s: &mut Stream, length: Length, probe: &mut Probe, mut visit: impl FnMut(Step)) {
    probe.light_paths += 1;
    let Some(emission) = scene.sample_emission(s) else { return };
    let (mut ray, mut flux) = (emission.ray, emission.flux);
    let start = flux.luminance();
    for edges in 1..=length.max_edges {
        if !flux.is_valid() {
            probe.broken_paths += 1;
            return;
        }
        if flux.is_black() {
            return;
        }
        probe.path_rays += 1;
        let (vertex, through) = scene.advance(&ray, Mode::Importance, flux, s);
        let Some(vertex) = vertex else { return };
        flux *= through;
        visit(Step { vertex, flux, edges });
        let Some(next) = vertex.sample(s.next_f32(), s.next_2d()) else { return };
        flux *= next.weight;
        if edges >= length.certain_edges {
            let limit = if edges < WHITE_EDGES { 1.0 } else { SURVIVAL };
            let survival = (flux.luminance() / start).min(limit);
            if !(s.next_f32() < survival) {
                return;
            }
            flux *= 1.0 / survival;
        }
        ray = vertex.leave(next.dir);
    }
}
