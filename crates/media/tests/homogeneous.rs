//! Free flight and transmittance of homogeneous media against closed forms. Fixed seeds.

use manylight_math::{Ray, Spectrum, Vec3};
use manylight_media::{Flight, HenyeyGreenstein, Homogeneous, Medium};
use manylight_sampling::{Purpose, Stream};
use manylight_stats::chi2_goodness_of_fit;

fn medium(scattering: [f32; 3], extinction: [f32; 3]) -> Medium {
    Homogeneous::new(scattering.into(), extinction.into(), HenyeyGreenstein::ISOTROPIC).unwrap().into()
}
/// Means over flights: weight of collisions, of those beyond half the length, and of passing.
fn means(m: &Medium, length: f32, weights: [f32; 3], n: usize, seed: u64) -> [[(f64, f64); 3]; 3] {
    let mut s = Stream::new(seed, [0; 3], Purpose::TEST);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let mut sums = [[(0.0f64, 0.0f64); 3]; 3];
    for _ in 0..n {
        let (kinds, w): (&[usize], Spectrum) = match m.fly(&ray, 1.0, 1.0 + length, weights, &mut s) {
            Flight::Collision { t, weight } => {
                assert!(t >= 1.0 && t <= 1.0 + length);
                (if t - 1.0 > 0.5 * length { &[0, 1] } else { &[0] }, weight)
            }
            Flight::Passed { weight } => (&[2], weight),
        };
        assert!(w.is_valid(), "{w:?}");
        for &k in kinds {
            for (sum, x) in sums[k].iter_mut().zip(w.to_array()) {
                sum.0 += x as f64;
                sum.1 += (x as f64).powi(2);
            }
        }
    }
    let n = n as f64;
    // Mean, and standard error of the mean.
    sums.map(|kind| kind.map(|(s, q)| (s / n, ((q / n - (s / n).powi(2)).max(0.0) / n).sqrt())))
}

#[test]
fn the_weights_of_flights_have_the_means_of_their_integrals_in_each_channel() {
    for (i, (scattering, extinction, length)) in [
        ([0.5, 0.5, 0.5], [1.0, 1.0, 1.0], 1.3),
        ([0.5, 0.2, 0.0], [0.6, 0.8, 0.4], 2.0),
        ([3.0, 0.0, 0.1], [3.0, 0.0, 5.0], 1.0),
        ([20.0, 1.0, 0.01], [25.0, 1.0, 0.02], 3.0),
        ([0.0, 0.0, 0.0], [1.0, 2.0, 0.0], 1.0),
    ]
    .into_iter()
    .enumerate()
    {
        let m = medium(scattering, extinction);
        for weights in [[1.0 / 3.0; 3], Medium::channels(Spectrum::rgb(1.0, 0.1, 0.0))] {
            let got = means(&m, length, weights, 100_000, i as u64);
            for c in 0..3 {
                let (sigma_s, sigma) = (scattering[c] as f64, extinction[c] as f64);
                let t = |x: f64| (-sigma * x).exp();
                let part =
                    |a: f64, b: f64| if sigma > 0.0 { sigma_s / sigma * (t(a) - t(b)) } else { sigma_s * (b - a) };
                let l = length as f64;
                for (k, truth) in [part(0.0, l), part(0.5 * l, l), t(l)].into_iter().enumerate() {
                    let (mean, error) = got[k][c];
                    // 90 means: 4.3 standard errors is 0.0015 for all of them.
                    assert!(
                        (mean - truth).abs() <= 4.3 * error + 2e-6,
                        "medium {i}, channel {c}, kind {k}: {mean} +- {error} is not {truth}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_grey_flight_is_exponential_and_its_weight_is_the_albedo() {
    let m = medium([0.9; 3], [1.5; 3]);
    let mut s = Stream::new(9, [0; 3], Purpose::TEST);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let (n, length) = (100_000u64, 2.0f64);
    let mut counts = [0u64; 21];
    for _ in 0..n {
        match m.fly(&ray, 0.0, length as f32, [1.0 / 3.0; 3], &mut s) {
            Flight::Collision { t, weight } => {
                assert!((weight.luminance() - 0.6).abs() < 1e-5);
                counts[(t as f64 / length * 20.0).min(19.0) as usize] += 1;
            }
            Flight::Passed { weight } => {
                assert!((weight.luminance() - 1.0).abs() < 1e-5);
                counts[20] += 1;
            }
        }
    }
    let through = |i: usize| (-1.5 * length * i as f64 / 20.0).exp();
    let mut expected: Vec<f64> = (0..20).map(|i| n as f64 * (through(i) - through(i + 1))).collect();
    expected.push(n as f64 * through(20));
    let p = chi2_goodness_of_fit(&counts, &expected, 0).p_value;
    assert!(p > 0.001, "{p}");
}

#[test]
fn transmittance_is_beers_law_and_multiplies() {
    let m = medium([0.1, 0.0, 0.0], [0.7, 0.0, 30.0]);
    let mut s = Stream::new(9, [0; 3], Purpose::TEST);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    let mut t = |a, b| m.transmittance(&ray, a, b, &mut s).to_array();
    let (whole, first, rest) = (t(0.5, 2.5), t(0.5, 1.0), t(1.0, 2.5));
    for (c, sigma) in [0.7f64, 0.0, 30.0].into_iter().enumerate() {
        assert!((whole[c] as f64 - (-2.0 * sigma).exp()).abs() < 1e-6);
        assert!((whole[c] - first[c] * rest[c]).abs() < 1e-6);
    }
    assert_eq!(t(0.0, f32::INFINITY), [0.0, 1.0, 0.0]);
}

#[test]
fn hard_media_give_numbers() {
    let mut s = Stream::new(4, [0; 3], Purpose::TEST);
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    for (extinction, length) in [
        ([0.0, 0.0, 0.0], f32::INFINITY),
        ([1.0, 0.0, 3.0], f32::INFINITY),
        ([1e4, 1e-4, 0.0], 1e3),
        ([1e30, 1.0, 1.0], 1.0),
        ([800.0, 900.0, 1000.0], 10.0),
        ([1e-30, 1e-20, 1e-10], 1e30),
        ([1.0, 1.0, 1.0], 0.0),
    ] {
        let m = medium(extinction, extinction);
        for _ in 0..2000 {
            for weights in [[1.0 / 3.0; 3], Medium::channels(Spectrum::rgb(0.0, 1.0, 0.0))] {
                let (w, t) = match m.fly(&ray, 0.0, length, weights, &mut s) {
                    Flight::Collision { t, weight } => (weight, t),
                    Flight::Passed { weight } => (weight, 0.0),
                };
                assert!(w.is_valid() && w.largest() <= 20.01 && t.is_finite(), "{extinction:?} {length}: {w:?} at {t}");
            }
        }
    }
}

#[test]
fn coefficients_that_make_no_sense_are_refused() {
    let phase = HenyeyGreenstein::ISOTROPIC;
    for (scattering, extinction) in
        [([2.0, 0.0, 0.0], [1.0; 3]), ([-1.0; 3], [1.0; 3]), ([0.0; 3], [f32::NAN; 3]), ([0.0; 3], [f32::INFINITY; 3])]
    {
        assert!(Homogeneous::new(Spectrum::from(scattering), Spectrum::from(extinction), phase).is_err());
    }
}
