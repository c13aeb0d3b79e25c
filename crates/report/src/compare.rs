//! Comparing two images.

use crate::blocks::compare_blocks;
use crate::flip::flip;
use crate::view::{channels, mean};
use crate::{Difference, ImageSummary, ImageView, ReportError, WorstPixel};

/// What a comparison should report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// How many of the worst pixels.
    pub worst: usize,
    /// Means over \[columns, rows\] of blocks.
    pub blocks: Option<[usize; 2]>,
    /// Exposure for FLIP; `None` brings the reference's median luminance to 0.18. \[stops\]
    pub exposure: Option<f32>,
}

impl Default for Comparison {
    fn default() -> Self {
        Comparison { worst: 5, blocks: None, exposure: None }
    }
}

/// Compares an image with a reference of the same size: five worst pixels, no blocks.
pub fn compare(image: &ImageView, reference: &ImageView) -> Result<Difference, ReportError> {
    Comparison::default().run(image, reference)
}

impl Comparison {
    /// Compares an image with a reference of the same size.
    pub fn run(&self, image: &ImageView, reference: &ImageView) -> Result<Difference, ReportError> {
        image.check_size(reference)?;
        let both_finite = |i: usize| image.pixels()[i].is_finite() && reference.pixels()[i].is_finite();
        let kept: Vec<usize> = (0..image.pixels().len()).filter(|i| both_finite(*i)).collect();
        if kept.is_empty() {
            return Err(ReportError::NothingFinite { pixels: image.pixels().len() });
        }
        let (image_summary, reference_summary) = (summary(image, &kept), summary(reference, &kept));
        let eps = relative_epsilon(reference_summary.mean);
        // 0.01 |mean R|
        let offset = 0.1 * eps.sqrt();
        let (mut squares, mut relative, mut absolute, mut symmetric) = (0.0, 0.0, 0.0, 0.0);
        let mut errors: Vec<(f64, usize)> = Vec::with_capacity(kept.len());
        for &index in &kept {
            let (i, r) = (channels(image.pixels()[index]), channels(reference.pixels()[index]));
            let (mut pixel_squares, mut pixel_relative) = (0.0, 0.0);
            for c in 0..3 {
                let d = (i[c] - r[c]).abs();
                pixel_squares += d * d;
                pixel_relative += d * d / (r[c] * r[c] + eps);
                absolute += d / (r[c].abs() + offset);
                symmetric += if d > 0.0 { 2.0 * d / (i[c].abs() + r[c].abs()) } else { 0.0 };
            }
            squares += pixel_squares;
            relative += pixel_relative;
            errors.push(((if eps > 0.0 { pixel_relative } else { pixel_squares } / 3.0).sqrt(), index));
        }
        // Largest first; of equals the first in the image.
        errors.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let n = 3.0 * kept.len() as f64;
        Ok(Difference {
            width: image.width(),
            height: image.height(),
            compared: kept.len(),
            excluded: image.pixels().len() - kept.len(),
            image: image_summary,
            reference: reference_summary,
            rmse: (squares / n).sqrt(),
            relmse: (eps > 0.0).then_some(relative / n),
            relmse_epsilon: eps,
            mape: (eps > 0.0).then_some(absolute / n),
            smape: symmetric / n,
            // Nearest rank: the ceil(0.999 n)-th smallest, which has floor(0.001 n) above it.
            percentile_999: errors[errors.len() / 1000].0,
            worst: errors.iter().take(self.worst).map(|e| worst_pixel(image, reference, *e)).collect(),
            blocks: match self.blocks {
                Some(tiling) => compare_blocks(image, reference, tiling, both_finite)?,
                None => Vec::new(),
            },
            flip: flip(image, reference, self.exposure),
        })
    }
}

/// 0.01 (mean R)^2, the mean over channels too.
pub(crate) fn relative_epsilon(mean_of_reference: [f64; 3]) -> f64 {
    0.01 * (mean_of_reference.iter().sum::<f64>() / 3.0).powi(2)
}

fn summary(view: &ImageView, kept: &[usize]) -> ImageSummary {
    let has_nan = |i: &usize| view.pixels()[*i].to_array().iter().any(|x| x.is_nan());
    let not_finite: Vec<usize> = (0..view.pixels().len()).filter(|i| !view.pixels()[*i].is_finite()).collect();
    let nan = not_finite.iter().filter(|i| has_nan(i)).count();
    ImageSummary {
        nan,
        infinite: not_finite.len() - nan,
        first_non_finite: not_finite.first().map(|i| view.place(*i)),
        mean: mean(kept.iter().map(|i| view.pixels()[*i])),
    }
}

fn worst_pixel(image: &ImageView, reference: &ImageView, (error, index): (f64, usize)) -> WorstPixel {
    let [x, y] = image.place(index);
    let [image, reference] = [image, reference].map(|view| view.pixels()[index].to_array());
    WorstPixel { x, y, image, reference, error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    fn view(width: usize, pixels: &[Spectrum]) -> ImageView<'_> {
        ImageView::new(width, pixels.len() / width, pixels).unwrap()
    }
    fn near(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1e-3), "{a} is not {b}");
    }
    #[test]
    fn by_hand() {
        let image = [Spectrum::rgb(1.0, 2.0, 3.0), Spectrum::rgb(0.0, 1.0, 4.0)];
        let reference = [Spectrum::rgb(1.0, 1.0, 5.0), Spectrum::rgb(0.0, 3.0, 2.0)];
        let d = compare(&view(2, &image), &view(2, &reference)).unwrap();
        assert_eq!((d.compared, d.excluded), (2, 0));
        assert_eq!((d.image.mean, d.reference.mean), ([0.5, 1.5, 3.5], [0.5, 2.0, 3.5]));
        // Differences 0, 1, 2 and 0, 2, 2; the mean of the reference is 2.
        near(d.rmse, (13.0f64 / 6.0).sqrt());
        let eps = 0.04;
        near(d.relmse_epsilon, eps);
        let (first, second) = (1.0 / (1.0 + eps) + 4.0 / (25.0 + eps), 4.0 / (9.0 + eps) + 4.0 / (4.0 + eps));
        near(d.relmse.unwrap(), (first + second) / 6.0);
        near(d.mape.unwrap(), (1.0 / 1.02 + 2.0 / 5.02 + 2.0 / 3.02 + 2.0 / 2.02) / 6.0);
        near(d.smape, (2.0 / 3.0 + 4.0 / 8.0 + 4.0 / 4.0 + 4.0 / 6.0) / 6.0);
        near(d.percentile_999, (second / 3.0).sqrt());
        assert_eq!(d.worst.len(), 2);
        assert_eq!(
            (d.worst[0].x, d.worst[0].y, d.worst[0].image, d.worst[0].reference),
            (1, 0, [0.0, 1.0, 4.0], [0.0, 3.0, 2.0])
        );
        near(d.worst[1].error, (first / 3.0).sqrt());
    }
    #[test]
    fn one_nan_is_counted_and_in_no_sum() {
        let mut image = [Spectrum::ONE; 6];
        let reference = [Spectrum::gray(0.5); 6];
        let clean = compare(&view(3, &image), &view(3, &reference)).unwrap();
        image[4] = Spectrum::rgb(1.0, f32::NAN, f32::INFINITY);
        image[5] = Spectrum::rgb(f32::NEG_INFINITY, 1.0, 1.0);
        let d = compare(&view(3, &image), &view(3, &reference)).unwrap();
        assert_eq!((d.image.nan, d.image.infinite, d.image.first_non_finite), (1, 1, Some([1, 1])));
        assert_eq!((d.reference.nan, d.reference.infinite, d.reference.first_non_finite), (0, 0, None));
        assert_eq!((d.compared, d.excluded), (4, 2));
        near(d.rmse, clean.rmse);
        near(d.relmse.unwrap(), clean.relmse.unwrap());
        near(d.mape.unwrap(), clean.mape.unwrap());
        near(d.smape, clean.smape);
        assert_eq!(d.image.mean, [1.0; 3]);
        assert!(d.to_string().contains("1 NaN, 1 infinite, the first at (1, 1)"), "{d}");
        let swapped = compare(&view(3, &reference), &view(3, &image)).unwrap();
        assert_eq!((swapped.reference.nan, swapped.image.nan, swapped.compared), (1, 0, 4));
        let nothing = compare(&view(1, &image[4..5]), &view(1, &reference[..1]));
        assert!(matches!(nothing, Err(ReportError::NothingFinite { pixels: 1 })));
    }
    #[test]
    fn sizes_that_differ_are_both_named() {
        let pixels = [Spectrum::ONE; 6];
        let message = compare(&view(3, &pixels), &view(2, &pixels)).unwrap_err().to_string();
        assert_eq!(message, "the image is 3 x 2 pixels and the reference 2 x 3");
        for (width, height) in [(2, 2), (0, 6), (usize::MAX, 2)] {
            assert!(matches!(ImageView::new(width, height, &pixels), Err(ReportError::NoImage { found: 6, .. })));
        }
        assert!(ImageView::new(0, 0, &[]).is_err());
    }
    #[test]
    fn a_black_reference_has_no_relative_error() {
        let mut image = [Spectrum::BLACK; 4];
        image[2] = Spectrum::gray(3.0);
        let d = compare(&view(2, &image), &view(2, &[Spectrum::BLACK; 4])).unwrap();
        assert_eq!((d.relmse, d.mape, d.rmse, d.smape), (None, None, 1.5, 0.5));
        assert_eq!((d.worst[0].x, d.worst[0].y, d.worst[0].error), (0, 1, 3.0));
        assert!(d.to_string().contains("none: the reference is black"));
    }
    #[test]
    fn fireflies_show_in_the_percentile_only_if_one_in_a_thousand_pixels_is_one() {
        let with = |pixels: usize, fireflies: usize| {
            let reference = vec![Spectrum::ONE; pixels];
            let mut image = reference.clone();
            image[..fireflies].fill(Spectrum::gray(100.0));
            compare(&view(1, &image), &view(1, &reference)).unwrap().percentile_999
        };
        assert_eq!((with(3000, 3), with(3999, 3), with(2999, 2)), (0.0, 0.0, 0.0));
        for (pixels, fireflies) in [(3000, 4), (2999, 3), (10, 1)] {
            assert!(with(pixels, fireflies) > 90.0);
        }
        near(with(3000, 3000), 99.0 / 1.01f64.sqrt());
    }
    #[test]
    fn blocks_leave_out_what_is_not_finite() {
        let mut image = [1.0, 2.0, 3.0, 4.0].map(Spectrum::gray);
        image[0] = Spectrum::gray(f32::NAN);
        image[1] = Spectrum::gray(f32::NAN);
        image[2] = Spectrum::gray(f32::NAN);
        let comparison = Comparison { blocks: Some([1, 2]), ..Comparison::default() };
        let d = comparison.run(&view(2, &image), &view(2, &[Spectrum::ONE; 4])).unwrap();
        assert_eq!((d.blocks.len(), d.blocks[0].compared, d.blocks[1].compared), (2, 0, 1));
        assert!(d.blocks[0].image[0].is_nan() && d.blocks[1].image == [4.0; 3] && d.blocks[1].reference == [1.0; 3]);
        assert_eq!((d.blocks[1].x, d.blocks[1].y, d.blocks[1].width, d.blocks[1].height), (0, 1, 2, 1));
    }
    #[test]
    fn json_holds_the_numbers() {
        let d = compare(&view(2, &[Spectrum::ONE; 2]), &view(2, &[Spectrum::gray(0.5); 2])).unwrap();
        let json: serde_json::Value = serde_json::from_str(&d.to_json().unwrap()).unwrap();
        assert_eq!((json["rmse"].as_f64(), json["worst"][0]["x"].as_u64()), (Some(0.5), Some(0)));
        assert_eq!(json["image"]["mean"][2].as_f64(), Some(1.0));
        assert!(json["flip"].get(if cfg!(feature = "flip") { "measured" } else { "absent" }).is_some(), "{json}");
    }
    #[test]
    fn the_table_is_aligned() {
        let d = compare(&view(2, &[Spectrum::ONE; 2]), &view(2, &[Spectrum::gray(0.5); 2])).unwrap();
        let table = d.to_string();
        let column = |line: &str| line.char_indices().skip(11).find(|(_, c)| *c != ' ').map(|(i, _)| i);
        assert!(table.lines().count() == 11 && table.lines().all(|line| column(line) == Some(12)), "{table}");
    }
}
