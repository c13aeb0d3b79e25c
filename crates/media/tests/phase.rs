//! Henyey and Greenstein's phase function against its own definition. Significance 0.001 by Sidak over the cases; fixed seeds.

use manylight_math::{Vec2, Vec3};
use manylight_media::HenyeyGreenstein;
use manylight_sampling::{Purpose, Stream};
use manylight_stats::chi2_goodness_of_fit;
use std::f64::consts::PI;

const MEANS: [f32; 11] = [-0.999, -0.99, -0.5, -1e-6, 0.0, 1e-6, 0.5, 0.55, 0.95, 0.99, 0.999];

/// As published, in f64.
fn textbook(g: f64, mu: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * mu).powf(1.5))
}
/// The share of directions with a cosine below mu, in closed form (isotropic near g = 0, where it cancels).
fn below(g: f64, mu: f64) -> f64 {
    if g.abs() < 1e-4 {
        return 0.5 * (1.0 + mu) - 0.25 * g * 3.0 * (1.0 - mu * mu);
    }
    (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 + g * g - 2.0 * g * mu).sqrt() - 1.0 / (1.0 + g))
}
/// The two directions of travel with a cosine of 1 - `versine`, as `wi` and `to`; around any axis.
fn directions(versine: f64) -> (Vec3, Vec3) {
    let axis = Vec3::new(0.48, -0.6, 0.64);
    let side = axis.any_orthonormal_vector();
    let sin = (versine * (2.0 - versine)).sqrt();
    let to = axis.as_dvec3() * (1.0 - versine) + side.as_dvec3() * sin;
    (-axis, to.as_vec3())
}

#[test]
fn it_is_the_textbooks_formula_up_to_the_peak() {
    for g in MEANS {
        let f = HenyeyGreenstein::new(g).unwrap();
        for i in 0..=400 {
            // Versines from 1e-8 to 2, and the same from behind.
            let small = 2.0 * 10f64.powf(-8.0 * (1.0 - i as f64 / 400.0));
            for versine in [small, 2.0 - small] {
                let (wi, to) = directions(versine);
                // The versine that the rounded directions have.
                let versine = 0.5 * (wi.as_dvec3().normalize() + to.as_dvec3().normalize()).length_squared();
                let truth = textbook(g as f64, 1.0 - versine);
                let got = f.eval(wi, to) as f64;
                let tolerance = if g.abs() > 0.99 { 5e-3 } else { 2e-4 };
                assert!((got - truth).abs() <= tolerance * truth, "g = {g}, 1 - mu = {versine}: {got} is not {truth}");
                assert!(f.eval(wi, to) <= f.largest() * 1.00001);
            }
        }
        for mu in [-1.0f32, -0.5, 0.0, 0.3, 0.9] {
            let (a, b) = (f.of_cosine(mu) as f64, textbook(g as f64, mu as f64));
            assert!((a - b).abs() < 1e-3 * b, "g = {g}, mu = {mu}: {a} is not {b}");
        }
    }
}

#[test]
fn it_integrates_to_one() {
    for g in MEANS {
        let f = HenyeyGreenstein::new(g).unwrap();
        // In ln(1 -+ mu), so that the peak is resolved: d mu = x d ln x.
        let n = 20_000;
        let (lo, hi) = (1e-12f64.ln(), 1f64.ln());
        let sum: f64 = (0..n)
            .flat_map(|i| {
                let x = (lo + (hi - lo) * (i as f64 + 0.5) / n as f64).exp();
                [x, 2.0 - x].map(|versine| {
                    let (wi, to) = directions(versine);
                    f.eval(wi, to) as f64 * x * 2.0 * PI * (hi - lo) / n as f64
                })
            })
            .sum();
        assert!((sum - 1.0).abs() < 3e-3, "g = {g}: {sum}");
    }
}

#[test]
fn what_is_drawn_has_its_density_and_its_mean_cosine() {
    const N: usize = 200_000;
    for (case, g) in MEANS.into_iter().enumerate() {
        let f = HenyeyGreenstein::new(g).unwrap();
        let wi = Vec3::new(-0.36, 0.48, 0.8);
        let mut s = Stream::new(3, [case as u64, 0, 0], Purpose::TEST);
        // Bins of equal probability by the closed form of the cumulative distribution; and of the azimuth.
        const BINS: usize = 24;
        let mut counts = [[0u64; BINS]; 2];
        let mut sum = 0.0;
        let (a, b) = wi.any_orthonormal_pair();
        for _ in 0..N {
            let to = f.sample(wi, s.next_2d());
            assert!((to.length() - 1.0).abs() < 1e-5);
            // From the side of the peak: f32 directions say nothing of a cosine near the other end.
            let peak = if g < 0.0 { -to } else { to };
            let mu = 1.0 - 0.5 * (wi.as_dvec3() + peak.as_dvec3()).length_squared();
            sum += if g < 0.0 { -mu } else { mu };
            let c = below(g.abs() as f64, mu).clamp(0.0, 0.999_999);
            counts[0][(c * BINS as f64) as usize] += 1;
            let azimuth = (to.dot(a).atan2(to.dot(b)) as f64 / (2.0 * PI) + 0.5).clamp(0.0, 0.999_999);
            counts[1][(azimuth * BINS as f64) as usize] += 1;
        }
        let expected = [N as f64 / BINS as f64; BINS];
        for (what, counts) in ["cosine", "azimuth"].iter().zip(&counts) {
            let p = chi2_goodness_of_fit(counts, &expected, 0).p_value;
            println!("g = {g}, {what}: p = {p:.3}");
            assert!(p > 0.001 / (2 * MEANS.len()) as f64, "g = {g}, {what}: {p}, {counts:?}");
        }
        // The variance of a cosine is at most one.
        assert!((sum / N as f64 - g as f64).abs() < 4.5 / (N as f64).sqrt(), "g = {g}: mean cosine {}", sum / N as f64);
    }
}

#[test]
fn the_corners_of_the_unit_square_give_directions() {
    for g in MEANS {
        let f = HenyeyGreenstein::new(g).unwrap();
        let most = 1.0 - 1.0 / (1u32 << 24) as f32;
        for u in [Vec2::ZERO, Vec2::splat(most), Vec2::new(0.0, most), Vec2::new(most, 0.0)] {
            for wi in [Vec3::Z, -Vec3::Z, Vec3::X] {
                let to = f.sample(wi, u);
                assert!((to.length() - 1.0).abs() < 1e-5 && f.eval(wi, to).is_finite() && f.eval(wi, to) > 0.0);
            }
        }
    }
    for bad in [1.0, -1.0, 2.0, f32::NAN, f32::INFINITY] {
        assert!(HenyeyGreenstein::new(bad).is_none());
    }
}
