//! FLIP: what a viewer would see who flips between two images (Andersson et al. 2020).

use crate::view::ImageView;
use serde::Serialize;

/// The LDR-FLIP error, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Flip {
    /// Measured on sRGB of 8 bits after the exposure; pixels that are not finite in both images are black in both.
    Measured {
        /// Mean over the pixels: 0 is no difference, 1 the largest.
        mean: f64,
        /// Both images were multiplied by 2^exposure. \[stops\]
        exposure: f32,
    },
    /// Not measured, and why.
    Absent(&'static str),
}

/// The sentence of a build without FLIP.
#[cfg(not(feature = "flip"))]
pub(crate) fn flip(_: &ImageView, _: &ImageView, _: Option<f32>) -> Flip {
    Flip::Absent("FLIP is not in this build: build with --features flip (needs a C++ compiler)")
}

/// LDR-FLIP version 1, 67 pixels per degree (a 0.7 m wide monitor of 3840 pixels from 0.7 m).
#[cfg(feature = "flip")]
pub(crate) fn flip(image: &ImageView, reference: &ImageView, exposure: Option<f32>) -> Flip {
    // The library counts bytes in u32.
    let (Ok(width), Ok(height), true) =
        (u32::try_from(image.width()), u32::try_from(image.height()), image.pixels().len() < (u32::MAX / 3) as usize)
    else {
        return Flip::Absent("the image is too large for FLIP");
    };
    let exposure = exposure.unwrap_or_else(|| measured::auto_exposure(reference));
    let bytes = |view: &ImageView| {
        let both = image.pixels().iter().zip(reference.pixels()).map(|(i, r)| i.is_finite() && r.is_finite());
        let pixels = view.pixels().iter().zip(both);
        pixels
            .flat_map(|(p, finite)| measured::srgb8(*p, if finite { exposure.exp2() } else { 0.0 }))
            .collect::<Vec<u8>>()
    };
    let rgb8 = |view| nv_flip::FlipImageRgb8::with_data(width, height, &bytes(view));
    let error = nv_flip::flip(rgb8(reference), rgb8(image), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
    Flip::Measured { mean: error.iter().map(|e| f64::from(*e)).sum::<f64>() / error.len() as f64, exposure }
}

#[cfg(feature = "flip")]
mod measured {
    use crate::view::ImageView;
    use manylight_math::Spectrum;

    /// Stops that bring the median luminance of what is lit to 0.18; 0 if nothing is.
    pub fn auto_exposure(reference: &ImageView) -> f32 {
        let lit = |x: &f32| *x > 0.0 && x.is_finite();
        let mut luminance: Vec<f32> = reference.pixels().iter().map(|p| p.luminance()).filter(lit).collect();
        if luminance.is_empty() {
            return 0.0;
        }
        let middle = luminance.len() / 2;
        let (_, median, _) = luminance.select_nth_unstable_by(middle, f32::total_cmp);
        (0.18 / *median).log2()
    }
    /// sRGB (IEC 61966-2-1) of a pixel times `scale`. A scale of 0 makes black of anything.
    pub fn srgb8(pixel: Spectrum, scale: f32) -> [u8; 3] {
        if scale == 0.0 {
            return [0; 3];
        }
        pixel.to_array().map(|linear| {
            let x = (linear * scale).clamp(0.0, 1.0);
            let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
            (255.0 * encoded).round() as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    #[cfg(not(feature = "flip"))]
    #[test]
    fn without_the_feature_it_says_so() {
        let image = ImageView::new(1, 1, &[Spectrum::ONE]).unwrap();
        assert_eq!(
            flip(&image, &image, None),
            Flip::Absent("FLIP is not in this build: build with --features flip (needs a C++ compiler)")
        );
    }
    #[cfg(feature = "flip")]
    mod with_the_feature {
        use super::*;

        fn mean(image: &[Spectrum], reference: &[Spectrum], exposure: Option<f32>) -> f64 {
            let view = |p| ImageView::new(8, 8, p).unwrap();
            match flip(&view(image), &view(reference), exposure) {
                Flip::Measured { mean, .. } => mean,
                Flip::Absent(why) => panic!("{why}"),
            }
        }
        #[test]
        fn black_and_white_are_as_far_apart_as_the_paper_makes_them() {
            let (black, white) = ([Spectrum::BLACK; 64], [Spectrum::ONE; 64]);
            assert_eq!(mean(&white, &white, None), 0.0);
            // HyAB distance 100 to the power 0.7 is 25.1; the largest (green to blue) is 41.3, and 0.4 of it maps to 0.95.
            let error = mean(&black, &white, Some(0.0));
            assert!((error - 0.967).abs() < 0.002, "{error}");
            assert!((error - mean(&white, &black, Some(0.0))).abs() < 1e-6);
        }
        #[test]
        fn the_exposure_is_made_of_the_reference() {
            let (a, b) = ([Spectrum::gray(0.18); 64], [Spectrum::gray(0.2); 64]);
            let scaled = |p: [Spectrum; 64]| p.map(|s| s * 64.0);
            assert!((mean(&b, &a, None) - mean(&scaled(b), &scaled(a), None)).abs() < 1e-6);
            assert!((measured::auto_exposure(&ImageView::new(8, 8, &scaled(a)).unwrap()) + 6.0).abs() < 1e-5);
            assert_eq!(measured::auto_exposure(&ImageView::new(8, 8, &[Spectrum::BLACK; 64]).unwrap()), 0.0);
        }
        #[test]
        fn a_pixel_that_is_not_finite_shows_no_difference() {
            let (mut a, b) = ([Spectrum::gray(0.5); 64], [Spectrum::gray(0.5); 64]);
            a[9] = Spectrum::rgb(0.0, f32::NAN, 0.0);
            assert_eq!(mean(&a, &b, None), 0.0);
            assert_eq!(mean(&b, &a, None), 0.0);
        }
        #[test]
        fn srgb_by_hand() {
            assert_eq!(measured::srgb8(Spectrum::rgb(0.0, 0.5, 7.0), 1.0), [0, 188, 255]);
            assert_eq!(measured::srgb8(Spectrum::rgb(0.001, 0.25, f32::NAN), 2.0)[..2], [7, 188]);
        }
    }
}
