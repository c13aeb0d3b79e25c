//! Emitters as lights of a light set, and a path tracer whose next-event estimation is any light set.
//!
//! A [`Lamp`] is a piece of an emitter: a triangle of an emitting mesh, a sphere, a point light, the sky. No points are put on it in
//! advance: the [`LampKernel`] draws one, y of density 1 / A, each time that the light is asked,
//!
//! > E[ f(x) cos_x cos_y L(y) A / |x - y|^2 ]  =  direct light from the lamp at x, without what stands between.
//!
//! With a light set that can say the probability P with which it takes a lamp ([`Picks`]), a direction drawn by the BSDF is as
//! good a way to find the lamp, and both are combined by multiple importance sampling, since P / A is the density of y.
//!
//! ```
//! use manylight_framework::{Claim, Promise};
//! assert!(manylight_lamps::Lamps.claim().is_unbiased());
//! ```
//!
//! [`Picks`]: manylight_framework::Picks

mod generator;
mod kernel;
mod lamp;
mod path_lights;

pub use generator::Lamps;
pub use kernel::LampKernel;
pub use lamp::{Lamp, LampCluster};
pub use path_lights::{ByPicks, BySum, NextEvent, PathLights, Whole};
