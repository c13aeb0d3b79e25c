//! Light paths whose edges in media are ray lights.

use crate::Vrl;
use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_math::{Ray, Spectrum};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Flight, Medium, MediumPoint, Mode, Scatter, Scene, Span, Vertex};
use manylight_vpl::{Emitters, Vpl, walk_all};

/// Where a ray light ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// At the collision that the light path had, or the surface: no transmittance along it is needed.
    Short,
    /// At the surface, whatever the path did: fewer, longer rays.
    Long,
}

/// Walks N light paths: their edges in media become ray lights, their vertices on surfaces point lights. Indirect light only
/// (light scattered once in a medium is direct), unless points of the emitters are drawn too.
#[derive(Clone, Copy, Debug)]
pub struct RayWalk {
    /// N.
    pub paths: u64,
    /// Longest path from emitter to eye, in edges; `None`: no limit.
    pub max_edges: Option<u32>,
    /// Edges before Russian roulette may end a path: 1 plays it at every vertex.
    pub certain_edges: u32,
    /// Where ray lights end.
    pub extent: Extent,
    /// Also draws N points of the emitters, for direct light.
    pub emitters: bool,
}

/// From this edge on the roulette never lets everything through, so that a walk ends even in white fog.
const WHITE_EDGES: u32 = 16;
const SURVIVAL: f32 = 0.95;
/// Beyond this optical depth nothing arrives: rays to infinity are cut there.
const OPAQUE: f32 = 60.0;

enum Light {
    Point(Vpl),
    Ray(Vrl),
}

impl Promise for RayWalk {
    fn claim(&self) -> Claim {
        Claim { misses: PathClasses::CAUSTICS, ..Claim::UNBIASED }
    }
}

impl Generator for RayWalk {
    type Lights = (Vec<Vpl>, Vec<Vrl>);
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Self::Lights>, GenerateError> {
        let made = walk_all(self.paths, probe, |path, probe, out| {
            self.walk(scene, &mut Stream::new(seed, [pass, path, 0], Purpose::LIGHT_PATHS), probe, out);
        })?;
        probe.lights += made.len() as u64;
        let (mut points, mut rays) = (Vec::new(), Vec::new());
        for light in made {
            match light {
                Light::Point(l) => points.push(l),
                Light::Ray(l) => rays.push(l),
            }
        }
        if self.emitters {
            points.extend(Emitters { paths: self.paths }.generate(scene, pass, seed, probe)?.lights);
        }
        Ok(Batch { lights: (points, rays), paths: self.paths, covers_direct: self.emitters })
    }
}

impl RayWalk {
    fn walk(&self, scene: &Scene, s: &mut Stream, probe: &mut Probe, out: &mut Vec<Light>) {
        probe.light_paths += 1;
        let Some(emission) = scene.sample_emission(s) else { return };
        let (mut ray, mut flux) = (emission.ray, emission.flux);
        let start = flux.luminance();
        let share = 1.0 / self.paths as f32;
        // The connection and the eye's own edge come on top.
        let longest = self.max_edges.map_or(u32::MAX, |m| m.saturating_sub(2));
        for edges in 1..=longest {
            if !flux.is_valid() {
                probe.broken_paths += 1;
                return;
            }
            if flux.is_black() {
                return;
            }
            probe.path_rays += 1;
            let surface = scene.intersect(&ray, Mode::Importance);
            let length = surface.map_or(f32::INFINITY, |x| (x.p - ray.origin).length());
            let light = |ray: Ray, flux: Spectrum, medium: &Medium, channels| {
                let ray = Ray { t_max: ray.t_max.min(medium.reach(&ray, OPAQUE)), ..ray };
                let span = Span { ray, scattering_max: medium.scattering_max(), phase: medium.phase() };
                let l = Vrl { span, flux: flux * share, edges, channels };
                let worth = ray.t_max > 0.0 && !(l.flux * span.scattering_max).is_black();
                worth.then_some(Light::Ray(l))
            };
            let mut collision = None;
            // What a long ray has left, whatever happened to the path.
            let mut arriving = flux;
            for run in scene.runs(&Ray { t_max: length, ..ray }) {
                let Some(medium) = scene.medium(run.medium) else { continue };
                let part =
                    |to: f32| Ray { t_max: to - run.from, ..Ray::new(ray.at(run.from), ray.dir) }.within(run.medium);
                if self.extent == Extent::Long {
                    out.extend(light(part(run.to), arriving, medium, None));
                    arriving *= medium.transmittance(&ray, run.from, run.to, s);
                }
                if collision.is_some() {
                    continue;
                }
                let channels = Medium::channels(flux);
                let flight = medium.fly(&ray, run.from, run.to, channels, s);
                let (to, weight) = match flight {
                    Flight::Collision { t, weight } => (t, weight),
                    Flight::Passed { weight } => (run.to, weight),
                };
                if self.extent == Extent::Short {
                    // Where a flight's density is an estimate itself, T / P is not: this piece is long.
                    let short = medium.knows_flights();
                    let (end, drawn) = if short { (to, Some(channels)) } else { (run.to, None) };
                    out.extend(light(part(end), flux, medium, drawn));
                }
                flux *= weight;
                if let Flight::Collision { t, .. } = flight {
                    let phase = medium.phase();
                    let point = MediumPoint { wi: -ray.dir, scattering: Spectrum::ONE, phase, medium: run.medium };
                    collision = Some(Vertex { p: ray.at(t), scatter: Scatter::Medium(point) });
                    if self.extent == Extent::Short {
                        break;
                    }
                }
            }
            let Some(vertex) = collision.or(surface) else { return };
            if collision.is_none() && vertex.connects() && flux.luminance() > 0.0 {
                out.push(Light::Point(Vpl { vertex, flux: flux * share, edges }));
            }
            let Some(next) = vertex.sample(s.next_f32(), s.next_2d()) else { return };
            flux *= next.weight;
            if edges >= self.certain_edges {
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
}
