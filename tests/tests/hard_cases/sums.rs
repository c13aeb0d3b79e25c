//! Sums of very many, or very unequal, lights.

use super::*;

#[test]
fn a_million_equal_lights_give_a_million_times_one() {
    let scene = lantern(0.5, (4, 4));
    let x = scene.intersect(&scene.camera().ray(Vec2::splat(2.0)), Mode::Radiance).unwrap();
    let n = 1_000_000;
    let vertex = Vertex { p: Vec3::new(0.1, 0.2, 0.3), scatter: Scatter::Emitter(EmitterPoint::Isotropic) };
    let light = Vpl { vertex, flux: Spectrum::rgb(0.7, 0.3, 0.123_456_79), edges: 1 };
    let sum = |lights: Vec<Vpl>| {
        let mut probe = Probe::default();
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        build(&All, lights).radiance(&mut gather(&scene, &x, &Bound::None, &mut probe), &mut s)
    };
    let (one, all) = (sum(vec![light]), sum(vec![light; n]));
    assert!(one.0.min_element() > 0.0);
    for (one, all) in one.to_array().into_iter().zip(all.to_array()) {
        let expected = one as f64 * n as f64;
        assert!((all as f64 / expected - 1.0).abs() < 1e-6, "{all} is not {expected}");
    }
}

#[test]
fn of_two_lamps_a_million_to_one_the_weak_one_is_drawn_as_seldom_and_weighs_as_much() {
    let mut b = Scene::builder();
    let intensities = [1e6f32, 1.0];
    for (i, intensity) in intensities.into_iter().enumerate() {
        let position = Vec3::X * i as f32;
        b.emitter(Emitter::Point { position, intensity: Spectrum::gray(intensity) });
    }
    b.camera(camera(DVec3::Z, DVec3::ZERO, 40.0, (2, 2)));
    let scene = built(b);
    let emitters = scene.emitters();
    assert!((emitters.pmf(1) as f64 * (1e6 + 1.0) - 1.0).abs() < 1e-6);
    let mut s = Stream::new(3, [0; 3], Purpose::TEST);
    let n = 20_000_000;
    let mut weak = 0;
    for _ in 0..n {
        let e = scene.sample_emitter(&mut s).unwrap();
        // pmf x flux = 4 pi I, for both.
        let flux = e.flux.luminance() * emitters.pmf(e.emitter);
        let expected = 4.0 * std::f32::consts::PI * intensities[e.emitter as usize];
        assert!((flux / expected - 1.0).abs() < 1e-5, "{flux} {expected}");
        weak += e.emitter;
    }
    // Poisson of mean 20: within [7, 36] but for one in 1000.
    assert!((7..=36).contains(&weak), "{weak} of {n}");
    // And as lights of a set: each stratum of the power weighs what it is.
    let lights = |flux: [f32; 2]| {
        let vertex = |x| Vertex { p: Vec3::X * x, scatter: Scatter::Emitter(EmitterPoint::Isotropic) };
        vec![0, 1]
            .into_iter()
            .map(|i| Vpl { vertex: vertex(i as f32), flux: Spectrum::gray(flux[i]), edges: 1 })
            .collect()
    };
    let made: Vec<Vpl> = lights(intensities);
    assert_eq!(made[0].intensity() / made[1].intensity(), 1e6);
    let set = build(&Power { samples: 1 }, made);
    use manylight_framework::Picks;
    let pmf = |i| Picks::<()>::pmf(&set, &mut (), i);
    assert!((pmf(0) + pmf(1) - 1.0).abs() < 1e-15 && (pmf(1) * (1e6 + 1.0) - 1.0).abs() < 1e-6);
}

#[test]
fn a_weak_lamp_that_is_seldom_drawn_is_found_by_chance_at_its_full_strength() {
    // A ceiling of radiance 1 over the floor, and a lantern of a million times its power that cannot be seen from there: drawn
    // once in a million, the ceiling is still what the BSDF's samples say.
    let scene = plane_under(
        |b| {
            let m = diffuse(b, Spectrum::BLACK);
            place(b, ceiling(1.0, 1.0), m, Some(Spectrum::ONE));
            b.emitter(Emitter::Point { position: Vec3::NEG_Z, intensity: Spectrum::gray(1e6) });
        },
        (4, 4),
    );
    // Form factor of a square from a point below its middle: four times that of a corner, 2 / (pi sqrt 2) atan(1 / sqrt 2).
    let quarter = (0.5f64.sqrt() * 0.5f64.sqrt().atan()) / std::f64::consts::PI;
    let truth = Spectrum::gray((0.8 * 4.0 * quarter) as f32);
    for (method, params) in [("path", &["max-depth=2"][..]), (IR, &["direct=only"])] {
        let r = recipe(method, params, &scene);
        mean_is(method, &block_runs(&scene, &*r.method, 64, 1, 256, 2).with_mean(), truth);
    }
}
