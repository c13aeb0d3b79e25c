//! Glass that scatters to both sides: rough, and thin.

mod common;

use common::*;
use manylight_bsdf::*;
use manylight_math::{Frame, Spectrum, Vec2, Vec3};
use manylight_sampling::{Stream, warp};
use manylight_stats::{chi2_goodness_of_fit, sidak_alpha};

fn rough(distribution: Distribution, alpha: (f32, f32), int_ior: f32) -> Bsdf {
    RoughDielectric::new(distribution, alpha, (int_ior, 1.0), Spectrum::ONE, Spectrum::ONE).into()
}
fn models() -> Vec<(String, Bsdf)> {
    let mut models = Vec::new();
    for distribution in [Distribution::Beckmann, Distribution::Ggx] {
        for (alpha, ior) in [((0.15, 0.15), 1.5), ((0.4, 0.4), 1.5), ((0.3, 0.7), 1.3), ((0.8, 0.8), 2.0)] {
            models.push((format!("{distribution:?} {alpha:?} {ior}"), rough(distribution, alpha, ior)));
        }
    }
    models.extend(principled_glass());
    models
}
/// From above and from below, some beyond the critical angle.
fn views() -> [Vec3; 6] {
    let up = [Vec3::Z, polar(0.6, 1.0), polar(1.3, -0.4)];
    [up[0], up[1], up[2], -up[0], -up[1], -up[2]]
}
/// Of the sphere: a grid above and its mirror image below.
fn integrate(wi: Vec3, cells: (usize, usize), parts: usize, f: impl Fn(Vec3) -> f32) -> Vec<f64> {
    let grid = Grid { rows: cells.0, columns: cells.1, wi: Vec3::new(wi.x, wi.y, wi.z.abs()) };
    let mut all = grid.integrate_scalar(parts, &f);
    all.extend(grid.integrate_scalar(parts, |w| f(Vec3::new(w.x, w.y, -w.z))));
    all
}

#[test]
fn directions_follow_their_density_to_both_sides() {
    const SAMPLES: usize = 60_000;
    let models = models();
    let alpha = sidak_alpha(0.01, models.len() * views().len());
    for (i, (name, bsdf)) in models.iter().enumerate() {
        for (j, wi) in views().into_iter().enumerate() {
            let grid = Grid { rows: 8, columns: 12, wi: Vec3::new(wi.x, wi.y, wi.z.abs()) };
            let mut observed = vec![0u64; 2 * grid.cells() + 1];
            let mut s = stream((100 * i + j) as u64);
            for _ in 0..SAMPLES {
                let cell = draw(bsdf, wi, &mut s).map_or(2 * grid.cells(), |x| {
                    let above = Vec3::new(x.wo.x, x.wo.y, x.wo.z.abs());
                    grid.cell(above) + if x.wo.z > 0.0 { 0 } else { grid.cells() }
                });
                observed[cell] += 1;
            }
            let mut expected = integrate(wi, (8, 12), 12, |wo| bsdf.pdf_sa(wi, wo));
            let integral: f64 = expected.iter().sum();
            assert!(integral < 1.001, "{name} from {wi}: density of {integral}");
            expected.push((1.0 - integral).max(0.0));
            expected.iter_mut().for_each(|e| *e *= SAMPLES as f64);
            let p = chi2_goodness_of_fit(&observed, &expected, 0).p_value;
            assert!(p > alpha, "{name} from {wi}: p = {p:e} <= {alpha:e}");
        }
    }
}

#[test]
fn weights_are_f_cos_over_pdf_of_radiance_and_of_importance() {
    for (name, bsdf) in models() {
        for wi in views() {
            let mut s = stream(3);
            for mode in [Mode::Radiance, Mode::Importance] {
                for _ in 0..500 {
                    let u_lobe = s.next_f32();
                    let Some(x) = bsdf.sample(wi, mode, u_lobe, s.next_2d()) else { continue };
                    let factor = if mode == Mode::Radiance { bsdf.radiance_factor(wi, x.wo) } else { 1.0 };
                    let want = bsdf.eval(wi, x.wo).0.x * factor * x.wo.z.abs() / bsdf.pdf_sa(wi, x.wo);
                    assert!((x.weight.0.x / want - 1.0).abs() < 1e-3, "{name} {mode:?}: {:?} {want}", x.weight);
                    assert_eq!(x.eta != 1.0, x.wo.z * wi.z < 0.0, "{name}");
                }
            }
        }
    }
}

#[test]
fn light_that_takes_a_path_backwards_is_worth_the_same() {
    // Importance along a path is radiance along its reverse: f*(a, b) = f(b, a).
    for (name, bsdf) in models() {
        let mut s = stream(4);
        let mut across = 0;
        for _ in 0..4000 {
            let (a, b) = (warp::sphere(s.next_2d()), warp::sphere(s.next_2d()));
            let (there, back) = (bsdf.eval(a, b).0.x, bsdf.eval(b, a).0.x * bsdf.radiance_factor(b, a));
            // Near the critical angle cosines cancel.
            assert!((there - back).abs() <= 2e-3 * there.max(back) + 1e-5, "{name}: {a} {b}: {there} {back}");
            across += usize::from(there > 0.0 && a.z * b.z < 0.0);
        }
        assert!(across > 100, "{name}: {across}");
    }
}

#[test]
fn glass_keeps_almost_all_light_and_makes_none() {
    for (name, bsdf) in models() {
        for wi in views() {
            let energy: f64 = integrate(wi, (1, 1), 60, |wo| bsdf.eval(wi, wo).0.x * wo.z.abs()).iter().sum();
            // What microfacets shadow is lost. (Beckmann's fit of the masking makes up to 0.4 % too much.)
            let polished = name.contains("(0.15, 0.15)") && wi.z.abs() > 0.5;
            let least = if polished { 0.94 } else { 0.3 };
            // A mixture may shine at grazing angles: lacquer and sheen come on top.
            let most = if name.contains("mixture") && wi.z > 0.0 { 1.2 } else { 1.004 };
            assert!((least..=most).contains(&energy), "{name} from {wi}: {energy}");
        }
    }
}

#[test]
fn bounds_hold_over_cones_to_both_sides() {
    let between = |s: &mut Stream, low: f32, high: f32| low * (high / low).powf(s.next_f32());
    let mut s = stream(5);
    let (mut across, mut reflected) = (0, 0);
    for _ in 0..30_000 {
        let distribution = [Distribution::Beckmann, Distribution::Ggx][s.next_below(2)];
        let alpha = (between(&mut s, 1e-3, 2.0), between(&mut s, 1e-3, 2.0));
        let ior = if s.next_f32() < 0.5 { between(&mut s, 1.05, 3.0) } else { between(&mut s, 0.3, 0.95) };
        let glass = s.next_f32() < 0.6;
        let bsdf = if glass { rough(distribution, alpha, ior) } else { any_principled(&mut s, true) };
        let wi = warp::sphere(s.next_2d());
        let axis = draw(&bsdf, wi, &mut s).filter(|_| s.next_f32() < 0.8).map_or(Vec3::Z, |x| x.wo);
        let frame = Frame::around(axis.normalize());
        let cos_half = 1.0 - between(&mut s, 1e-6, 2.0);
        let bound = bsdf.upper_bound(wi, frame.n, cos_half);
        for _ in 0..12 {
            let wo = frame.to_world(warp::cone(s.next_2d(), 1.0 - cos_half)).normalize();
            let f = bsdf.eval(wi, wo).largest() * bsdf.radiance_factor(wi, wo).max(1.0);
            assert!(f <= bound.without_cosine, "{bsdf:?} {wi} {wo}: {f} {bound:?}");
            assert!(f * wo.z.abs() <= bound.with_cosine, "{bsdf:?} {wi} {wo}: {} {bound:?}", f * wo.z.abs());
            across += usize::from(f > 0.0 && wi.z * wo.z < 0.0);
            reflected += usize::from(f > 0.0 && wi.z * wo.z > 0.0);
        }
    }
    assert!(across > 30_000 && reflected > 20_000, "{across} {reflected}");
}

#[test]
fn a_thin_sheet_reflects_or_lets_pass_all_light_and_bends_none() {
    let sheet = Bsdf::from(ThinDielectric::new(1.5, 1.0, Spectrum::ONE, Spectrum::ONE));
    for wi in views() {
        let mirrored = sheet.sample(wi, Mode::Radiance, 0.0, Vec2::ZERO).unwrap();
        let passed = sheet.sample(wi, Mode::Radiance, 0.999_999, Vec2::ZERO).unwrap();
        assert_eq!((passed.wo, passed.eta, mirrored.wo.z), (-wi, 1.0, wi.z));
        assert!((mirrored.pdf + passed.pdf - 1.0).abs() < 1e-6);
        assert_eq!((mirrored.weight, passed.weight), (Spectrum::ONE, Spectrum::ONE));
    }
    // Two interfaces of R = 0.04, all reflections between them summed term by term.
    let (r, t) = (0.04f64, 0.96f64);
    let sum: f64 = r + (0..50).map(|k| t * t * r * (r * r).powi(k)).sum::<f64>();
    let got = sheet.sample(Vec3::Z, Mode::Radiance, 0.0, Vec2::ZERO).unwrap().pdf;
    assert!((f64::from(got) - sum).abs() < 1e-6, "{got} {sum}");
}
