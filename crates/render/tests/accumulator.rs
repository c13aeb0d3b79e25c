//! The running statistics against their definitions.

use manylight_framework::Image;
use manylight_math::Spectrum;
use manylight_render::{Accumulator, RenderError};
use proptest::{prelude::*, test_runner::FileFailurePersistence};

type Pass = Vec<[f32; 3]>;

const PIXELS: usize = 6;

fn image(pixels: &Pass) -> Image {
    Image { width: 3, height: 2, pixels: pixels.iter().map(|&p| p.into()).collect() }
}
fn accumulated(passes: &[Pass]) -> Accumulator {
    let mut film = Accumulator::new(3, 2);
    passes.iter().for_each(|pass| film.add(&image(pass)).unwrap());
    film
}
fn passes() -> impl Strategy<Value = Vec<Pass>> {
    // Dark and bright, and variance far below the mean: where the textbook formula loses all digits.
    let channel = prop_oneof![0.0..1.0f32, 1e4..1.0001e4f32, Just(0.0)];
    prop::collection::vec(prop::collection::vec([channel.clone(), channel.clone(), channel], PIXELS), 1..12)
}
/// Mean and variance of the mean, by two passes over the data.
fn naive(passes: &[Pass], pixel: usize, channel: usize) -> (f64, f64) {
    let values: Vec<f64> = passes.iter().map(|p| p[pixel][channel].into()).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n * (n - 1.0)))
}
fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1e-3 + a.abs().max(b.abs()))
}
fn channels(image: &Image) -> Vec<f64> {
    image.pixels.iter().flat_map(|p| p.to_array()).map(f64::from).collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn mean_and_standard_error_are_those_of_the_definition(passes in passes()) {
        let film = accumulated(&passes);
        let mean = channels(&film.mean());
        let error = film.standard_error().map(|e| channels(&e));
        prop_assert_eq!(error.is_some(), passes.len() >= 2);
        for i in 0..3 * PIXELS {
            let (expected, variance) = naive(&passes, i / 3, i % 3);
            prop_assert!(near(mean[i], expected, 1e-6));
            if let Some(error) = &error {
                prop_assert!(near(error[i], variance.sqrt(), 1e-6), "{} {}", error[i], variance.sqrt());
            }
        }
    }
    #[test]
    fn the_estimated_error_is_that_of_the_definition(passes in passes()) {
        let film = accumulated(&passes);
        let pairs: Vec<_> = (0..3 * PIXELS).map(|i| naive(&passes, i / 3, i % 3)).collect();
        let mean = pairs.iter().map(|p| p.0).sum::<f64>() / pairs.len() as f64;
        let terms = pairs.iter().map(|(m, v)| if *v == 0.0 { 0.0 } else { v / (m * m + 0.01 * mean * mean) });
        let expected = terms.sum::<f64>() / pairs.len() as f64;
        match film.estimated_error() {
            Some(error) => prop_assert!(near(error, expected, 1e-9), "{error} {expected}"),
            None => prop_assert!(passes.len() < 2),
        }
    }
    #[test]
    fn merging_is_adding_one_by_one(passes in passes(), cut in 0usize..12) {
        let (first, second) = passes.split_at(cut.min(passes.len()));
        let mut merged = accumulated(first);
        merged.merge(&accumulated(second)).unwrap();
        let sequential = accumulated(&passes);
        prop_assert_eq!(merged.passes(), sequential.passes());
        let pairs = channels(&merged.mean()).into_iter().zip(channels(&sequential.mean()));
        prop_assert!(pairs.into_iter().all(|(a, b)| near(a, b, 1e-6)));
        if let (Some(a), Some(b)) = (merged.standard_error(), sequential.standard_error()) {
            prop_assert!(channels(&a).into_iter().zip(channels(&b)).all(|(a, b)| near(a, b, 1e-6)));
        }
    }
}

#[test]
fn an_image_of_another_size_is_refused_and_changes_nothing() {
    let mut film = accumulated(&[vec![[1.0; 3]; PIXELS]]);
    let before = film.clone();
    let turned = Image { width: 2, height: 3, pixels: vec![Spectrum::ONE; PIXELS] };
    let short = Image { width: 3, height: 2, pixels: vec![Spectrum::ONE; PIXELS - 1] };
    assert!(matches!(film.add(&turned), Err(RenderError::Size { expected: (3, 2), found: (2, 3) })));
    assert!(film.add(&short).is_err());
    assert!(film.merge(&Accumulator::new(2, 3)).is_err());
    assert_eq!(film, before);
}
#[test]
fn equal_passes_have_no_error_and_a_black_image_none_either() {
    let film = accumulated(&[vec![[0.1, 0.0, 3e7]; PIXELS], vec![[0.1, 0.0, 3e7]; PIXELS]]);
    assert_eq!(film.estimated_error(), Some(0.0));
    assert_eq!(accumulated(&[vec![[0.0; 3]; PIXELS], vec![[0.0; 3]; PIXELS]]).estimated_error(), Some(0.0));
}
#[test]
fn a_pass_that_is_not_finite_shows_in_the_estimated_error() {
    let film = accumulated(&[vec![[f32::NAN; 3]; PIXELS], vec![[1.0; 3]; PIXELS]]);
    assert!(film.estimated_error().unwrap().is_nan());
}
