//! The furnace: inside a closed sphere whose wall glows, the answer is known for every path length.
//!
//! A wall of albedo rho that emits radiance 1 is seen at 1 by paths of one edge; each further bounce adds rho times the last, so
//! paths of up to k edges carry 1 + rho + .. + rho^(k-1). The geometry term of any two points of a sphere of radius R is
//! 1 / (4 R^2): every virtual light gives every point the same, and a single light path is as good as a million.
//!
//! `cargo run --release -p manylight --example 01_furnace`

use manylight::recipes;
use manylight::render::{Budget, Progress, Settings, render};
use manylight::scene_io::{LoadOptions, load};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/furnace/scene.xml");
    let scene = load(file.as_ref(), &LoadOptions { size: Some((16, 16)), ..LoadOptions::default() })?.scene;
    println!("max-depth  darkest  brightest  exact");
    for k in 1..=6i32 {
        // One path, never ended by Russian roulette; direct light from a virtual light too, and nothing bounded.
        let params = [("paths", "1"), ("rr-depth", "99"), ("direct", "virtual"), ("bound", "none")];
        let params = params.map(|(name, value)| (name.to_string(), value.to_string()));
        let params = [&params[..], &[("max-depth".to_string(), k.to_string())]].concat();
        let recipe = recipes::build("instant-radiosity", &params, &scene)?;

        let settings = Settings { budget: Budget::Passes(1), seed: 0, spp: recipe.spp, threads: None };
        let done = render(&scene, &*recipe.method, &settings, &mut |_: &Progress| {}, &Arc::default())?;
        let gray = || done.image.pixels.iter().map(|p| p.mean());
        let (darkest, brightest) = (gray().fold(f32::INFINITY, f32::min), gray().fold(0.0, f32::max));

        // The scene's albedo is 1/2, so the sum is 2 - 2^(1-k).
        let exact = 2.0 - 0.5f32.powi(k - 1);
        println!("{k:9}  {darkest:7.4}  {brightest:9.4}  {exact:.4}");
        assert!((darkest - exact).abs() < 1e-3 * exact && (brightest - exact).abs() < 1e-3 * exact);
    }
    Ok(())
}
