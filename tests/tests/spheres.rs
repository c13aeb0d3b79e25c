//! Virtual spherical lights: their blur vanishes with their radius, and all light sets agree about them.
//!
//! Family-wise significance 0.01 by Holm within each verdict; fixed seeds. `MANYLIGHT_EFFORT=16` takes sixteen times the passes.

use manylight_integration::{block_runs, effort, our_scene, pass, recipe};
use manylight_scene::Scene;
use manylight_stats::{BlockTest, Moments, Point, Reference, Runs, Slope};

const BASE: &[&str] = &["kernel=sphere", "bound=none", "paths=128", "min-depth=3"];

fn runs(scene: &Scene, more: &[&str], passes: u64, grid: usize) -> Runs {
    let r = recipe("many-lights", &[BASE, more].concat(), scene);
    block_runs(scene, &*r.method, 1, 31, passes, grid)
}
fn mean(r: &Runs) -> Moments {
    r.rows().iter().map(|row| row.iter().sum::<f64>()).collect()
}

/// Passes of the same lights, asked in two ways: what the lights vary by cancels.
fn same_sum(what: &str, a: &Runs, b: &Runs) {
    let means: Vec<f64> = (0..b.blocks()).map(|i| b.moments(i).mean()).collect();
    let pair = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).zip(&means).map(|((a, b), m)| a - b + m).collect();
    let differences = Runs::new(a.rows().iter().zip(b.rows()).map(pair).collect()).unwrap();
    let verdict = BlockTest::default().run(&differences, Reference::Exact(&means)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}

#[test]
fn every_light_set_gives_the_spheres_the_same_sum() {
    let scene = our_scene("corner", (16, 16));
    let base = runs(&scene, &["radius=0.15"], effort(150), 2);
    for set in [
        &["lights=power", "samples=64"][..],
        &["lights=light-bvh", "samples=32"],
        &["lights=stochastic-lightcuts", "cut=16"],
        &["lights=lightcuts", "error=0.01", "representatives=receiver"],
    ] {
        let other = runs(&scene, &[&["radius=0.15"], set].concat(), effort(150), 2);
        same_sum(&format!("{set:?}"), &other, &base);
    }
}

#[test]
fn each_way_of_sampling_the_cone_gives_the_same_image() {
    // Diffuse surfaces: every lobe reaches all of the cone.
    let scene = our_scene("corner", (16, 16));
    let base = runs(&scene, &["radius=0.2", "sphere-sampling=cone"], effort(150), 2);
    for way in ["mis", "receiver", "light"] {
        let way = format!("sphere-sampling={way}");
        let other = runs(&scene, &["radius=0.2", &way, "sphere-samples=16"], effort(150), 2);
        same_sum(&way, &other, &base);
    }
}

#[test]
fn the_bias_falls_with_the_radius() {
    // In a corner a cone dips below the horizon of the wall: a loss that grows as r.
    let scene = our_scene("corner", (16, 16));
    let path = recipe("path", &["min-depth=3"], &scene);
    let truth = mean(&block_runs(&scene, &*path.method, 64, 12, effort(64), 1));
    let loss = |radius: &str| {
        let m = mean(&runs(&scene, &[radius], effort(300), 1));
        let loss = 1.0 - m.mean() / truth.mean();
        let error = (m.std_error() / truth.mean()).hypot(truth.std_error() / truth.mean());
        println!("{radius}: loss {loss:.4} +- {error:.4}");
        (loss, error)
    };
    let (wide, middle, narrow) = (loss("radius=0.4"), loss("radius=0.2"), loss("radius=0.05"));
    assert!(wide.0 > 4.0 * wide.1, "the loss is there to be seen: {wide:?}");
    assert!(wide.0 - middle.0 > 2.6 * wide.1.hypot(middle.1), "{wide:?} {middle:?}");
    assert!(middle.0 - narrow.0 > 2.6 * middle.1.hypot(narrow.1), "{middle:?} {narrow:?}");
    assert!(narrow.0.abs() < 3.3 * narrow.1 + 0.02, "{narrow:?}");
}

#[test]
fn with_radii_that_shrink_the_error_keeps_falling_where_fixed_ones_level_off() {
    let scene = our_scene("corner", (16, 16));
    let path = recipe("path", &["min-depth=3"], &scene);
    let truth = {
        let r = block_runs(&scene, &*path.method, 512, 12, effort(64), 4);
        (0..r.blocks()).map(|b| r.moments(b).mean()).collect::<Vec<_>>()
    };
    // Error of the mean of the first n passes, over several seeds.
    let (most, seeds) = (128u64, effort(10));
    let points = |more: &[&str]| -> Vec<Point> {
        let r = recipe("many-lights", &[BASE, more].concat(), &scene);
        let curves: Vec<Vec<f64>> = (0..seeds)
            .map(|seed| {
                let (mut sum, mut errors) = (vec![0.0; truth.len()], Vec::new());
                for i in 0..most {
                    let image = pass(&scene, &*r.method, 1, 100 + seed, i).0;
                    manylight_integration::blocks(&image, 4).iter().zip(&mut sum).for_each(|(x, s)| *s += x);
                    if (i + 1).is_power_of_two() && i >= 3 {
                        let n = (i + 1) as f64;
                        let square = |(s, t): (&f64, &f64)| (s / n - t) * (s / n - t) / (t * t);
                        errors.push(sum.iter().zip(&truth).map(square).sum::<f64>() / truth.len() as f64);
                    }
                }
                errors
            })
            .collect();
        (0..curves[0].len())
            .map(|k| Point::root_of_mean(4.0 * f64::powi(2.0, k as i32), &curves.iter().map(|c| c[k]).collect()))
            .collect()
    };
    let slope = |name: &str, more: &[&str]| {
        let s = Slope::new(&points(more)).unwrap();
        let (lo, hi) = s.interval(0.99);
        println!("{name}: error falls as passes^[{lo:.3}, {hi:.3}]");
        (lo, hi)
    };
    let fixed = slope("fixed", &["radius=0.8"]);
    let shrinking = slope("shrinking", &["radius=0.8", "shrink=0.5"]);
    assert!(fixed.0 > -0.12, "fixed radii level off: {fixed:?}");
    assert!(shrinking.1 < fixed.0 && shrinking.1 < -0.12, "shrinking radii converge: {shrinking:?}");
}
