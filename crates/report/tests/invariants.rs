//! What holds for all images.

use manylight_math::Spectrum;
use manylight_report::{Comparison, Difference, ImageView, block_means, compare};
use proptest::prelude::*;

const WIDTH: usize = 4;
const HEIGHT: usize = 3;

fn image() -> impl Strategy<Value = Vec<Spectrum>> {
    let channel = || 0.01f32..10.0;
    let pixel = (channel(), channel(), channel()).prop_map(|(r, g, b)| Spectrum::rgb(r, g, b));
    prop::collection::vec(pixel, WIDTH * HEIGHT)
}
fn view(pixels: &[Spectrum]) -> ImageView<'_> {
    ImageView::new(WIDTH, HEIGHT, pixels).unwrap()
}
fn difference(a: &[Spectrum], b: &[Spectrum]) -> Difference {
    Comparison { blocks: Some([2, 3]), ..Comparison::default() }.run(&view(a), &view(b)).unwrap()
}
fn scaled(pixels: &[Spectrum], by: f32) -> Vec<Spectrum> {
    pixels.iter().map(|p| *p * by).collect()
}
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * b.abs()
}

proptest! {
    #[test]
    fn an_image_does_not_differ_from_itself(a in image()) {
        let d = compare(&view(&a), &view(&a)).unwrap();
        prop_assert_eq!((d.rmse, d.relmse, d.mape, d.smape, d.percentile_999), (0.0, Some(0.0), Some(0.0), 0.0, 0.0));
        prop_assert_eq!(d.image, d.reference);
    }
    #[test]
    fn rmse_and_smape_do_not_care_which_is_the_reference(a in image(), b in image()) {
        let (d, e) = (difference(&a, &b), difference(&b, &a));
        prop_assert!(near(d.rmse, e.rmse) && near(d.smape, e.smape));
        prop_assert!(d.smape <= 2.0);
    }
    #[test]
    fn rmse_scales_with_the_images_and_relative_errors_do_not(a in image(), b in image(), exponent in -8i32..8) {
        let by = 2f32.powi(exponent);
        let (d, e) = (difference(&a, &b), difference(&scaled(&a, by), &scaled(&b, by)));
        prop_assert!(near(e.rmse, d.rmse * f64::from(by)));
        prop_assert!(near(e.relmse.unwrap(), d.relmse.unwrap()) && near(e.mape.unwrap(), d.mape.unwrap()));
        prop_assert!(near(e.smape, d.smape) && near(e.percentile_999, d.percentile_999));
    }
    #[test]
    fn the_worst_pixels_come_in_order_and_exist(a in image(), b in image()) {
        let d = difference(&a, &b);
        prop_assert!(d.worst.windows(2).all(|w| w[0].error >= w[1].error));
        for p in &d.worst {
            let index = p.y * WIDTH + p.x;
            prop_assert_eq!((p.image, p.reference), (a[index].to_array(), b[index].to_array()));
        }
    }
    #[test]
    fn blocks_add_up_to_the_image(a in image(), b in image()) {
        let d = difference(&a, &b);
        let sum: f64 = d.blocks.iter().map(|k| k.image[1] * k.compared as f64).sum();
        prop_assert!(near(sum, d.image.mean[1] * d.compared as f64));
        let means = block_means(&view(&a), 2, 3).unwrap();
        prop_assert_eq!(d.blocks.iter().map(|k| k.image).collect::<Vec<_>>(), means);
    }
    #[test]
    fn shuffling_pixels_of_both_changes_no_mean(a in image(), b in image(), shift in 0..WIDTH * HEIGHT) {
        let turned = |p: &[Spectrum]| [&p[shift..], &p[..shift]].concat();
        let (d, e) = (difference(&a, &b), difference(&turned(&a), &turned(&b)));
        prop_assert!(near(e.rmse, d.rmse) && near(e.relmse.unwrap(), d.relmse.unwrap()));
    }
}
