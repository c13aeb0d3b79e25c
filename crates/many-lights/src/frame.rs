//! The residual of a whole frame.

use crate::eye::Parts;
use manylight_framework::{
    Bounding, Depth, Film, Frame, FrameCompensator, GBuffer, Onward, Pixel, Probe, TILE, collect,
};
use manylight_math::Spectrum;
use manylight_scene::{Mode, Scene};

/// Adds to the film what a frame compensator estimates. Values that are not finite are left out and reported.
pub(crate) fn add_residual(
    compensator: &dyn FrameCompensator,
    scene: &Scene,
    bounding: &dyn Bounding,
    onward: &dyn Onward,
    sharp: f32,
    film: &mut Film,
    probe: &mut Probe,
) {
    let gbuffer = gbuffer(scene, film, onward, sharp, probe);
    let scheduler = film.scheduler();
    let frame = Frame { scene, gbuffer: &gbuffer, bounding, rendered: &film.image, onward, scheduler };
    let residual = compensator.residual(&frame, film.seed, film.pass, probe);
    if let Some(i) = film.explained {
        let at = Depth { edges: gbuffer.pixels[i].map_or(1, |p| p.edges), level: 0 };
        // Counted as if each of the samples had it, since they are told as a sum.
        probe.explain_residual(at, residual.pixels[i] * film.spp as f32);
    }
    for (i, (pixel, more)) in film.image.pixels.iter_mut().zip(residual.pixels).enumerate() {
        if more.is_finite() {
            *pixel += more;
        } else {
            probe.drop_sample(film.pass, i, 0);
        }
    }
}

/// What the first camera sample of each pixel sees, found again; behind lobes that are walked through, something of the kind.
fn gbuffer(scene: &Scene, film: &Film, onward: &dyn Onward, sharp: f32, probe: &mut Probe) -> GBuffer {
    let (width, count) = (film.image.width, film.image.pixels.len());
    let chunk = width.max(1) * TILE;
    let tasks = collect(film.scheduler(), count.div_ceil(chunk), &|task| {
        let mut probe = Probe::default();
        let places = task * chunk..((task + 1) * chunk).min(count);
        let pixels: Vec<_> = places.map(|i| first_vertex(scene, film, i, onward, sharp, &mut probe)).collect();
        (pixels, probe)
    });
    let mut pixels = Vec::with_capacity(count);
    for (task, result) in tasks.into_iter().enumerate() {
        let (mut found, counted) = result.unwrap_or_default();
        // A task that was cancelled has nothing to show.
        found.resize(chunk.min(count - task * chunk), None);
        pixels.extend(found);
        probe.merge(&counted);
    }
    GBuffer { width, pixels }
}

/// Walks through delta and sharp lobes as the eye path does, with the same camera ray.
fn first_vertex(
    scene: &Scene,
    film: &Film,
    pixel: usize,
    onward: &dyn Onward,
    sharp: f32,
    probe: &mut Probe,
) -> Option<Pixel> {
    let mut s = film.stream(pixel, 0);
    let (mut ray, weight) = film.camera_ray(pixel, &mut s);
    let (mut throughput, mut depth) = (Spectrum::gray(weight), 0.0f32);
    let shot = ray.dir;
    probe.camera_rays += 1;
    for edges in 1..=MOST_EDGES {
        if !onward.allows(edges + 1) {
            break;
        }
        let vertex = scene.intersect(&ray, Mode::Radiance)?;
        depth += (vertex.p - ray.origin).length();
        let parts = Parts::of(&vertex, sharp);
        if parts.gathers.connects() {
            let vertex = parts.gathers;
            let facing = vertex.normal().map_or(1.0, |n| n.dot(ray.dir).abs());
            // A pixel of the film at unit distance, seen from the pinhole, spread over the surface that it meets.
            let area = film.camera.area_across(shot, depth) / facing.max(1e-3);
            return Some(Pixel { vertex, edges, area, depth, throughput });
        }
        let next = parts.step(&mut s)?;
        throughput *= next.weight;
        ray = vertex.leave(next.dir);
        probe.path_rays += 1;
    }
    None
}

/// Behind a longer chain of delta lobes points are compensated one by one.
pub(crate) const MOST_EDGES: u32 = 8;
