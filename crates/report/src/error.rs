//! What can be wrong with two images.

/// Why images cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Sizes differ.
    #[error(
        "the image is {image_width} x {image_height} pixels and the reference {reference_width} x {reference_height}"
    )]
    SizeMismatch {
        /// Of the image.
        image_width: usize,
        /// Of the image.
        image_height: usize,
        /// Of the reference.
        reference_width: usize,
        /// Of the reference.
        reference_height: usize,
    },
    /// An image without pixels, or with another number than its size says.
    #[error("{found} pixels do not make an image of {width} x {height}")]
    NoImage {
        /// Stated width.
        width: usize,
        /// Stated height.
        height: usize,
        /// Pixels there are.
        found: usize,
    },
    /// Every pixel is NaN or infinite in one of the images.
    #[error("none of the {pixels} pixels is finite in all images")]
    NothingFinite {
        /// Pixels of each.
        pixels: usize,
    },
    /// More blocks than pixels, or none.
    #[error("an image of {width} x {height} pixels cannot be tiled with {columns} x {rows} blocks")]
    Tiling {
        /// Of the image.
        width: usize,
        /// Of the image.
        height: usize,
        /// Blocks across.
        columns: usize,
        /// Blocks down.
        rows: usize,
    },
    /// Drawing failed.
    #[error("the plot cannot be drawn: {0}")]
    Plot(String),
    /// Writing JSON failed.
    #[error("the report cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}
