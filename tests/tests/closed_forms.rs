//! Scenes whose radiance is known exactly, by every method that can render them.
//!
//! Family-wise significance 0.01 by Holm within each test; seeds are fixed, so a test that passes always passes.

use manylight_framework::{Compensation, Probe};
use manylight_integration::rooms::{
    self, ball_light, disc_light, furnace, hollow_ball, hollow_cube, lantern, plane_under,
};
use manylight_integration::{block_runs, pass, recipe};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_math::{Spectrum, Vec3};
use manylight_scene::{Emitter, Scene};
use manylight_stats::{BlockTest, Reference};
use manylight_vpl::{Emission, Emitters, Keller, Points, Sum};

const IR: &str = "instant-radiosity";

/// Every block and channel has the exact mean `truth`. Where an estimator has no noise but rounding, that is asked of each pass.
fn holds(scene: &Scene, method: &str, params: &[&str], passes: u64, truth: Spectrum) {
    let recipe = recipe(method, params, scene);
    let runs = block_runs(scene, &*recipe.method, recipe.spp, 1, passes, 2);
    let exact: Vec<f64> = (0..runs.blocks()).map(|i| truth.to_array()[i % 3] as f64).collect();
    let right = |row: &Vec<f64>| row.iter().zip(&exact).all(|(x, t)| (x - t).abs() <= NOISELESS * t);
    if runs.rows().iter().all(right) {
        println!("{method} {params:?}: no noise, each pass within {NOISELESS}");
        return;
    }
    let test = BlockTest { rounding: ROUNDING, ..BlockTest::default() };
    let verdict = test.run(&runs, Reference::Exact(&exact)).unwrap();
    println!("{method} {params:?}: {verdict}");
    assert!(verdict.passes(), "{method} {params:?} against {truth:?}: {verdict}");
}
/// What means over f32 sums along a path may be off by.
const ROUNDING: f64 = 5e-5;
/// What a single pass may be off by where there is no noise but that of geometry terms of near points in f32.
const NOISELESS: f64 = 1e-3;

#[test]
fn one_light_path_in_a_sphere_gives_every_truncation_exactly() {
    // G is 1 / (4 R^2) for every pair of points, so with uniform emission every contribution is the same number, and a single
    // path without roulette has no variance at all: L_e (1 + rho + .. + rho^(k-1)) for paths of up to k edges.
    for (radius, rho) in
        [(1.0f32, Spectrum::gray(0.5)), (1e-4, Spectrum::rgb(0.5, 0.2, 0.0)), (1e4, Spectrum::rgb(0.9, 0.5, 0.1))]
    {
        let scene = furnace(hollow_ball(radius), radius as f64, rho, Spectrum::ONE, (16, 16));
        for k in 1..=6u32 {
            let keller = Keller { paths: 1, max_edges: Some(k), certain_edges: 99, emission: Emission::Full };
            let method = ManyLights {
                generator: Box::new(Sum(vec![Box::new(keller), Box::new(Emitters { paths: 1 })])),
                plan: All,
                kernel: Points,
                bounding: manylight_compensation::BoundPlan::NONE,
                compensation: Compensation::None,
                max_edges: k,
                min_edges: 1,
                sharp: 0.0,
            };
            let truth = (0..k).fold([0.0f64; 3], |sum, j| {
                let c = rho.to_array();
                [0, 1, 2].map(|i| sum[i] + (c[i] as f64).powi(j as i32))
            });
            let (image, _) = pass(&scene, &method, 1, 7, 0);
            for p in &image.pixels {
                for (c, t) in p.to_array().iter().zip(truth) {
                    assert!((*c as f64 - t).abs() < 2e-3 * t, "R = {radius}, k = {k}: {c} is not {t}");
                }
            }
        }
    }
}

#[test]
fn a_glowing_sphere_is_a_furnace() {
    let rho = Spectrum::rgb(0.5, 0.25, 0.0);
    let truth = Spectrum::rgb(2.0, 4.0 / 3.0, 1.0);
    let scene = furnace(hollow_ball(1.0), 1.0, rho, Spectrum::ONE, (8, 8));
    holds(&scene, "path", &["spp=16"], 64, truth);
    holds(&scene, "path", &["spp=16", "nee=off"], 64, truth);
    for direct in ["direct=sampled", "direct=virtual"] {
        holds(&scene, IR, &["bound=none", "paths=64", direct], 64, truth);
        holds(&scene, "power-sampling", &["bound=none", "paths=64", "samples=4", direct], 64, truth);
    }
}

#[test]
fn a_glowing_cube_is_a_furnace_and_nothing_leaks() {
    for scale in [1e-4, 1.0, 1e4] {
        let scene = furnace(hollow_cube(scale), scale, Spectrum::gray(0.6), Spectrum::rgb(1.0, 2.0, 0.0), (8, 8));
        let truth = Spectrum::rgb(2.5, 5.0, 0.0);
        holds(&scene, "path", &["spp=16"], 64, truth);
        // No pixel, not just no block: a leak would make single samples dark.
        let recipe = recipe("path", &["spp=4", "nee=off", "rr-depth=1000", "max-depth=60"], &scene);
        let (image, _) = pass(&scene, &*recipe.method, recipe.spp, 3, 0);
        for p in &image.pixels {
            assert!((p.0 - truth.0).abs().max_element() < 1e-3, "scale {scale}: {p:?}");
        }
    }
}

#[test]
fn each_path_length_in_a_furnace_has_its_power_of_the_albedo() {
    let scene = furnace(hollow_ball(2.0), 2.0, Spectrum::gray(0.5), Spectrum::ONE, (8, 8));
    for k in 1..=5u32 {
        let truth = Spectrum::gray(0.5f32.powi(k as i32 - 1));
        let only = [format!("min-depth={k}"), format!("max-depth={k}")];
        let with = |more: &[&'static str]| -> Vec<String> {
            only.iter().cloned().chain(more.iter().map(|m| m.to_string())).collect()
        };
        for (method, params) in [
            ("path", with(&["spp=16"])),
            (IR, with(&["bound=none", "paths=64", "direct=sampled"])),
            (IR, with(&["bound=none", "paths=64", "direct=virtual"])),
        ] {
            let params: Vec<&str> = params.iter().map(String::as_str).collect();
            holds(&scene, method, &params, 48, truth);
        }
    }
}

#[test]
fn a_lantern_in_a_sphere() {
    let scene = lantern(0.5, (8, 8));
    let inv_pi = std::f32::consts::FRAC_1_PI;
    let (direct, all) = (Spectrum::gray(0.5 * inv_pi), Spectrum::gray(inv_pi));
    holds(&scene, "path", &["spp=16"], 64, all);
    holds(&scene, "path", &["max-depth=2"], 4, direct);
    for params in [["direct=sampled", "paths=64"], ["direct=virtual", "paths=64"]] {
        holds(&scene, IR, &[&params[..], &["bound=none"]].concat(), 64, all);
        holds(&scene, IR, &[&params[..], &["bound=none", "max-depth=2"]].concat(), 8, direct);
    }
    holds(&scene, IR, &["direct=only"], 4, direct);
}

#[test]
fn lights_over_a_plane() {
    // [radiance of the plane] = 0.8 / pi x irradiance.
    let over_pi = 0.8 * std::f32::consts::FRAC_1_PI;
    let pi = std::f32::consts::PI;
    let disc = plane_under(disc_light, (2, 2));
    let ball = plane_under(ball_light, (2, 2));
    let point = plane_under(
        |b| b.emitter(Emitter::Point { position: Vec3::Z * 2.0, intensity: Spectrum::rgb(4.0, 2.0, 0.0) }),
        (2, 2),
    );
    let sun = plane_under(
        |b| b.emitter(Emitter::Directional { direction: Vec3::new(0.6, 0.0, -0.8), irradiance: Spectrum::ONE }),
        (2, 2),
    );
    let sky = plane_under(|b| b.emitter(Emitter::Constant { radiance: Spectrum::rgb(1.0, 0.5, 0.0) }), (2, 2));
    for (scene, truth) in [
        (&disc, Spectrum::gray(pi / 2.0)),
        (&ball, Spectrum::gray(pi / 16.0)),
        (&point, Spectrum::rgb(1.0, 0.5, 0.0)),
        (&sun, Spectrum::gray(0.8)),
        (&sky, Spectrum::rgb(pi, 0.5 * pi, 0.0)),
    ] {
        let truth = truth * over_pi;
        holds(scene, "path", &["spp=4096", "max-depth=2"], 64, truth);
        holds(scene, IR, &["spp=4096", "direct=only"], 64, truth);
        holds(scene, IR, &["direct=virtual", "max-depth=2", "bound=none", "paths=8192"], 64, truth);
    }
    // Without next-event estimation, where chance can find the light.
    holds(&disc, "path", &["spp=4096", "nee=off", "max-depth=2"], 64, Spectrum::gray(pi / 2.0 * over_pi));
    holds(&sky, "path", &["spp=4096", "nee=off", "max-depth=2"], 64, Spectrum::rgb(pi, 0.5 * pi, 0.0) * over_pi);
}

#[test]
fn the_flux_of_the_lights_is_what_the_emitter_sends_times_the_albedo() {
    let rho = 0.5f64;
    let scene = furnace(hollow_ball(1.5), 1.5, Spectrum::gray(rho as f32), Spectrum::ONE, (1, 1));
    let keller = Keller { paths: 20_000, max_edges: None, certain_edges: 1, emission: Emission::Full };
    let mut probe = Probe::default();
    let batch = manylight_framework::Generator::generate(&keller, &scene, 0, 5, &mut probe).unwrap();
    let emitted = std::f64::consts::PI * scene.area();
    for j in 1..=5 {
        let flux: f64 = batch.lights.iter().filter(|l| l.edges == j).map(|l| l.flux.luminance() as f64).sum();
        let expected = emitted * rho.powi(j as i32 - 1);
        // Each survives by a coin of probability rho: a relative standard error of sqrt((1 - p) / (p N)), p = rho^(j-1).
        let p = rho.powi(j as i32 - 1);
        let sigma = expected * ((1.0 - p) / (p * 20_000.0)).sqrt();
        assert!(
            (flux - expected).abs() <= 3.3 * sigma + 1e-4 * expected,
            "after {j} edges: {flux} W, expected {expected}"
        );
    }
    // 1 / (1 - rho) lights a path.
    let each = batch.lights.len() as f64 / 20_000.0;
    assert!((each - 2.0).abs() < 0.04, "{each} lights a path");
    assert_eq!(probe.light_paths, 20_000);
}

#[test]
fn a_repeated_seed_repeats_the_pass_and_another_does_not() {
    let scene = lantern(0.5, (8, 8));
    let r = recipe(IR, &["paths=8"], &scene);
    let image = |seed, p| pass(&scene, &*r.method, 1, seed, p).0;
    assert_eq!(image(1, 0), image(1, 0));
    assert_ne!(image(1, 0), image(2, 0));
    assert_ne!(image(1, 0), image(1, 1));
}

#[test]
fn without_light_every_method_gives_black_and_no_error() {
    let mut b = Scene::builder();
    let material = rooms::diffuse(&mut b, Spectrum::gray(0.5));
    rooms::place(&mut b, hollow_ball(1.0), material, None);
    b.camera(rooms::camera(manylight_math::DVec3::ZERO, manylight_math::DVec3::X, 60.0, (4, 4)));
    let scene = rooms::built(b);
    for m in manylight_recipes::methods() {
        let r = recipe(m.name, &[], &scene);
        assert!(r.warnings.iter().any(|w| w.contains("emits")), "{}: {:?}", m.name, r.warnings);
        let (image, _) = pass(&scene, &*r.method, 1, 1, 0);
        assert!(image.pixels.iter().all(|p| p.is_black()), "{}", m.name);
    }
}

#[test]
fn a_sky_and_a_lamp_are_weighed_alike_at_any_scale() {
    // A floor under a constant sky and a point light: the sky brings radiance rho L, the light rho / pi I / h^2. Drawn by power
    // from the lights of both, whatever the unit of length: the power of light from infinity is irradiance x area.
    for scale in [1.0f64, 100.0, 1e4] {
        let mut b = Scene::builder();
        let material = rooms::diffuse(&mut b, Spectrum::gray(0.8));
        let floor = manylight_geometry::TriangleMesh::rectangle(&manylight_math::DAffine3::from_scale(
            manylight_math::DVec3::splat(5.0 * scale),
        ));
        rooms::place(&mut b, manylight_geometry::ShapeGeometry::Mesh(floor), material, None);
        b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
        let h = 2.0 * scale as f32;
        b.emitter(Emitter::Point { position: Vec3::Z * h, intensity: Spectrum::gray(h * h) });
        let eye = manylight_math::DVec3::new(3.0, 0.0, 0.5) * scale;
        b.camera(rooms::camera(eye, manylight_math::DVec3::ZERO, 0.005, (4, 4)));
        let scene = rooms::built(b);
        let truth = Spectrum::gray(0.8 + 0.8 * std::f32::consts::FRAC_1_PI);
        holds(
            &scene,
            "power-sampling",
            &["direct=virtual", "max-depth=2", "bound=none", "paths=4096", "samples=64"],
            100,
            truth,
        );
    }
}
