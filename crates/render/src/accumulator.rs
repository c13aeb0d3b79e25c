//! Mean and variance over passes.

use crate::RenderError;
use manylight_framework::Image;
use manylight_math::{DVec3, Spectrum};

/// The running mean and variance of every pixel and channel over passes, in double precision (Welford 1962). Passes are
/// added in their order, so that the result does not depend on threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Accumulator {
    width: usize,
    height: usize,
    passes: u64,
    pixels: Vec<Moments>,
}

/// Mean of the passes so far, and the sum of their squared distances from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    mean: DVec3,
    squares: DVec3,
}

impl Accumulator {
    /// No passes yet of images of this size.
    pub fn new(width: usize, height: usize) -> Self {
        Accumulator { width, height, passes: 0, pixels: vec![Moments::default(); width * height] }
    }
    /// How many passes have been added.
    pub fn passes(&self) -> u64 {
        self.passes
    }
    /// Adds one pass. An image of another size is refused, and nothing is changed.
    pub fn add(&mut self, pass: &Image) -> Result<(), RenderError> {
        self.check((pass.width, pass.height), pass.pixels.len())?;
        self.passes += 1;
        let n = self.passes as f64;
        for (moments, pixel) in self.pixels.iter_mut().zip(&pass.pixels) {
            let x = pixel.0.as_dvec3();
            let before = x - moments.mean;
            moments.mean += before / n;
            moments.squares += before * (x - moments.mean);
        }
        Ok(())
    }
    /// Adds all passes of another accumulator (Chan, Golub and LeVeque 1979). The result is that of adding them one by one
    /// up to rounding.
    pub fn merge(&mut self, other: &Accumulator) -> Result<(), RenderError> {
        self.check((other.width, other.height), other.pixels.len())?;
        if other.passes == 0 {
            return Ok(());
        }
        let (a, b) = (self.passes as f64, other.passes as f64);
        for (moments, more) in self.pixels.iter_mut().zip(&other.pixels) {
            let difference = more.mean - moments.mean;
            moments.mean += difference * (b / (a + b));
            moments.squares += more.squares + difference * difference * (a * b / (a + b));
        }
        self.passes += other.passes;
        Ok(())
    }
    /// The mean of the passes; black where there are none.
    pub fn mean(&self) -> Image {
        self.image(|m| m.mean)
    }
    /// The standard error of the mean, sqrt(variance / passes). `None` with fewer than two passes.
    pub fn standard_error(&self) -> Option<Image> {
        let degrees = self.degrees()?;
        Some(self.image(|m| (m.squares.max(DVec3::ZERO) / degrees).map(f64::sqrt)))
    }
    /// Estimates the relative mean squared error of the mean, as far as it is noise:
    ///
    /// ```text
    /// mean_j  s_j^2 / (mean_j^2 + 0.01 mean^2)
    /// ```
    ///
    /// over pixels and channels j, `s_j` the standard error and `mean` that of the whole image. The bias of a method is not
    /// in it. `None` with fewer than two passes; a black image without noise has 0.
    pub fn estimated_error(&self) -> Option<f64> {
        let degrees = self.degrees()?;
        let count = (3 * self.pixels.len()) as f64;
        let mean = self.pixels.iter().map(|m| m.mean.element_sum()).sum::<f64>() / count;
        let floor = 0.01 * mean * mean;
        let relative = |squares: f64, mean: f64| {
            let variance = squares / degrees;
            if variance == 0.0 { 0.0 } else { variance / (mean * mean + floor) }
        };
        let of_pixel = |m: &Moments| (0..3).map(|i| relative(m.squares[i], m.mean[i])).sum::<f64>();
        Some(if self.pixels.is_empty() { 0.0 } else { self.pixels.iter().map(of_pixel).sum::<f64>() / count })
    }

    /// What a sum of squares is divided by to give the variance of the mean.
    fn degrees(&self) -> Option<f64> {
        let n = self.passes as f64;
        (self.passes >= 2).then_some(n * (n - 1.0))
    }
    fn image(&self, value: impl Fn(&Moments) -> DVec3) -> Image {
        let pixels = self.pixels.iter().map(|m| Spectrum(value(m).as_vec3())).collect();
        Image { width: self.width, height: self.height, pixels }
    }
    fn check(&self, found: (usize, usize), pixels: usize) -> Result<(), RenderError> {
        let expected = (self.width, self.height);
        if found == expected && pixels == self.pixels.len() {
            Ok(())
        } else {
            Err(RenderError::Size { expected, found })
        }
    }
}
