//! The traits fit media: spans of a fog as receivers, lights that are points and lights that are rays, all of them gathered by
//! a light set that knows of none of this. Against quadrature; significance 0.01 by Holm, fixed seeds.

use manylight_framework::{
    Bounding, Claim, Connection, Gather, Kernel, LightSet, Occlusion, Pair, Plan, Probe, Promise, VirtualLight,
};
use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_light_list::{All, AllLights};
use manylight_math::{Aabb, DAffine3, DVec3, MediumId, Ray, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Camera, Edge, End, HenyeyGreenstein, Material, Model, Scene, Shape, Source, Span, Vertex};
use manylight_stats::{BlockTest, Reference, Runs};

/// A fog that is the same everywhere.
struct Fog {
    /// [1/m]
    scattering: Spectrum,
    /// [1/m]
    extinction: Spectrum,
}
impl Fog {
    fn transmittance(&self, length: f32) -> Spectrum {
        self.extinction.map(|s| (-s * length).exp())
    }
}
impl Promise for Fog {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}

/// A virtual point light in the fog: scattered power at a point. [W]
#[derive(Clone, Copy)]
struct PointLight {
    at: Vertex,
    flux: Spectrum,
    edges: u32,
}
impl VirtualLight for PointLight {
    fn intensity(&self) -> f32 {
        self.flux.luminance()
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}
/// A virtual ray light: flux that runs along a span, and is scattered all along it. [W]
#[derive(Clone, Copy)]
struct RayLight {
    span: Span,
    flux: Spectrum,
    edges: u32,
}
impl VirtualLight for RayLight {
    fn intensity(&self) -> f32 {
        self.flux.luminance()
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}

impl Fog {
    /// What a vertex `y` of scattered power `flux` sends to the eye by way of the vertex `x`, which lies at `t` on the span.
    fn transport(&self, x: &Vertex, t: f32, y: &Vertex, flux: Spectrum) -> (Spectrum, Pair) {
        let d = y.p - x.p;
        let (length, w) = (d.length(), d.normalize());
        let lobes = x.lobe_at(w) * y.lobe_at(-w);
        let g = 1.0 / (length * length);
        let value = self.transmittance(t + length) * lobes * flux * g;
        (value, Pair { g, lobes: Some(lobes.largest()) })
    }
}
impl Kernel<Span, PointLight> for Fog {
    fn connect(&self, _: &Scene, r: &Span, l: &PointLight, s: &mut Stream) -> Option<Connection> {
        // Uniform along the span.
        let t = s.next_f32() * r.ray.t_max;
        let x = r.at(t, self.scattering);
        let (value, pair) = self.transport(&x, t, &l.at, l.flux);
        Some(Connection { value: value * r.ray.t_max, edge: Edge::Between(x.end(), l.at.end()), pair })
    }
}
impl Kernel<Span, RayLight> for Fog {
    fn connect(&self, _: &Scene, r: &Span, l: &RayLight, s: &mut Stream) -> Option<Connection> {
        let (t, u) = (s.next_f32() * r.ray.t_max, s.next_f32() * l.span.ray.t_max);
        let (x, y) = (r.at(t, self.scattering), l.span.at(u, self.scattering));
        let (value, pair) = self.transport(&x, t, &y, l.flux * self.transmittance(u));
        let area = r.ray.t_max * l.span.ray.t_max;
        Some(Connection { value: value * area, edge: Edge::Between(x.end(), y.end()), pair })
    }
}

/// min(G, b), or everything.
struct Cap(f32);
impl Promise for Cap {
    fn claim(&self) -> Claim {
        Claim::DARKENS
    }
}
impl Bounding for Cap {
    fn keep(&self, pair: &Pair) -> f32 {
        (self.0 / pair.g).min(1.0)
    }
    fn cap(&self) -> f32 {
        self.0
    }
}
struct Clear;
impl Occlusion for Clear {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}

const FOG: Fog = Fog { scattering: Spectrum::rgb(0.5, 0.2, 0.0), extinction: Spectrum::rgb(0.6, 0.8, 0.4) };

/// A card of side 0.25 that hides [0, 0.5] of the x axis from the point (0, 0, 1).
fn scene() -> Scene {
    let mut b = Scene::builder();
    let black = Model::Diffuse { reflectance: Source::Constant(Spectrum::BLACK) };
    let material = b.material(Material::one_sided("black", black));
    let card = DAffine3::from_translation(DVec3::new(0.125, 0.0, 0.5)) * DAffine3::from_scale(DVec3::splat(0.125));
    let geometry = ShapeGeometry::Mesh(TriangleMesh::rectangle(&card));
    b.shape(Shape { name: "card".into(), geometry, material, radiance: None });
    b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (2, 2)).unwrap());
    b.build().unwrap()
}
fn span(from: Vec3, to: Vec3, g: f32) -> Span {
    let phase = HenyeyGreenstein::new(g).unwrap();
    let ray = Ray { t_max: (to - from).length(), ..Ray::new(from, (to - from).normalize()).within(MediumId::new(0)) };
    Span { ray, scattering_max: FOG.scattering, phase }
}
fn eye() -> Span {
    span(Vec3::new(-2.0, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), 0.4)
}
/// A point light's power has its scattering coefficient in it already.
fn point() -> PointLight {
    let at = span(Vec3::Z * 3.0, Vec3::Z, 0.4).at(2.0, Spectrum::ONE);
    PointLight { at, flux: Spectrum::rgb(3.0, 2.0, 1.0), edges: 1 }
}
fn ray() -> RayLight {
    let span = span(Vec3::new(1.0, 1.0, 2.0), Vec3::new(-1.0, 0.5, 0.3), 0.4);
    RayLight { span, flux: Spectrum::rgb(1.0, 2.0, 5.0), edges: 2 }
}
type Sets = (AllLights<PointLight>, AllLights<RayLight>);
fn sets(points: Vec<PointLight>, rays: Vec<RayLight>) -> Sets {
    (All, All).build((points, rays), &Clear, &mut Stream::new(0, [0; 3], Purpose::BUILD)).unwrap()
}
/// One estimate along the span `eye`.
fn gather(scene: &Scene, sets: &Sets, cap: f32, edges: (u32, u32), s: &mut Stream) -> Spectrum {
    let (mut probe, receiver) = (Probe::default(), eye());
    let (edges_least, edges_left) = edges;
    let bounding = &Cap(cap);
    let mut ask =
        Gather { scene, receiver: &receiver, kernel: &FOG, bounding, edges_left, edges_least, probe: &mut probe };
    sets.radiance(&mut ask, s)
}
/// f64 Henyey and Greenstein for the cosine between the directions of travel.
fn phase(cos: f64) -> f64 {
    let g = 0.4f64;
    (1.0 - g * g) / (4.0 * std::f64::consts::PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}
/// In-scattering along the span from a point that emits `flux` by its phase function, written down independently.
fn in_scattered(y: DVec3, travel: DVec3, flux: [f64; 3], cap: f64, visible: impl Fn(f64) -> bool) -> [f64; 3] {
    let n = 4000;
    let mut sum = [0.0; 3];
    for i in 0..n {
        let x = -2.0 + 4.0 * (i as f64 + 0.5) / n as f64;
        if !visible(x) {
            continue;
        }
        let d = DVec3::new(x, 0.0, 0.0) - y;
        let (length, w) = (d.length(), d.normalize());
        let g = (1.0 / (length * length)).min(cap);
        // Light travels on to the eye along -x.
        let f = phase(travel.dot(w)) * phase(-w.x) * g * 4.0 / n as f64;
        for k in 0..3 {
            let (scattering, extinction) = (FOG.scattering.to_array()[k] as f64, FOG.extinction.to_array()[k] as f64);
            sum[k] += scattering * f * flux[k] * (-extinction * (x + 2.0 + length)).exp();
        }
    }
    sum
}
fn of_point(cap: f64) -> [f64; 3] {
    in_scattered(DVec3::Z, DVec3::NEG_Z, [3.0, 2.0, 1.0], cap, |x| !(0.0..=0.5).contains(&x))
}
fn of_ray(cap: f64) -> [f64; 3] {
    let (from, to) = (DVec3::new(1.0, 1.0, 2.0), DVec3::new(-1.0, 0.5, 0.3));
    let n = 400;
    let (mut sum, length) = ([0.0; 3], (to - from).length());
    for i in 0..n {
        let u = (i as f64 + 0.5) / n as f64;
        let y = from.lerp(to, u);
        let flux: [f64; 3] = std::array::from_fn(|k| {
            let (scattering, extinction) = (FOG.scattering.to_array()[k] as f64, FOG.extinction.to_array()[k] as f64);
            [1.0, 2.0, 5.0][k] * scattering * (-extinction * u * length).exp() * length / n as f64
        });
        // The card lies in y within an eighth; the segments to y >= 0.5 at half height or above pass it.
        let clear = |x: f64| {
            let t = 0.5 / y.z;
            let hit = DVec3::new(x, 0.0, 0.0).lerp(y, t);
            t > 1.0 || !((0.0..=0.25).contains(&hit.x) && hit.y.abs() <= 0.125)
        };
        let part = in_scattered(y, (to - from).normalize(), flux, cap, clear);
        (0..3).for_each(|k| sum[k] += part[k]);
    }
    sum
}
fn is(what: &str, cap: f32, sets: &Sets, truth: [f64; 3]) {
    let scene = scene();
    let row = |i| {
        let mut sum = [0.0f64; 3];
        for j in 0..200 {
            let mut s = Stream::new(2, [i, j, 0], Purpose::TEST);
            let c = gather(&scene, sets, cap, (0, u32::MAX), &mut s).to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 / 200.0);
        }
        sum.to_vec()
    };
    let runs = Runs::new((0..300).map(row).collect()).unwrap();
    let verdict = BlockTest { rounding: 1e-5, ..BlockTest::default() }.run(&runs, Reference::Exact(&truth)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
    assert!(truth[0] > 0.0 && truth[2] == 0.0, "a fog that does not scatter blue: {truth:?}");
}

#[test]
fn a_point_light_in_fog_is_what_quadrature_along_the_span_says_shadow_included() {
    is("point", f32::INFINITY, &sets(vec![point()], vec![]), of_point(f64::INFINITY));
}

#[test]
fn a_ray_light_in_fog_is_what_quadrature_along_both_says() {
    is("ray", f32::INFINITY, &sets(vec![], vec![ray()]), of_ray(f64::INFINITY));
}

#[test]
fn lights_of_both_kinds_add_and_a_bound_is_applied_at_each_sampled_point() {
    let (p, r) = (of_point(0.6), of_ray(0.6));
    assert!(p[0] < 0.95 * of_point(f64::INFINITY)[0], "the bound takes something");
    let truth = std::array::from_fn(|k| 2.0 * p[k] + r[k]);
    is("bounded", 0.6, &sets(vec![point(); 2], vec![ray()]), truth);
}

#[test]
fn depths_are_counted_along_spans_as_at_points() {
    let (scene, mut s) = (scene(), Stream::new(1, [0; 3], Purpose::TEST));
    let (only_point, only_ray) = (sets(vec![point()], vec![]), sets(vec![], vec![ray()]));
    let mut lit = |sets: &Sets, edges| (0..50).any(|_| !gather(&scene, sets, f32::INFINITY, edges, &mut s).is_black());
    // A light of e edges needs e < left, and e >= least.
    assert!(
        lit(&only_point, (0, 2)) && !lit(&only_point, (0, 1)) && lit(&only_point, (1, 2)) && !lit(&only_point, (2, 9))
    );
    assert!(lit(&only_ray, (2, 3)) && !lit(&only_ray, (0, 2)));
}

#[test]
fn a_span_is_bounded_over_its_whole_length() {
    use manylight_framework::Receiver;
    let r = eye();
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    for _ in 0..1000 {
        let y = Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * 8.0 - 4.0;
        let x = r.at(s.next_f32() * r.ray.t_max, r.scattering_max);
        assert!(r.extent().contains(x.p));
        let f = x.eval((y - x.p).normalize()).largest() * r.ray.t_max;
        assert!(f <= r.lobe(&Aabb::point(y)).with_cosine * 1.0001);
        assert!(r.guess(y) <= r.lobe(&Aabb::point(y)).with_cosine * 1.0001);
    }
    let end = r.at(0.0, r.scattering_max).end();
    assert!(matches!(end, End { surface: None, .. }) && end.towards(Vec3::X) == MediumId::new(0));
}
