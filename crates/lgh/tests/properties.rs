//! What must hold for any lights: conservation, limits, continuity, degenerate input, randomness.

mod common;

use common::{At, Clear, Lamp, build, header, lamp, set_a, set_b, stream, table_lattice};
use manylight_framework::{BuildError, LightSet, Plan};
use manylight_lgh::{Lattice, Lgh, Shadows};
use manylight_math::{Aabb, DVec3, Spectrum, Vec3};
use manylight_stats::Moments;

fn radiance(plan: &Lgh, lights: &[Lamp], at: &At, seed: u64) -> f64 {
    build(plan, lights).radiance(&mut at.clone(), &mut stream(seed)).to_array()[0] as f64
}

#[test]
fn each_level_holds_all_intensity_and_its_first_moment() {
    for lights in [set_a(1000), set_b(10_000), set_b(100_000)] {
        let total: f64 = lights.iter().map(|l| l.intensity as f64).sum();
        let moment: DVec3 = lights.iter().map(|l| l.intensity as f64 * l.p.as_dvec3()).sum();
        let set = build(&Lgh::default(), &lights);
        let h = set.hierarchies().next().unwrap();
        for level in 1..h.sizes().len() {
            let sum: f64 = h.level(level).map(|(_, l)| l.intensity as f64).sum();
            let first: DVec3 = h.level(level).map(|(p, l)| l.intensity as f64 * p.as_dvec3()).sum();
            assert!((sum / total - 1.0).abs() < 1e-6, "level {level}: {sum} of {total}");
            assert!((first - moment).length() < 1e-5 * total, "level {level}: {first} of {moment}");
        }
        assert!(h.bytes() < 120 * lights.len() + 100_000, "{} bytes for {} lights", h.bytes(), lights.len());
    }
}

#[test]
fn one_light_is_exact_wherever_it_is_and_so_are_many_at_one_place() {
    for p in [Vec3::ZERO, Vec3::new(0.3, -7.2, 1e4), Vec3::new(-0.125, 0.25, 0.5), Vec3::splat(3e5)] {
        let lattices = [None, Some(Lattice { origin: DVec3::new(-2.0, 0.5, 0.0), top: 1.0, levels: 4 })];
        for lattice in lattices {
            for n in [1, 500] {
                let lights = vec![lamp(p, 2.0); n];
                for alpha in [0.5, 2.0, 9.0] {
                    for d in [0.003, 0.4, 1.3, 8.0, 300.0] {
                        let at = At::inside(p + Vec3::new(0.6 * d, 0.0, 0.8 * d));
                        let e = radiance(&Lgh { alpha, lattice, ..Lgh::default() }, &lights, &at, 0) / at.all(&lights)
                            - 1.0;
                        assert!(e.abs() < 1e-5, "{n} at {p}, alpha {alpha}, {d} away: {e}");
                    }
                }
            }
        }
    }
}

#[test]
fn with_a_large_alpha_it_is_the_sum_over_all_lights() {
    let lights = set_a(1000);
    let centre = At::inside(Vec3::splat(0.5));
    let set = build(&header(4.0), &lights);
    assert_eq!(centre.by(&set).1, 1000);
    assert!(centre.error(&set, &lights).abs() < 1e-12);
    // And the largest error over points falls on the way there.
    let errors = [1.0, 2.0, 4.0, 16.0].map(|alpha_h| {
        let set = build(&header(alpha_h), &lights);
        At::points(true).iter().map(|at| at.error(&set, &lights).abs()).fold(0.0, f64::max)
    });
    println!("largest errors on the plane: {errors:?}");
    assert!(errors.windows(2).all(|e| e[1] < 0.5 * e[0]) && errors[3] < 1e-12, "{errors:?}");
}

#[test]
fn light_moves_continuously_if_the_grid_is_pinned_and_not_if_it_follows_the_lights() {
    let lights = set_a(1000);
    let lattice = Some(Lattice { origin: DVec3::splat(-0.6), top: 2.0, levels: 4 });
    let step = 0.25 / 200.0;
    let points: Vec<At> = At::points(true).into_iter().take(64).collect();
    // The largest change, from step to step, of the relative error at any point.
    let jump = |plan: &Lgh, moved: &dyn Fn(usize) -> Vec<Lamp>| {
        let (mut before, mut largest) = (Vec::new(), 0.0f64);
        for i in 0..300 {
            let lights = moved(i);
            let set = build(plan, &lights);
            let errors: Vec<f64> = points.iter().map(|p| p.error(&set, &lights)).collect();
            largest = errors.iter().zip(&before).map(|(a, b): (&f64, &f64)| (a - b).abs()).fold(largest, f64::max);
            before = errors;
        }
        largest
    };
    let along = |i: usize| Vec3::new(0.7, 0.2, 0.5).normalize() * (i as f32 * step as f32);
    let translated = |i: usize| lights.iter().map(|l| Lamp { p: l.p + along(i), ..*l }).collect::<Vec<_>>();
    // The notes' largest steps (theirs with other points), rounded up.
    for (alpha_h, most) in [(1.0, 5.6e-4), (2.0, 1.2e-4)] {
        let largest = jump(&Lgh { lattice, ..header(alpha_h) }, &translated);
        println!("alpha {alpha_h}: largest step {largest:.2e}");
        assert!(largest < most, "alpha {alpha_h}: {largest}");
    }
    // A single faint light that flies away: a grid around all lights is moved by it, and its levels change.
    let outlier = |i: usize| {
        let far = lamp(Vec3::new(1.0 + 0.02 * i as f32, 0.5, 0.5), 1e-9);
        lights.iter().copied().chain([far]).collect::<Vec<_>>()
    };
    let pinned = jump(&Lgh { lattice, ..header(1.0) }, &outlier);
    let follows = jump(&header(1.0), &outlier);
    println!("an outlier: {pinned:.1e} pinned, {follows:.1e} following");
    assert!(pinned < 1e-6 && follows > 1e-3, "{pinned}, {follows}");
}

#[test]
fn scaling_space_scales_light_and_turning_by_right_angles_changes_nothing() {
    let lights = set_b(1000);
    let at = At { soft: 0.0, ..At::inside(Vec3::new(1.3, 0.2, -0.4)) };
    let lattice = table_lattice(&lights);
    let plan = |l| Lgh { lattice: Some(l), ..header(1.0) };
    let here = radiance(&plan(lattice), &lights, &at, 0);
    // By a power of two: nothing is rounded otherwise.
    let scaled: Vec<Lamp> = lights.iter().map(|l| Lamp { p: l.p * 4.0, ..*l }).collect();
    let large = Lattice { origin: lattice.origin * 4.0, top: lattice.top * 4.0, ..lattice };
    let there = radiance(&plan(large), &scaled, &At { p: at.p * 4.0, ..at.clone() }, 0);
    assert!((16.0 * there / here - 1.0).abs() < 1e-6, "{here} and {there}");
    let turn = |p: Vec3| Vec3::new(-p.y, p.x, p.z);
    let turned: Vec<Lamp> = lights.iter().map(|l| Lamp { p: turn(l.p), ..*l }).collect();
    let o = lattice.origin;
    let lattice = Lattice { origin: DVec3::new(-o.y - lattice.top, o.x, o.z), ..lattice };
    let there = radiance(&plan(lattice), &turned, &At { p: turn(at.p), ..at.clone() }, 0);
    assert!((there / here - 1.0).abs() < 1e-5, "{here} and {there}");
}

#[test]
fn odd_lights_are_no_trouble() {
    let at = At::inside(Vec3::new(0.4, 0.2, 3.0));
    assert_eq!(radiance(&Lgh::default(), &[], &at, 0), 0.0);
    // All dark, all in a plane, all on a line, on faces and edges of cells, next to very strong ones.
    let dark: Vec<Lamp> = set_a(100).iter().map(|l| Lamp { intensity: 0.0, ..*l }).collect();
    assert_eq!(radiance(&Lgh::default(), &dark, &at, 0), 0.0);
    let flat = |scale: Vec3| set_a(1000).iter().map(|l| Lamp { p: l.p * scale - Vec3::ONE, ..*l }).collect::<Vec<_>>();
    let lattice = Some(Lattice { origin: DVec3::ZERO, top: 0.5, levels: 3 });
    for scale in [Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(1.0, 1e-30, 2.0)] {
        for lattice in [None, lattice] {
            let lights = flat(scale);
            let plan = Lgh { lattice, ..header(2.0) };
            let e = radiance(&plan, &lights, &at, 0) / at.all(&lights) - 1.0;
            assert!(e.abs() < 0.01, "{scale}, {lattice:?}: {e}");
        }
    }
    let corners: Vec<Lamp> =
        (0..27).map(|i| lamp(Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32), 1.0)).collect();
    let unit = Lattice { origin: DVec3::ZERO, top: 1.0, levels: 1 };
    let set = build(&Lgh { lattice: Some(unit), ..Lgh::default() }, &corners);
    assert_eq!(set.hierarchies().next().unwrap().sizes(), [27, 27], "a light on a vertex is that vertex");
    let mut mixed = set_a(100);
    mixed[7].intensity = 1e30;
    let value = radiance(&Lgh::default(), &mixed, &at, 0);
    assert!(value.is_finite() && value > 0.0);
    // The receiver on a light.
    let lights = set_a(50);
    let on = At { soft: 1e-12, ..At::inside(lights[3].p) };
    assert!((radiance(&Lgh::default(), &lights, &on, 0) / on.all(&lights) - 1.0).abs() < 1e-3);
}

#[test]
fn lights_that_are_no_numbers_are_refused_by_their_place() {
    for bad in [
        lamp(Vec3::ZERO, f32::NAN),
        lamp(Vec3::ZERO, f32::INFINITY),
        lamp(Vec3::ZERO, -1.0),
        lamp(Vec3::new(0.0, f32::NAN, 0.0), 1.0),
        lamp(Vec3::new(f32::INFINITY, 0.0, 0.0), 1.0),
    ] {
        let mut lights = set_a(10);
        lights[6] = bad;
        let built = Lgh::default().build(lights, &Clear, &mut stream(0)).map(|_| ());
        assert_eq!(built, Err(BuildError::NotFinite { light: 6 }), "{bad:?}");
    }
}

#[test]
fn lights_of_other_edges_are_kept_apart_if_asked_and_left_out_where_paths_end() {
    let mut lights = set_a(2000);
    lights.iter_mut().enumerate().for_each(|(i, l)| l.edges = (i % 3) as u32);
    let plan = Lgh { apart: true, ..header(2.0) };
    let merges = |p: &Lgh| Plan::<Vec<Lamp>>::merges(p);
    assert!(!merges(&plan) && merges(&Lgh::default()));
    let worst = |plan: Lgh| {
        let set = build(&plan, &lights);
        let points = At::points(true).into_iter().take(64).map(|at| At { edges: (1, 2), ..at });
        let error = |at: At| set.radiance(&mut at.clone(), &mut stream(0)).to_array()[0] as f64 / at.all(&lights) - 1.0;
        points.map(|at| error(at).abs()).fold(0.0, f64::max)
    };
    // Merged, averages are left out or let in as a whole.
    let (apart, merged) = (worst(plan), worst(Lgh { apart: false, ..plan }));
    println!("apart {apart:.3}, merged {merged:.3}");
    assert!(apart < 0.03 && merged > 5.0 * apart, "{apart}, {merged}");
}

#[test]
fn lights_that_cannot_be_averaged_are_asked_themselves() {
    let mut lights = set_a(1000);
    lights.iter_mut().step_by(2).for_each(|l| l.alone = true);
    // Such a light need not have a place.
    lights.push(Lamp { p: Vec3::NAN, alone: true, ..lamp(Vec3::ZERO, 0.0) });
    let set = build(&header(1.0), &lights);
    lights.pop();
    let at = At::inside(Vec3::new(10.0, 0.5, 0.5));
    assert_eq!(set.hierarchies().next().unwrap().sizes()[0], 500);
    assert_eq!(at.by(&set).1, 501 + 8);
}

#[test]
fn drawn_shadows_have_the_mean_of_all_of_them_and_one_that_forgets_its_odds_has_not() {
    let lights = set_b(1000);
    let points = At::points(true);
    for at in [0usize, 17, 101].map(|i| At { wall: 0.6, ..points[i].clone() }) {
        let all = build(&header(1.0), &lights);
        let truth = all.radiance(&mut at.clone(), &mut stream(0)).to_array()[0] as f64;
        for rays in [1, 4] {
            let set = build(&Lgh { shadows: Shadows::Drawn(rays), ..header(1.0) }, &lights);
            let (mut drawn, mut blind) = (Moments::default(), Moments::default());
            for seed in 0..20_000 {
                let mut ask = at.clone();
                let value = set.radiance(&mut ask, &mut stream(seed)).to_array()[0] as f64;
                assert!(ask.asked == rays as u64 && ask.unshadowed as f32 == ask.notes["grid lights"]);
                drawn.push(value);
                blind.push(value * 1.05);
            }
            let z = |m: &Moments| (m.mean() - truth) / m.std_error();
            // Six comparisons at 0.01 together: 3.1 standard errors each.
            assert!(z(&drawn).abs() < 3.1, "{rays} rays: {} against {truth}", drawn.mean());
            assert!(z(&blind) > 3.1, "a bias of 5 % would not be seen");
        }
    }
}

#[test]
fn the_set_is_the_same_whatever_the_number_of_threads() {
    let lights = set_b(20_000);
    let at = At::points(false).swap_remove(3);
    let value = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(&header(1.0), &lights).radiance(&mut at.clone(), &mut stream(0)))
    };
    assert_eq!(value(1), value(5));
    assert_ne!(value(1), Spectrum::BLACK);
}

#[test]
fn a_lattice_around_nothing_is_a_lattice() {
    for bounds in [Aabb::EMPTY, Aabb::point(Vec3::ONE)] {
        let l = Lattice::around(&bounds, 0);
        assert!(l.origin.is_finite() && l.top > 0.0 && l.levels == 1);
    }
    assert_eq!([0, 100, 107, 108, 1000, 100_000].map(Lattice::levels_for), [1, 1, 1, 2, 3, 5]);
}
