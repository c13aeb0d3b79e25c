//! What is hard about trees of lights, and what they must do there.

mod common;

use common::{At, Clear, Lamp, build, holds, plane_points, set_a, set_b, stream};
use manylight_framework::{BuildError, LightSet, Picks, Plan};
use manylight_light_tree::{Build, Growth, LightBvh, LightTree, Lightcuts, Standing, StochasticLightcuts};
use manylight_math::Vec3;

fn slc(size: u32) -> StochasticLightcuts {
    StochasticLightcuts { size, ..StochasticLightcuts::default() }
}
fn at_plane() -> At {
    plane_points(1).remove(0)
}
fn luminance(set: &impl LightSet<At>, at: &mut At) -> f64 {
    let c = set.radiance(at, &mut stream(1)).luminance() as f64;
    assert!(c.is_finite(), "{c} at {}", at.p);
    c
}

#[test]
fn without_lights_there_is_nothing() {
    let mut at = at_plane();
    for lights in [vec![], vec![Lamp { p: Vec3::ONE, intensity: 0.0, edges: 1 }; 3]] {
        assert_eq!(luminance(&build(&slc(4), &lights, 0), &mut at), 0.0);
        assert_eq!(luminance(&build(&LightBvh::default(), &lights, 0), &mut at), 0.0);
        assert_eq!(luminance(&build(&Lightcuts::default(), &lights, 0), &mut at), 0.0);
        let set = build(&slc(4), &lights, 0);
        assert!(set.pick(&mut at, &mut stream(1)).is_none() && set.pmf(&mut at, 0) == 0.0);
        assert_eq!((at.asked, set.tree().validate(holds)), (0, Ok(())));
    }
}

#[test]
fn one_light_is_exact_and_so_are_two_of_which_one_lies_below() {
    let above = Lamp { p: Vec3::new(0.3, 0.2, 0.7), intensity: 2.0, edges: 1 };
    let below = Lamp { p: Vec3::new(0.3, 0.2, -0.7), ..above };
    for lights in [vec![above], vec![above, below], vec![below, above]] {
        let mut at = at_plane();
        let truth = at.all(&lights);
        for estimate in [
            luminance(&build(&slc(1), &lights, 0), &mut at),
            luminance(&build(&slc(9), &lights, 0), &mut at),
            luminance(&build(&LightBvh { samples: 3, ..LightBvh::default() }, &lights, 0), &mut at),
            luminance(&build(&Lightcuts::default(), &lights, 0), &mut at),
        ] {
            assert!((estimate / truth - 1.0).abs() < 1e-6, "{estimate} {truth}");
        }
    }
}

#[test]
fn lights_below_the_horizon_are_a_dead_branch_and_cost_no_shadow_ray() {
    let lights: Vec<Lamp> = set_a(500).into_iter().map(|l| Lamp { p: l.p - Vec3::Z * 2.0, ..l }).collect();
    let mut at = at_plane();
    for size in [1, 10] {
        assert_eq!(luminance(&build(&slc(size), &lights, 0), &mut at), 0.0);
    }
    assert_eq!(luminance(&build(&LightBvh::default(), &lights, 0), &mut at), 0.0);
    assert_eq!(at.asked, 0);
    // A cut knows by its bound: one look at the root.
    assert_eq!(luminance(&build(&Lightcuts::default(), &lights, 0), &mut at), 0.0);
    assert_eq!(at.asked, 1);
}

#[test]
fn a_cut_in_the_dark_ends_at_its_largest_size() {
    let mut at = At { wall: -1.0, ..at_plane() };
    let plan = Lightcuts { most: 100, ..Lightcuts::default() };
    assert_eq!(luminance(&build(&plan, &set_a(1000), 0), &mut at), 0.0);
    assert_eq!((at.notes["cut size"], at.asked), (100.0, 100));
}

#[test]
fn all_leaves_are_all_lights() {
    for lights in [set_a(333), set_b(333)] {
        for mut at in plane_points(20) {
            let truth = at.all(&lights);
            let every = Lightcuts { error: 0.0, most: u32::MAX, ..Lightcuts::default() };
            for build_by in [Build::Fast, Build::Greedy] {
                let growth = Growth { build: build_by, ..Growth::default() };
                let cut = luminance(&build(&Lightcuts { growth, ..every }, &lights, 0), &mut at);
                let drawn = luminance(&build(&StochasticLightcuts { growth, ..slc(333) }, &lights, 0), &mut at);
                assert!((cut / truth - 1.0).abs() < 1e-6 && (drawn / truth - 1.0).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn coincident_lights_and_a_receiver_among_them_are_finite() {
    let here = Lamp { p: Vec3::new(0.5, 0.5, 0.5), intensity: 1.0, edges: 1 };
    let lights = [vec![here; 40], set_a(40)].concat();
    // Below them, and just below the coincident ones; on them all distances are zero.
    for z in [0.0, 0.4999, 0.5] {
        let mut at = At::new(Vec3::new(0.5, 0.5, z));
        for size in [1, 7, 80] {
            let set = build(&slc(size), &lights, 0);
            assert_eq!(set.tree().validate(holds), Ok(()));
            luminance(&set, &mut at);
            let pmf: f64 = (0..lights.len()).map(|i| set.pmf(&mut at, i)).sum();
            assert!(pmf < 1.0 + 1e-9 && pmf > 0.0, "{pmf}");
        }
        luminance(&build(&LightBvh::default(), &lights, 0), &mut at);
        luminance(&build(&Lightcuts::default(), &lights, 0), &mut at);
    }
}

#[test]
fn lights_of_other_depths_are_left_out_where_they_are_kept_apart() {
    let lights: Vec<Lamp> =
        set_a(300).into_iter().enumerate().map(|(i, l)| Lamp { edges: (i % 5) as u32, ..l }).collect();
    for (allowed, together) in [((0, 3), (0, 2)), ((1, 5), (u32::MAX, 0)), ((2, 4), (2, 3))] {
        for standing in [Standing::Pass(1), Standing::Pass(3), Standing::Receiver] {
            let growth = Growth { together, ..Growth::default() };
            let plan = Lightcuts { error: 1e-3, most: 5000, standing, growth };
            assert!(!Plan::<Vec<Lamp>>::merges(&plan));
            let mut at = At { edges: allowed, ..at_plane() };
            let truth = at.all(&lights);
            let estimate = luminance(&build(&plan, &lights, 0), &mut at);
            assert!((estimate / truth - 1.0).abs() < 2e-3, "{allowed:?}: {estimate} {truth}");
        }
    }
    assert!(Plan::<Vec<Lamp>>::merges(&Lightcuts::default()));
}

#[test]
fn the_same_lights_give_the_same_tree_on_any_number_of_threads() {
    let leaves = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let tree = LightTree::new(set_b(20_000), Growth::default(), &mut stream(3)).unwrap();
            let nodes = (0..tree.len() as u32).map(|i| (tree.weight(i).to_bits(), tree.representative(i)));
            nodes.collect::<Vec<_>>()
        })
    };
    let one = leaves(1);
    assert!(one == leaves(2) && one == leaves(7));
}

#[test]
fn a_light_that_is_not_finite_is_named() {
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let mut lights = set_a(10);
        lights[7].intensity = bad;
        let built = slc(1).build(lights, &Clear, &mut stream(0));
        assert_eq!(built.err(), Some(BuildError::NotFinite { light: 7 }));
        let mut lights = set_a(10);
        lights[3].p.x = bad;
        if !bad.is_finite() {
            let built = slc(1).build(lights, &Clear, &mut stream(0));
            assert_eq!(built.err(), Some(BuildError::NotFinite { light: 3 }));
        }
    }
}
