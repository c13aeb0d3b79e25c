//! Lights put where eye paths lead, and the density of that.

use crate::importance::Importon;
use crate::walk::{emission_pdf, per_area};
use crate::{Importons, Length, Step};
use manylight_framework::Probe;
use manylight_math::{Spectrum, Vec3};
use manylight_sampling::{AliasTable, Stream};
use manylight_scene::{Edge, EmitterPoint, Mode, Scatter, Scene, Vertex};

/// A vertex of a light path that light can be carried on from, its emitter's point included.
#[derive(Clone, Copy)]
pub(crate) struct Source {
    pub vertex: Vertex,
    /// alpha, not divided by the number of paths. \[W\], or [W/m^2] at infinity
    pub flux: Spectrum,
    /// 0 on the emitter.
    pub edges: u32,
    /// Luminance that the path was emitted with: what its roulette goes by. \[W\]
    pub start: f32,
}

impl Source {
    /// What it is drawn by: a flux at infinity is one per area. \[W\]
    pub fn power(&self) -> f32 {
        match self.vertex.scatter {
            Scatter::Emitter(EmitterPoint::Distant { disc, .. }) => self.flux.luminance() * disc,
            _ => self.flux.luminance(),
        }
    }
}

/// Second vertices x2 of eye paths: k of the points x1^k is picked, and a direction of its BSDF leads to x2. Given the points,
/// their density is known,
///
/// > p(x2) = mean over k of   pdf^k(x1^k -> x2) cos_x2 / |x2 - x1^k|^2  V(x1^k, x2),
///
/// over the points on that side of the surface where the light is to shine.
pub(crate) struct Reverse<'a> {
    pub scene: &'a Scene,
    pub points: Importons,
    /// How many are drawn, n.
    pub count: u64,
    /// Sources that each gathers from, m.
    pub gathers: u32,
    pub sources: &'a [Source],
    /// By which they are drawn.
    pub picks: AliasTable,
    pub length: Length,
}

impl Reverse<'_> {
    /// Density of x2 under one draw, on the side that it is seen from; 0 for what is no surface. [1/m^2]
    pub fn density(&self, x2: &Vertex, probe: &mut Probe, s: &mut Stream) -> f64 {
        let Scatter::Surface(surface) = &x2.scatter else { return 0.0 };
        let side = surface.ng * surface.ng.dot(surface.wi).signum();
        let points = self.points.points();
        let of = |x1: &Importon, probe: &mut Probe, s: &mut Stream| {
            let d = x2.p - x1.vertex.p;
            if !(side.dot(d) < 0.0) {
                return 0.0;
            }
            let pdf = x1.vertex.pdf_sa(d.normalize_or_zero()) * per_area(&x1.vertex, x2);
            if !(pdf > 0.0 && pdf.is_finite()) {
                return 0.0;
            }
            probe.shadow_rays += 1;
            // Masks let a part of the directions pass, all channels alike.
            let clear = self.scene.transmittance(&Edge::Between(x1.vertex.end(), x2.end()), s).largest();
            (pdf * clear) as f64
        };
        points.iter().map(|x1| of(x1, probe, s)).sum::<f64>() / points.len().max(1) as f64
    }
    /// How often the pair of a source and x2 is expected to be made backwards: n p(x2) m q(source). [1/m^2]
    fn backward(&self, density: f64, source: usize) -> f64 {
        self.count as f64 * density * self.gathers as f64 * self.picks.pmf(source)
    }
    /// Weight (balance heuristic: Veach and Guibas 1995) of a walk's way from a source to x2 with density `forward`.
    pub fn forward_weight(&self, x2: &Vertex, forward: f32, source: usize, probe: &mut Probe, s: &mut Stream) -> f32 {
        let backward = self.backward(self.density(x2, probe, s), source);
        let weight = (forward as f64 / (forward as f64 + backward)) as f32;
        // Without a value where the source lies in the surface itself: no eye path finds that pair.
        if weight.is_nan() { 1.0 } else { weight }
    }
    /// Draws x2, and a light there of what arrives from some of the sources. Of the directions that it arrives from one is kept,
    /// with a probability that goes with its light. Flux is that of all paths together.
    pub fn light(&self, probe: &mut Probe, s: &mut Stream) -> Option<Step> {
        let points = self.points.points();
        let x1 = points.get(s.next_below(points.len().max(1)))?;
        let next = x1.vertex.sample(s.next_f32(), s.next_2d()).filter(|n| !n.delta)?;
        probe.path_rays += 1;
        let x2 = self.scene.intersect(&x1.vertex.leave(next.dir), Mode::Radiance).filter(Vertex::connects)?;
        let density = self.density(&x2, probe, s);
        if !(density > 0.0) {
            return None; // rounding: it was found, and is not seen
        }
        let (mut sum, mut kept) = (0.0f64, None);
        for _ in 0..self.gathers {
            let i = self.picks.sample(s.next_f64());
            let Some((arrived, forward)) = self.arriving(&self.sources[i], &x2, probe, s) else { continue };
            // The balance heuristic's weight over the expected number of such pairs.
            let scale = 1.0 / (forward + self.backward(density, i));
            let arrived = Step { flux: arrived.flux * scale as f32, ..arrived };
            let value = arrived.flux.luminance() as f64;
            if !(value > 0.0 && value.is_finite()) {
                continue;
            }
            sum += value;
            if s.next_f64() * sum < value {
                kept = Some(arrived);
            }
        }
        kept.map(|k: Step| Step { flux: k.flux * (sum / k.flux.luminance() as f64) as f32, ..k })
    }
    /// The light that a source makes at x2, per area there, and the density with which its walk would have come here.
    fn arriving(&self, y: &Source, x2: &Vertex, probe: &mut Probe, s: &mut Stream) -> Option<(Step, f64)> {
        let Scatter::Surface(surface) = x2.scatter else { return None };
        let distant = match y.vertex.scatter {
            Scatter::Emitter(EmitterPoint::Distant { towards, .. }) => Some(towards),
            _ => None,
        };
        let wi = distant.unwrap_or_else(|| (y.vertex.p - x2.p).normalize_or_zero());
        // From the side that it was found from: that is what its density is of.
        let side = |w: Vec3| surface.ng.dot(w);
        if !(side(wi) * side(surface.wi) > 0.0) || y.edges >= self.length.max_edges {
            return None;
        }
        let area = per_area(&y.vertex, x2);
        let (sent, pdf) = match y.vertex.scatter {
            Scatter::Emitter(_) => (
                y.flux * if distant.is_some() { 1.0 } else { emission_pdf(&y.vertex, -wi) },
                emission_pdf(&y.vertex, -wi),
            ),
            _ => {
                let (sent, pdf) = (y.flux * y.vertex.eval(-wi), y.vertex.pdf_sa(-wi));
                (sent, pdf * if pdf > 0.0 { self.length.survival(sent * (1.0 / pdf), y.start, y.edges) } else { 0.0 })
            }
        };
        let flux = sent * area;
        if flux.is_black() || !flux.is_valid() {
            return None;
        }
        let edge = match distant {
            Some(towards) => Edge::ToInfinity(x2.end(), towards),
            None => Edge::Between(x2.end(), y.vertex.end()),
        };
        probe.shadow_rays += 1;
        let flux = flux * self.scene.transmittance(&edge, s);
        let vertex = Vertex {
            scatter: Scatter::Surface(manylight_scene::SurfacePoint { wi, mode: Mode::Importance, ..surface }),
            ..*x2
        };
        (!flux.is_black()).then(|| (Step { vertex, flux, edges: y.edges + 1, density: None }, (pdf * area) as f64))
    }
}
