//! Two light sets from two crates in one method: lights on the lamps by a tree, all others one by one.
//!
//! A pair of lists of lights goes with a pair of light sets: light adds, so sets add. Here the 4096 lights on emitters, of which a point
//! needs few, are asked by stochastic lightcuts (crate `light-tree`, ten shadow rays), and the lights of 64 light paths all (crate
//! `light-list`). Only the generator of the pair has to be written.
//!
//! `cargo run --release -p manylight --example 03_mix_two_crates`

use manylight::compensation::BoundPlan;
use manylight::framework::{Batch, Claim, Compensation, GenerateError, Generator, Method, Probe, Promise};
use manylight::light_list::All;
use manylight::light_tree::StochasticLightcuts;
use manylight::many_lights::ManyLights;
use manylight::reference::PathTracer;
use manylight::render::{Budget, Progress, Settings, render};
use manylight::scene::Scene;
use manylight::scene_io::{LoadOptions, load};
use manylight::stats::{Alternative, MeanTest, Moments};
use manylight::vpl::{Emission, Emitters, Keller, Points, Vpl};
use std::sync::Arc;

/// Lights on emitters, and those of light paths, apart.
struct Both(Emitters, Keller);

impl Promise for Both {
    fn claim(&self) -> Claim {
        // Paths of two edges are made by the one, longer ones by the other: what the second misses is missed.
        Claim { misses: self.1.claim().misses, ..self.0.claim().and(self.1.claim()) }
    }
}
impl Generator for Both {
    type Lights = (Vec<Vpl>, Vec<Vpl>);
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Self::Lights>, GenerateError> {
        let direct = self.0.generate(scene, pass, seed, probe)?;
        let indirect = self.1.generate(scene, pass, seed, probe)?;
        // A bound that goes by the number of paths goes by the smaller.
        let paths = direct.paths.min(indirect.paths);
        Ok(Batch { lights: (direct.lights, indirect.lights), paths, covers_direct: true })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell-box/scene.xml");
    let scene = load(file.as_ref(), &LoadOptions { size: Some((48, 48)), ..LoadOptions::default() })?.scene;
    let max_edges = 5;
    let keller = Keller { paths: 64, max_edges: Some(max_edges), certain_edges: 1, emission: Emission::Full };
    let mixed = ManyLights {
        generator: Box::new(Both(Emitters { paths: 4096 }, keller)),
        plan: (StochasticLightcuts::default(), All),
        kernel: Points,
        bounding: BoundPlan::AUTO,
        compensation: Compensation::None,
        max_edges,
        min_edges: 1,
        sharp: 0.0,
    };
    println!("mixed: {}", mixed.claim());
    let path = PathTracer { max_edges, ..PathTracer::default() };
    // The pass is what is independent: its mean is one number of the sample.
    let means = |method: &dyn Method, passes: u64, spp| -> Result<(Moments, u64), Box<dyn std::error::Error>> {
        let (mut moments, mut rays) = (Moments::default(), 0);
        for seed in 0..passes {
            let settings = Settings { budget: Budget::Passes(1), seed, spp, threads: None };
            let done = render(&scene, method, &settings, &mut |_: &Progress| {}, &Arc::default())?;
            let sum: f64 = done.image.pixels.iter().map(|p| f64::from(p.luminance())).sum();
            moments.push(sum / done.image.pixels.len() as f64);
            rays += done.probe.shadow_rays;
        }
        Ok((moments, rays / passes))
    };
    let ((of_mixed, rays), (of_path, _)) = (means(&mixed, 48, 1)?, means(&path, 24, 16)?);
    println!("mixed: {:.4} +- {:.4}, {rays} shadow rays a pass", of_mixed.mean(), of_mixed.std_error());
    println!("path:  {:.4} +- {:.4}", of_path.mean(), of_path.std_error());
    // It promises never to be too bright (its bound takes a little): a one-sided test, which errs once in a hundred times.
    let test = MeanTest::welch(&of_mixed, &of_path, Alternative::Greater);
    println!(
        "difference: {:+.4} +- {:.4}, p that it is too bright = {:.2}",
        test.difference, test.std_error, test.p_value
    );
    assert!(test.p_value > 0.01, "brighter than paths are: {test:?}");
    assert!(test.difference > -0.1 * of_path.mean(), "more is missing than a bound takes: {test:?}");
    Ok(())
}
