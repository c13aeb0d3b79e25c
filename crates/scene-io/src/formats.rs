//! The files that scenes name, one format at a time: is a file's content what it should be? For fuzzing, and for tools.

use crate::mesh::{obj, ply, serialized};
use crate::{image, vol};
use std::io::Cursor;

/// A format of files beside the scene's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, whose MTL files are not read.
    Obj,
    /// Stanford PLY.
    Ply,
    /// A mesh of Mitsuba's, the first of the file's.
    Serialized,
    /// A grid of Mitsuba's.
    Vol,
    /// PNG, JPEG, Radiance HDR or OpenEXR, by its content.
    Image,
}

/// How much is in a file (vertices and triangles, voxels or pixels), or why it cannot be read.
pub fn check(format: Format, bytes: &[u8]) -> Result<usize, String> {
    match format {
        Format::Obj => obj::read(bytes).map(|m| m.positions.len() + m.triangles.len()),
        Format::Ply => ply::read(bytes).map(|m| m.positions.len() + m.triangles.len()),
        Format::Serialized => {
            serialized::read(&mut Cursor::new(bytes), 0).map(|m| m.positions.len() + m.triangles.len())
        }
        Format::Vol => vol::read(bytes).map(|g| g.values.len()),
        Format::Image => image::read(bytes, false).map(|(image, _)| image.pixels.len()),
    }
}
