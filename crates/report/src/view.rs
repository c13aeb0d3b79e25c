//! An image that belongs to someone else.

use crate::ReportError;
use manylight_math::Spectrum;

/// Pixels row by row from the top left.
#[derive(Clone, Copy, Debug)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    pixels: &'a [Spectrum],
}

impl<'a> ImageView<'a> {
    /// At least one pixel, and as many as the size says.
    pub fn new(width: usize, height: usize, pixels: &'a [Spectrum]) -> Result<Self, ReportError> {
        if pixels.is_empty() || width.checked_mul(height) != Some(pixels.len()) {
            return Err(ReportError::NoImage { width, height, found: pixels.len() });
        }
        Ok(ImageView { width, height, pixels })
    }
    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }
    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }
    /// All of them.
    pub fn pixels(&self) -> &'a [Spectrum] {
        self.pixels
    }
    /// Column and row of a pixel.
    pub(crate) fn place(&self, index: usize) -> [usize; 2] {
        [index % self.width, index / self.width]
    }
    /// An error unless `reference` has this size.
    pub(crate) fn check_size(&self, reference: &ImageView) -> Result<(), ReportError> {
        if (self.width, self.height) == (reference.width, reference.height) {
            return Ok(());
        }
        Err(ReportError::SizeMismatch {
            image_width: self.width,
            image_height: self.height,
            reference_width: reference.width,
            reference_height: reference.height,
        })
    }
}

/// A pixel in f64.
pub(crate) fn channels(pixel: Spectrum) -> [f64; 3] {
    pixel.to_array().map(f64::from)
}

/// Channel by channel mean; NaN of nothing.
pub(crate) fn mean(pixels: impl Iterator<Item = Spectrum>) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0usize);
    for pixel in pixels {
        let pixel = channels(pixel);
        sum = std::array::from_fn(|c| sum[c] + pixel[c]);
        count += 1;
    }
    sum.map(|s| s / count as f64)
}
