//! `upper_bound` is never below the truth, and not far above it where it matters.

mod common;

use common::*;
use manylight_bsdf::*;
use manylight_math::{Frame, Spectrum, Vec3};
use manylight_sampling::{Stream, warp};

fn between(s: &mut Stream, low: f32, high: f32) -> f32 {
    low * (high / low).powf(s.next_f32())
}
fn colour(s: &mut Stream) -> Spectrum {
    // Saturated: each channel is dark or bright.
    Spectrum::rgb(s.next_f32().powi(4), s.next_f32().powi(4), s.next_f32().powi(4))
}
fn distribution(s: &mut Stream) -> Distribution {
    [Distribution::Beckmann, Distribution::Ggx][s.next_below(2)]
}
fn any_model(s: &mut Stream) -> Bsdf {
    // A table costs milliseconds: few coats.
    const COATS: [(f32, f32); 4] = [(0.01, 1.5), (0.1, 1.3), (0.4, 2.0), (1.2, 1.5)];
    match s.next_below(11) {
        0 => Diffuse::new(colour(s)).into(),
        1 => Plastic::new(between(s, 0.5, 4.0), 1.0, colour(s), colour(s), s.next_f32() < 0.5).into(),
        2 | 3 => {
            let (alpha, eta) = COATS[s.next_below(4)];
            RoughPlastic::new(RoughTransmittance::of(distribution(s), alpha, eta), colour(s), colour(s), true).into()
        }
        4..=6 => any_principled(s, false),
        _ => {
            let alpha_u = between(s, 1e-4, 3.0);
            let alpha_v = if s.next_f32() < 0.5 { alpha_u } else { between(s, 1e-4, 3.0) };
            let eta = Spectrum::rgb(between(s, 0.05, 5.0), between(s, 0.05, 5.0), between(s, 0.05, 5.0));
            let k = Spectrum::rgb(between(s, 0.05, 5.0), between(s, 0.05, 5.0), 0.0);
            RoughConductor::new(distribution(s), alpha_u, alpha_v, eta, k, colour(s)).into()
        }
    }
}
/// Above the surface, grazing in a third of the cases.
fn any_direction(s: &mut Stream) -> Vec3 {
    let w = warp::sphere(s.next_2d());
    let z = if s.next_f32() < 0.33 { between(s, 1e-8, 0.1) } else { w.z.abs() };
    Vec3::new(w.x, w.y, 0.0).normalize_or(Vec3::X) * (1.0 - z * z).sqrt() + Vec3::new(0.0, 0.0, z)
}

struct Case {
    bsdf: Bsdf,
    wi: Vec3,
    frame: Frame,
    cos_half: f32,
}

fn any_case(s: &mut Stream) -> Case {
    let (bsdf, wi) = (any_model(s), any_direction(s));
    // Where the lobe is, near the horizon, or anywhere, also below.
    let axis = match s.next_below(4) {
        0 | 1 => draw(&bsdf, wi, s).map_or(Vec3::Z, |sample| sample.wo),
        2 => any_direction(s),
        _ => warp::sphere(s.next_2d()),
    };
    // From a cone of one direction to the sphere.
    let cos_half = if s.next_f32() < 0.05 { 1.0 } else { 1.0 - between(s, 1e-7, 2.0) };
    Case { bsdf, wi, frame: Frame::around(axis.normalize()), cos_half }
}

impl Case {
    fn directions(&self, s: &mut Stream) -> Vec<Vec3> {
        let mut directions: Vec<Vec3> = (0..24)
            .map(|i| {
                let mut u = s.next_2d();
                if i % 3 == 0 {
                    u.x = 1.0; // The rim, where most largest values are.
                }
                warp::cone(u, 1.0 - self.cos_half)
            })
            .chain([Vec3::Z])
            .map(|w| self.frame.to_world(w).normalize())
            .collect();
        // Also where the model itself goes, if that is in the cone.
        let drawn = (0..8).filter_map(|_| draw(&self.bsdf, self.wi, s)).map(|sample| sample.wo);
        directions.extend(drawn.filter(|w| w.dot(self.frame.n) > self.cos_half + 1e-6));
        directions
    }
    /// Largest channel of f cos and of f over the directions.
    fn truth(&self, directions: &[Vec3]) -> (f32, f32) {
        directions.iter().fold((0.0, 0.0), |(a, b): (f32, f32), &wo| {
            let f = self.bsdf.eval(self.wi, wo).largest();
            (a.max(f * wo.z.max(0.0)), b.max(f))
        })
    }
}

fn median(mut ratios: Vec<f32>) -> f32 {
    ratios.sort_by(f32::total_cmp);
    ratios[ratios.len() / 2]
}

#[test]
fn bounds_are_never_below_the_truth() {
    let mut s = stream(31);
    let mut bright = 0;
    for i in 0..200_000 {
        let case = any_case(&mut s);
        let bound = case.bsdf.upper_bound(case.wi, case.frame.n, case.cos_half);
        let directions = case.directions(&mut s);
        let (with_cosine, without_cosine) = case.truth(&directions);
        let about =
            || format!("case {i}: {:?} wi {:?} axis {:?} cos {}", case.bsdf, case.wi, case.frame.n, case.cos_half);
        assert!(bound.with_cosine.is_finite() && bound.without_cosine.is_finite(), "{bound:?} {}", about());
        assert!(with_cosine <= bound.with_cosine, "{with_cosine} > {bound:?} {}", about());
        assert!(without_cosine <= bound.without_cosine, "{without_cosine} > {bound:?} {}", about());
        bright += usize::from(with_cosine > 1e-3);
    }
    assert!(bright > 80_000, "{bright} cases had light to bound");
}

#[test]
fn bounds_are_tight_for_narrow_cones() {
    // Where the lobe is and a tenth of its width: the bound has to see the lobe, not its peak alone.
    for (distribution, alpha_u, alpha_v) in [
        (Distribution::Ggx, 0.1, 0.1),
        (Distribution::Ggx, 0.4, 0.4),
        (Distribution::Ggx, 0.5, 0.1),
        (Distribution::Beckmann, 0.1, 0.1),
        (Distribution::Beckmann, 0.4, 0.4),
        (Distribution::Beckmann, 0.5, 0.1),
    ] {
        let bsdf = metal(distribution, alpha_u, alpha_v);
        let cos_half = (0.1 * alpha_u.min(alpha_v)).cos();
        let mut s = stream(32);
        let (mut with_cosine, mut without_cosine) = (vec![], vec![]);
        for _ in 0..4000 {
            let wi = warp::cosine_hemisphere(s.next_2d());
            let Some(sample) = draw(&bsdf, wi, &mut s) else { continue };
            let case = Case { bsdf, wi, frame: Frame::around(sample.wo), cos_half };
            let bound = bsdf.upper_bound(wi, case.frame.n, cos_half);
            let truth = case.truth(&case.directions(&mut s));
            with_cosine.push(bound.with_cosine / truth.0);
            without_cosine.push(bound.without_cosine / truth.1);
        }
        let (with_cosine, without_cosine) = (median(with_cosine), median(without_cosine));
        println!("{distribution:?} {alpha_u} {alpha_v}: median bound / truth {with_cosine:.3} {without_cosine:.3}");
        assert!(with_cosine < 1.5 && without_cosine < 1.5, "{with_cosine} {without_cosine}");
    }
}

#[test]
fn bounds_of_wide_cones_stay_within_a_small_factor() {
    let mut s = stream(33);
    for half in [0.03f32, 0.1, 0.3, 1.0] {
        let mut ratios = vec![];
        for _ in 0..20_000 {
            let (distribution, alpha) = (distribution(&mut s), between(&mut s, 0.05, 1.0));
            let bsdf = metal(distribution, alpha, alpha);
            let wi = warp::cosine_hemisphere(s.next_2d());
            let Some(sample) = draw(&bsdf, wi, &mut s) else { continue };
            let case = Case { bsdf, wi, frame: Frame::around(sample.wo), cos_half: half.cos() };
            let truth = case.truth(&case.directions(&mut s)).0;
            ratios.push(bsdf.upper_bound(wi, case.frame.n, case.cos_half).with_cosine / truth);
        }
        let ratio = median(ratios);
        println!("half angle {half}: median bound / truth {ratio:.3}");
        assert!(ratio < 4.0, "{half}: {ratio}");
    }
}

#[test]
fn a_diffuse_bound_is_exact() {
    let bsdf = Bsdf::from(Diffuse::new(RED));
    let f = 0.95 / std::f32::consts::PI;
    let bound = bsdf.upper_bound(Vec3::Z, polar(1.0, 0.3), 0.8f32.cos());
    assert!(
        (bound.without_cosine / f - 1.0).abs() < 1e-4 && (bound.with_cosine / (f * 0.2f32.cos()) - 1.0).abs() < 1e-4
    );
}

#[test]
fn nothing_is_bounded_by_nothing_where_nothing_scatters() {
    let below = polar(2.0, 0.0);
    for (name, bsdf) in smooth_models() {
        assert_eq!(bsdf.upper_bound(Vec3::Z, below, 0.99), Lobe::NONE, "{name}: cone below");
        assert_eq!(bsdf.upper_bound(below, Vec3::Z, 0.99), Lobe::NONE, "{name}: wi below");
        assert_eq!(bsdf.upper_bound(Vec3::X, Vec3::Z, 0.99), Lobe::NONE, "{name}: wi along the surface");
    }
    let diffuse = Bsdf::from(Diffuse::new(RED));
    assert!(diffuse.upper_bound(Vec3::Z, below, 0.5).with_cosine > 0.0, "a cone that reaches above");
    assert_eq!(glass().upper_bound(Vec3::Z, Vec3::Z, 0.0), Lobe::NONE);
    assert_eq!(Bsdf::Black.upper_bound(Vec3::Z, Vec3::Z, 0.0), Lobe::NONE);
}

#[test]
fn the_peak_of_a_lobe_is_found_in_a_cone_that_is_far_from_it() {
    // The liar: a bound made of the value at the cone's axis.
    let bsdf = metal(Distribution::Ggx, 0.05, 0.05);
    let wi = polar(0.7, 0.0);
    let (axis, mirror) = (polar(1.2, std::f32::consts::PI), polar(0.7, std::f32::consts::PI));
    let bound = bsdf.upper_bound(wi, axis, 0.55f32.cos());
    let peak = bsdf.eval(wi, mirror).largest();
    assert!(bound.without_cosine >= peak, "{bound:?} {peak}");
    assert!(bsdf.eval(wi, axis).largest() < 0.01 * peak, "the liar is not far enough from the truth");
}
