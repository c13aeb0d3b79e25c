//! The random walk of a light path.

use manylight_framework::Probe;
use manylight_math::{Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Emission, EmitterPoint, Mode, Scatter, Scene, Vertex};

/// A vertex of a light path.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Seen from the previous vertex.
    pub vertex: Vertex,
    /// alpha_j, before the vertex's own roulette. \[W\]
    pub flux: Spectrum,
    /// Edges from the emitter: 1 for the first hit.
    pub edges: u32,
    /// Density, per area, with which the walk got here from the vertex before, its roulette included; `None` after a delta lobe.
    /// Of surfaces, where no medium lies between. [1/m^2]
    pub density: Option<f32>,
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
pub fn walk_along(scene: &Scene, s: &mut Stream, length: Length, probe: &mut Probe, visit: impl FnMut(Step)) {
    probe.light_paths += 1;
    if let Some(emission) = scene.sample_emission(s) {
        walk_from(scene, &emission, s, length, probe, visit);
    }
}

/// The walk after its emission has been drawn.
pub(crate) fn walk_from(
    scene: &Scene,
    emission: &Emission,
    s: &mut Stream,
    length: Length,
    probe: &mut Probe,
    mut visit: impl FnMut(Step),
) {
    let (mut ray, mut flux) = (emission.ray, emission.flux);
    let start = flux.luminance();
    let (mut from, mut pdf) = (emission.start.vertex, Some(emission_pdf(&emission.start.vertex, ray.dir)));
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
        visit(Step { vertex, flux, edges, density: pdf.map(|p| p * per_area(&from, &vertex)) });
        let Some(next) = vertex.sample(s.next_f32(), s.next_2d()) else { return };
        flux *= next.weight;
        let survival = length.survival(flux, start, edges);
        if edges >= length.certain_edges {
            if !(s.next_f32() < survival) {
                return;
            }
            flux *= 1.0 / survival;
        }
        (from, pdf) = (vertex, (!next.delta).then_some(next.pdf * survival));
        ray = vertex.leave(next.dir);
    }
}

impl Length {
    /// Probability that the roulette lets a path go on, which was emitted with the luminance `start` and would carry `flux` on
    /// from its vertex of so many edges.
    pub(crate) fn survival(&self, flux: Spectrum, start: f32, edges: u32) -> f32 {
        let limit = if edges < WHITE_EDGES { 1.0 } else { SURVIVAL };
        if edges < self.certain_edges { 1.0 } else { (flux.luminance() / start).min(limit) }
    }
}

/// Density with which an emitter's point sends a ray: per solid angle [1/sr], or per area of the disc for light from infinity.
pub(crate) fn emission_pdf(y: &Vertex, dir: Vec3) -> f32 {
    match y.scatter {
        Scatter::Emitter(EmitterPoint::Distant { disc, .. }) => 1.0 / disc,
        // Lobes of emitters are normalised, and rays are drawn by them.
        _ => y.eval(dir).largest(),
    }
}

/// What turns a density at `y`, of `emission_pdf` or per solid angle, into one per area at `x`: cos_x / d^2, or cos_x towards
/// infinity. [1/m^2]
pub(crate) fn per_area(y: &Vertex, x: &Vertex) -> f32 {
    let across = |w: Vec3| x.normal().map_or(1.0, |n| n.dot(w).abs());
    if let Scatter::Emitter(EmitterPoint::Distant { towards, .. }) = y.scatter {
        return across(towards);
    }
    let d = y.p - x.p;
    across(d.normalize_or_zero()) / d.length_squared()
}
