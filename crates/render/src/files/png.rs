//! PNG, to look at.

use super::write_atomically;
use crate::RenderError;
use ::image::codecs::png::PngEncoder;
use ::image::{ExtendedColorType, ImageEncoder};
use manylight_framework::Image;
use manylight_math::Spectrum;
use std::io;
use std::path::Path;

/// How radiance becomes brightness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Radiance times 2^EV: at 0, a radiance of 1 is white.
    Ev(f32),
    /// The 95th percentile of the largest channel of all pixels that are not black becomes white, the exposure being rounded
    /// to a tenth. A small lamp in the picture then does not darken the room around it, and coloured walls keep their colour.
    Auto,
}

impl Exposure {
    /// The exposure value this means for `image`. An image without light has 0.
    pub fn ev(self, image: &Image) -> f32 {
        match self {
            Exposure::Ev(ev) => ev,
            Exposure::Auto => automatic_ev(image),
        }
    }
}

/// Writes the image with 8 bits a channel and the sRGB curve, and returns the exposure value that was used. Radiance above
/// white and below black is clipped; a pixel that is not a number is black.
pub fn write_png(path: &Path, image: &Image, exposure: Exposure) -> Result<f32, RenderError> {
    let ev = exposure.ev(image);
    let bytes = srgb_bytes(image, ev);
    let (width, height) = size(path, (image.width, image.height))?;
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| RenderError::write(path, io::Error::other(e)))?;
    write_atomically(path, &file)?;
    Ok(ev)
}

/// Three bytes a pixel.
pub(super) fn srgb_bytes(image: &Image, ev: f32) -> Vec<u8> {
    let scale = ev.exp2();
    image.pixels.iter().flat_map(|p| (*p * scale).to_array().map(srgb_byte)).collect()
}

/// Width and height, if a PNG can have them.
pub(super) fn size(path: &Path, (width, height): (usize, usize)) -> Result<(u32, u32), RenderError> {
    let too_large = |_| RenderError::write(path, io::Error::other("the image is too large for a PNG"));
    Ok((u32::try_from(width).map_err(too_large)?, u32::try_from(height).map_err(too_large)?))
}

fn automatic_ev(image: &Image) -> f32 {
    let largest = image.pixels.iter().copied().map(Spectrum::largest);
    let mut lit: Vec<f32> = largest.filter(|l| l.is_finite() && *l > 0.0).collect();
    if lit.is_empty() {
        return 0.0;
    }
    let place = (lit.len() - 1) * 95 / 100;
    let (_, white, _) = lit.select_nth_unstable_by(place, f32::total_cmp);
    (-white.log2() * 10.0).round() / 10.0
}

/// IEC 61966-2-1, rounded to the nearest of 256 steps.
fn srgb_byte(linear: f32) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    // The cast saturates and makes NaN zero.
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(values: &[f32]) -> Image {
        Image { width: values.len(), height: 1, pixels: values.iter().map(|&x| Spectrum::gray(x)).collect() }
    }
    fn bytes_of(path: &Path) -> Vec<u8> {
        ::image::open(path).unwrap().into_rgb8().into_raw()
    }
    #[test]
    fn linear_light_is_written_as_srgb_and_clipped() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        let values = [0.0, 0.002, 0.215_86, 1.0, 7.0, -1.0, f32::NAN, f32::INFINITY];
        assert_eq!(write_png(&path, &gray(&values), Exposure::Ev(0.0)).unwrap(), 0.0);
        let expected = [0, 7, 128, 255, 255, 0, 0, 255];
        assert_eq!(bytes_of(&path), expected.map(|b| [b; 3]).concat());
    }
    #[test]
    fn one_more_ev_is_twice_the_light() {
        let directory = tempfile::tempdir().unwrap();
        let (a, b) = (directory.path().join("a.png"), directory.path().join("b.png"));
        write_png(&a, &gray(&[0.1, 0.2, 0.3]), Exposure::Ev(1.0)).unwrap();
        write_png(&b, &gray(&[0.2, 0.4, 0.6]), Exposure::Ev(0.0)).unwrap();
        assert_eq!(bytes_of(&a), bytes_of(&b));
    }
    #[test]
    fn automatic_exposure_puts_the_lit_part_at_white_whatever_the_lamp_and_the_dark() {
        let mut values = vec![0.25; 200];
        values.extend([1000.0; 3]);
        values.extend([0.0; 300]);
        values.extend([f32::NAN, f32::INFINITY]);
        assert_eq!(Exposure::Auto.ev(&gray(&values)), 2.0);
        assert_eq!(Exposure::Auto.ev(&gray(&[0.0; 9])), 0.0);
        assert_eq!(Exposure::Auto.ev(&gray(&[])), 0.0);
    }
}
