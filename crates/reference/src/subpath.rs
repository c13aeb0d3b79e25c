//! Light and eye subpaths, with the densities that every strategy needs.

use manylight_framework::Probe;
use manylight_math::{Ray, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::{EmitterPoint, Mode, Scatter, Scene, SurfacePoint, Vertex};

/// A vertex of a subpath. Densities are per area [1/m^2]; of a direction to infinity per solid angle [1/sr]. Those that belong to
/// a delta lobe have its probability in place of a density: the same number whichever way the path is made, so that it cancels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub vertex: Vertex,
    /// What arrives: importance, or flux \[W\] (of an emitter's point: the flux that it stands for).
    pub beta: Spectrum,
    /// Density with which its own subpath made it, of the vertex before.
    pub ahead: f64,
    /// Density with which it would be made the other way, from the next vertex, where that one and the one after are of this
    /// subpath; else of no meaning.
    pub back: f64,
    /// The subpath goes on from here by a delta lobe.
    pub delta: bool,
    /// Density (or probability) of the direction in which it goes on.
    pdf: f64,
}

impl Node {
    pub fn new(vertex: Vertex, beta: Spectrum, ahead: f64) -> Self {
        Node { vertex, beta, ahead, back: 0.0, delta: false, pdf: 0.0 }
    }
    /// Density of a vertex that it goes on to.
    pub fn on_to(&self, next: &Vertex) -> f64 {
        self.pdf * per_area(&self.vertex, next)
    }
}

/// Turns a density per solid angle at `from` into one per area at `to`; from infinity, one per area across. [sr/m^2]
pub(crate) fn per_area(from: &Vertex, to: &Vertex) -> f64 {
    if let Scatter::Emitter(EmitterPoint::Distant { .. }) = to.scatter {
        return 1.0; // directions to infinity keep their solid angle
    }
    let across = |w: Vec3| to.normal().map_or(1.0, |n| n.dot(w).abs()) as f64;
    if let Scatter::Emitter(EmitterPoint::Distant { towards, .. }) = from.scatter {
        return across(towards);
    }
    let d = to.p - from.p;
    across(d.normalize_or_zero()) / d.length_squared() as f64
}

/// Unit, from one vertex to another, which may be infinitely far.
pub(crate) fn direction(from: &Vertex, to: &Vertex) -> Vec3 {
    match (to.scatter, from.scatter) {
        (Scatter::Emitter(EmitterPoint::Distant { towards, .. }), _) => towards,
        (_, Scatter::Emitter(EmitterPoint::Distant { towards, .. })) => -towards,
        _ => (to.p - from.p).normalize_or_zero(),
    }
}

/// Density with which an emitter's point sends its ray: per solid angle, or per area across for light from infinity.
pub(crate) fn emission_density(y: &Vertex, dir: Vec3) -> f64 {
    match y.scatter {
        Scatter::Emitter(EmitterPoint::Distant { disc, .. }) => 1.0 / disc as f64,
        // Lobes of emitters are normalised, and rays are drawn by them.
        _ => (y.lobe_at(dir).largest() * y.cosine(dir)) as f64,
    }
}

/// Density with which `at`, reached from `from`, would go on to `to`.
pub(crate) fn scattering_density(from: &Vertex, at: &Vertex, to: &Vertex) -> f64 {
    reverse_pdf(at, direction(at, from), to) * per_area(at, to)
}

/// Walks on along a ray from the last of `nodes`, which left with density `pdf`, until there are `most` nodes. Returns the
/// direction of a ray that left the scene, if one did, with what it carried.
#[allow(clippy::too_many_arguments)]
pub(crate) fn walk(
    scene: &Scene,
    nodes: &mut Vec<Node>,
    mut ray: Ray,
    mut beta: Spectrum,
    mut density: impl FnMut(&Node, &Vertex) -> f64,
    (most, certain_edges): (usize, u32),
    mode: Mode,
    probe: &mut Probe,
    s: &mut Stream,
) -> Option<(Vec3, Spectrum)> {
    let (start, mut eta2) = (beta, 1.0);
    while nodes.len() < most {
        let edges = nodes.len();
        probe.path_rays += 1;
        let Some(vertex) = scene.intersect(&ray, mode) else { return Some((ray.dir, beta)) };
        let last = nodes.len() - 1;
        let ahead = match last {
            0 => density(&nodes[0], &vertex),
            _ => nodes[last].on_to(&vertex),
        };
        nodes.push(Node::new(vertex, beta, ahead));
        if nodes.len() == most {
            break;
        }
        let Some(next) = vertex.sample(s.next_f32(), s.next_2d()) else { break };
        beta *= next.weight;
        eta2 *= next.eta * next.eta;
        if beta.is_black() || !beta.is_valid() {
            break;
        }
        if edges as u32 >= certain_edges {
            let survival = match mode {
                // Refraction divides radiance by the square of the index: that is no loss.
                Mode::Radiance => beta.largest() * eta2,
                Mode::Importance => beta.luminance() / start.luminance(),
            };
            let survival = survival.min(0.95);
            if !(s.next_f32() < survival) {
                break;
            }
            beta *= 1.0 / survival;
        }
        (nodes[last + 1].delta, nodes[last + 1].pdf) = (next.delta, next.pdf as f64);
        ray = vertex.leave(next.dir);
        // Now that the way on from here is known: how would the vertex before be made from this one?
        let pdf = if next.delta { next.pdf as f64 } else { reverse_pdf(&vertex, next.dir, &nodes[last].vertex) };
        nodes[last].back = pdf * per_area(&vertex, &nodes[last].vertex);
    }
    None
}

/// Density per solid angle, at a vertex reached from the direction `from`, of going on to `to`. [1/sr]
fn reverse_pdf(at: &Vertex, from: Vec3, to: &Vertex) -> f64 {
    let Scatter::Surface(x) = at.scatter else { return at.pdf_sa(direction(at, to)) as f64 };
    let mode = if x.mode == Mode::Radiance { Mode::Importance } else { Mode::Radiance };
    let seen = Vertex { p: at.p, scatter: Scatter::Surface(SurfacePoint { wi: from, mode, ..x }) };
    seen.pdf_sa(direction(at, to)) as f64
}
