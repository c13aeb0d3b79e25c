//! `sample` draws what `pdf_sa` says, and weighs it by f cos / pdf.

mod common;

use common::*;
use manylight_bsdf::*;
use manylight_math::{Spectrum, Vec3};
use manylight_stats::{chi2_goodness_of_fit, sidak_alpha};

const SAMPLES: usize = 100_000;

fn grid(wi: Vec3) -> Grid {
    Grid { rows: 12, columns: 20, wi }
}
fn views() -> [Vec3; 5] {
    [Vec3::Z, polar(0.3, 1.0), polar(0.9, 2.5), polar(1.35, -0.4), polar(1.55, 4.0)]
}

/// Pearson's chi2 of drawn directions against the integrated density; the paths that end, and those of delta lobes, are a
/// cell of their own. Also the integral of the density.
fn chi2(bsdf: &Bsdf, wi: Vec3, seed: u64) -> (f64, f64) {
    let mut s = stream(seed);
    let grid = grid(wi);
    let mut observed = vec![0u64; grid.cells() + 1];
    for _ in 0..SAMPLES {
        let cell = draw(bsdf, wi, &mut s).filter(|x| !x.delta).map_or(grid.cells(), |x| grid.cell(x.wo));
        observed[cell] += 1;
    }
    let mut expected = grid.integrate_scalar(8, |wo| bsdf.pdf_sa(wi, wo));
    let integral: f64 = expected.iter().sum();
    expected.push((1.0 - integral).max(0.0));
    for e in &mut expected {
        *e *= SAMPLES as f64;
    }
    (chi2_goodness_of_fit(&observed, &expected, 0).p_value, integral)
}

/// Fraction of `n` draws that a smooth lobe gave.
fn smooth_fraction(bsdf: &Bsdf, wi: Vec3, n: usize) -> f64 {
    let mut s = stream(55);
    let smooth = (0..n).filter(|_| draw(bsdf, wi, &mut s).is_some_and(|x| !x.delta)).count();
    smooth as f64 / n as f64
}

#[test]
fn directions_follow_their_density() {
    let models = smooth_models();
    let cases = models.len() * views().len();
    let alpha = sidak_alpha(0.01, cases);
    let mut least = 1.0f64;
    for (i, (name, bsdf)) in models.iter().enumerate() {
        for (j, wi) in views().into_iter().enumerate() {
            let (p, _) = chi2(bsdf, wi, (100 * i + j) as u64);
            assert!(p > alpha, "{name} from {wi}: p = {p:e} <= {alpha:e}");
            least = least.min(p);
        }
    }
    println!("{cases} cases of {SAMPLES} samples, least p {least:.2e}, rejected below {alpha:.2e}");
}

#[test]
fn densities_integrate_to_the_probability_of_the_smooth_lobes() {
    for (name, bsdf) in smooth_models() {
        for wi in views() {
            let integral: f64 = grid(wi).integrate_scalar(8, |wo| bsdf.pdf_sa(wi, wo)).iter().sum();
            let n = 40_000;
            let drawn = smooth_fraction(&bsdf, wi, n);
            // Five standard deviations.
            let tolerance = 5.0 * (integral * (1.0 - integral)).max(0.0).sqrt() / (n as f64).sqrt() + 1e-3;
            assert!((integral - drawn).abs() < tolerance, "{name} from {wi}: {integral} and drawn {drawn}");
            assert!(integral < 1.0 + 1e-3, "{name} from {wi}: {integral}");
        }
    }
}

/// A diffuse twin that draws with the cosine twice: z = u^(1/3), but says it draws with the cosine.
#[test]
fn a_liar_that_draws_with_the_cosine_twice_is_rejected() {
    let bsdf = Bsdf::from(Diffuse::new(RED));
    let mut s = stream(4);
    let grid = grid(Vec3::Z);
    let mut observed = vec![0u64; grid.cells()];
    let mut energy = 0.0;
    for _ in 0..SAMPLES {
        let u = s.next_2d();
        let z = u.x.cbrt();
        let wo = polar(z.acos(), std::f32::consts::TAU * u.y);
        observed[grid.cell(wo)] += 1;
        energy += f64::from((bsdf.eval(Vec3::Z, wo) * (wo.z / bsdf.pdf_sa(Vec3::Z, wo))).0.x) * f64::from(wo.z);
    }
    let expected = grid.integrate_scalar(8, |wo| bsdf.pdf_sa(Vec3::Z, wo) * SAMPLES as f32);
    let p = chi2_goodness_of_fit(&observed, &expected, 0).p_value;
    assert!(p < 1e-12, "{p}");
    // Its twin that multiplies by the cosine twice loses a quarter of the energy.
    assert!((energy / SAMPLES as f64 / 0.95 - 0.75).abs() < 0.01);
}

#[test]
fn weights_are_f_cos_over_pdf() {
    for (name, bsdf) in smooth_models() {
        let mut s = stream(12);
        let mut compared = 0;
        for _ in 0..4000 {
            let wi = polar(1.56 * s.next_f32(), std::f32::consts::TAU * s.next_f32());
            let Some(sample) = draw(&bsdf, wi, &mut s).filter(|x| !x.delta) else { continue };
            assert!((sample.wo.length() - 1.0).abs() < 1e-5 && sample.wo.z > 0.0 && sample.eta == 1.0, "{name}");
            assert_eq!(sample.pdf, bsdf.pdf_sa(wi, sample.wo), "{name}");
            let weight = bsdf.eval(wi, sample.wo) * (sample.wo.z / sample.pdf);
            let error = (weight - sample.weight).0.abs().max_element();
            assert!(error < 1e-4 * sample.weight.largest() + 1e-7, "{name} {wi} {sample:?} {weight:?}");
            compared += 1;
        }
        assert!(compared > 1500, "{name}: {compared}");
    }
}

#[test]
fn reflection_is_reciprocal() {
    for (name, bsdf) in smooth_models() {
        let mut s = stream(13);
        for _ in 0..4000 {
            let wi = polar(1.5 * s.next_f32(), std::f32::consts::TAU * s.next_f32());
            let wo = draw(&bsdf, wi, &mut s).map_or(Vec3::Z, |x| x.wo);
            let (there, back) = (bsdf.eval(wi, wo), bsdf.eval(wo, wi));
            assert!((there - back).0.abs().max_element() <= 2e-3 * there.largest() + 1e-6, "{name} {wi} {wo}");
        }
    }
}

#[test]
fn one_sided_models_scatter_nothing_below_the_surface() {
    let (above, below) = (polar(0.5, 1.0), polar(2.6, 0.2));
    for (name, bsdf) in smooth_models() {
        for (wi, wo) in [(above, below), (below, above), (below, below)] {
            assert!(bsdf.eval(wi, wo).is_black() && bsdf.pdf_sa(wi, wo) == 0.0, "{name}");
        }
        assert!(draw(&bsdf, below, &mut stream(1)).is_none() && bsdf.albedo(below).is_black(), "{name}");
    }
}

#[test]
fn black_scatters_nothing_and_lobes_are_what_they_say() {
    let black = Bsdf::Black;
    assert!(black.eval(Vec3::Z, Vec3::Z).is_black() && draw(&black, Vec3::Z, &mut stream(1)).is_none());
    let mirror = Bsdf::from(Conductor::new(Spectrum::BLACK, Spectrum::ONE, Spectrum::ONE));
    for (bsdf, smooth, delta) in [(black, false, false), (mirror, false, true), (glass(), false, true)] {
        assert_eq!((bsdf.has_smooth(), bsdf.has_delta()), (smooth, delta));
    }
    for (name, bsdf) in smooth_models() {
        let mut s = stream(2);
        let drawn_delta = (0..1000).any(|_| draw(&bsdf, polar(1.0, 0.0), &mut s).is_some_and(|x| x.delta));
        assert!(bsdf.has_smooth() && bsdf.has_delta() == drawn_delta, "{name}");
    }
}

#[test]
fn the_sharp_and_the_dull_lobes_are_the_whole_and_each_samples_itself() {
    let mut parted = 0;
    for (name, bsdf) in smooth_models() {
        let mut s = stream(15);
        for _ in 0..2000 {
            let wi = polar(1.5 * s.next_f32(), std::f32::consts::TAU * s.next_f32());
            let Some(split) = bsdf.split(wi, 0.3) else { continue };
            assert!((0.0..=1.0).contains(&split.chance), "{name}");
            let parts = [split.dull, split.sharp];
            for part in parts {
                let Some(sample) = draw(&part, wi, &mut s) else { continue };
                let (whole, sum) =
                    (bsdf.eval(wi, sample.wo), parts[0].eval(wi, sample.wo) + parts[1].eval(wi, sample.wo));
                assert!((whole - sum).0.abs().max_element() <= 1e-5 * whole.largest(), "{name} {whole:?} {sum:?}");
                let weight = part.eval(wi, sample.wo) * (sample.wo.z / sample.pdf);
                let error = (weight - sample.weight).0.abs().max_element();
                assert!(error < 1e-4 * sample.weight.largest() + 1e-7, "{name} {wi} {sample:?} {weight:?}");
                parted += 1;
            }
            assert!(bsdf.split(wi, 0.01).is_none(), "{name}");
        }
    }
    assert!(parted > 10_000, "{parted}");
}
