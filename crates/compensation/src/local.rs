//! Local virtual lights (Davidovic et al. 2010).

use crate::{Arrival, KolligKeller};
use manylight_bsdf::Bsdf;
use manylight_framework::{
    Bounding, Claim, Compensator, Depth, Frame, FrameCompensator, Image, Onward, Pair, Pixel, Probe, TILE, collect,
};
use manylight_math::{Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, Mode, Scatter, Scene, Vertex};

/// Each pixel i of a tile continues its path by one residual step to a point y, which becomes a light of the radiance that leaves
/// it, and lights all pixels of the tile: what was lost near a corner comes from the same few surfaces for all of them. With
///
/// > D(y) = sum_i p_i(y) lost_i(y) V_i(y)    \[1/m^2\]
///
/// lights expected per area at y (p_i: density of pixel i's step; it survives by the part that was lost, 1 - keep), pixel j gets
///
/// > f_j G_j lost_j V_j L(y) / D(y).
///
/// Every visibility V asked of each pair, that is unbiased. One visibility for all, that of the pixel which made the light, is
/// what the paper does: faster, and light leaks around what stands between.
///
/// Light that leaves y by anything but a diffuse surface goes to the pixel that found it alone, as does that of pixels with mirrors
/// in between that the others do not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LocalLights {
    /// Side of a tile. \[pixel\]
    pub tile: u32,
    /// Is visibility asked of every pair?
    pub exact: bool,
}

/// At the local lights themselves all lights are asked again, as these serve many pixels; further on paths are traced.
struct Onwards(KolligKeller);
const ONWARDS: Onwards = Onwards(KolligKeller { steps: None, arrival: Arrival::Path });
impl Compensator for Onwards {
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
        self.0.residual(scene, x, at, bounding, onward, probe, s)
    }
    fn repairs(&self, bounding: Claim) -> Claim {
        self.0.repairs(bounding)
    }
    fn asks_lights(&self, level: u32) -> bool {
        level <= 1
    }
}

impl FrameCompensator for LocalLights {
    fn residual(&self, frame: &Frame, seed: u64, pass: u64, probe: &mut Probe) -> Image {
        let width = frame.gbuffer.width;
        let height = frame.gbuffer.pixels.len() / width.max(1);
        let side = self.tile.max(1) as usize;
        let across = width.div_ceil(side);
        let tiles = collect(frame.scheduler, across * height.div_ceil(side), &|t| {
            let (x0, y0) = (t % across * side, t / across * side);
            let places: Vec<usize> = (y0..(y0 + side).min(height))
                .flat_map(|y| (x0..(x0 + side).min(width)).map(move |x| y * width + x))
                .collect();
            let mut counts = Probe::default();
            let sums = self.tile(frame, &places, [seed, pass], &mut counts);
            (places, sums, counts)
        });
        let mut image = Image::new(width, height);
        for (places, sums, counts) in tiles.into_iter().flatten() {
            places.into_iter().zip(sums).for_each(|(i, v)| image.pixels[i] = v);
            probe.merge(&counts);
        }
        image
    }
    fn repairs(&self, _: Claim) -> Claim {
        if self.exact { Claim::UNBIASED } else { Claim { bias: f32::INFINITY, brightens: true, ..Claim::UNBIASED } }
    }
    fn deeper(&self) -> Option<&dyn Compensator> {
        Some(&ONWARDS)
    }
}

/// A light that a pixel of the tile has found.
struct Local {
    /// Which pixel of the tile found it.
    by: usize,
    y: Vertex,
    radiance: Spectrum,
}

impl LocalLights {
    fn tile(&self, frame: &Frame, places: &[usize], [seed, pass]: [u64; 2], probe: &mut Probe) -> Vec<Spectrum> {
        let pixels: Vec<Option<&Pixel>> = places.iter().map(|&i| frame.gbuffer.pixels[i].as_ref()).collect();
        let mut sums = vec![Spectrum::BLACK; places.len()];
        for (by, pixel) in pixels.iter().enumerate() {
            let Some(pixel) = pixel else { continue };
            if frame.scheduler.cancelled() {
                break;
            }
            let mut s = Stream::new(seed, [pass, places[by] as u64, 0], Purpose::FRAME);
            if let Some(light) = found(frame, pixel, by, probe, &mut s) {
                self.light(frame, &pixels, &light, &mut sums, probe, &mut s);
            }
        }
        sums
    }
    /// Adds what one light brings to the pixels of its tile.
    fn light(
        &self,
        frame: &Frame,
        pixels: &[Option<&Pixel>],
        light: &Local,
        sums: &mut [Spectrum],
        probe: &mut Probe,
        s: &mut Stream,
    ) {
        let Some(maker) = pixels[light.by] else { return };
        let diffuse = diffuse_towards(&light.y, maker);
        // (pixel, f G lost throughput, density of its own step x lost), of those who can have made this light.
        let mut pairs: Vec<(usize, Spectrum, f32)> = Vec::with_capacity(pixels.len());
        for (j, pixel) in pixels.iter().enumerate() {
            let Some(pixel) = pixel else { continue };
            let shared = diffuse && pixel.edges == maker.edges && diffuse_towards(&light.y, pixel);
            if j != light.by && !shared {
                continue;
            }
            let Some((value, density)) = step_to(pixel, &light.y, frame.bounding) else { continue };
            // The maker has seen y; but through a mask only with a probability.
            let ask = self.exact && (j != light.by || frame.scene.has_masks());
            let clear = if ask {
                probe.shadow_rays += 1;
                let edge = Edge::Between(pixel.vertex.end(), light.y.end());
                frame.scene.transmittance(&edge, s).largest()
            } else {
                1.0
            };
            if clear > 0.0 {
                pairs.push((j, value * clear, density * clear));
            }
        }
        let together: f64 = pairs.iter().map(|p| p.2 as f64).sum();
        if !(together > 0.0) {
            return;
        }
        for (j, value, _) in pairs {
            sums[j] += value * light.radiance * (1.0 / together) as f32;
        }
    }
}

/// One residual step of a pixel, and what leaves the surface that it finds.
fn found(frame: &Frame, pixel: &Pixel, by: usize, probe: &mut Probe, s: &mut Stream) -> Option<Local> {
    let (x, scene) = (&pixel.vertex, frame.scene);
    if !frame.onward.allows(pixel.edges.saturating_add(2)) {
        return None;
    }
    let next = x.sample(s.next_f32(), s.next_2d()).filter(|n| !n.delta)?;
    let mut ray = x.leave(next.dir);
    ray.t_max = ray.t_max.min((x.cosine(next.dir) / frame.bounding.cap()).sqrt());
    probe.path_rays += 1;
    let y = scene.intersect(&ray, Mode::Radiance).filter(Vertex::connects)?;
    let g = geometry(x, &y)?.0;
    if !(s.next_f32() < lost(g, frame.bounding)) {
        return None;
    }
    let at = Depth { edges: pixel.edges, level: 0 }.step(1);
    let radiance = frame.onward.scattered(&y, at, probe, s);
    (!radiance.is_black()).then_some(Local { by, y, radiance })
}

/// What a pixel would get of unit radiance at y, and the density per area \[1/m^2\] with which its own step comes there and survives.
fn step_to(pixel: &Pixel, y: &Vertex, bounding: &dyn Bounding) -> Option<(Spectrum, f32)> {
    let x = &pixel.vertex;
    let (g, w, per_area) = geometry(x, y)?;
    let lost = lost(g, bounding);
    let density = x.pdf_sa(w) * per_area * lost;
    (density > 0.0).then(|| (x.lobe_at(w) * pixel.throughput * (g * lost), density))
}

/// G, the direction from x to y, and the solid angle of an area at y. `None` if the points coincide.
fn geometry(x: &Vertex, y: &Vertex) -> Option<(f32, Vec3, f32)> {
    let d = y.p - x.p;
    let d2 = d.length_squared();
    if !(d2 > 1e-30) {
        return None;
    }
    let w = d / d2.sqrt();
    let per_area = y.normal().map_or(1.0, |n| n.dot(w).abs()) / d2;
    Some((x.cosine(w) * per_area, w, per_area))
}

fn lost(g: f32, bounding: &dyn Bounding) -> f32 {
    1.0 - bounding.keep(&Pair { g, lobes: None })
}

/// Does y send a pixel the same radiance as the one that found it? It does if it is diffuse and seen from the same side.
fn diffuse_towards(y: &Vertex, pixel: &Pixel) -> bool {
    let Scatter::Surface(point) = &y.scatter else { return false };
    let w = (pixel.vertex.p - y.p).normalize_or_zero();
    let same = |n: Vec3| n.dot(w) * n.dot(point.wi) > 0.0;
    matches!(point.bsdf, Bsdf::Diffuse(_)) && same(point.ng) && same(point.frame.n)
}

/// Tiles of the film are a multiple of it.
pub(crate) const DEFAULT_TILE: u32 = TILE as u32 / 2;

impl Default for LocalLights {
    fn default() -> Self {
        LocalLights { tile: DEFAULT_TILE, exact: true }
    }
}
