//! Linear RGB.

use crate::Vec3;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

/// Three linear channels (Rec. 709 primaries). What they measure (\[W\], [W/sr], [W/(m^2 sr)]) is said by whoever returns one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spectrum(pub Vec3);

impl Spectrum {
    /// Nothing.
    pub const BLACK: Self = Spectrum(Vec3::ZERO);
    /// One in each channel.
    pub const ONE: Self = Spectrum(Vec3::ONE);

    /// From the three channels.
    pub const fn rgb(r: f32, g: f32, b: f32) -> Self {
        Spectrum(Vec3::new(r, g, b))
    }
    /// The same in each channel.
    pub const fn gray(x: f32) -> Self {
        Spectrum(Vec3::splat(x))
    }
    /// Luminance (Rec. 709). The one scalar by which light is weighed: probabilities and intensities are made of it.
    pub fn luminance(self) -> f32 {
        0.2126 * self.0.x + 0.7152 * self.0.y + 0.0722 * self.0.z
    }
    /// Largest channel: what material bounds are made of, since lum(a b) can exceed lum(a) lum(b).
    pub fn largest(self) -> f32 {
        self.0.max_element()
    }
    /// Mean of the channels.
    pub fn mean(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) / 3.0
    }
    /// Exactly zero in each channel.
    pub fn is_black(self) -> bool {
        self.0 == Vec3::ZERO
    }
    /// No channel is NaN or infinite.
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    /// Finite, and no channel below zero: what radiance has to be.
    pub fn is_valid(self) -> bool {
        self.is_finite() && self.0.min_element() >= 0.0
    }
    /// Applies `f` to each channel.
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Spectrum::rgb(f(self.0.x), f(self.0.y), f(self.0.z))
    }
    /// Channels as an array.
    pub fn to_array(self) -> [f32; 3] {
        self.0.to_array()
    }
    /// `a` at 0, `b` at 1.
    pub fn lerp(a: Self, b: Self, t: f32) -> Self {
        a * (1.0 - t) + b * t
    }
}

impl From<[f32; 3]> for Spectrum {
    fn from(c: [f32; 3]) -> Self {
        Spectrum(Vec3::from_array(c))
    }
}
impl Add for Spectrum {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Spectrum(self.0 + o.0)
    }
}
impl AddAssign for Spectrum {
    fn add_assign(&mut self, o: Self) {
        self.0 += o.0;
    }
}
impl Sub for Spectrum {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Spectrum(self.0 - o.0)
    }
}
impl Mul for Spectrum {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Spectrum(self.0 * o.0)
    }
}
impl Mul<f32> for Spectrum {
    type Output = Self;
    fn mul(self, o: f32) -> Self {
        Spectrum(self.0 * o)
    }
}
impl MulAssign<f32> for Spectrum {
    fn mul_assign(&mut self, o: f32) {
        self.0 *= o;
    }
}
impl MulAssign for Spectrum {
    fn mul_assign(&mut self, o: Self) {
        self.0 *= o.0;
    }
}
impl Div<f32> for Spectrum {
    type Output = Self;
    fn div(self, o: f32) -> Self {
        Spectrum(self.0 / o)
    }
}
impl std::iter::Sum for Spectrum {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Spectrum::BLACK, |a, b| a + b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminance_of_a_product_can_exceed_the_product_of_luminances_thirteenfold() {
        let blue = Spectrum::rgb(0.0, 0.0, 1.0);
        let ratio = (blue * blue).luminance() / (blue.luminance() * blue.luminance());
        assert!(ratio > 13.0 && ratio < 14.0, "{ratio}");
        assert!((blue * blue).largest() <= blue.largest() * blue.largest());
    }
    #[test]
    fn a_channel_that_is_nan_is_not_valid() {
        assert!(!Spectrum::rgb(0.0, f32::NAN, 0.0).is_valid());
        assert!(!Spectrum::rgb(0.0, -1e-9, 0.0).is_valid());
        assert!(Spectrum::BLACK.is_valid());
    }
}
