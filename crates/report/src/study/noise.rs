//! What of an error is bias, what is noise, and what is the reference's own.

use crate::compare::relative_epsilon;
use crate::view::{ImageView, channels, mean};
use crate::{ReportError, Row};
use serde::Serialize;

/// Relative mean squared error, split. All are means over pixels and channels of squares over R^2 + eps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Of the image, with the reference's variance.
    pub relmse: f64,
    /// The reference's variance; 0 if it is not known.
    pub reference: f64,
    /// Standard deviation of that variance's estimate by one reference: sqrt(2 sum Var(R)^2 / (R^2 + eps)^2) / n.
    pub spread: f64,
    /// mean (A - R)(B - R) / (R^2 + eps) without the reference's variance, A and B being the means of two independent halves of the
    /// passes: its expectation is the squared bias. `None`: there is one pass.
    pub bias: Option<f64>,
}

impl Noise {
    /// relMSE without the reference's variance.
    pub fn net(&self) -> f64 {
        self.relmse - self.reference
    }
    /// Fills in the row's `relmse` and its parts.
    pub fn note(&self, row: &mut Row) {
        (row.relmse, row.relmse_net, row.bias) = (self.relmse, self.net(), self.bias);
        row.noise = self.bias.map(|b| self.net() - b);
    }
}

/// Splits the error of an image against a reference whose standard error may be known. `halves` are means of independent passes.
/// A noisy reference is in the weights too: an effect of second order, of Var(R) / R^2 times the error, is left.
/// Pixels that are not finite in any of the images are left out, as everywhere. `None`: the reference is black.
pub fn separate(
    image: &ImageView,
    halves: Option<[&ImageView; 2]>,
    reference: &ImageView,
    std_error: Option<&ImageView>,
) -> Result<Option<Noise>, ReportError> {
    image.check_size(reference)?;
    for other in halves.iter().flatten().copied().chain(std_error) {
        other.check_size(reference)?;
    }
    let finite = |view: &ImageView, i: usize| view.pixels()[i].is_finite();
    let others = || halves.iter().flatten().copied().chain(std_error);
    let kept: Vec<usize> = (0..image.pixels().len())
        .filter(|&i| finite(image, i) && finite(reference, i) && others().all(|o| finite(o, i)))
        .collect();
    if kept.is_empty() {
        return Err(ReportError::NothingFinite { pixels: image.pixels().len() });
    }
    let eps = relative_epsilon(mean(kept.iter().map(|i| reference.pixels()[*i])));
    if !(eps > 0.0) {
        return Ok(None);
    }
    let (mut error, mut variance, mut squares, mut product) = (0.0, 0.0, 0.0, 0.0);
    for i in &kept {
        let at = |view: &ImageView| channels(view.pixels()[*i]);
        let (x, r) = (at(image), at(reference));
        let (s, ab) = (std_error.map(at), halves.map(|h| h.map(at)));
        for c in 0..3 {
            let weight = 1.0 / (r[c] * r[c] + eps);
            error += weight * (x[c] - r[c]).powi(2);
            let own = weight * s.map_or(0.0, |s| s[c] * s[c]);
            variance += own;
            squares += own * own;
            product += weight * ab.map_or(0.0, |[a, b]| (a[c] - r[c]) * (b[c] - r[c]));
        }
    }
    let n = 3.0 * kept.len() as f64;
    let reference = variance / n;
    let spread = (2.0 * squares).sqrt() / n;
    Ok(Some(Noise { relmse: error / n, reference, spread, bias: halves.map(|_| product / n - reference) }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    fn noise(state: &mut u64) -> f32 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 40) as f32 / (1u64 << 24) as f32 - 0.5) * 12f32.sqrt()
    }
    #[test]
    fn bias_noise_and_the_noise_of_the_reference_are_told_apart() {
        // Truth 1; halves of bias 0.1 and noise 0.2; a reference of noise 0.02.
        let (n, mut state) = (200 * 200, 7u64);
        let mut around =
            |mean: f32, s: f32| (0..n).map(|_| Spectrum::gray(mean + s * noise(&mut state))).collect::<Vec<_>>();
        let (a, b, r) = (around(1.1, 0.2), around(1.1, 0.2), around(1.0, 0.02));
        let image: Vec<Spectrum> = a.iter().zip(&b).map(|(a, b)| (*a + *b) * 0.5).collect();
        let s = vec![Spectrum::gray(0.02); n];
        let view = |p| ImageView::new(200, 200, p).unwrap();
        let (a, b) = (view(&a), view(&b));
        let split = separate(&view(&image), Some([&a, &b]), &view(&r), Some(&view(&s))).unwrap().unwrap();
        // Over R^2 + 0.01: 0.01 bias^2, 0.02 noise, 0.0004 of the reference.
        assert!((split.net() * 1.01 - 0.03).abs() < 0.001, "{split:?}");
        assert!((split.bias.unwrap() * 1.01 - 0.01).abs() < 0.001, "{split:?}");
        assert!((split.reference * 1.01 - 0.0004).abs() < 0.00002, "{split:?}");
        // 3 n numbers of relative variance 0.0004 each.
        assert!((split.spread / (0.0004 / 1.01 * (2.0 / 120_000.0f64).sqrt()) - 1.0).abs() < 0.05, "{split:?}");
        let alone = crate::compare(&view(&image), &view(&r)).unwrap();
        assert!((split.relmse / alone.relmse.unwrap() - 1.0).abs() < 1e-12);
    }
    #[test]
    fn a_black_reference_gives_nothing_and_sizes_must_agree() {
        let black = [Spectrum::BLACK; 4];
        let view = |w| ImageView::new(w, 4 / w, &black).unwrap();
        assert_eq!(separate(&view(2), None, &view(2), None).unwrap(), None);
        assert!(separate(&view(2), None, &view(2), Some(&view(4))).is_err());
    }
}
