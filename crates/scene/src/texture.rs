//! Colours that vary over a surface.

use glam::Affine2;
use manylight_math::{Spectrum, Vec2};
use std::sync::Arc;

/// Index of a texture in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureId(pub u32);

/// A colour: the same everywhere, or looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// The same everywhere.
    Constant(Spectrum),
    /// Looked up by texture coordinates.
    Texture(TextureId),
}

impl Source {
    /// The colour at texture coordinates.
    pub fn at(&self, textures: &[Texture], uv: Vec2) -> Spectrum {
        match self {
            Source::Constant(c) => *c,
            Source::Texture(id) => textures[id.0 as usize].at(uv),
        }
    }
    /// The mean over the unit square.
    pub fn mean(&self, textures: &[Texture]) -> Spectrum {
        match self {
            Source::Constant(c) => *c,
            Source::Texture(id) => textures[id.0 as usize].mean(),
        }
    }
}

/// Linear RGB pixels, row 0 first.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// Pixels in a row; positive.
    pub width: usize,
    /// Rows; positive.
    pub height: usize,
    /// `width * height` of them.
    pub pixels: Vec<Spectrum>,
}

/// How to look between pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureFilter {
    /// The pixel that holds the point.
    Nearest,
    /// Linear between the four nearest pixel centres.
    Bilinear,
}

/// What lies outside the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The same again.
    Repeat,
    /// The same, mirrored.
    Mirror,
    /// The border.
    Clamp,
}

impl Wrap {
    fn index(self, i: i64, n: usize) -> usize {
        let n = n as i64;
        (match self {
            Wrap::Repeat => i.rem_euclid(n),
            Wrap::Mirror => {
                let k = i.rem_euclid(2 * n);
                if k < n { k } else { 2 * n - 1 - k }
            }
            Wrap::Clamp => i.clamp(0, n - 1),
        }) as usize
    }
}

/// A colour that varies with the texture coordinates.
#[derive(Clone, Debug)]
pub enum Texture {
    /// Two by two squares to the unit square: `color0` where u and v lie in the same half.
    Checkerboard {
        /// In the lower left square.
        color0: Spectrum,
        /// In the lower right square.
        color1: Spectrum,
        /// Applied to the texture coordinates first.
        to_uv: Affine2,
    },
    /// An image; its row 0 lies at v = 0.
    Bitmap {
        /// The pixels; may be shared.
        image: Arc<Bitmap>,
        /// Between pixels.
        filter: TextureFilter,
        /// Outside the unit square.
        wrap: Wrap,
        /// Applied to the texture coordinates first.
        to_uv: Affine2,
    },
}

impl Texture {
    /// The colour at texture coordinates.
    pub fn at(&self, uv: Vec2) -> Spectrum {
        match self {
            Texture::Checkerboard { color0, color1, to_uv } => {
                let p = to_uv.transform_point2(uv);
                let p = p - p.floor();
                if (p.x > 0.5) == (p.y > 0.5) { *color0 } else { *color1 }
            }
            Texture::Bitmap { image, filter, wrap, to_uv } => image.at(to_uv.transform_point2(uv), *filter, *wrap),
        }
    }
    /// How the luminance changes with u and with v: the derivative of `at` where that has one, zero at its steps.
    pub fn gradient(&self, uv: Vec2) -> Vec2 {
        match self {
            Texture::Bitmap { image, filter: TextureFilter::Bilinear, wrap, to_uv } => {
                to_uv.matrix2.transpose() * image.gradient(to_uv.transform_point2(uv), *wrap)
            }
            _ => Vec2::ZERO,
        }
    }
    /// The mean over the unit square (of the image, whatever the transform).
    pub fn mean(&self) -> Spectrum {
        match self {
            Texture::Checkerboard { color0, color1, .. } => (*color0 + *color1) * 0.5,
            Texture::Bitmap { image, .. } => {
                let sum = image.pixels.iter().fold([0.0f64; 3], |s, p| {
                    let c = p.to_array();
                    [s[0] + c[0] as f64, s[1] + c[1] as f64, s[2] + c[2] as f64]
                });
                Spectrum::from(sum.map(|x| (x / image.pixels.len() as f64) as f32))
            }
        }
    }
}

impl Bitmap {
    /// The derivative of the luminance of the bilinear `at`.
    fn gradient(&self, uv: Vec2, wrap: Wrap) -> Vec2 {
        if !uv.is_finite() {
            return Vec2::ZERO;
        }
        let size = Vec2::new(self.width as f32, self.height as f32);
        let p = uv * size - 0.5;
        let (corner, f) = (p.floor(), p - p.floor());
        let (x, y) = (corner.x as i64, corner.y as i64);
        let pixel = |x: i64, y: i64| {
            self.pixels[wrap.index(y, self.height) * self.width + wrap.index(x, self.width)].luminance()
        };
        let [a, b, c, d] = [pixel(x, y), pixel(x + 1, y), pixel(x, y + 1), pixel(x + 1, y + 1)];
        let mix = |low: f32, high: f32, t: f32| low + (high - low) * t;
        Vec2::new(mix(b - a, d - c, f.y), mix(c - a, d - b, f.x)) * size
    }
    /// The colour at a point; (0, 0) is the outer corner of the first pixel, (1, 1) of the last.
    pub fn at(&self, uv: Vec2, filter: TextureFilter, wrap: Wrap) -> Spectrum {
        if !uv.is_finite() {
            return Spectrum::BLACK;
        }
        let p = uv * Vec2::new(self.width as f32, self.height as f32);
        let pixel = |x: i64, y: i64| self.pixels[wrap.index(y, self.height) * self.width + wrap.index(x, self.width)];
        match filter {
            TextureFilter::Nearest => pixel(p.x.floor() as i64, p.y.floor() as i64),
            TextureFilter::Bilinear => {
                let p = p - 0.5;
                let (x, y) = (p.x.floor(), p.y.floor());
                let (fx, fy) = (p.x - x, p.y - y);
                let (x, y) = (x as i64, y as i64);
                let row = |y: i64| Spectrum::lerp(pixel(x, y), pixel(x + 1, y), fx);
                Spectrum::lerp(row(y), row(y + 1), fy)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bitmap() -> Bitmap {
        Bitmap { width: 2, height: 2, pixels: [1.0, 2.0, 3.0, 4.0].map(Spectrum::gray).to_vec() }
    }
    #[test]
    fn a_bitmap_is_exact_at_its_pixel_centres_and_linear_between() {
        let b = bitmap();
        for filter in [TextureFilter::Nearest, TextureFilter::Bilinear] {
            assert_eq!(b.at(Vec2::new(0.75, 0.25), filter, Wrap::Clamp), Spectrum::gray(2.0));
        }
        assert_eq!(b.at(Vec2::splat(0.5), TextureFilter::Bilinear, Wrap::Clamp), Spectrum::gray(2.5));
    }
    #[test]
    fn wraps_repeat_mirror_and_clamp() {
        let at = |x: f32, wrap| bitmap().at(Vec2::new(x, 0.25), TextureFilter::Nearest, wrap).0.x;
        assert_eq!([at(1.25, Wrap::Repeat), at(1.25, Wrap::Mirror), at(1.25, Wrap::Clamp)], [1.0, 2.0, 2.0]);
        assert_eq!([at(-0.25, Wrap::Repeat), at(-0.25, Wrap::Mirror), at(-0.25, Wrap::Clamp)], [2.0, 1.0, 1.0]);
        assert_eq!(at(f32::NAN, Wrap::Repeat), 0.0);
    }
}
