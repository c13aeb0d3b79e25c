//! Light that arrives at the camera from wherever: its place on the film, and the pixels whose filters reach it.

use manylight_math::{Ray, Spectrum, Vec2};
use manylight_scene::{Camera, EmitterPoint, Filter, Scatter, Vertex};

/// The camera as the end of light paths.
#[derive(Clone, Copy)]
pub(crate) struct Lens {
    camera: Camera,
    filter: Filter,
    /// Integral of the filter along an axis. \[pixel\]
    width: f64,
}

impl Lens {
    pub fn new(camera: Camera, filter: Filter) -> Self {
        const CELLS: usize = 4096;
        let (r, cell) = (filter.radius(), 2.0 * filter.radius() as f64 / CELLS as f64);
        let width = (0..CELLS).map(|i| filter.eval(((i as f64 + 0.5) * cell) as f32 - r) as f64 * cell).sum();
        Lens { camera, filter, width }
    }
    /// As the eye path sees through it whose first ray this is: from one point of the lens.
    pub fn along(&self, ray: &Ray) -> Lens {
        Lens { camera: self.camera.at_lens_point(ray.origin), ..*self }
    }
    /// The point of the camera that sees `x`.
    pub fn eye(&self, x: &Vertex) -> Vertex {
        Vertex { p: self.camera.seen_from(x.p), scatter: Scatter::Emitter(EmitterPoint::Isotropic) }
    }
    /// Density, per area at `x`, with which camera rays over the whole image meet it: 1 / (film cos^3) cos_x / d^2. [1/m^2]
    pub fn density(&self, x: &Vertex) -> f64 {
        let Some((_, scale)) = self.camera.project(x.p) else { return 0.0 };
        let (w, h) = self.camera.size;
        let film = self.camera.pixel_area() as f64 * w as f64 * h as f64;
        let d = x.p - self.camera.seen_from(x.p);
        let across = x.normal().map_or(1.0, |n| n.dot(d.normalize_or_zero()).abs()) as f64;
        across * scale as f64 / film
    }
    /// Where it is seen \[pixel\], and what its radiant intensity [W/sr] towards the camera is to a pixel there, per light path:
    /// 1 / (d^2 cos^3 a), for a pixel of area a on the film at 1 m; 1 / a for parallel rays. `None` from behind.
    pub fn see(&self, x: &Vertex) -> Option<(Vec2, f32)> {
        let (at, scale) = self.camera.project(x.p)?;
        Some((at, scale / self.camera.pixel_area())).filter(|seen| seen.1.is_finite())
    }
    /// Could any pixel's filter reach that far?
    pub fn reaches(&self, at: Vec2) -> bool {
        let (r, (w, h)) = (self.filter.radius() - 0.5, self.camera.size);
        at.x >= -r && at.y >= -r && at.x <= w as f32 + r && at.y <= h as f32 + r
    }
    /// The pixels that a value belongs to, each with its part of it.
    pub fn splat(&self, at: Vec2, value: Spectrum, out: &mut Vec<(usize, Spectrum)>) {
        let (w, h) = (self.camera.size.0 as i64, self.camera.size.1 as i64);
        if self.filter == Filter::Box {
            let (x, y) = (at.x.floor() as i64, at.y.floor() as i64);
            if (0..w).contains(&x) && (0..h).contains(&y) {
                out.push(((y * w + x) as usize, value));
            }
            return;
        }
        let r = self.filter.radius();
        let span = |c: f32, n: i64| ((c - r - 0.5).ceil() as i64).max(0)..=((c + r - 0.5).floor() as i64).min(n - 1);
        for y in span(at.y, h) {
            for x in span(at.x, w) {
                let part =
                    self.filter.eval(at.x - x as f32 - 0.5) as f64 * self.filter.eval(at.y - y as f32 - 0.5) as f64;
                out.push(((y * w + x) as usize, value * (part / (self.width * self.width)) as f32));
            }
        }
    }
}
