//! Light in media: closed forms, quadratures, and methods against each other.
//!
//! Family-wise significance 0.01 by Holm within each test; seeds are fixed, so a test that passes always passes.

use manylight_compensation::BoundPlan;
use manylight_framework::{
    Bounding, Claim, Compensation, Connection, Integrator, Kernel, Pair, PassError, Probe, Promise,
};
use manylight_geometry::{Disk, ShapeGeometry, Sphere};
use manylight_integration::fogs::{endless, fog, foggy_room, part, smoky_cube};
use manylight_integration::rooms::{built, camera, diffuse, place};
use manylight_integration::{block_runs, effort, recipe};
use manylight_light_list::All;
use manylight_many_lights::{InMedia, ManyLights, Whole};
use manylight_math::{DVec3, Frame, MediumId, Ray, Spectrum, Vec3};
use manylight_reference::PathTracer;
use manylight_sampling::Stream;
use manylight_scene::{Edge, Emitter, Mode, Scene};
use manylight_stats::{BlockTest, Reference};
use manylight_vrl::{Extent, RayWalk, Rays};

/// Every block and channel of the method has the exact mean.
fn holds(what: &str, scene: &Scene, method: &str, params: &[&str], passes: u64, truth: [f64; 3]) {
    let r = recipe(method, params, scene);
    let runs = block_runs(scene, &*r.method, r.spp, 5, effort(passes), 1);
    let test = BlockTest { rounding: 1e-4, ..BlockTest::default() };
    let verdict = test.run(&runs, Reference::Exact(&truth)).unwrap();
    println!("{what}, {method} {params:?}: {verdict}");
    assert!(verdict.passes(), "{what}, {method} {params:?} against {truth:?}: {verdict}");
}
/// Both methods have the same means in 2 x 2 blocks.
fn agree(what: &str, scene: &Scene, a: (&str, &[&str], u64), b: (&str, &[&str], u64)) {
    let runs = |(method, params, passes): (&str, &[&str], u64), seed| {
        let r = recipe(method, params, scene);
        block_runs(scene, &*r.method, r.spp, seed, effort(passes), 2)
    };
    let (first, second) = (runs(a, 6), runs(b, 7));
    let verdict = BlockTest::default().run(&first, Reference::Runs(&second)).unwrap();
    println!("{what}, {} against {}: {verdict}", a.0, b.0);
    assert!(verdict.passes(), "{what}, {a:?} against {b:?}: {verdict}");
}

#[test]
fn airlight_of_a_point_is_its_integral() {
    // L = sigma_s Phi / (16 pi^2) int exp(-sigma_t (t + d(t))) / d(t)^2 dt (Sun et al. 2005; table by quadrature).
    for (sigma_t, sigma_s, d, t0, truth) in [
        (0.7f32, 0.5f32, 1.3, 2.1, 4.585106752e-4),
        (1.0, 1.0, 1.0, 0.0, 1.2241179718e-3),
        (1.0, 1.0, 1.0, 2.0, 7.1087843319e-4),
        (0.1, 0.1, 0.5, 3.0, 2.4687275458e-3),
    ] {
        let scene = endless(sigma_s / sigma_t, sigma_t, 0.0, d, t0);
        let what = format!("airlight {sigma_t} {sigma_s} {d} {t0}");
        holds(&what, &scene, "path", &["max-depth=2", "spp=64"], 64, [truth; 3]);
        holds(&what, &scene, "media-vpl", &["max-depth=2", "direct=only", "spp=64"], 64, [truth; 3]);
    }
}

#[test]
fn light_scattered_again_is_what_the_fluence_says() {
    // Orders of two and more along (-1.5, 0.7, 0) + t x, by Fourier inversion of the fluence (notes of the method).
    let scene = endless(0.8, 1.0, 0.0, 0.7, 1.5);
    let truth = [4.3381603619e-3; 3];
    holds("orders", &scene, "media-vpl", &["min-depth=3", "bound=none", "paths=512"], 128, truth);
    for rays in ["rays=short", "rays=long"] {
        holds("orders", &scene, "vrl", &["min-depth=3", "bound=none", "paths=512", rays], 128, truth);
    }
}

/// The wall behind a slab of fog that absorbs only.
#[test]
fn what_shines_through_a_slab_is_left_as_beers_law_says() {
    let mut b = Scene::builder();
    let sigma = Spectrum::rgb(0.5, 1.0, 3.0);
    let medium = fog(&mut b, Spectrum::BLACK, sigma, 0.3);
    part(&mut b, DVec3::new(-5.0, -5.0, -1.0), DVec3::new(5.0, 5.0, 1.0), medium, MediumId::VACUUM);
    let black = diffuse(&mut b, Spectrum::BLACK);
    let disc = Disk { centre: Vec3::Z * -3.0, radius: 4.0, frame: Frame::around(Vec3::Z) };
    place(&mut b, ShapeGeometry::Disk(disc), black, Some(Spectrum::ONE));
    b.camera(camera(DVec3::Z * 3.0, DVec3::ZERO, 1e-3, (4, 4)));
    let scene = built(b);
    let truth = [1.0, 2.0, 6.0].map(|x: f64| (-x).exp());
    holds("slab", &scene, "path", &["spp=256"], 64, truth);
    holds("slab", &scene, "media-vpl", &["spp=16"], 4, truth);
}

/// Half a space of isotropic fog under a sky of radiance 1, seen from above; tau = 50 is as good as infinite.
fn half_space(albedo: f32) -> Scene {
    let mut b = Scene::builder();
    let medium = fog(&mut b, Spectrum::gray(albedo), Spectrum::ONE, 0.0);
    part(&mut b, DVec3::new(-400.0, -400.0, -50.0), DVec3::new(400.0, 400.0, 0.0), medium, MediumId::VACUUM);
    b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
    b.camera(camera(DVec3::Z, DVec3::ZERO, 1e-3, (4, 4)));
    built(b)
}

#[test]
fn half_a_space_of_fog_has_chandrasekhars_albedo() {
    // By reciprocity, what it sends upwards is its plane albedo at normal incidence, 1 - sqrt(1 - alpha) H(1).
    for (albedo, truth) in [(0.5, 0.115226), (0.8, 0.285255), (0.9, 0.414947)] {
        let scene = half_space(albedo);
        holds("half space", &scene, "path", &["spp=256"], 64, [truth; 3]);
    }
}

#[test]
fn white_fog_in_a_uniform_sky_cannot_be_seen() {
    // Two touching boxes of different fogs, a box in a box, a white floor: all of it vanishes in a sky of radiance 1.
    let mut b = Scene::builder();
    let thin = fog(&mut b, Spectrum::ONE, Spectrum::rgb(0.5, 1.0, 0.0), 0.7);
    let dense = fog(&mut b, Spectrum::ONE, Spectrum::rgb(4.0, 2.0, 1.0), -0.4);
    part(&mut b, DVec3::new(-1.0, -1.0, 0.0), DVec3::new(0.0, 1.0, 1.0), thin, MediumId::VACUUM);
    part(&mut b, DVec3::new(0.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 1.0), dense, MediumId::VACUUM);
    part(&mut b, DVec3::new(-0.7, -0.3, 0.3), DVec3::new(-0.3, 0.3, 0.7), dense, thin);
    let white = diffuse(&mut b, Spectrum::ONE);
    let ball = Sphere::new(Vec3::new(0.5, 0.0, 0.5), 0.3);
    place(&mut b, ShapeGeometry::Sphere(ball), white, None);
    b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
    b.camera(camera(DVec3::new(0.0, -4.0, 2.0), DVec3::new(0.0, 0.0, 0.5), 40.0, (8, 8)));
    let scene = built(b);
    holds("white fog", &scene, "path", &["spp=64"], 64, [1.0; 3]);
    holds("white fog", &scene, "path", &["spp=64", "nee=off"], 64, [1.0; 3]);
    // Where every weight is one, there is no noise either.
    let mut b = Scene::builder();
    let grey = fog(&mut b, Spectrum::ONE, Spectrum::gray(2.0), 0.9);
    part(&mut b, DVec3::splat(-1.0), DVec3::ONE, grey, MediumId::VACUUM);
    b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
    b.camera(camera(DVec3::new(0.1, 0.2, 0.3), DVec3::X, 60.0, (8, 8)).within(grey));
    let (image, _) = manylight_integration::pass(
        &built(b),
        &*Box::new(PathTracer { next_event: false, certain_edges: u32::MAX, ..PathTracer::default() }),
        4,
        1,
        0,
    );
    for p in image.pixels {
        assert!((p.0 - Vec3::ONE).abs().max_element() < 1e-4, "{p:?}");
    }
}

/// The light that a bound keeps, of paths of three edges and more, whose first vertex may lie in a medium: by path tracing.
struct BoundedInMedia<B> {
    bounding: B,
}
impl<B: Bounding> Promise for BoundedInMedia<B> {
    fn claim(&self) -> Claim {
        Claim::UNBIASED.and(self.bounding.claim())
    }
}
impl<B: Bounding> Integrator for BoundedInMedia<B> {
    type Prepared = ();
    fn prepare(&self, _: &Scene, _: u64, _: u64, _: &mut Probe) -> Result<(), PassError> {
        Ok(())
    }
    fn radiance(&self, scene: &Scene, _: &(), ray: &Ray, probe: &mut Probe, s: &mut Stream) -> Spectrum {
        let mut kept = || -> Option<Spectrum> {
            let (x, beta) = scene.advance(ray, Mode::Radiance, Spectrum::ONE, s);
            let x = x?;
            let next = x.sample(s.next_f32(), s.next_2d())?;
            let beta = beta * next.weight;
            let (y, through) = scene.advance(&x.leave(next.dir), Mode::Radiance, beta, s);
            let (y, beta) = (y?, beta * through);
            let cosines = x.cosine(next.dir) * y.normal().map_or(1.0, |n| n.dot(next.dir).abs());
            let pair = Pair { g: cosines / (y.p - x.p).length_squared(), lobes: None };
            let direct = manylight_many_lights::direct_light(scene, &y, probe, s);
            let further = y.sample(s.next_f32(), s.next_2d()).map_or(Spectrum::BLACK, |z| {
                let rest = PathTracer { min_edges: 2, ..PathTracer::default() };
                z.weight * rest.radiance(scene, &(), &y.leave(z.dir), probe, s)
            });
            Some(beta * (direct + further) * self.bounding.keep(&pair))
        };
        kept().unwrap_or(Spectrum::BLACK)
    }
}

#[test]
fn bounded_point_lights_in_fog_are_the_bounded_path_tracer() {
    for (g, bound) in [(0.0, 2.0), (0.6, 4.0)] {
        let scene = foggy_room(g);
        let path = BoundedInMedia { bounding: manylight_compensation::Bound::Geometry(bound) };
        let truth = block_runs(&scene, &path, 32, 8, effort(64), 2);
        for params in [&["segment=span"][..], &["segment=points", "points=4"], &["lights=power", "samples=32"]] {
            let bound = format!("bound={bound}");
            let params = [&["min-depth=3", "paths=64", bound.as_str()][..], params].concat();
            let r = recipe("media-vpl", &params, &scene);
            let runs = block_runs(&scene, &*r.method, 1, 9, effort(64), 2);
            let verdict = BlockTest::default().run(&runs, Reference::Runs(&truth)).unwrap();
            println!("g = {g}, {params:?}: {verdict}");
            assert!(verdict.passes(), "g = {g}, {params:?}: {verdict}");
        }
    }
}

#[test]
fn ray_lights_in_fog_are_the_path_tracer() {
    for g in [0.0, 0.6] {
        let scene = foggy_room(g);
        let vrl = ["min-depth=3", "bound=none", "paths=64"];
        agree("fog", &scene, ("vrl", &vrl, 64), ("path", &["min-depth=3", "spp=64"], 64));
    }
    let scene = foggy_room(-0.5);
    let path = ("path", &["min-depth=3", "spp=64"][..], 64);
    for more in [&["rays=long"][..], &["lights=power", "samples=32"]] {
        agree("fog", &scene, ("vrl", &[&["min-depth=3", "bound=none", "paths=64"], more].concat(), 64), path);
    }
    let direct = ["max-depth=2", "bound=none", "paths=64", "direct=virtual"];
    agree("fog", &scene, ("vrl", &direct, 64), ("path", &["max-depth=2", "spp=64"], 64));
}

#[test]
fn direct_light_along_the_ray_is_the_path_tracers() {
    for g in [0.0, 0.9] {
        let scene = foggy_room(g);
        agree(
            "single scattering and direct light",
            &scene,
            ("media-vpl", &["direct=only", "max-depth=2", "spp=16"], 64),
            ("path", &["max-depth=2", "spp=64"], 64),
        );
    }
}

#[test]
fn methods_that_know_no_media_say_so() {
    let scene = foggy_room(0.0);
    for m in manylight_recipes::methods() {
        let built = manylight_recipes::build(m.name, &[], &scene);
        match m.name {
            "path" | "media-vpl" | "vrl" | "photon-map" | "beam-radiance" | "photon-beams" | "lgh" => {
                assert!(built.is_ok())
            }
            _ => assert!(built.err().unwrap().to_string().contains("knows nothing of them: use `path`"), "{}", m.name),
        }
    }
}

/// A kernel that errs.
#[derive(Clone, Copy)]
enum Liar {
    /// Of what a light gives, nothing is lost on the way.
    NothingIsLost,
    /// The receiver's scattering coefficient counts twice.
    ScattersTwice,
}
impl Promise for Liar {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<R, L> Kernel<R, L> for Liar
where
    Rays: Kernel<R, L>,
{
    fn connect(&self, scene: &Scene, r: &R, l: &L, s: &mut Stream) -> Option<Connection> {
        let c = Rays.connect(scene, r, l, s)?;
        let Edge::Between(a, _) = c.edge else { return Some(c) };
        Some(match self {
            Liar::NothingIsLost => Connection { edge: Edge::Between(a, a), ..c },
            Liar::ScattersTwice => {
                let sigma = if a.surface.is_some() { None } else { scene.medium(a.sides.outside) };
                Connection { value: sigma.map_or(c.value, |m| c.value * m.scattering(a.p)), ..c }
            }
        })
    }
}

#[test]
fn liars_in_fog_are_rejected() {
    let scene = foggy_room(0.0);
    let path = recipe("path", &["min-depth=3", "spp=64"], &scene);
    let truth = block_runs(&scene, &*path.method, path.spp, 12, 64, 2);
    for (kernel, name) in [(Liar::NothingIsLost, "nothing is lost"), (Liar::ScattersTwice, "scatters twice")] {
        let lights = ManyLights {
            generator: Box::new(RayWalk {
                paths: 64,
                max_edges: None,
                certain_edges: 1,
                extent: Extent::Short,
                emitters: false,
            }),
            plan: (All, All),
            kernel,
            bounding: BoundPlan::NONE,
            compensation: Compensation::None,
            max_edges: u32::MAX,
            min_edges: 3,
            sharp: 0.0,
        };
        let liar = InMedia { lights, segment: Whole };
        let verdict =
            BlockTest::default().run(&block_runs(&scene, &liar, 1, 13, 64, 2), Reference::Runs(&truth)).unwrap();
        println!("{name}: {verdict}");
        assert!(verdict.rejected(), "{name}: {verdict}");
    }
}

#[test]
fn lights_in_smoke_are_the_path_tracer() {
    let scene = smoky_cube();
    let path = ("path", &["min-depth=3", "spp=64"][..], 64);
    for rays in ["rays=short", "rays=long"] {
        agree("smoke", &scene, ("vrl", &["min-depth=3", "bound=none", "paths=48", rays], 64), path);
    }
    let direct = ["max-depth=2", "direct=only", "spp=16"];
    agree("smoke", &scene, ("media-vpl", &direct, 64), ("path", &["max-depth=2", "spp=64"], 64));
}
