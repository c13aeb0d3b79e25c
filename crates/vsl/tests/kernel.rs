//! The kernel against closed forms, quadratures over the hemisphere, and its own limit.

use manylight_bsdf::{Bsdf, Diffuse, Distribution, Mode, RoughConductor};
use manylight_framework::{Bounds, Clustered, Kernel, Promise, Reaches, VirtualLight};
use manylight_geometry::Surface;
use manylight_math::{DAffine3, Frame, Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Camera, EmitterPoint, Scatter, Scene, SurfacePoint, Vertex};
use manylight_stats::{Alternative, MeanTest, Moments};
use manylight_vpl::{Points, Vpl};
use manylight_vsl::{Sampling, SphereKernel, Vsl};
use proptest::prelude::*;

fn nothing() -> Scene {
    let mut b = Scene::builder();
    b.camera(Camera::perspective(DAffine3::IDENTITY, 45.0, (1, 1)).unwrap());
    b.build().unwrap()
}
fn surface(p: Vec3, n: Vec3, wi: Vec3, bsdf: Bsdf, mode: Mode) -> Vertex {
    let x = Surface { p, error: 1e-6, ng: n, ns: n, uv: Vec2::ZERO, dpdu: Vec3::ZERO };
    Vertex { p, scatter: Scatter::Surface(SurfacePoint::new(&x, Frame::around(n), wi, bsdf, mode)) }
}
/// Whose f is 1.
fn unit() -> Bsdf {
    Diffuse::new(Spectrum::gray(std::f32::consts::PI)).into()
}
fn metal(alpha: f32) -> Bsdf {
    let (eta, k) = (Spectrum::gray(0.2), Spectrum::gray(3.0));
    RoughConductor::new(Distribution::Ggx, alpha, alpha, eta, k, Spectrum::ONE).into()
}
fn sphere(vertex: Vertex, radius: f32) -> Vsl {
    Vsl { vpl: Vpl { vertex, flux: Spectrum::ONE, edges: 1 }, radius }
}
fn connect(kernel: &SphereKernel, x: &Vertex, l: &Vsl, s: &mut Stream, scene: &Scene) -> f32 {
    kernel.connect(scene, x, l, s).map_or(0.0, |c| c.value.luminance())
}
fn mean(sampling: Sampling, x: &Vertex, l: &Vsl, n: u64) -> Moments {
    let (scene, kernel) = (nothing(), SphereKernel { sampling, ..SphereKernel::default() });
    let mut s = Stream::new(3, [0; 3], Purpose::TEST);
    (0..n).map(|_| connect(&kernel, x, l, &mut s, &scene) as f64).collect()
}
/// 1 / (pi r^2) x the integral over the directions of the cone, by a grid over the sphere: 1 - cos evenly, so that each has the same
/// solid angle.
fn quadrature(x: &Vertex, l: &Vsl, n: u32) -> f64 {
    let (y, r) = (&l.vpl.vertex, l.radius as f64);
    let v = (y.p - x.p).as_dvec3();
    let d = v.length();
    let top = if d > r {
        let s2 = r * r / (d * d);
        s2 / (1.0 + (1.0 - s2).sqrt())
    } else {
        1.0
    };
    let frame = Frame::around((v / d).as_vec3());
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let down = top * (i as f64 + 0.5) / n as f64;
            let angle = std::f64::consts::TAU * (j as f64 + 0.5) / n as f64;
            let sin = (down * (2.0 - down)).sqrt();
            let w = Vec3::new((sin * angle.cos()) as f32, (sin * angle.sin()) as f32, (1.0 - down) as f32);
            let w = frame.to_world(w).normalize();
            sum += (x.eval(w) * y.eval(-w)).luminance() as f64;
        }
    }
    sum / (n * n) as f64 * std::f64::consts::TAU * top / (std::f64::consts::PI * r * r)
}
fn same(what: &str, a: &Moments, truth: f64) {
    let test = MeanTest::one_sample(a, truth, Alternative::Different);
    println!("{what}: {} against {truth}, p = {:.3}", a.mean(), test.p_value);
    assert!(test.p_value > 1e-3, "{what}: {} against {truth}, p = {}", a.mean(), test.p_value);
}

#[test]
fn a_lamp_faced_squarely_gives_the_irradiance_of_a_point_at_any_radius() {
    // Irradiance of an isotropic intensity 1 / (4 pi): exactly I / d^2 outside the sphere, I / r^2 inside.
    let lamp = |r| sphere(Vertex { p: Vec3::Z * 2.0, scatter: Scatter::Emitter(EmitterPoint::Isotropic) }, r);
    let x = surface(Vec3::ZERO, Vec3::Z, Vec3::Z, unit(), Mode::Radiance);
    let intensity = 1.0 / (4.0 * std::f64::consts::PI);
    for (r, d2) in [(0.02, 4.0), (0.2, 4.0), (1.0, 4.0), (1.98, 4.0), (3.0, 9.0), (10.0, 100.0)] {
        same(&format!("r = {r}"), &mean(Sampling::Mis, &x, &lamp(r), 200_000), intensity / d2);
    }
}

#[test]
fn the_corner_of_the_document() {
    // A floor point (a, 0, 0), a in (0, 1], lit by a wall light at x = 0, y in [-1, 1], z in [0, 1]; both f are 1. Averaged over both.
    let (scene, kernel) = (nothing(), SphereKernel { sampling: Sampling::Cone, ..SphereKernel::default() });
    for (r, document) in [(0.2f32, 0.3688), (0.1, 0.3953), (0.05, 0.4094), (0.025, 0.4171)] {
        let mut s = Stream::new(8, [(r * 1e3) as u64, 0, 0], Purpose::TEST);
        let draws: Moments = (0..1_000_000)
            .map(|_| {
                let a = 1.0 - s.next_f32();
                let x = surface(Vec3::X * a, Vec3::Z, Vec3::Z, unit(), Mode::Radiance);
                let u = s.next_2d();
                let y = surface(Vec3::new(0.0, 2.0 * u.x - 1.0, u.y), Vec3::X, Vec3::X, unit(), Mode::Importance);
                connect(&kernel, &x, &sphere(y, r), &mut s, &scene) as f64
            })
            .collect();
        // The document's own numbers are rounded, and from four million samples: their error is at most that of ours.
        let error = draws.std_error() * std::f64::consts::SQRT_2 + 5e-5;
        println!("r = {r}: {} +- {}, document {document}", draws.mean(), draws.std_error());
        assert!((draws.mean() - document).abs() < 3.3 * error, "r = {r}: {} against {document}", draws.mean());
        // Every value is finite and bounded: no spike.
        assert!(draws.mean() < 0.4221, "a sphere loses light at a corner, and gains none");
    }
}

#[test]
fn a_coplanar_receiver_gets_nothing() {
    let x = surface(Vec3::ZERO, Vec3::Z, Vec3::Z, unit(), Mode::Radiance);
    let l = sphere(surface(Vec3::X * 0.1, Vec3::Z, Vec3::Z, unit(), Mode::Importance), 0.5);
    for sampling in [Sampling::Cone, Sampling::Mis, Sampling::Receiver, Sampling::Light] {
        assert_eq!(mean(sampling, &x, &l, 10_000).mean(), 0.0);
    }
}

#[test]
fn nothing_leaks_through_a_sheet() {
    // A light on a partition that shines to +x, and floor points on both sides of it.
    let y = surface(Vec3::new(0.0, 0.0, 0.2), Vec3::X, Vec3::X, unit(), Mode::Importance);
    let at = |x: f32| {
        mean(Sampling::Mis, &surface(Vec3::X * x, Vec3::Z, Vec3::Z, unit(), Mode::Radiance), &sphere(y, 0.3), 2000)
    };
    assert!(at(0.05).mean() > 0.0);
    assert_eq!(at(-0.05).mean(), 0.0);
}

#[test]
fn each_way_of_sampling_has_the_mean_of_the_quadrature_and_all_together_the_least_noise() {
    let eye = Vec3::new(-0.6, 0.0, 0.8);
    let from = Vec3::new(-0.3, 0.2, -1.0).normalize();
    // Receiver's BSDF, light's BSDF, radius: outside the sphere, and inside.
    for (f, g, r) in [
        (unit(), unit(), 0.5f32),
        (metal(0.15), unit(), 0.5),
        (unit(), metal(0.15), 0.5),
        (metal(0.2), metal(0.2), 0.5),
        (metal(0.3), unit(), 0.05),
        (unit(), metal(0.3), 2.0),
    ] {
        let x = surface(Vec3::ZERO, Vec3::Z, eye, f, Mode::Radiance);
        let l = sphere(surface(Vec3::new(0.9, 0.0, 1.2), Vec3::NEG_Z, from, g, Mode::Importance), r);
        let truth = quadrature(&x, &l, 1500);
        let (cone, mis) = (mean(Sampling::Cone, &x, &l, 100_000), mean(Sampling::Mis, &x, &l, 100_000));
        same(&format!("cone, r = {r}"), &cone, truth);
        same(&format!("all, r = {r}"), &mis, truth);
        // These reach every direction of the cone: the lobes are of surfaces that face it.
        same(&format!("receiver, r = {r}"), &mean(Sampling::Receiver, &x, &l, 400_000), truth);
        same(&format!("light, r = {r}"), &mean(Sampling::Light, &x, &l, 400_000), truth);
        assert!(mis.variance() <= cone.variance() * 1.05, "{} against {}", mis.variance(), cone.variance());
    }
}

#[test]
fn as_the_radius_goes_to_zero_it_is_the_point_light() {
    let x = surface(Vec3::ZERO, Vec3::Z, Vec3::new(0.0, -0.6, 0.8), metal(0.3), Mode::Radiance);
    let y = surface(Vec3::new(0.4, 0.5, 1.0), Vec3::NEG_Z, Vec3::new(0.0, 0.6, -0.8), unit(), Mode::Importance);
    let point =
        Points.connect(&nothing(), &x, &sphere(y, 0.0).vpl, &mut Stream::new(1, [0; 3], Purpose::TEST)).unwrap();
    let truth = point.value.luminance() as f64;
    for (r, within) in [(1e-2f32, 2e-3), (1e-3, 2e-4), (1e-5, 2e-5), (1e-7, 2e-5)] {
        let m = mean(Sampling::Mis, &x, &sphere(y, r), 2000);
        assert!((m.mean() / truth - 1.0).abs() < within, "r = {r}: {} against {truth}", m.mean());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn it_is_finite_and_bounded_whatever_the_place(
        d in prop_oneof![Just(0.0f32), 1e-12f32..1e-6, 1e-3f32..10.0, 1e3f32..1e5],
        r in prop_oneof![1e-10f32..1e-4, 0.01f32..1.0, 1e2f32..1e6],
        alpha in prop_oneof![Just(0.01f32), 0.1f32..1.0],
        seed in 0u64..10_000,
    ) {
        let mut s = Stream::new(seed, [0; 3], Purpose::TEST);
        let mut dir = || warp::sphere(s.next_2d());
        let (w, n, m, eye, from) = (dir(), dir(), dir(), dir(), dir());
        let x = surface(Vec3::ZERO, n, eye, metal(alpha), Mode::Radiance);
        let y = surface(w * d, m, from, metal(alpha), Mode::Importance);
        let kernel = SphereKernel::default();
        let l = sphere(y, r);
        let mut sum = 0.0f64;
        for _ in 0..8 {
            let c = kernel.connect(&nothing(), &x, &l, &mut s);
            prop_assert!(c.is_none_or(|c| c.value.is_valid() && c.pair.g == 0.0));
            sum += c.map_or(0.0, |c| c.value.luminance() as f64);
        }
        // A cluster of one: reach promises nothing where there is something.
        if sum > 0.0 {
            prop_assert!(kernel.reach(&x, &l.cluster(), f32::INFINITY).facing_max > 0.0);
        }
    }
    /// Of clusters of several spheres, at receivers inside them too: against the quadrature, since the bound is one of the mean.
    #[test]
    fn the_bound_of_a_cluster_is_never_below_the_sum_of_its_spheres(
        spread in prop_oneof![Just(0.0f32), 0.01f32..2.0], r in 0.01f32..2.0, glossy in any::<bool>(), seed in 0u64..100_000,
    ) {
        let mut s = Stream::new(seed, [1, 0, 0], Purpose::TEST);
        let bsdf = |rough: bool| if rough { metal(0.3) } else { unit() };
        let mut dir = || warp::sphere(s.next_2d());
        let n = dir();
        let eye = dir();
        let x = surface(Vec3::ZERO, n, if eye.dot(n) < 0.0 { -eye } else { eye }, bsdf(glossy), Mode::Radiance);
        let centre = dir();
        let lights: Vec<Vsl> = (0..3)
            .map(|i| {
                let (m, from) = (dir(), dir());
                let from = if from.dot(m) < 0.0 { -from } else { from };
                sphere(surface(centre + dir() * spread, m, from, bsdf(!glossy), Mode::Importance), r * (1.0 + 0.5 * i as f32))
            })
            .collect();
        let all = lights.iter().map(Clustered::cluster).reduce(|a, b| Vsl::merge(&a, &b)).unwrap();
        let sum: f64 = lights.iter().map(|l| quadrature(&x, l, 24)).sum();
        let bound = SphereKernel::default().upper_bound(&x, &all, f32::INFINITY) as f64;
        prop_assert!(sum <= bound * 1.0001, "{sum} above {bound}");
        prop_assert!(sum == 0.0 || SphereKernel::default().reach(&x, &all, f32::INFINITY).facing_max > 0.0);
    }
}

#[test]
fn ways_that_leave_out_part_of_the_cone_say_so() {
    assert!(SphereKernel { sampling: Sampling::Mis, ..SphereKernel::default() }.claim().is_unbiased());
    assert!(!SphereKernel { sampling: Sampling::Light, ..SphereKernel::default() }.claim().is_unbiased());
    assert_eq!(sphere(surface(Vec3::ZERO, Vec3::Z, Vec3::Z, unit(), Mode::Importance), 1.0).edges(), 1);
}
