//! Media that shine, as many small lights: one for each block of voxels of an emission grid,
//!
//! > I = int j(y) dV [W/sr]    at the block's middle by what shines,
//!
//! which is level 0 of a lighting grid hierarchy (Yuksel and Yuksel 2017), or a light of any other set. Transport from it is that of a
//! ball as large as the block: 1/d^2 from outside, at most 3/a^2 in it, so that smoke inside a fire has no spikes.
//!
//! ```
//! use manylight_volume_lights::mean_inverse_square;
//! // At the centre of a ball of radius 2, on its surface, far away.
//! assert!((mean_inverse_square(0.0, 2.0) - 0.75).abs() < 1e-6);
//! assert!((mean_inverse_square(4.0, 2.0) - 0.375).abs() < 1e-6);
//! assert!((mean_inverse_square(1e6, 2.0) * 1e6 - 1.0).abs() < 1e-5);
//! ```

mod ball;
mod generator;
mod kernel;
mod light;

pub use ball::{VolumeLight, mean_inverse_square};
pub use generator::{VolumeError, VolumeLights};
pub use kernel::Balls;
pub use light::{Cluster, Sum};
