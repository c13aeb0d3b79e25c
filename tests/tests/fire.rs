//! Media that emit: closed forms by the path tracer, and the lighting grid hierarchy against it.
//!
//! Family-wise significance 0.01 within each test; seeds are fixed, so a test that passes always passes.

use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_integration::rooms::{self, built, camera, diffuse, hollow_ball, place};
use manylight_integration::{block_runs, effort, our_scene, pass, recipe};
use manylight_math::{DAffine3, DVec3, MediumId, Spectrum};
use manylight_scene::{
    Boundary, Glow, Grid, HenyeyGreenstein, Heterogeneous, Homogeneous, Interpolation, Medium, Scene, SceneBuilder,
    Sides, Volume,
};
use manylight_stats::{BlockTest, Equivalence, Moments, Reference};
use rayon::prelude::*;

/// A box [lo, hi] with a medium in it.
fn filled(b: &mut SceneBuilder, lo: DVec3, hi: DVec3, inside: MediumId) {
    let placed = DAffine3::from_translation(0.5 * (lo + hi)) * DAffine3::from_scale(0.5 * (hi - lo));
    let geometry = ShapeGeometry::Mesh(TriangleMesh::cube(&placed));
    b.boundary(Boundary { name: "box".into(), geometry, sides: Sides { outside: MediumId::VACUUM, inside } });
}
fn holds(what: &str, scene: &Scene, params: &[&str], passes: u64, truth: [f64; 3]) {
    let r = recipe("path", params, scene);
    let runs = block_runs(scene, &*r.method, r.spp, 5, effort(passes), 1);
    let test = BlockTest { rounding: 1e-4, ..BlockTest::default() };
    let verdict = test.run(&runs, Reference::Exact(&truth)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what} against {truth:?}: {verdict}");
}

#[test]
fn a_slab_that_emits_and_absorbs_is_as_bright_as_its_closed_form() {
    // j (1 - exp(-sigma L)) / sigma through 2 m of it.
    let (sigma, j) = ([0.5, 1.0, 3.0], [1.0, 0.2, 4.0]);
    let truth = [0, 1, 2].map(|c| j[c] * (1.0 - f64::exp(-2.0 * sigma[c])) / sigma[c]);
    let colour = |x: [f64; 3]| Spectrum::from(x.map(|x| x as f32));
    let even = |c: [f64; 3]| {
        let placed = DAffine3::from_translation(DVec3::new(-5.0, -5.0, -1.0))
            * DAffine3::from_scale(DVec3::new(10.0, 10.0, 2.0));
        Grid::new([2, 2, 3], vec![colour(c); 12], &placed, Interpolation::Trilinear).unwrap()
    };
    let homogeneous = Homogeneous::new(Spectrum::BLACK, colour(sigma), HenyeyGreenstein::ISOTROPIC).unwrap();
    let grid =
        Heterogeneous::new(even(sigma), 1.0, Volume::Constant(Spectrum::BLACK), HenyeyGreenstein::ISOTROPIC).unwrap();
    let media = [
        Medium::from(homogeneous.emitting(colour(j)).unwrap()),
        Medium::from(grid.emitting(Glow::new(even(j), 1.0).unwrap())),
    ];
    for medium in media {
        let mut b = Scene::builder();
        let medium = b.medium(medium);
        filled(&mut b, DVec3::new(-5.0, -5.0, -1.0), DVec3::new(5.0, 5.0, 1.0), medium);
        b.camera(camera(DVec3::Z * 3.0, DVec3::ZERO, 1e-3, (4, 4)));
        let scene = built(b);
        assert!(scene.media_emit());
        holds("slab", &scene, &["spp=24"], 32, truth);
        // One edge, and no other.
        holds("slab, emission seen directly", &scene, &["spp=24", "max-depth=1"], 32, truth);
        holds("slab, light that was scattered", &scene, &["spp=1", "min-depth=2"], 4, [0.0; 3]);
        // A method of another kind sees the same of it.
        if scene.media().all(|m| m.1.homogeneous().is_none()) {
            let r = recipe("lgh", &["max-depth=1", "spp=24"], &scene);
            let runs = block_runs(&scene, &*r.method, r.spp, 6, effort(32), 1);
            let verdict =
                BlockTest { rounding: 1e-4, ..BlockTest::default() }.run(&runs, Reference::Exact(&truth)).unwrap();
            assert!(verdict.passes(), "lgh: {verdict}");
        }
    }
}

#[test]
fn a_closed_room_of_one_temperature_looks_the_same_everywhere() {
    // Walls of albedo rho emit (1 - rho) B, a medium sigma_a B: radiance is B along every ray, however light is scattered.
    let (b_, rho, albedo) = ([2.0, 1.0, 0.5], 0.6f32, 0.7f32);
    let radiance = Spectrum::from(b_.map(|x: f64| x as f32));
    let sigma = Spectrum::rgb(0.4, 0.8, 1.5);
    let mut b = Scene::builder();
    let medium = Homogeneous::new(sigma * albedo, sigma, HenyeyGreenstein::new(0.5).unwrap()).unwrap();
    let medium = b.medium(medium.emitting(radiance * sigma * (1.0 - albedo)).unwrap().into());
    let wall = diffuse(&mut b, Spectrum::gray(rho));
    place(&mut b, hollow_ball(1.5), wall, Some(radiance * (1.0 - rho)));
    b.camera(camera(DVec3::new(0.3, 0.2, -0.1), DVec3::X, 60.0, (4, 4)).within(medium));
    let scene = built(b);
    for nee in ["nee=on", "nee=off"] {
        holds(&format!("furnace, {nee}"), &scene, &["spp=64", nee], 64, b_);
    }
}

/// A turned cloud with a hot core of voxels over a floor.
fn cloud(g: f32, at: DVec3, fov: f64, size: (u32, u32)) -> Scene {
    let n = 12usize;
    let placed = DAffine3::from_translation(DVec3::new(0.0, 1.0, 0.0))
        * DAffine3::from_rotation_y(0.4)
        * DAffine3::from_translation(DVec3::splat(-0.5));
    let grid = |of: &dyn Fn(f32, usize) -> Spectrum| {
        let value = |i: usize| {
            let p = [i % n, i / n % n, i / n / n].map(|x| (x as f32 + 0.5) / n as f32 - 0.5);
            of((p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt(), i)
        };
        Grid::new([n; 3], (0..n * n * n).map(value).collect(), &placed, Interpolation::Trilinear).unwrap()
    };
    let smoke = grid(&|r, i| Spectrum::gray((1.0 - 2.2 * r).max(0.0) * (0.5 + (i * 7 % 13) as f32 / 13.0)));
    let fire = grid(&|r, i| Spectrum::rgb(1.0, 0.4, 0.1) * ((0.45 - r).max(0.0) * (i * 5 % 11) as f32));
    let phase = HenyeyGreenstein::new(g).unwrap();
    let medium = Heterogeneous::new(smoke, 4.0, Volume::Constant(Spectrum::gray(0.8)), phase).unwrap();
    let mut b = Scene::builder();
    let medium = b.medium(medium.emitting(Glow::new(fire, 2.0).unwrap()).into());
    let geometry = ShapeGeometry::Mesh(TriangleMesh::cube(
        &(placed * DAffine3::from_translation(DVec3::splat(0.5)) * DAffine3::from_scale(DVec3::splat(0.5))),
    ));
    b.boundary(Boundary { name: "cloud".into(), geometry, sides: Sides { outside: MediumId::VACUUM, inside: medium } });
    let floor = diffuse(&mut b, Spectrum::gray(0.6));
    let square = DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2) * DAffine3::from_scale(DVec3::splat(6.0));
    place(&mut b, ShapeGeometry::Mesh(TriangleMesh::rectangle(&square)), floor, None);
    // From above.
    b.camera(camera(DVec3::new(0.0, 5.0, 0.3), at, fov, size));
    built(b)
}

#[test]
fn lights_of_a_volume_light_smoke_and_floor_as_the_path_tracer_does() {
    let mean = |scene: &Scene, name: &str, params: &[&str], passes: u64| -> Moments {
        let r = recipe(name, params, scene);
        let image = |p: u64| manylight_integration::blocks(&pass(scene, &*r.method, r.spp, 1, p).0, 1);
        let rows: Vec<f64> = (0..effort(passes)).into_par_iter().map(|p| image(p).iter().sum::<f64>() / 3.0).collect();
        rows.into_iter().collect()
    };
    // The floor beside the smoke, and the smoke alone: within 4 and 6 %, shown at 0.01 for all together.
    let views = [(DVec3::X * 2.0, 20.0, 0.04), (DVec3::Y, 9.0, 0.06)].map(|(at, fov, margin)| {
        let scene = cloud(0.4, at, fov, (8, 8));
        let path = mean(&scene, "path", &["max-depth=2", "min-depth=2", "spp=768"], 48);
        (scene, path, margin)
    });
    let same = |lights: &[&str]| {
        let params: Vec<&str> = ["min-depth=2", "points=4"].into_iter().chain(lights.iter().copied()).collect();
        [0, 1].map(|i| {
            let (scene, path, margin) = &views[i];
            let (truth, mine) = (path.mean(), mean(scene, "lgh", &params, 12));
            let e = Equivalence::welch(&mine, path, margin * truth);
            let error = 100.0 * e.above_lower.std_error / truth;
            println!("{lights:?}, view {i}: {:+.2} % +- {error:.2} %", 100.0 * (mine.mean() / truth - 1.0));
            e.p_value < 0.01 / 12.0
        })
    };
    for lights in [
        &["lights=all", "spp=8"][..],
        &["alpha=4", "shadow-rays=all", "spp=6"],
        &["alpha=3", "shadow-rays=2", "spp=24"],
        &["lights=stochastic-lightcuts", "spp=24"],
    ] {
        assert_eq!(same(lights), [true; 2], "{lights:?}");
    }
    // All light from one point: the test can tell.
    assert!(!same(&["block=12", "spp=8"])[0]);
}

#[test]
fn methods_that_do_not_see_media_shine_say_so() {
    let scene = cloud(0.0, DVec3::Y, 40.0, (4, 4));
    for m in manylight_recipes::methods() {
        let built = manylight_recipes::build(m.name, &[], &scene);
        match m.name {
            "path" | "lgh" => assert!(built.is_ok(), "{}", m.name),
            _ => {
                let error = built.err().unwrap().to_string();
                assert!(error.contains("knows nothing of them") || error.contains("would leave it out"), "{error}");
            }
        }
    }
    assert_eq!(manylight_recipes::default_method(&scene), "lgh");
    // Only grids can be divided.
    let mut b = Scene::builder();
    let medium = Homogeneous::new(Spectrum::BLACK, Spectrum::ONE, HenyeyGreenstein::ISOTROPIC).unwrap();
    let medium = b.medium(medium.emitting(Spectrum::ONE).unwrap().into());
    b.camera(camera(DVec3::ZERO, DVec3::X, 60.0, (4, 4)).within(medium));
    let scene = rooms::built(b);
    let error = manylight_recipes::build("lgh", &[], &scene).err().unwrap().to_string();
    assert!(error.contains("use `path`"), "{error}");
}

#[test]
fn the_explosion_of_the_scene_folder_is_lit_by_its_own_light() {
    let scene = our_scene("explosion", (24, 24));
    let r = recipe("lgh", &["block=2"], &scene);
    assert!(r.warnings.iter().any(|w| w.contains("scatters light once")) && r.warnings.len() == 1, "{:?}", r.warnings);
    let (image, probe) = pass(&scene, &*r.method, 2, 1, 0);
    let mean = |rows: std::ops::Range<usize>| {
        image.pixels[rows.start * 24..rows.end * 24].iter().map(|p| p.luminance()).sum::<f32>()
            / (24 * rows.len()) as f32
    };
    // The fire, and the floor beneath it.
    assert!(mean(6..10) > 3.0 * mean(20..24) && mean(20..24) > 0.0, "{} {}", mean(6..10), mean(20..24));
    assert!(probe.lights > 1000 && probe.mean("grid lights").unwrap() < 0.5 * probe.lights as f64);
}
