//! Photon maps, beam radiance estimates and photon beams: a closed form, and the path tracer.
//!
//! Family-wise significance 0.01 by Holm within each verdict; fixed seeds. Biases of small radii are allowed for by `rounding`.

use manylight_framework::KnobSet;
use manylight_integration::fogs::{endless, foggy_room, glass_in_fog, room_of_fogs, smoky_cube};
use manylight_integration::rooms::lantern;
use manylight_integration::{block_runs, effort, recipe};
use manylight_math::Spectrum;
use manylight_scene::Scene;
use manylight_stats::{BlockTest, Reference, Runs, Verdict};

/// All three, with what is best for small tests.
const METHODS: &[(&str, &[&str])] = &[
    ("photon-map", &["points=8"]),
    ("beam-radiance", &[]),
    ("photon-beams", &["rays=short"]),
    ("photon-beams", &["rays=long"]),
];

fn runs(scene: &Scene, method: (&str, &[&str]), more: &[&str], passes: u64) -> Runs {
    let r = recipe(method.0, &[method.1, more].concat(), scene);
    block_runs(scene, &*r.method, r.spp, 31, effort(passes), 1)
}
fn test(a: &Runs, reference: Reference, allowed: f64) -> Verdict {
    BlockTest { rounding: allowed, ..BlockTest::default() }.run(a, reference).unwrap()
}
/// Orders of two and more along (-1.5, 0.7, 0) + t x from a point light in an endless fog, by Fourier inversion of the fluence.
const FLUENCE: f64 = 4.3381603619e-3;

#[test]
fn in_an_endless_fog_they_estimate_what_the_fluence_says() {
    let scene = endless(0.8, 1.0, 0.0, 0.7, 1.5);
    for m in METHODS {
        // Long beams are long here.
        let paths = if m.1 == ["rays=long"] { "paths=128" } else { "paths=1024" };
        let r = runs(&scene, *m, &["radius=0.2", "shrink=none", "min-depth=3", paths], 96);
        let verdict = test(&r, Reference::Exact(&[FLUENCE; 3]), 0.01);
        println!("{m:?}: {verdict}");
        assert!(verdict.passes(), "{m:?}: {verdict}");
        // One order alone is less: no path length counts that should not.
        let r = runs(&scene, *m, &["radius=0.2", "shrink=none", "min-depth=3", "max-depth=3", paths], 64);
        let verdict = test(&r, Reference::Exact(&[FLUENCE; 3]), 0.01);
        assert!(verdict.rejected(), "{m:?}: {verdict}");
    }
}

#[test]
fn in_the_limit_of_small_radii_they_are_the_path_tracer() {
    let mild = (Spectrum::rgb(0.9, 0.8, 0.7), Spectrum::rgb(0.5, 0.6, 0.7), 0.2);
    let rooms = room_of_fogs(mild, (Spectrum::rgb(0.8, 0.9, 0.9), Spectrum::rgb(2.2, 2.0, 1.8), -0.3));
    for (what, scene, wide, narrow) in [
        ("fog", rooms, "radius=0.2", "radius=0.1"),
        ("smoke", smoky_cube(), "radius=0.16", "radius=0.08"),
        ("glass", glass_in_fog(), "radius=0.16", "radius=0.08"),
        ("no fog", lantern(0.7, (8, 8)), "radius=0.2", "radius=0.1"),
    ] {
        let path = recipe("path", &["min-depth=3"], &scene);
        let truth = block_runs(&scene, &*path.method, 64, 24, effort(64), 1);
        // On surfaces they are all the same.
        for m in &METHODS[..if scene.has_media() { 3 } else { 1 }] {
            let at = |radius| runs(&scene, *m, &[radius, "shrink=none", "min-depth=3", "paths=2048"], 48);
            // At walls, whose discs and balls reach out of the room, the bias is of first order: to the limit, in a straight line, with
            // the same photons.
            let (wide, narrow) = (at(wide), at(narrow));
            let limit = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| 2.0 * b - a).collect();
            let r = Runs::new(wide.rows().iter().zip(narrow.rows()).map(limit).collect()).unwrap();
            let verdict = test(&r, Reference::Runs(&truth), 0.02);
            println!("{what}, {m:?}: {verdict}");
            assert!(verdict.passes(), "{what}, {m:?}: {verdict}");
        }
    }
}

#[test]
fn what_they_promise_follows_from_their_radius() {
    let scene = foggy_room(0.0);
    for m in METHODS {
        let claim = |more| recipe(m.0, &[m.1, more].concat(), &scene).claim;
        let (shrinks, stays) = (claim(&["shrink=0.5"]), claim(&["shrink=none"]));
        assert_eq!((shrinks.vanishes_with, stays.vanishes_with), (KnobSet::PASSES, KnobSet::NONE));
        assert!(!shrinks.is_unbiased() && shrinks.brightens && shrinks.misses.is_empty() && shrinks.finite_variance);
    }
    let wrong = manylight_recipes::build("photon-map", &[("shrink".into(), "1".into())], &scene);
    assert!(wrong.err().unwrap().to_string().contains("between 0 and 1"));
}

#[test]
fn white_thick_thin_and_forward_fogs_are_finite() {
    for (albedo, sigma, g) in [(1.0, 1.0, 0.0), (0.99, 50.0, 0.0), (0.9, 1e-3, 0.0), (0.95, 1.0, 0.95)] {
        let fog = (Spectrum::gray(albedo), Spectrum::gray(sigma), g);
        let scene = room_of_fogs(fog, fog);
        for m in METHODS {
            // Panics at what is not finite.
            let r = runs(&scene, *m, &["paths=256"], 2);
            assert!((0..3).all(|k| r.moments(k).mean() > 0.0));
        }
    }
}
