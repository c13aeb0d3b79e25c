//! The exact numbers of the notes on lightcuts and stochastic lightcuts: no random number is in them.
//!
//! f = I cos / d^2 without shadows, lights of the sets A and B, receivers on the plane below them. The relative standard
//! deviation of an estimate with one light for each node C of a cut is exactly
//!
//! > sqrt(sum_C (sum_{i in C} f_i^2 / P(i | C) - F_C^2)) / sum_i f_i,    F_C = sum_{i in C} f_i.

mod common;

use common::{At, Lamp, Odds, build, holds, plane_points, set_a, set_b, stream};
use manylight_framework::{Clustered, LightSet};
use manylight_light_tree::{Build, CutBy, DescentLights, Growth, LightTree, Lightcuts, Standing, StochasticLightcuts};

const RECEIVERS: u64 = 512;

/// (sum f^2 / P, sum f) below a node, in which each child is taken by its odds.
fn moments(set: &DescentLights<Lamp>, node: u32, p: f64, at: &At) -> (f64, f64) {
    match set.tree().children(node) {
        None => {
            let f = at.gives(set.tree().light(node));
            (f * f / p, f)
        }
        Some(children) => {
            let Some(odds) = set.odds(at, children.map(|c| set.tree().cluster(c))) else { return (0.0, 0.0) };
            let mut sum = (0.0, 0.0);
            for (child, q) in children.into_iter().zip(odds).filter(|c| c.1 > 0.0) {
                let m = moments(set, child, p * q, at);
                sum = (sum.0 + m.0, sum.1 + m.1);
            }
            sum
        }
    }
}
fn relative_deviation(set: &DescentLights<Lamp>, at: &At) -> f64 {
    let (mut variance, mut total) = (0.0, 0.0);
    // Cuts are found by the bounds, whatever the odds.
    let cut = set.cut_nodes(&At { odds: Odds::MinMax, ..at.clone() });
    for node in cut {
        let (second, first) = moments(set, node, 1.0, at);
        variance += (second - first * first).max(0.0);
        total += first;
    }
    variance.sqrt() / total
}
fn table(lights: &[Lamp], build_by: Build, odds: Odds, expected: &[(u32, f64)]) {
    let growth = Growth { build: build_by, ..Growth::default() };
    for &(size, expected) in expected {
        let set = build(&StochasticLightcuts { size, by: CutBy::Size, growth }, lights, 0);
        let points = plane_points(RECEIVERS);
        let mean = points.iter().map(|at| relative_deviation(&set, &At { odds, ..at.clone() })).sum::<f64>()
            / points.len() as f64;
        // Half of the last digit, and what positions in single precision may move it.
        println!("{} lights, {odds:?}, cut of {size}: {mean:.5}, expected {expected}", lights.len());
        assert!(
            (mean - expected).abs() < 0.6e-5 + 1e-4 * expected,
            "{} lights, {odds:?}, cut of {size}: {mean}, expected {expected}",
            lights.len()
        );
    }
}

#[test]
fn the_sets_are_those_of_the_notes() {
    let a = set_a(1000);
    assert!((a[0].p - manylight_math::Vec3::new(0.319_172_513, 0.171_043_607, 0.049_700_480)).length() < 1e-7);
    let mean = |lights: &[Lamp]| plane_points(512).iter().map(|at| at.all(lights)).sum::<f64>() / 512.0;
    for (lights, expected) in [(a, 0.831_631_641_109), (set_a(10_000), 0.830_447_868_804), (set_b(1000), 9.017_390_789)]
    {
        assert!((mean(&lights) / expected - 1.0).abs() < 1e-6, "{}", mean(&lights));
    }
}

#[test]
fn trees_have_the_depths_and_costs_of_the_notes() {
    for (n, by, depth, cost) in [
        (1000, Build::Fast, 10, 8.546_074),
        (10_000, Build::Fast, 14, 8.827_573),
        (1000, Build::Greedy, 12, 10.065_484),
        (10_000, Build::Greedy, 15, 11.302_736),
    ] {
        let tree = LightTree::new(set_a(n), Growth { build: by, ..Growth::default() }, &mut stream(0)).unwrap();
        assert_eq!(tree.validate(holds), Ok(()));
        let inner = (0..tree.len() as u32).filter(|&i| tree.children(i).is_some());
        let sum: f64 = inner.map(|i| Lamp::cost(tree.cluster(i), 0.0) as f64).sum();
        println!("{n} lights, {by:?}: depth {}, cost {sum:.6}", tree.depth());
        assert!(tree.len() as u64 == 2 * n - 1 && tree.depth() == depth, "{n} {by:?}: depth {}", tree.depth());
        assert!((sum / cost - 1.0).abs() < 1e-5, "{n} {by:?}: {sum}, expected {cost}");
        assert!(tree.bytes() as u64 <= 128 * n);
    }
}

#[test]
fn deviations_over_1000_lights_are_exact() {
    let a = set_a(1000);
    let sizes = [1, 2, 4, 8, 16, 32, 64, 128];
    let all = |odds, row: [f64; 8]| {
        table(&a, Build::Fast, odds, &std::array::from_fn::<_, 8, _>(|i| (sizes[i], row[i])));
    };
    all(Odds::Intensity, [1.14786, 0.79499, 0.40681, 0.19812, 0.10278, 0.05580, 0.02938, 0.01490]);
    all(Odds::Min, [1.12949, 0.37366, 0.20700, 0.08747, 0.04006, 0.01991, 0.00983, 0.00483]);
    all(Odds::Max, [0.37027, 0.25868, 0.13173, 0.05976, 0.02964, 0.01498, 0.00707, 0.00335]);
    all(Odds::Centre, [0.25415, 0.14917, 0.08952, 0.04812, 0.02564, 0.01336, 0.00642, 0.00316]);
    all(Odds::MinMax, [0.34206, 0.13879, 0.09165, 0.05199, 0.02660, 0.01360, 0.00649, 0.00318]);
}

#[test]
fn deviations_over_other_sets_and_trees_are_exact() {
    table(&set_a(1000), Build::Fast, Odds::MinMaxWithoutCosine, &[(1, 0.44644), (16, 0.05639), (128, 0.00936)]);
    table(&set_a(10_000), Build::Fast, Odds::MinMax, &[(1, 0.29411), (2, 0.22557), (64, 0.00729)]);
    table(&set_a(10_000), Build::Fast, Odds::Intensity, &[(1, 1.15778)]);
    table(&set_b(1000), Build::Fast, Odds::MinMax, &[(1, 0.40028), (8, 0.08217), (128, 0.00523)]);
    table(&set_b(10_000), Build::Fast, Odds::MinMax, &[(1, 0.32729), (64, 0.01190)]);
}

#[test]
fn lightcuts_have_the_sizes_of_the_notes() {
    // (lights, threshold, mean size, largest size), of cuts by the brightest light of each cluster.
    for (n, error, mean, largest) in [
        (100, 0.02, 75.07, 85),
        (1000, 0.1, 38.60, 0),
        (1000, 0.05, 63.10, 0),
        (1000, 0.02, 123.71, 138),
        (1000, 0.01, 209.15, 227),
        (10_000, 0.02, 141.95, 180),
        (10_000, 0.01, 247.82, 292),
    ] {
        let plan = Lightcuts { error, most: u32::MAX, standing: Standing::Brightest, growth: Growth::default() };
        let set = build(&plan, &set_a(n), 0);
        let (mut sum, mut most) = (0.0, 0.0f32);
        for mut at in plane_points(RECEIVERS) {
            set.radiance(&mut at, &mut stream(1));
            let size = at.notes["cut size"];
            assert_eq!(at.asked as f32, size, "one shadow ray for each node of the cut");
            (sum, most) = (sum + size as f64, most.max(size));
        }
        let size = sum / RECEIVERS as f64;
        println!("{n} lights, {error}: {size:.2} nodes, at most {most}; expected {mean}, {largest}");
        assert!((size - mean).abs() < 0.02, "{n} lights, {error}: {size}, expected {mean}");
        assert!(largest == 0 || most == largest as f32, "{n} lights, {error}: at most {most}, expected {largest}");
    }
}
