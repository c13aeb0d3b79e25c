//! Many-light rendering methods that compose: one name for all crates.
//!
//! Global illumination as a sum over virtual lights, L(x) = sum_i f(x) G(x, y_i) V(x, y_i) f(y_i) Phi_i, with each part of that
//! sum a crate of its own. Depend on this facade to try things, on the single crates to build on one or two of them.
//!
//! ```
//! use manylight::recipes;
//! use manylight::render::{Budget, Progress, Settings, render};
//! use manylight::scene_io::{LoadOptions, load};
//! use std::sync::Arc;
//!
//! // A closed sphere, which looks the same everywhere: its wall emits 1 and reflects half, so the radiance is 2.
//! # let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/furnace/scene.xml");
//! let scene = load(file.as_ref(), &LoadOptions { size: Some((8, 8)), ..LoadOptions::default() })?.scene;
//! let recipe = recipes::build("instant-radiosity", &[("paths".into(), "256".into())], &scene)?;
//! let settings = Settings { budget: Budget::Passes(1), seed: 0, spp: recipe.spp, threads: None };
//! // Who watches (here nobody), and a flag by which another thread may stop it (here never).
//! let done = render(&scene, &*recipe.method, &settings, &mut |_: &Progress| {}, &Arc::default())?;
//! let mean = done.image.pixels.iter().map(|p| p.mean()).sum::<f32>() / 64.0;
//! assert!((mean - 2.0).abs() < 0.2, "{mean}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! In `examples/` of this crate: 01 is a furnace, 02 an image by virtual point lights whose method is put together by hand, 03 two
//! light sets in one method, 06 a scene that a program builds and writes. `cargo run --release -p manylight --example 01_furnace` runs the
//! first. 04 a light and 05 a light set of your own are a crate of their own, `examples/outside` of the repository.

pub use manylight_bsdf as bsdf;
pub use manylight_compensation as compensation;
pub use manylight_framework as framework;
pub use manylight_geometry as geometry;
pub use manylight_lamps as lamps;
pub use manylight_lgh as lgh;
pub use manylight_light_list as light_list;
pub use manylight_light_tree as light_tree;
pub use manylight_many_lights as many_lights;
pub use manylight_math as math;
pub use manylight_media as media;
pub use manylight_metropolis_ir as metropolis_ir;
pub use manylight_photon as photon;
pub use manylight_recipes as recipes;
pub use manylight_reference as reference;
pub use manylight_render as render;
pub use manylight_report as report;
pub use manylight_sampling as sampling;
pub use manylight_scene as scene;
pub use manylight_scene_io as scene_io;
pub use manylight_stats as stats;
pub use manylight_verify as verify;
pub use manylight_volume_lights as volume_lights;
pub use manylight_vpl as vpl;
pub use manylight_vrl as vrl;
pub use manylight_vsl as vsl;
