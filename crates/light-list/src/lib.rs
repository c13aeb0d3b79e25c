//! Light sets without a tree: all lights, and power sampling.
//!
//! `all` sums every light, sum_i c_i(x). `power` draws n of them by their power and sums c_i(x) / (n p_i) (Shirley, Wang and
//! Zimmerman 1996): the baseline of every sublinear set. Both are unbiased.
//!
//! ```
//! use manylight_framework::{Promise, Plan};
//! use manylight_light_list::{All, Power};
//! assert!(All.claim().is_unbiased() && !All.claim().noisy);
//! assert!(Power { samples: 16 }.claim().is_unbiased());
//! ```

mod all;
mod power;

pub use all::{All, AllLights};
pub use power::{Power, PowerLights};
