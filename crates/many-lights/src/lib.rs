//! The composite integrator: generator x light set x kernel x bounding x compensation.
//!
//! At the first vertex x of an eye path that scatters into all directions,
//!
//! > L(x -> eye) = emission + direct(x) + sum over the lights of keep x contribution + residual(x),
//!
//! where `direct` is sampled (lights and BSDF, combined by multiple importance sampling), unless the lights cover it. Delta
//! lobes (mirrors, glass) are walked through until that vertex, and so are lobes too sharp for few lights to show
//! (`ManyLights::sharp`); emission seen on the way counts once.
//!
//! See `ManyLights` for the parts, and the crate `manylight-recipes` for the named compositions.

mod along;
mod direct;
mod eye;
mod frame;
mod further;
mod in_media;
mod many_lights;

pub use along::direct_along;
pub use direct::{direct_light, lost_direct_light};
pub use in_media::{Along, InMedia, Marched, Parted, Sampled, Segment, Whole};
pub use many_lights::{ManyLights, Prepared};
