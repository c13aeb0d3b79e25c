//! How steady a sequence of images is.

use crate::{ImageView, ReportError};
use manylight_math::Spectrum;
use std::fmt;

/// How much pixels change from frame to frame: of frames I_0, I_1, .. with M the mean of all their pixels, and means taken over frames,
/// pixels and channels,
///
/// ```text
/// change  = mean |I_(k+1) - I_k| / M
/// flicker = mean |I_(k+2) - 2 I_(k+1) + I_k| / (sqrt(3) M)
/// ```
///
/// Noise of each frame's own appears in both alike: what moves or brightens evenly is no flicker, and its part of `change` is what is
/// more of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Frames.
    pub frames: usize,
    /// First differences, relative to the mean.
    pub change: f64,
    /// Second differences, relative to the mean; `None` of two frames.
    pub flicker: Option<f64>,
}

impl fmt::Display for Steadiness {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "pixels change by {:.3} % of the mean from frame to frame", 100.0 * self.change)?;
        match self.flicker {
            Some(flicker) => write!(f, ", and flicker by {:.3} %", 100.0 * flicker),
            None => Ok(()),
        }
    }
}

/// Measures a [`Steadiness`], frame by frame.
#[derive(Default)]
pub struct Sequence {
    /// The last frame, and the one before.
    last: Vec<Vec<Spectrum>>,
    size: (usize, usize),
    frames: usize,
    mean: f64,
    change: f64,
    flicker: f64,
}

impl Sequence {
    /// The next frame; an error if it has another size. Pixels must be finite.
    pub fn add(&mut self, frame: &ImageView) -> Result<(), ReportError> {
        let size = (frame.width(), frame.height());
        if self.frames == 0 {
            self.size = size;
        }
        let ((image_width, image_height), (reference_width, reference_height)) = (size, self.size);
        if size != self.size {
            return Err(ReportError::SizeMismatch { image_width, image_height, reference_width, reference_height });
        }
        let channels = 3.0 * frame.pixels().len() as f64;
        let mean = |of: &dyn Fn(usize) -> [f32; 3]| {
            let sum = |i| of(i).iter().map(|c| f64::from(*c)).sum::<f64>();
            (0..frame.pixels().len()).map(sum).sum::<f64>() / channels
        };
        let now = frame.pixels();
        self.mean += mean(&|i| now[i].to_array());
        if let [last, ..] = &self.last[..] {
            self.change += mean(&|i| (now[i] - last[i]).to_array().map(f32::abs));
        }
        if let [last, before] = &self.last[..] {
            self.flicker += mean(&|i| ((now[i] - last[i]) - (last[i] - before[i])).to_array().map(f32::abs));
        }
        self.last.truncate(1);
        self.last.insert(0, now.to_vec());
        self.frames += 1;
        Ok(())
    }
    /// `None` of fewer than two frames, and if all is black.
    pub fn steadiness(&self) -> Option<Steadiness> {
        let whole = self.mean / self.frames as f64;
        let over = |sum: f64, count: usize| sum / count as f64 / whole;
        (self.frames > 1 && whole > 0.0).then(|| Steadiness {
            frames: self.frames,
            change: over(self.change, self.frames - 1),
            // Of independent noise a first difference has twice the variance, a second one six times.
            flicker: (self.frames > 2).then(|| over(self.flicker, self.frames - 2) / 3f64.sqrt()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(frames: &[Vec<Spectrum>]) -> Option<Steadiness> {
        let mut sequence = Sequence::default();
        frames.iter().for_each(|f| sequence.add(&ImageView::new(f.len(), 1, f).unwrap()).unwrap());
        sequence.steadiness()
    }
    #[test]
    fn what_brightens_evenly_changes_and_does_not_flicker() {
        let frames: Vec<_> = (0..5).map(|k| vec![Spectrum::gray(1.0 + 0.5 * k as f32); 3]).collect();
        let found = of(&frames).unwrap();
        assert_eq!((found.frames, found.change, found.flicker), (5, 0.25, Some(0.0)));
    }
    #[test]
    fn independent_noise_is_as_much_change_as_flicker() {
        let mut state = 1u32;
        let mut noise = || {
            // Sums of twelve uniform numbers: Gaussian enough.
            let uniform = |state: &mut u32| {
                *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                (*state >> 8) as f32 / 16_777_216.0
            };
            1.0 + 0.1 * ((0..12).map(|_| uniform(&mut state)).sum::<f32>() - 6.0)
        };
        let frames: Vec<_> = (0..40).map(|_| (0..400).map(|_| Spectrum::gray(noise())).collect()).collect();
        let found = of(&frames).unwrap();
        // Mean absolute difference of two Gaussians of deviation 0.1.
        let expected = 0.2 / std::f64::consts::PI.sqrt();
        assert!((found.change / expected - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.flicker.unwrap() / expected - 1.0).abs() < 0.02, "{found:?}");
    }
    #[test]
    fn a_frame_alone_and_darkness_say_nothing_and_sizes_must_agree() {
        assert_eq!(of(&[vec![Spectrum::ONE]]), None);
        assert_eq!(of(&vec![vec![Spectrum::BLACK]; 3]), None);
        let mut sequence = Sequence::default();
        sequence.add(&ImageView::new(1, 1, &[Spectrum::ONE]).unwrap()).unwrap();
        assert!(sequence.add(&ImageView::new(2, 1, &[Spectrum::ONE; 2]).unwrap()).is_err());
    }
}
