//! Bidirectional path tracing (Lafortune and Willems 1993, Veach and Guibas 1994), and light tracing as one of its strategies.

use crate::Combine;
use crate::splat::Lens;
use crate::subpath::{Node, direction, emission_density, per_area, walk};
use crate::weights::Ways;
use manylight_framework::{Claim, Film, Integrator, PassError, PathClasses, Probe, Promise, TILE};
use manylight_math::{Ray, Spectrum};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, EmitterPoint, EmitterSample, Mode, Scatter, Scene, Vertex};
use std::sync::Mutex;

/// For each camera sample one light path, and every way to join the two: s vertices of the one, t of the other. Surfaces only.
#[derive(Clone, Copy, Debug)]
pub struct BidirectionalPathTracer {
    /// Longest path, in edges; `u32::MAX`: no limit.
    pub max_edges: u32,
    /// Shortest path that counts, in edges.
    pub min_edges: u32,
    /// Edges before Russian roulette begins, on either side.
    pub certain_edges: u32,
    /// What becomes of the strategies.
    pub combine: Combine,
}

impl Default for BidirectionalPathTracer {
    fn default() -> Self {
        BidirectionalPathTracer { max_edges: u32::MAX, min_edges: 1, certain_edges: 5, combine: Combine::Balance }
    }
}

impl Promise for BidirectionalPathTracer {
    fn claim(&self) -> Claim {
        match self.combine {
            Combine::Balance | Combine::Power => Claim::UNBIASED,
            // What a mirror shows no light path reaches the pinhole through.
            Combine::LightTracing => Claim { misses: PathClasses::MIRRORED, ..Claim::UNBIASED },
            // Of one strategy nothing is promised but the paths that it can make.
            Combine::Alone(..) => Claim { noisy: true, finite_variance: false, ..Claim::DARKENS },
        }
    }
}

/// A camera sample's own value, and what it leaves elsewhere on the film.
struct Sample<'a> {
    tracer: &'a BidirectionalPathTracer,
    scene: &'a Scene,
    lens: Lens,
    own: Spectrum,
    splats: Vec<(usize, Spectrum)>,
}

impl Integrator for BidirectionalPathTracer {
    type Prepared = ();

    fn prepare(&self, _: &Scene, _: u64, _: u64, _: &mut Probe) -> Result<(), PassError> {
        Ok(())
    }
    /// One camera sample without what light paths leave elsewhere (t = 1): the rest of the pass's own.
    fn radiance(&self, scene: &Scene, _: &(), ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let lens = Lens::new(*scene.camera(), scene.filter());
        let mut light = Stream::new(s.next_u64(), [0; 3], Purpose::LIGHT_PATHS);
        self.sample(scene, &lens, ray, probe, s, &mut light).own
    }
    /// A whole pass: each pixel's own samples, and then what each left elsewhere, in the order of the tiles.
    fn render_pass(&self, scene: &Scene, _: &(), film: &mut Film, probe: &mut Probe) {
        let lens = Lens::new(film.camera, scene.filter());
        let (w, h, across) = (film.image.width, film.image.height, film.image.width.div_ceil(TILE));
        type Tile = (Vec<(usize, Spectrum)>, Vec<(usize, Spectrum)>, Probe);
        let tiles: Vec<Mutex<Option<Tile>>> = (0..across * h.div_ceil(TILE)).map(|_| Mutex::new(None)).collect();
        let (this, spp) = (&*film, film.spp);
        this.scheduler().run(tiles.len(), &|tile| {
            let (mut probe, mut pixels, mut splats) = (Probe::default(), vec![], vec![]);
            let (x0, y0) = (tile % across * TILE, tile / across * TILE);
            for y in y0..(y0 + TILE).min(h) {
                for x in x0..(x0 + TILE).min(w) {
                    let pixel = y * w + x;
                    let mut sum = Spectrum::BLACK;
                    for sample in 0..spp {
                        let mut s = this.stream(pixel, sample);
                        let mut light =
                            Stream::new(this.seed, [this.pass, pixel as u64, 1 + sample as u64], Purpose::LIGHT_PATHS);
                        let (ray, weight) = this.camera_ray(pixel, &mut s);
                        probe.camera_rays += 1;
                        let made = self.sample(scene, &lens, &ray, &mut probe, &mut s, &mut light);
                        let valid = made.own.is_valid() && made.splats.iter().all(|v| v.1.0.is_finite());
                        if valid {
                            sum += made.own * weight;
                            splats.extend(made.splats);
                        } else {
                            probe.drop_sample(this.pass, pixel, sample);
                        }
                    }
                    pixels.push((pixel, sum * (1.0 / spp as f32)));
                }
            }
            if let Ok(mut slot) = tiles[tile].lock() {
                *slot = Some((pixels, splats, probe));
            }
        });
        let mut sums = vec![[0.0f64; 3]; w * h];
        for tile in tiles {
            let Ok(Some((pixels, splats, counted))) = tile.into_inner() else { continue };
            let scaled = splats.into_iter().map(|(i, v)| (i, v * (1.0 / spp as f32)));
            for (i, value) in pixels.into_iter().chain(scaled) {
                value.to_array().iter().zip(&mut sums[i]).for_each(|(c, sum)| *sum += *c as f64);
            }
            probe.merge(&counted);
        }
        film.image.pixels = sums.into_iter().map(|s| Spectrum::from(s.map(|c| c as f32))).collect();
    }
}

impl BidirectionalPathTracer {
    fn sample<'a>(
        &'a self,
        scene: &'a Scene,
        lens: &Lens,
        ray: &Ray,
        probe: &mut Probe,
        s: &mut Stream,
        light: &mut Stream,
    ) -> Sample<'a> {
        let lens = lens.along(ray);
        let mut sample = Sample { tracer: self, scene, lens, own: Spectrum::BLACK, splats: vec![] };
        let most = |edges: u32| edges.saturating_add(1).min(1 << 16) as usize;
        let pinhole = Vertex { p: ray.origin, scatter: Scatter::Emitter(EmitterPoint::Isotropic) };
        let mut x = vec![Node::new(pinhole, Spectrum::ONE, 1.0)];
        // A light tracer sees nothing but emission.
        let eye_edges = if self.combine == Combine::LightTracing { 1 } else { self.max_edges };
        let left = walk(
            scene,
            &mut x,
            *ray,
            Spectrum::ONE,
            |_, to| lens.density(to),
            (most(eye_edges), self.certain_edges),
            Mode::Radiance,
            probe,
            s,
        );
        // The camera's own ray is counted by whoever shot it.
        probe.path_rays -= 1;
        let mut y = Vec::new();
        let mut start = None;
        probe.light_paths += 1;
        if let Some(emission) = scene.sample_emission(light) {
            let from = emission.start;
            y.push(Node::new(from.vertex, from.flux, from.density.map_or(1.0, f64::from)));
            walk(
                scene,
                &mut y,
                emission.ray,
                emission.flux,
                |from, to| emission_density(&from.vertex, direction(&from.vertex, to)) * per_area(&from.vertex, to),
                (most(self.max_edges.saturating_sub(1)), self.certain_edges),
                Mode::Importance,
                probe,
                light,
            );
            start = Some(from);
        }
        sample.emission(&x, left);
        for t in 2..=x.len() {
            sample.next_event(&x[..t], probe, s);
            for n in 2..=y.len() {
                sample.connect(&y[..n], &x[..t], start.is_some_and(|e| e.density.is_some()), probe, s);
            }
        }
        for n in 2..=y.len() {
            sample.see(&y[..n], &x[..1], start.is_some_and(|e| e.density.is_some()), probe, s);
        }
        sample
    }
}

impl Sample<'_> {
    /// Does a path of s + t - 1 edges count, made this way?
    fn counts(&self, s: usize, t: usize) -> bool {
        let edges = (s + t - 1) as u32;
        let wanted = match self.tracer.combine {
            Combine::Alone(light, eye) => (s, t) == (light as usize, eye as usize),
            Combine::LightTracing => t == 1 || edges == 1,
            _ => true,
        };
        wanted && (self.tracer.min_edges..=self.tracer.max_edges).contains(&edges)
    }
    fn weight(&self, s: usize, ways: impl FnOnce() -> Ways) -> f32 {
        match self.tracer.combine {
            Combine::Balance => ways().weight(s, 1) as f32,
            Combine::Power => ways().weight(s, 2) as f32,
            _ => 1.0,
        }
    }
    /// s = 0: emission that the eye path met, on a surface or by leaving the scene.
    fn emission(&mut self, x: &[Node], left: Option<(manylight_math::Vec3, Spectrum)>) {
        let emitters = self.scene.emitters();
        for t in 2..=x.len() {
            let hit = &x[t - 1];
            let emitted = hit.vertex.emitted();
            if emitted.is_black() || !self.counts(0, t) {
                continue;
            }
            let first = hit.vertex.emitter().map_or(0.0, |e| emitters.pdf_area(e)) as f64;
            // As a point that light starts from: one that sends by the cosine to the side that shines.
            let mut nodes = x[..t].to_vec();
            if let (Scatter::Surface(p), Some(n)) = (hit.vertex.scatter, hit.vertex.normal()) {
                let point = EmitterPoint::Lambert { n, error: p.error };
                nodes[t - 1].vertex.scatter = Scatter::Emitter(point);
            }
            self.own += hit.beta * emitted * self.weight(0, || self.ways(&[], &nodes, first, true));
        }
        let Some((dir, beta)) = left else { return };
        let emitted = self.scene.environment(dir);
        if emitted.is_black() || !self.counts(0, x.len() + 1) {
            return;
        }
        let (first, disc) = (emitters.environment_pdf_sa(dir) as f64, emitters.disc());
        let mut nodes = x.to_vec();
        let point = EmitterPoint::Distant { towards: dir, disc };
        let vertex = Vertex { p: self.scene.bounds().centre(), scatter: Scatter::Emitter(point) };
        let last = &x[x.len() - 1];
        nodes.push(Node::new(vertex, beta, last.on_to(&vertex)));
        self.own += beta * emitted * self.weight(0, || self.ways(&[], &nodes, first, true));
    }
    /// s = 1: a point of an emitter, drawn for this vertex.
    fn next_event(&mut self, x: &[Node], probe: &mut Probe, s: &mut Stream) {
        let at = &x[x.len() - 1];
        if !self.counts(1, x.len()) || !at.vertex.connects() {
            return;
        }
        let Some(EmitterSample { vertex: y, flux, density, .. }) = self.scene.sample_emitter(s) else { return };
        let node = Node::new(y, flux, density.map_or(1.0, f64::from));
        let value = at.beta * joined(&y, &at.vertex) * flux;
        let Some(value) = self.unblocked(&at.vertex, &y, value, probe, s) else { return };
        let first = node.ahead;
        self.own += value * self.weight(1, || self.ways(&[node], x, first, density.is_some()));
    }
    /// s, t >= 2.
    fn connect(&mut self, y: &[Node], x: &[Node], hit: bool, probe: &mut Probe, s: &mut Stream) {
        let (from, at) = (&y[y.len() - 1], &x[x.len() - 1]);
        if !self.counts(y.len(), x.len()) || !at.vertex.connects() || !from.vertex.connects() {
            return;
        }
        let value = at.beta * joined(&from.vertex, &at.vertex) * from.beta;
        let Some(value) = self.unblocked(&at.vertex, &from.vertex, value, probe, s) else { return };
        self.own += value * self.weight(y.len(), || self.ways(y, x, y[0].ahead, hit));
    }
    /// t = 1: the camera sees the end of a light path.
    fn see(&mut self, y: &[Node], x: &[Node], hit: bool, probe: &mut Probe, s: &mut Stream) {
        let from = &y[y.len() - 1];
        if !self.counts(y.len(), 1) || !from.vertex.connects() {
            return;
        }
        let Some((at, scale)) = self.lens.see(&from.vertex).filter(|seen| self.lens.reaches(seen.0)) else { return };
        let eye = self.lens.eye(&from.vertex);
        let value = from.beta * from.vertex.eval(direction(&from.vertex, &eye)) * scale;
        // One light path for each pixel and sample.
        let (w, h) = self.scene.camera().size;
        let value = value * (1.0 / (w as f32 * h as f32));
        let Some(value) = self.unblocked(&eye, &from.vertex, value, probe, s) else { return };
        let mut camera = [x[0]];
        camera[0].vertex = eye;
        let value = value * self.weight(y.len(), || self.ways(y, &camera, y[0].ahead, hit));
        self.lens.splat(at, value, &mut self.splats);
    }
    fn ways(&self, y: &[Node], x: &[Node], first: f64, hit: bool) -> Ways {
        Ways::new(y, x, first, hit, |v| self.lens.density(v))
    }
    /// A value, if it is any and nothing stands between.
    fn unblocked(
        &self,
        x: &Vertex,
        y: &Vertex,
        value: Spectrum,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Option<Spectrum> {
        if value.is_black() {
            return None;
        }
        let edge = match y.scatter {
            Scatter::Emitter(EmitterPoint::Distant { towards, .. }) => Edge::ToInfinity(x.end(), towards),
            _ => Edge::Between(x.end(), y.end()),
        };
        probe.shadow_rays += 1;
        Some(value * self.scene.transmittance(&edge, s)).filter(|v| !v.is_black())
    }
}

/// f(y) G(x, y) f(x), unshadowed; towards infinity without the distance.
fn joined(y: &Vertex, x: &Vertex) -> Spectrum {
    let w = direction(x, y);
    let distance2 = match y.scatter {
        Scatter::Emitter(EmitterPoint::Distant { .. }) => 1.0,
        _ => (y.p - x.p).length_squared(),
    };
    if !(distance2 > f32::MIN_POSITIVE) {
        return Spectrum::BLACK;
    }
    x.eval(w) * y.eval(-w) * (1.0 / distance2)
}
