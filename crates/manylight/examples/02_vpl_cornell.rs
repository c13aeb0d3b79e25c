//! Instant radiosity by the library: a Cornell box with virtual point lights, as linear EXR and as PNG to look at.
//!
//! `cargo run --release -p manylight --example 02_vpl_cornell` writes vpl_cornell.exr and vpl_cornell.png where it is run.

use manylight::compensation::BoundPlan;
use manylight::framework::{Compensation, Promise};
use manylight::light_list::All;
use manylight::many_lights::ManyLights;
use manylight::render::files::{Exposure, Picture, write_exr, write_png};
use manylight::render::{Budget, Progress, Settings, render};
use manylight::scene_io::{LoadOptions, load};
use manylight::vpl::{Emission, Keller, Points};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell-box/scene.xml");
    let scene = load(file.as_ref(), &LoadOptions { size: Some((256, 256)), ..LoadOptions::default() })?.scene;
    // Longest path from lamp to eye, in edges: direct light is 2, so this is up to four bounces.
    let max_edges = 6;
    let method = ManyLights {
        // Where lights come from: the vertices of 64 light paths, new ones in each pass.
        generator: Box::new(Keller {
            paths: 64,
            max_edges: Some(max_edges),
            certain_edges: 1,
            emission: Emission::Full,
        }),
        // Which of them each point asks, and how light gets from there to here.
        plan: All,
        kernel: Points,
        // cos cos / d^2 is bounded, against splotches; what that takes from the corners is not put back.
        bounding: BoundPlan::AUTO,
        compensation: Compensation::None,
        max_edges,
        min_edges: 1,
        sharp: 0.0,
    };
    println!("this is {}", method.claim());
    let settings = Settings { budget: Budget::Passes(16), seed: 0, spp: 1, threads: None };
    let mut report = |p: &Progress| println!("pass {}: {:.1} s, {} rays", p.passes, p.elapsed.as_secs_f64(), p.rays);
    let done = render(&scene, &method, &settings, &mut report, &Arc::default())?;

    let picture = Picture { standard_error: done.standard_error, ..Picture::from(done.image) };
    write_exr("vpl_cornell.exr".as_ref(), &picture)?;
    let ev = write_png("vpl_cornell.png".as_ref(), &picture.image, Exposure::Auto)?;
    println!("wrote vpl_cornell.exr, and vpl_cornell.png at an exposure of {ev} EV");
    Ok(())
}
