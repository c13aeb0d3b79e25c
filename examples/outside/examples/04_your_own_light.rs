//! Lights from this crate beside Manylight's own, on a Cornell box: the same image in half the memory.
//!
//! `cargo run --release --example 04_your_own_light`

use manylight_compensation::BoundPlan;
use manylight_framework::{Compensation, Generator, Method, Probe};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_math::Spectrum;
use manylight_render::{Budget, Progress, Settings, render};
use manylight_scene_io::{LoadOptions, load};
use manylight_vpl::{Emission, Keller, Points, Vpl};
use outside::{Lambert, Sorted, Two};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell-box/scene.xml");
    let scene = load(file.as_ref(), &LoadOptions { size: Some((128, 128)), ..LoadOptions::default() })?.scene;
    let (max_edges, bounding, compensation) = (6, BoundPlan::AUTO, || Compensation::None);
    let keller = Keller { paths: 256, max_edges: Some(max_edges), certain_edges: 1, emission: Emission::Full };
    let plain = ManyLights {
        generator: Box::new(keller),
        plan: All,
        kernel: Points,
        bounding,
        compensation: compensation(),
        max_edges,
        min_edges: 1,
        sharp: 0.0,
    };
    let sorted = ManyLights {
        generator: Box::new(Sorted(keller)),
        plan: (All, All),
        kernel: Two,
        bounding,
        compensation: compensation(),
        max_edges,
        min_edges: 1,
        sharp: 0.0,
    };
    let lights = Sorted(keller).generate(&scene, 0, 0, &mut Probe::default())?.lights;
    println!(
        "{} of {} lights are diffuse: {} bytes each instead of {}",
        lights.0.len(),
        lights.0.len() + lights.1.len(),
        size_of::<Lambert>(),
        size_of::<Vpl>()
    );
    let image = |method: &dyn Method| -> Result<Vec<Spectrum>, Box<dyn std::error::Error>> {
        let settings = Settings { budget: Budget::Passes(4), seed: 0, spp: 1, threads: None };
        Ok(render(&scene, method, &settings, &mut |_: &Progress| {}, &Arc::default())?.image.pixels)
    };
    // The same light paths and camera rays: the same sums, in another order.
    let (a, b) = (image(&plain)?, image(&sorted)?);
    let off = |(a, b): (&Spectrum, &Spectrum)| ((a.luminance() - b.luminance()) / a.luminance().max(1e-3)).abs();
    let worst = a.iter().zip(&b).map(off).fold(0.0, f32::max);
    println!("largest difference of a pixel: {:.1e} of it", worst);
    assert!(worst < 1e-4, "the two are not the same image");
    Ok(())
}
