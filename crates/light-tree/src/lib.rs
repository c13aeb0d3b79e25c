//! Light sets over a tree of clusters: cost per receiver grows with the logarithm of the number of lights.
//!
//! Lights are leaves; each node knows a box, a cone and an intensity of the lights below it ([`Clustered`]). A *cut* is a set of
//! nodes that each path from a leaf to the root meets exactly once, and
//!
//! > sum_i c_i(x)  =  sum over the cut's nodes C of  sum_{i in C} c_i(x),
//!
//! where each set estimates the inner sum from a single light of C:
//!
//! | set | light of C | cut |
//! |---|---|---|
//! | [`Lightcuts`] (Walter et al. 2005) | its representative, times the ratio of weights | until no node can be off by more than 2 % |
//! | [`StochasticLightcuts`] (Yuksel 2019) | one drawn for this receiver by a walk down the tree, over its probability | of fixed size, or by error |
//! | [`LightBvh`] (Conty Estevez and Kulla 2018) | the same with another importance | the root alone, several times |
//!
//! ```
//! use manylight_framework::{Claim, Promise};
//! use manylight_light_tree::{Lightcuts, StochasticLightcuts};
//! assert!(StochasticLightcuts::default().claim().is_unbiased());
//! assert!(!Lightcuts::default().claim().is_unbiased());
//! ```
//!
//! [`Clustered`]: manylight_framework::Clustered

mod descent;
mod error;
mod fast;
mod greedy;
mod light_bvh;
mod lightcuts;
mod starts;
mod stochastic;
mod tree;

pub use error::TreeError;
pub use light_bvh::{BvhLights, LightBvh};
pub use lightcuts::{CutLights, Lightcuts, Standing};
pub use stochastic::{CutBy, DescentLights, StochasticLightcuts};
pub use tree::{Build, Group, Growth, LightTree, Representatives};
