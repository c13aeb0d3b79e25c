//! Image files, written whole or not at all.

mod animation;
mod atomic;
mod exr;
mod png;

pub use self::exr::{Attribute, MAX_SAMPLES, Picture, read_exr, write_exr};
pub use self::png::{Exposure, write_png};
pub use animation::{Animation, FRAME_RATE};
pub use atomic::{check_writable, write_atomically};
