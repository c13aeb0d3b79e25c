//! Compensation in screen space (Novak, Engelhardt and Dachsbacher 2011).

use manylight_framework::{Bounding, Claim, Frame, FrameCompensator, Image, Pair, Pixel, Probe, collect};
use manylight_math::{Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Scatter, Vertex};

/// The residual operator over the surfaces that the image shows, with the image itself as the light that they send:
///
/// > R_0 = image without emission,   R_{m+1}(i) = sum_j f(x_i) (1 - keep) G(x_i, x_j) R_m(j) A_j,   residual = R_1 + .. + R_M,
///
/// A_j being the surface of pixel j. The sum over the pixels within 1 / sqrt(b) of x_i is estimated by a few of them, denser
/// towards the middle, where most of what is missing comes from. No rays.
///
/// Biased: what the image does not show sends nothing, nothing stands between two pixels, and what pixel j sends is taken to be
/// the same in all directions. Neither more samples nor more passes cure that. R_0 counts paths by their edges from pixel j, so
/// that with a finite `max-depth` paths of up to M edges more come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScreenSpace {
    /// M.
    pub steps: u32,
    /// Pixels asked by each pixel and step.
    pub samples: u32,
}

impl FrameCompensator for ScreenSpace {
    fn residual(&self, frame: &Frame, seed: u64, pass: u64, _: &mut Probe) -> Image {
        let width = frame.gbuffer.width;
        let pixels = &frame.gbuffer.pixels;
        let height = pixels.len() / width.max(1);
        let mut sum = Image::new(width, height);
        let mut sent: Vec<Spectrum> = (0..pixels.len()).map(|i| scattered(frame, i)).collect();
        for step in 0..self.steps {
            let rows = collect(frame.scheduler, height, &|y| {
                let row = (0..width).map(|x| {
                    let mut s = Stream::new(seed, [pass, (y * width + x) as u64, step as u64], Purpose::FRAME);
                    self.step(frame, &sent, (x, y), &mut s)
                });
                row.collect::<Vec<_>>()
            });
            sent = rows.into_iter().flat_map(|r| r.unwrap_or_else(|| vec![Spectrum::BLACK; width])).collect();
            for ((total, more), pixel) in sum.pixels.iter_mut().zip(&sent).zip(pixels) {
                *total += *more * pixel.map_or(Spectrum::BLACK, |p| p.throughput);
            }
        }
        sum
    }
    fn repairs(&self, bounding: Claim) -> Claim {
        Claim { noisy: true, bias: f32::INFINITY, brightens: true, ..bounding }
    }
}

/// What the image shows of a pixel's surface, without its emission; black where a mirror swallows it.
fn scattered(frame: &Frame, i: usize) -> Spectrum {
    let Some(p) = &frame.gbuffer.pixels[i] else { return Spectrum::BLACK };
    let emitted = if frame.onward.counts(p.edges) { p.vertex.emitted() } else { Spectrum::BLACK };
    let (seen, through) = (frame.rendered.pixels[i].to_array(), p.throughput.to_array());
    let own = [0, 1, 2].map(|c| if through[c] > 1e-3 { seen[c] / through[c] - emitted.to_array()[c] } else { 0.0 });
    Spectrum::from(own.map(|c| c.max(0.0)))
}

/// Where the nearest neighbour begins. \[pixel\]
const NEAREST: f32 = 0.5;
/// An irrational turn spreads the directions. \[turn\]
const GOLDEN: f32 = 0.618_034;

impl ScreenSpace {
    /// One application of the residual operator at a pixel.
    fn step(&self, frame: &Frame, sent: &[Spectrum], at: (usize, usize), s: &mut Stream) -> Spectrum {
        let width = frame.gbuffer.width;
        let Some(p) = &frame.gbuffer.pixels[at.1 * width + at.0] else { return Spectrum::BLACK };
        if !frame.onward.allows(p.edges.saturating_add(2)) {
            return Spectrum::BLACK;
        }
        let Some(farthest) = self.reach(frame, p, at) else { return Spectrum::BLACK };
        let (turn, shift) = (s.next_f32(), s.next_f32());
        let centre = Vec2::new(at.0 as f32 + 0.5, at.1 as f32 + 0.5);
        let n = self.samples.max(1);
        let mut sum = Spectrum::BLACK;
        for k in 0..n {
            // The image is constant over each pixel: a point drawn with density 1 / (2 pi r (farthest - nearest)) asks its pixel.
            let r = NEAREST + (farthest - NEAREST) * (k as f32 + shift) / n as f32;
            let angle = std::f32::consts::TAU * (turn + GOLDEN * k as f32);
            let place = centre + Vec2::from_angle(angle) * r;
            if !(place.x >= 0.0 && place.y >= 0.0) {
                continue;
            }
            let (x, y) = (place.x as usize, place.y as usize);
            if x >= width || (x, y) == at {
                continue;
            }
            let j = y * width + x;
            let Some(Some(q)) = frame.gbuffer.pixels.get(j) else { continue };
            let per_density = std::f32::consts::TAU * r * (farthest - NEAREST);
            sum += lost(&p.vertex, q, frame.bounding) * sent[j] * (per_density / n as f32);
        }
        sum
    }
    /// Radius on the film in which surfaces lie that a bound can touch, those excepted that are less than half as far from the eye;
    /// `None` if there is no bound. \[pixel\]
    fn reach(&self, frame: &Frame, p: &Pixel, at: (usize, usize)) -> Option<f32> {
        let radius = 1.0 / frame.bounding.cap().sqrt();
        if !(radius > 0.0) {
            return None;
        }
        let camera = frame.scene.camera();
        // What lies nearer to the eye looks larger, up to a factor that keeps the sum from spreading over the whole image.
        let nearest = (p.depth - radius).max(0.5 * p.depth);
        // Off the axis by theta, a pixel is narrower by cos theta seen across, and by its square seen along.
        let cos = camera.forward.dot(camera.ray(Vec2::new(at.0 as f32 + 0.5, at.1 as f32 + 0.5)).dir);
        let pixels = match camera.is_parallel() {
            true => radius / camera.pixel_area().sqrt(),
            false => radius / (nearest * camera.pixel_area().sqrt() * cos * cos),
        };
        let diagonal = (camera.size.0 as f32).hypot(camera.size.1 as f32);
        Some(pixels.clamp(NEAREST + 1.0, diagonal))
    }
}

/// f(x) (1 - keep) G A_q, for the surface of pixel q: what comes back of its radiance.
fn lost(x: &Vertex, q: &Pixel, bounding: &dyn Bounding) -> Spectrum {
    let d = q.vertex.p - x.p;
    let d2 = d.length_squared();
    if !(d2 > 0.0) {
        return Spectrum::BLACK;
    }
    let w = d / d2.sqrt();
    // Only the side that the eye sees is known.
    let facing = q.vertex.normal().map_or(1.0, |n| same_side(n, q, -w));
    let g = x.cosine(w) * facing / d2;
    let part = 1.0 - bounding.keep(&Pair { g, lobes: None });
    // A pixel next to this one can have a larger form factor than there is: no surface fills more than the hemisphere.
    let form = (part * g * q.area).min(std::f32::consts::PI);
    if form > 0.0 { x.lobe_at(w) * form } else { Spectrum::BLACK }
}

/// |cos| towards `w` on the side of the surface that the eye sees; zero on the other.
fn same_side(n: Vec3, q: &Pixel, w: Vec3) -> f32 {
    let seen = match &q.vertex.scatter {
        Scatter::Surface(x) => n.dot(x.wi),
        _ => 1.0,
    };
    if n.dot(w) * seen > 0.0 { n.dot(w).abs() } else { 0.0 }
}
