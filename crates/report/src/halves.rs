//! Error without the reference's own noise.

use crate::ReportError;
use crate::compare::relative_epsilon;
use crate::view::{ImageView, channels, mean};
use serde::Serialize;

/// Error of an image against a reference that comes as two independent halves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HalvesError {
    /// mean((I - A)(I - B)) over pixels and channels. Its expectation is bias^2 + Var(I), without Var(reference); below zero
    /// where the error is smaller than what the halves can show.
    pub mse: f64,
    /// mean((I - A)(I - B) / (R^2 + eps)) with R = (A + B) / 2. `None` if the reference is black.
    pub relmse: Option<f64>,
    /// Pixels that are finite in all three images.
    pub compared: usize,
    /// Pixels that are not, and are left out.
    pub excluded: usize,
}

/// Error of `image` against the halves `a` and `b`, each an independent estimate of the truth.
pub fn compare_halves(image: &ImageView, a: &ImageView, b: &ImageView) -> Result<HalvesError, ReportError> {
    image.check_size(a)?;
    image.check_size(b)?;
    let triples = || {
        let all = image.pixels().iter().zip(a.pixels()).zip(b.pixels());
        all.map(|((i, a), b)| [*i, *a, *b]).filter(|t| t.iter().all(|p| p.is_finite()))
    };
    let compared = triples().count();
    if compared == 0 {
        return Err(ReportError::NothingFinite { pixels: image.pixels().len() });
    }
    let (mean_a, mean_b) = (mean(triples().map(|t| t[1])), mean(triples().map(|t| t[2])));
    let eps = relative_epsilon(std::array::from_fn(|c| 0.5 * (mean_a[c] + mean_b[c])));
    let (mut product, mut relative) = (0.0, 0.0);
    for [i, a, b] in triples().map(|t| t.map(channels)) {
        for c in 0..3 {
            let (term, r) = ((i[c] - a[c]) * (i[c] - b[c]), 0.5 * (a[c] + b[c]));
            product += term;
            relative += term / (r * r + eps);
        }
    }
    let n = 3.0 * compared as f64;
    Ok(HalvesError {
        mse: product / n,
        relmse: (eps > 0.0).then_some(relative / n),
        compared,
        excluded: image.pixels().len() - compared,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    #[test]
    fn by_hand() {
        let gray = |x: [f32; 2]| x.map(Spectrum::gray);
        let (i, a, b) = (gray([2.0, 1.0]), gray([1.0, 2.0]), gray([1.5, 0.0]));
        let view = |p| ImageView::new(2, 1, p).unwrap();
        let error = compare_halves(&view(&i), &view(&a), &view(&b)).unwrap();
        // (1 * 0.5 - 1 * 1) / 2; R = 1.25 and 1, mean 1.125.
        assert!((error.mse + 0.25).abs() < 1e-12);
        let eps = 0.01 * 1.125 * 1.125;
        let relative = 0.5 * (0.5 / (1.5625 + eps) - 1.0 / (1.0 + eps));
        assert!((error.relmse.unwrap() - relative).abs() < 1e-12);
    }
    #[test]
    fn noise_of_the_reference_does_not_count() {
        // Truth 1, image 1.1, halves with noise of 0.3 from a fixed sequence.
        let mut state = 1u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) as f32 / (1u64 << 24) as f32 - 0.5) * 0.3 * 12f32.sqrt()
        };
        let n = 200 * 100;
        let mut half = || (0..n).map(|_| Spectrum::gray(1.0 + noise())).collect::<Vec<_>>();
        let (a, b, i) = (half(), half(), vec![Spectrum::gray(1.1); n]);
        let view = |p| ImageView::new(200, 100, p).unwrap();
        let error = compare_halves(&view(&i), &view(&a), &view(&b)).unwrap();
        // Standard error of the mean of (0.1 + e)(0.1 + f): sqrt(2 (0.1 0.3)^2 + 0.3^4) / sqrt(20000) = 0.0007.
        assert!((error.mse - 0.01).abs() < 0.003, "{error:?}");
        let one = crate::compare(&view(&i), &view(&a)).unwrap();
        assert!(one.rmse * one.rmse > 0.09, "one half alone adds its variance");
    }
    #[test]
    fn what_is_not_finite_in_any_is_left_out_and_counted() {
        let (i, mut a, b) = ([Spectrum::ONE; 3], [Spectrum::ONE; 3], [Spectrum::gray(3.0); 3]);
        a[1] = Spectrum::gray(f32::INFINITY);
        let view = |p| ImageView::new(3, 1, p).unwrap();
        let error = compare_halves(&view(&i), &view(&a), &view(&b)).unwrap();
        assert_eq!((error.compared, error.excluded, error.mse), (2, 1, 0.0));
        let dark = [Spectrum::BLACK; 3];
        assert_eq!(compare_halves(&view(&i), &view(&dark), &view(&dark)).unwrap().relmse, None);
    }
}
