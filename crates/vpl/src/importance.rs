//! What a light brings to the camera, estimated by a few of the points that it sees.

use crate::{Vpl, connect_vertices};
use manylight_framework::Probe;
use manylight_math::{Spectrum, Vec2};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Mode, Scene, Vertex};

/// Points that the camera sees, spread evenly over the image ("importons"): fresh ones each pass.
///
/// The importance of a light y is what it brings to the mean pixel, W summing up the delta lobes on the way from the eye:
///
/// > Phi(y) = mean over the points x of   W  lum( f(x) min(G(x, y), b) V(x, y) f(y) flux )
///
/// It only steers where lights are put, never what they weigh: a bounded G and a path that is cut off here bias nothing.
#[derive(Default)]
pub struct Importons {
    points: Vec<Importon>,
    /// Camera rays, those that met nothing included.
    rays: usize,
    /// b. [1/m^2]
    bound: f32,
}

/// A point that the camera sees.
#[derive(Clone, Copy)]
pub(crate) struct Importon {
    pub vertex: Vertex,
    pub throughput: Spectrum,
}

/// Delta and sharp lobes are followed so far.
const MOST_EDGES: u32 = 8;

impl Importons {
    /// About `count` points, for lights of `paths` light paths: b is that of `bound=auto`. Lobes of a roughness of at most `sharp`
    /// are followed as delta lobes are: no light will be connected to them.
    pub fn new(scene: &Scene, count: u32, paths: u64, sharp: f32, [seed, pass]: [u64; 2], probe: &mut Probe) -> Self {
        Importons::at(scene, count, paths, sharp, [seed, pass, 0], probe)
    }
    /// The same from a place of its own, `[seed, pass, which]`.
    pub(crate) fn at(scene: &Scene, count: u32, paths: u64, sharp: f32, place: [u64; 3], probe: &mut Probe) -> Self {
        let [seed, pass, which] = place;
        let (w, h) = (scene.camera().size.0 as f32, scene.camera().size.1 as f32);
        let columns = ((count.max(1) as f32 * w / h).sqrt().ceil() as usize).clamp(1, count.max(1) as usize);
        let rows = (count.max(1) as usize).div_ceil(columns);
        let rays = columns * rows;
        let mut points = Vec::with_capacity(rays);
        for i in 0..rays {
            // 2^40 and above: places that no candidate's number reaches.
            let mut s = Stream::new(seed, [pass, (1 << 40) + i as u64, which], Purpose::IMPORTANCE);
            let cell = Vec2::new((i % columns) as f32, (i / columns) as f32) + s.next_2d();
            trace(scene, cell * Vec2::new(w / columns as f32, h / rows as f32), sharp, &mut s, probe, &mut points);
        }
        let bound = (std::f64::consts::PI * paths.max(1) as f64 / scene.area()) as f32;
        Importons { points, rays, bound }
    }
    /// All points.
    pub(crate) fn points(&self) -> &[Importon] {
        &self.points
    }
    /// An estimate of Phi from about `count` of the points, and as many shadow rays at most. [W/(m^2 sr)]
    pub fn importance(&self, scene: &Scene, light: &Vpl, count: u32, probe: &mut Probe, s: &mut Stream) -> f64 {
        if self.points.is_empty() {
            return 0.0;
        }
        let count = (count.max(1) as usize).min(self.points.len());
        let mut sum = 0.0;
        for k in 0..count {
            // The points lie row by row: one out of each stratum of the image.
            let i = ((k as f64 + s.next_f64()) / count as f64 * self.points.len() as f64) as usize;
            sum += self.from(scene, &self.points[i.min(self.points.len() - 1)], light, probe, s);
        }
        sum / count as f64 * (self.points.len() as f64 / self.rays as f64)
    }
    fn from(&self, scene: &Scene, x: &Importon, light: &Vpl, probe: &mut Probe, s: &mut Stream) -> f64 {
        let Some(c) = connect_vertices(&x.vertex, &light.vertex, light.flux) else { return 0.0 };
        let keep = if c.pair.g > self.bound { self.bound / c.pair.g } else { 1.0 };
        let value = (c.value * x.throughput * keep).luminance();
        // NaN fails too.
        if !(value > 0.0 && value.is_finite()) {
            return 0.0;
        }
        probe.shadow_rays += 1;
        (value * scene.transmittance(&c.edge, s).luminance()) as f64
    }
}

/// The vertices at which an eye path gathers: the first that scatters, and those before it that have delta or sharp lobes besides.
fn trace(scene: &Scene, at: Vec2, sharp: f32, s: &mut Stream, probe: &mut Probe, points: &mut Vec<Importon>) {
    let (mut ray, mut throughput) = (scene.camera().sample_ray(at, s), Spectrum::ONE);
    for _ in 0..MOST_EDGES {
        probe.path_rays += 1;
        let Some(vertex) = scene.intersect(&ray, Mode::Radiance) else { return };
        let split = if sharp > 0.0 { vertex.split(sharp) } else { None };
        let gathers = split.map_or(vertex, |s| s.0);
        if gathers.connects() {
            points.push(Importon { vertex: gathers, throughput });
        }
        let through = split.filter(|split| s.next_f32() < split.2);
        let next = match through {
            Some((_, sharp, _)) => sharp.sample(s.next_f32(), s.next_2d()),
            None => gathers.sample(s.next_f32(), s.next_2d()).filter(|n| n.delta),
        };
        let Some(next) = next else { return };
        let chance = split.map_or(1.0, |split| if through.is_some() { split.2 } else { 1.0 - split.2 });
        throughput *= next.weight * (1.0 / chance);
        if throughput.is_black() || !throughput.is_valid() {
            return;
        }
        ray = vertex.leave(next.dir);
    }
}
