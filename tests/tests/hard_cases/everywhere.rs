//! Light from everywhere, and white things.

use super::*;

#[test]
fn a_convex_thing_under_an_even_sky_has_its_albedo() {
    for (rho, sky) in [(Spectrum::rgb(0.5, 0.8, 0.0), Spectrum::rgb(2.0, 1.0, 3.0)), (Spectrum::ONE, Spectrum::ONE)] {
        let mut b = Scene::builder();
        let m = diffuse(&mut b, rho);
        place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), m, None);
        // Far away and hardly there: most paths from the sky meet nothing.
        place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::Z * 8.0, 1e-3)), m, None);
        b.emitter(Emitter::Constant { radiance: sky });
        b.camera(camera(DVec3::new(-3.0, 0.0, 0.0), DVec3::ZERO, 25.0, (8, 8)));
        let scene = built(b);
        let truth = rho * sky;
        // By chance alone, each sample is exact.
        let image = render(&scene, ("path", &["nee=off", "spp=16"]), 1);
        for p in &image.pixels {
            assert!((p.0 - truth.0).abs().max_element() < 1e-5, "{p:?} is not {truth:?}");
        }
        mean_is("path", &runs(&scene, "path", &["spp=16"], 64), truth);
        mean_is("lights", &runs(&scene, IR, &["spp=16", "bound=none", "paths=64"], 64), truth);
        mean_is("virtual", &runs(&scene, IR, &["direct=virtual", "bound=none", "paths=1024"], 64), truth);
        // The first vertices carry what falls on the ball: irradiance pi L, on 4 pi r^2. 1 in 20 paths meets it.
        let n = 400_000;
        let keller = Keller { paths: n, max_edges: Some(3), certain_edges: 9, emission: Emission::Full };
        let mut probe = Probe::default();
        let batch = keller.generate(&scene, 0, 3, &mut probe).unwrap();
        let hits = batch.lights.len() as f64 / n as f64;
        let flux: f64 = batch.lights.iter().map(|l| l.flux.luminance() as f64).sum();
        let expected = 4.0 * std::f64::consts::PI.powi(2) * sky.luminance() as f64;
        let sigma = ((1.0 - hits) / (hits * n as f64)).sqrt();
        println!("{hits} of the paths hit; flux {flux} W, expected {expected} +- {:.2} %", 100.0 * sigma);
        assert!((0.02..0.1).contains(&hits) && (flux / expected - 1.0).abs() < 3.3 * sigma);
        assert_eq!(probe.light_paths, n);
    }
}

#[test]
fn what_absorbs_nothing_vanishes_under_an_even_sky() {
    let glass = Model::Dielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        reflectance: Source::Constant(Spectrum::ONE),
        transmittance: Source::Constant(Spectrum::ONE),
    };
    // Index 0 + 1e6 i: reflects everything.
    let mirror =
        Model::Conductor { eta: Spectrum::BLACK, k: Spectrum::gray(1e6), reflectance: Source::Constant(Spectrum::ONE) };
    for (name, model) in [("diffuse", white()), ("glass", glass), ("mirror", mirror)] {
        let mut b = Scene::builder();
        let m = b.material(Material::one_sided(name, model));
        place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), m, None);
        b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
        b.camera(camera(DVec3::new(-3.0, 0.0, 0.0), DVec3::ZERO, 40.0, (8, 8)));
        let scene = built(b);
        // Roulette seldom ends a path through glass: each run has to hold some that it ends.
        let spp = if name == "glass" { "spp=1024" } else { "spp=64" };
        for (method, params) in
            [("path", &["spp=64"][..]), ("path", &["spp=64", "nee=off"]), (IR, &[spp, "paths=16", "bound=none"])]
        {
            mean_is(&format!("{name}, {method} {params:?}"), &runs(&scene, method, params, 32), Spectrum::ONE);
        }
    }
}

#[test]
fn roulette_ends_every_path_between_white_walls() {
    let scene = lantern(1.0, (4, 4));
    for what in ALL {
        let r = recipe(what.0, what.1, &scene);
        let (image, probe) = pass(&scene, &*r.method, 1, 1, 0);
        assert!(image.pixels.iter().all(|p| p.is_finite()));
        let walks = probe.light_paths + probe.camera_rays;
        // A chance of 0.95 an edge after the sixteenth: 36 edges in the mean.
        assert!(probe.path_rays < 60 * walks, "{what:?}: {} rays of {walks} paths", probe.path_rays);
    }
}
