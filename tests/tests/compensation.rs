//! What a bound takes away comes back: against closed forms, a quadrature and the path tracer, and with broken twins.
//!
//! Family-wise significance 0.01 by Holm within each verdict; fixed seeds. `MANYLIGHT_EFFORT=16` takes sixteen times the passes.

use manylight_compensation::BoundPlan;
use manylight_framework::{Bounding, Claim, Compensation, Compensator, Depth, Method, Onward, Pair, Probe, Promise};
use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
use manylight_integration::rooms::{built, camera, diffuse, furnace, hollow_ball, hollow_cube, place};
use manylight_integration::{block_runs, effort, our_scene, recipe};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::{Emitter, Material, Mode, Model, Scene, Source, Vertex};
use manylight_stats::{BlockTest, Reference, Runs, Verdict};
use manylight_vpl::{Emission, Keller, Points};

const KK: &str = "compensation=kollig-keller";

fn runs(scene: &Scene, params: &[&str], spp: u32, passes: u64, grid: usize) -> Runs {
    let r = recipe("many-lights", params, scene);
    block_runs(scene, &*r.method, spp, 21, passes, grid)
}
fn exactly(scene: &Scene, params: &[&str], spp: u32, passes: u64, truth: f64) -> Verdict {
    let runs = runs(scene, params, spp, passes, 1);
    let verdict =
        BlockTest { rounding: 5e-5, ..BlockTest::default() }.run(&runs, Reference::Exact(&[truth; 3])).unwrap();
    println!("{params:?} against {truth}: {verdict}");
    verdict
}
fn agree(what: &str, a: &Runs, b: &Runs) {
    let verdict = BlockTest::default().run(&a.clone().with_mean(), Reference::Runs(&b.clone().with_mean())).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}

/// The cube of `bounding_and_compensation.md`: side 1, albedo 1/2, all walls emit 1, so that radiance is 2 everywhere; seen at the
/// point (1/2, a, 0), whose distance to an edge is `a`.
fn cube(a: f64) -> Scene {
    let mut b = Scene::builder();
    let walls = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, hollow_cube(0.5), walls, Some(Spectrum::ONE)); // around the origin
    let eye = DVec3::new(0.0, 0.0, 0.2);
    b.camera(camera(eye, DVec3::new(0.0, a - 0.5, -0.5), 0.01, (2, 2)));
    built(b)
}
/// (1 / pi) integral of min(G, b) over the other walls of the cube, from the same point.
fn kept(a: f64, b: f64) -> f64 {
    let n = 800;
    let x = DVec3::new(0.5, a, 0.0);
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let (u, v) = ((i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / n as f64);
            for y in [
                DVec3::new(u, v, 1.0),
                DVec3::new(0.0, u, v),
                DVec3::new(1.0, u, v),
                DVec3::new(u, 0.0, v),
                DVec3::new(u, 1.0, v),
            ] {
                let d = y - x;
                let d2 = d.length_squared();
                // The wall's normal runs along the axis on which it lies at 0 or 1.
                let along = if y.z == 1.0 {
                    d.z
                } else if y.x == 0.0 || y.x == 1.0 {
                    d.x
                } else {
                    d.y
                };
                sum += (d.z * along.abs() / (d2 * d2)).min(b);
            }
        }
    }
    sum / (n * n) as f64 / std::f64::consts::PI
}

#[test]
fn in_a_cube_that_glows_the_bound_takes_what_a_quadrature_says_and_compensation_brings_it_back() {
    // Radiance without emission, as a fraction of the truth 1: what the document's own simulation found, to +-0.003.
    for (a, b, document) in [(0.05, 1.0, 0.818), (0.05, 10.0, 0.895), (0.01, 10.0, 0.802), (0.01, 1.0, 0.772)] {
        let scene = cube(a);
        let clamped = 0.5 + 0.5 * kept(a, b);
        assert!((clamped - document).abs() < 0.004, "a = {a}, b = {b}: quadrature {clamped}, document {document}");
        let bound = format!("bound={b}");
        let with = |more: &[&'static str]| [&[bound.as_str(), "paths=16", "min-depth=2"], more].concat();
        assert!(exactly(&scene, &with(&[]), 64, effort(48), clamped).passes());
        assert!(exactly(&scene, &with(&[]), 64, effort(48), 1.0).rejected());
        for arrival in ["arrival=lights", "arrival=path"] {
            assert!(exactly(&scene, &with(&[KK, arrival]), 64, effort(48), 1.0).passes());
        }
    }
}

#[test]
fn in_a_sphere_each_residual_step_brings_the_next_term_of_the_series() {
    // G is 1 / (4 R^2) for every pair; of it c is kept, so that m steps leave (rho (1 - c))^(m+1) of the radiance, which is 1.
    let (rho, c) = (0.5, 0.5);
    let scene = furnace(hollow_ball(1.0), 1.0, Spectrum::gray(rho as f32), Spectrum::ONE, (8, 8));
    let base = ["bound=0.125", "paths=16", "min-depth=2"];
    let left = |m: i32| f64::powi(rho * (1.0 - c), m + 1);
    assert!(exactly(&scene, &base, 1, effort(768), 1.0 - left(0)).passes());
    for m in [1, 2] {
        let steps = format!("steps={m}");
        let params = [&base[..], &[KK, "arrival=lights", &steps]].concat();
        assert!(exactly(&scene, &params, 1, effort(768), 1.0 - left(m)).passes());
    }
    // By path tracing all is continued at the steps in between, and the lights are asked at the last.
    for m in [1, 2] {
        let steps = format!("steps={m}");
        let truth = 1.0 - f64::powi(rho, m + 1) * (1.0 - c) * (1.0 - c);
        assert!(exactly(&scene, &[&base[..], &[KK, "arrival=path", &steps]].concat(), 1, effort(768), truth).passes());
    }
    for arrival in ["arrival=lights", "arrival=path"] {
        assert!(exactly(&scene, &[&base[..], &[KK, arrival]].concat(), 1, effort(768), 1.0).passes());
    }
    // Truncated at k edges: 1, 1.5, 1.75, .. less the emission.
    for k in [3u32, 4] {
        let depth = format!("max-depth={k}");
        let truth = 2.0 * (1.0 - 0.5f64.powi(k as i32)) - 1.0;
        for arrival in ["arrival=lights", "arrival=path"] {
            let params = [&base[..], &[KK, arrival, &depth]].concat();
            assert!(exactly(&scene, &params, 1, effort(768), truth).passes(), "{k} edges");
        }
    }
}

#[test]
fn any_bound_with_compensation_is_the_path_tracer() {
    for (name, size, auto, passes) in
        [("cornell-box", (16, 16), 8.0, 64), ("corner", (16, 16), 8.0, 64), ("ajar", (16, 10), 1.0, 96)]
    {
        let scene = our_scene(name, size);
        let path = recipe("path", &["min-depth=3"], &scene);
        let truth = block_runs(&scene, &*path.method, 128, 12, effort(64), 1);
        for bound in [0.0001, auto, 10.0 * auto] {
            let bound = format!("bound={bound}");
            let local = [bound.as_str(), "paths=32", "compensation=local", "min-depth=3"];
            agree(&format!("{name} {local:?}"), &runs(&scene, &local, 4, effort(passes), 1), &truth);
            for arrival in ["arrival=lights", "arrival=path"] {
                let params = [bound.as_str(), "paths=32", KK, arrival, "min-depth=3"];
                agree(&format!("{name} {params:?}"), &runs(&scene, &params, 4, effort(passes), 1), &truth);
            }
        }
    }
}

#[test]
fn local_lights_fill_the_edges_of_a_cube_that_glows() {
    let mut b = Scene::builder();
    let walls = diffuse(&mut b, Spectrum::rgb(0.5, 0.3, 0.0));
    place(&mut b, hollow_cube(0.5), walls, Some(Spectrum::ONE));
    b.camera(camera(DVec3::new(0.1, 0.0, 0.2), DVec3::new(0.5, 0.45, -0.5), 70.0, (16, 16)));
    let scene = built(b);
    let truth = [1.0, 0.3 / 0.7, 0.0];
    for tile in ["tile=1", "tile=3", "tile=16"] {
        let params = ["bound=1", "paths=16", "min-depth=2", "compensation=local", tile];
        let runs = runs(&scene, &params, 1, effort(200), 2);
        let exact: Vec<f64> = (0..runs.blocks()).map(|i| truth[i % 3]).collect();
        let test = BlockTest { rounding: 5e-5, ..BlockTest::default() };
        let verdict = test.run(&runs, Reference::Exact(&exact)).unwrap();
        println!("{params:?}: {verdict}");
        assert!(verdict.passes(), "{tile}: {verdict}");
    }
}

#[test]
fn what_is_seen_in_a_smooth_coat_is_compensated_too() {
    // A glossy floor, as plastic is, with a wall and its corner in it.
    let mut b = Scene::builder();
    let plastic = Model::Plastic {
        diffuse: Source::Constant(Spectrum::rgb(0.6, 0.4, 0.2)),
        specular: Source::Constant(Spectrum::ONE),
        int_ior: 2.5,
        ext_ior: 1.0,
        nonlinear: false,
    };
    let floor = b.material(Material::two_sided("plastic", plastic));
    let wall = diffuse(&mut b, Spectrum::gray(0.8));
    let rectangle = |m: DAffine3| ShapeGeometry::Mesh(TriangleMesh::rectangle(&m));
    place(&mut b, rectangle(DAffine3::IDENTITY), floor, None);
    let upright =
        DAffine3::from_translation(DVec3::new(-1.0, 0.0, 1.0)) * DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2);
    place(&mut b, rectangle(upright), wall, None);
    b.emitter(Emitter::Point { position: Vec3::new(0.3, 0.0, 1.5), intensity: Spectrum::ONE });
    b.camera(camera(DVec3::new(2.5, 0.0, 0.5), DVec3::new(-1.0, 0.0, 0.0), 25.0, (16, 16)));
    let scene = built(b);
    let path = recipe("path", &["min-depth=3"], &scene);
    let truth = block_runs(&scene, &*path.method, 128, 12, effort(48), 2);
    for c in [KK, "compensation=local"] {
        let params = ["bound=0.5", "paths=64", "min-depth=3", c];
        agree(&format!("{params:?}"), &runs(&scene, &params, 8, effort(100), 2), &truth);
    }
}

#[test]
fn what_the_image_shows_brings_back_most_of_what_the_bound_took() {
    // The same lights in all runs: what they vary by cancels in the differences.
    for name in ["corner", "cornell-box"] {
        let scene = our_scene(name, (64, 64));
        let mean = |r: &Runs| (0..r.blocks()).map(|b| r.moments(b).mean()).sum::<f64>();
        let with =
            |more: &[&'static str]| mean(&runs(&scene, &[&["bound=2", "paths=64"], more].concat(), 1, effort(24), 1));
        let bounded = with(&[]);
        let lost = with(&["compensation=local"]) - bounded;
        let back = |steps| (with(&["compensation=screen-space", steps]) - bounded) / lost;
        let (one, two) = (back("steps=1"), back("steps=2"));
        println!("{name}: lost {:.2} %; back after one step {one:.3}, after two {two:.3}", 100.0 * lost / bounded);
        assert!(one < two && two > 0.8 && two < 1.2, "{name}: {one} {two}");
    }
}

#[test]
fn lights_on_the_emitters_are_compensated_too() {
    // A bound that takes much of the direct light: the lamp's, and that of a point light, which no path can meet.
    let mut b = Scene::builder();
    let floor = diffuse(&mut b, Spectrum::gray(0.7));
    place(&mut b, ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(2.0)))), floor, None);
    let lamp = diffuse(&mut b, Spectrum::BLACK);
    place(
        &mut b,
        ShapeGeometry::Sphere(Sphere::new(Vec3::new(0.5, 0.2, 0.5), 0.2)),
        lamp,
        Some(Spectrum::rgb(3.0, 1.0, 0.2)),
    );
    b.emitter(Emitter::Point { position: Vec3::new(-0.6, 0.0, 0.4), intensity: Spectrum::rgb(0.1, 0.2, 0.4) });
    b.camera(camera(DVec3::new(3.0, 0.0, 2.0), DVec3::ZERO, 30.0, (16, 16)));
    let scene = built(b);
    let path = recipe("path", &[], &scene);
    let truth = block_runs(&scene, &*path.method, 64, 12, 32, 2);
    let base = ["bound=0.5", "paths=64", "direct=virtual"];
    let compensated = runs(&scene, &[&base[..], &[KK]].concat(), 8, effort(48), 2);
    agree("direct light by bounded lights, compensated", &compensated, &truth);
    let bounded = runs(&scene, &base, 4, 48, 2);
    assert!(BlockTest::default().run(&bounded, Reference::Runs(&truth)).unwrap().rejected());
}

/// A diffuse floor beside a mirror wall, under a wide lamp: the floor has a caustic.
fn mirror_room() -> Scene {
    let mut b = Scene::builder();
    let floor = diffuse(&mut b, Spectrum::rgb(0.7, 0.5, 0.3));
    let rectangle = |m: DAffine3| ShapeGeometry::Mesh(TriangleMesh::rectangle(&m));
    place(&mut b, rectangle(DAffine3::IDENTITY), floor, None);
    let silver = Model::Conductor {
        eta: Spectrum::gray(0.15),
        k: Spectrum::gray(4.0),
        reflectance: Source::Constant(Spectrum::ONE),
    };
    let mirror = b.material(Material::two_sided("mirror", silver));
    let upright =
        DAffine3::from_translation(DVec3::new(-1.0, 0.0, 1.0)) * DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2);
    place(&mut b, rectangle(upright), mirror, None);
    let black = diffuse(&mut b, Spectrum::BLACK);
    let facing = DAffine3::from_translation(DVec3::new(0.9, 0.0, 1.2))
        * DAffine3::from_rotation_y(-2.2)
        * DAffine3::from_scale(DVec3::splat(0.5));
    place(&mut b, rectangle(facing), black, Some(Spectrum::gray(4.0)));
    b.camera(camera(DVec3::new(0.5, -3.0, 2.5), DVec3::new(-0.2, 0.0, 0.0), 30.0, (16, 16)));
    built(b)
}

#[test]
fn continued_paths_make_the_caustics_that_virtual_lights_cannot() {
    let scene = mirror_room();
    let path = recipe("path", &[], &scene);
    let truth = block_runs(&scene, &*path.method, 128, 12, effort(48), 2);
    let base = ["bound=2", "paths=64"];
    let without = recipe("many-lights", &base, &scene);
    assert!(without.claim.misses != manylight_framework::PathClasses::NONE && !without.warnings.is_empty());
    let with = recipe("many-lights", &[&base[..], &[KK]].concat(), &scene);
    assert!(with.claim.misses == manylight_framework::PathClasses::NONE && with.warnings.is_empty());
    assert!(with.claim.is_unbiased(), "{}", with.claim);
    let dark = runs(&scene, &base, 8, 48, 2);
    assert!(BlockTest::default().run(&dark, Reference::Runs(&truth)).unwrap().rejected());
    for arrival in ["arrival=lights", "arrival=path"] {
        let params = [&base[..], &[KK, arrival]].concat();
        agree(&format!("{params:?}"), &runs(&scene, &params, 16, effort(64), 2), &truth);
    }
}

/// One residual step, wrong in one place; right where `lie` is `None`.
struct Liar(Option<Lie>);
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lie {
    /// Collects the emission of what it meets, which direct light has already.
    CountsEmission,
    /// Takes 1 - b / G with one cosine of G missing.
    ForgetsACosine,
    /// Goes no further than b^(-1/2) / 10.
    StopsShort,
    /// Continues by coin without dividing by its probability.
    ForgetsTheCoin,
}
impl Compensator for Liar {
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
        let told = |lie| self.0 == Some(lie);
        let Some(next) = x.sample(s.next_f32(), s.next_2d()) else { return Spectrum::BLACK };
        let mut ray = x.leave(next.dir);
        if told(Lie::StopsShort) {
            ray.t_max = 0.1 / bounding.cap().sqrt();
        }
        let Some(y) = scene.intersect(&ray, Mode::Radiance) else { return Spectrum::BLACK };
        let cos_y = if told(Lie::ForgetsACosine) { 1.0 } else { y.normal().unwrap().dot(next.dir).abs() };
        let g = x.cosine(next.dir) * cos_y / (y.p - x.p).length_squared();
        let weight = next.weight * (1.0 - bounding.keep(&Pair { g, lobes: None }));
        let survival = weight.luminance();
        if !(s.next_f32() < survival) {
            return Spectrum::BLACK;
        }
        let more = if told(Lie::CountsEmission) { y.emitted() } else { Spectrum::BLACK };
        let coin = if told(Lie::ForgetsTheCoin) { 1.0 } else { survival };
        weight * (1.0 / coin) * (onward.scattered(&y, at.step(1), probe, s) + more)
    }
    fn repairs(&self, _: Claim) -> Claim {
        Claim::UNBIASED
    }
}

#[test]
fn what_is_wrong_in_one_place_is_rejected() {
    let scene = cube(0.05);
    let verdict = |lie| {
        let keller = Keller { paths: 32, max_edges: None, certain_edges: 1, emission: Emission::Full };
        let method = ManyLights {
            generator: Box::new(keller),
            plan: All,
            kernel: Points,
            bounding: BoundPlan::fixed(1.0),
            compensation: Compensation::Point(Box::new(Liar(lie))),
            max_edges: u32::MAX,
            min_edges: 2,
            sharp: 0.0,
        };
        assert!(method.claim().is_unbiased());
        let runs = block_runs(&scene, &method as &dyn Method, 128, 9, 32, 1);
        BlockTest::default().run(&runs, Reference::Exact(&[1.0; 3])).unwrap()
    };
    assert!(verdict(None).passes(), "{}", verdict(None));
    for lie in [Lie::CountsEmission, Lie::ForgetsACosine, Lie::StopsShort, Lie::ForgetsTheCoin] {
        let v = verdict(Some(lie));
        println!("{lie:?}: {v}");
        assert!(v.rejected(), "{lie:?}: {v}");
    }
}
