//! A light set from this crate beside `all`, on a Cornell box: one shadow ray a point, and the same mean.
//!
//! `cargo run --release --example 05_your_own_light_set`

use manylight_compensation::BoundPlan;
use manylight_framework::{Compensation, Method, Plan, Promise};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_render::{Budget, Progress, Rendering, Settings, render};
use manylight_scene::Scene;
use manylight_scene_io::{LoadOptions, load};
use manylight_stats::{Alternative, MeanTest, Moments, student_quantile};
use manylight_vpl::{Emission, Keller, Points, Vpl};
use outside::Reservoir;
use std::sync::Arc;

/// Keller's lights, the point kernel and a bound: everything but the light set.
fn with<P: Plan<Vec<Vpl>>>(plan: P, max_edges: u32) -> ManyLights<Vec<Vpl>, P, Points, BoundPlan> {
    ManyLights {
        generator: Box::new(Keller {
            paths: 256,
            max_edges: Some(max_edges),
            certain_edges: 1,
            emission: Emission::Full,
        }),
        plan,
        kernel: Points,
        bounding: BoundPlan::AUTO,
        compensation: Compensation::None,
        max_edges,
        min_edges: 1,
        sharp: 0.0,
    }
}

/// One pass. Lights and camera samples follow from the seed alone: two methods with one seed share them.
fn one_pass(scene: &Scene, method: &dyn Method, seed: u64) -> Result<Rendering, Box<dyn std::error::Error>> {
    let settings = Settings { budget: Budget::Passes(1), seed, spp: 1, threads: None };
    Ok(render(scene, method, &settings, &mut |_: &Progress| {}, &Arc::default())?)
}

fn mean(r: &Rendering) -> f64 {
    r.image.pixels.iter().map(|p| p.luminance() as f64).sum::<f64>() / r.image.pixels.len() as f64
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell-box/scene.xml");
    let scene = load(file.as_ref(), &LoadOptions { size: Some((64, 64)), ..LoadOptions::default() })?.scene;
    let (all, reservoir) = (with(All, 6), with(Reservoir { candidates: 16 }, 6));
    println!("all: {}\nreservoir: {}", all.claim(), reservoir.claim());

    // All pixels of a pass share its lights, so the pass is what is independent, and its mean is one number of the sample. The
    // noise of the lights is the same in both images: it cancels in the difference, pass by pass.
    let (mut of_all, mut of_reservoir, mut difference) = (Moments::default(), Moments::default(), Moments::default());
    let mut shadow_rays = [0; 2];
    for seed in 0..24 {
        let (a, r) = (one_pass(&scene, &all, seed)?, one_pass(&scene, &reservoir, seed)?);
        of_all.push(mean(&a));
        of_reservoir.push(mean(&r));
        difference.push(mean(&r) - mean(&a));
        shadow_rays = [shadow_rays[0] + a.probe.shadow_rays, shadow_rays[1] + r.probe.shadow_rays];
    }
    for (name, m, rays) in [("all", of_all, shadow_rays[0]), ("reservoir", of_reservoir, shadow_rays[1])] {
        println!("{name:9}: {:.5} +- {:.5}, {rays} shadow rays", m.mean(), m.std_error());
    }

    // Student's test that the differences have mean zero. It errs once in a hundred times where they have.
    let test = MeanTest::one_sample(&difference, 0.0, Alternative::Different);
    let within = student_quantile(0.995, test.degrees) * test.std_error;
    let percent = 100.0 / of_all.mean();
    println!("difference: {:.6} +- {:.6}, p = {:.2}", test.difference, test.std_error, test.p_value);
    println!("that is, at 99 %, {:.3} % +- {:.3} % of the mean", test.difference * percent, within * percent);
    assert!(test.p_value > 0.01, "the means differ by more than their noise: {test:?}");
    Ok(())
}
