//! Where formulas divide by zero: no NaN, no infinity, nothing negative.

mod common;

use common::*;
use manylight_bsdf::*;
use manylight_math::{Spectrum, Vec2, Vec3};

fn models() -> Vec<(String, Bsdf)> {
    use Distribution::*;
    let mut models = smooth_models();
    let black = Spectrum::BLACK;
    let mut add = |name: &str, bsdf: Bsdf| models.push((name.into(), bsdf));
    for distribution in [Beckmann, Ggx] {
        // Clamped to MIN_ALPHA.
        add("polished metal", metal(distribution, 0.0, 0.0));
        add("brushed metal", metal(distribution, 0.0, 2.0));
        add("perfect mirrors", white_metal(distribution, 0.3, 0.3));
        let index_one = RoughConductor::new(distribution, 0.3, 0.3, Spectrum::ONE, black, Spectrum::ONE);
        add("metal that is not there", index_one.into());
        add("black metal", RoughConductor::new(distribution, 0.3, 0.3, GOLD.0, GOLD.1, black).into());
        add("polished plastic", rough_plastic(distribution, 0.0, RED, BLUE));
        add("rough plastic without a coat", rough_plastic(distribution, 0.3, RED, black));
        add("rough plastic without a base", rough_plastic(distribution, 0.3, black, BLUE));
        add("rough plastic of nothing", rough_plastic(distribution, 0.3, black, black));
        let thin = RoughTransmittance::of(distribution, 0.3, 1.0 / 1.5);
        add("rough plastic in water", RoughPlastic::new(thin, RED, BLUE, false).into());
    }
    for (eta, diffuse, specular) in
        [(1.0, RED, BLUE), (0.7, RED, BLUE), (4.5, RED, BLUE), (1.5, black, BLUE), (1.5, RED, black)]
    {
        add("plastic", Plastic::new(eta, 1.0, diffuse, specular, true).into());
    }
    add("plastic of nothing", Plastic::new(1.5, 1.0, black, black, false).into());
    add("conductor", Conductor::new(GOLD.0, GOLD.1, RED).into());
    for distribution in [Beckmann, Ggx] {
        add("rough glass", RoughDielectric::new(distribution, (0.3, 0.6), (1.5, 1.0), RED, BLUE).into());
        add("polished glass", RoughDielectric::new(distribution, (0.0, 0.0), (1.0, 1.5), RED, BLUE).into());
    }
    for int_ior in [1.0, 1.5, 0.5] {
        add("dielectric", Dielectric::new(int_ior, 1.0, RED, BLUE).into());
    }
    for (name, bsdf) in principled_glass() {
        add(&name, bsdf);
    }
    add("principled polish", common::principled(|p| (p.roughness, p.clearcoat, p.clearcoat_gloss) = (0.0, 1.0, 1.0)));
    add("principled of nothing", common::principled(|p| (p.base_color, p.eta, p.spec_tint) = (black, 1.0, 1.0)));
    add("principled glass that is not there", common::principled(|p| (p.spec_trans, p.eta) = (1.0, 1.0)));
    add(
        "principled past its range",
        common::principled(|p| (p.metallic, p.roughness, p.flatness) = (2.0, f32::NAN, -1.0)),
    );
    add("principled of no known roughness", common::principled(|p| (p.metallic, p.roughness) = (0.0, f32::NAN)));
    add("diffuse black", Diffuse::new(black).into());
    add("black", Bsdf::Black);
    models
}

fn directions() -> Vec<Vec3> {
    let mut directions = vec![];
    for z in [0.0f32, -0.0, 1e-38, 1e-20, 1e-8, 1e-4, 0.1, 0.7, 0.9999999, 1.0] {
        for phi in [0.0f32, 1.0, std::f32::consts::PI] {
            let sin = (1.0 - z * z).max(0.0).sqrt();
            directions.extend([1.0, -1.0].map(|side| Vec3::new(sin * phi.cos(), sin * phi.sin(), side * z)));
        }
    }
    directions
}

/// Its lobes add up to more than one, sheen above all.
fn principled(bsdf: &Bsdf) -> bool {
    matches!(bsdf, Bsdf::Principled(_))
}
fn valid(x: f32) -> bool {
    x.is_finite() && x >= 0.0
}

#[test]
fn values_densities_and_bounds_are_finite() {
    for (name, bsdf) in models() {
        for wi in directions() {
            for wo in directions() {
                let (f, pdf) = (bsdf.eval(wi, wo), bsdf.pdf_sa(wi, wo));
                assert!(f.is_valid() && valid(pdf), "{name} {wi:?} {wo:?}: {f:?} {pdf}");
                // What can be evaluated can be drawn.
                assert!(f.largest() < 1e-30 || pdf > 0.0, "{name} {wi:?} {wo:?}: {f:?} and no density");
                for cos_half in [1.0, 0.9999999, 0.5, 0.0, -1.0] {
                    let bound = bsdf.upper_bound(wi, wo, cos_half);
                    assert!(valid(bound.with_cosine) && valid(bound.without_cosine), "{name} {wi:?} {wo:?}: {bound:?}");
                    assert!(bound.without_cosine >= f.largest(), "{name} {wi:?} {wo:?}: {bound:?} {f:?}");
                    assert!(bound.with_cosine >= f.largest() * wo.z, "{name} {wi:?} {wo:?}: {bound:?} {f:?}");
                }
            }
            let albedo = bsdf.albedo(wi);
            assert!(
                albedo.is_valid() && albedo.largest() < if principled(&bsdf) { 1.8 } else { 1.02 },
                "{name} {wi:?}: {albedo:?}"
            );
        }
    }
}

#[test]
fn samples_are_unit_and_weigh_no_more_than_they_can() {
    let last = 1.0 - f32::EPSILON / 2.0;
    for (name, bsdf) in models() {
        for wi in directions() {
            for u_lobe in [0.0, 0.3, 0.7, last] {
                for u in [0.0, 1e-7, 0.5, last].into_iter().flat_map(|x| [0.0, 0.25, last].map(|y| Vec2::new(x, y))) {
                    for mode in [Mode::Radiance, Mode::Importance] {
                        let Some(s) = bsdf.sample(wi, mode, u_lobe, u) else { continue };
                        assert!((s.wo.length() - 1.0).abs() < 1e-5, "{name} {wi:?} {u:?}: {s:?}");
                        assert!(s.weight.is_valid() && s.pdf > 0.0 && s.pdf.is_finite(), "{name} {wi:?} {u:?}: {s:?}");
                        // Lobes are chosen by what they reflect: weights stay near it. Importance gains nothing by refraction.
                        let most = if mode == Mode::Radiance && s.eta != 1.0 { 4.0 } else { 3.0 };
                        let most = if principled(&bsdf) { 12.0 } else { most };
                        assert!(s.weight.largest() <= most, "{name} {wi:?} {u:?}: {s:?}");
                        assert!(
                            s.delta || (s.wo.z > 0.0 || !bsdf.is_one_sided()) && s.pdf == bsdf.pdf_sa(wi, s.wo),
                            "{name} {wi:?} {u:?}: {s:?}"
                        );
                        assert!(if s.delta { bsdf.has_delta() } else { bsdf.has_smooth() }, "{name}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_path_along_the_surface_meets_nothing() {
    for (name, bsdf) in models() {
        assert!(bsdf.sample(Vec3::X, Mode::Radiance, 0.5, Vec2::splat(0.5)).is_none(), "{name}");
        assert!(bsdf.eval(Vec3::X, Vec3::Z).is_black() && bsdf.eval(Vec3::Z, Vec3::X).is_black(), "{name}");
    }
}

#[test]
fn nan_scatters_nothing() {
    let nan = Vec3::splat(f32::NAN);
    for (name, bsdf) in models() {
        assert!(bsdf.eval(nan, Vec3::Z).is_black() && bsdf.eval(Vec3::Z, nan).is_black(), "{name}");
        assert!(bsdf.pdf_sa(nan, Vec3::Z) == 0.0 && bsdf.pdf_sa(Vec3::Z, nan) == 0.0, "{name}");
        assert!(bsdf.sample(nan, Mode::Radiance, 0.5, Vec2::splat(0.5)).is_none(), "{name}");
        assert_eq!(bsdf.upper_bound(nan, Vec3::Z, 0.5), Lobe::NONE, "{name}");
    }
}

#[test]
fn a_polished_metal_has_the_albedo_of_a_mirror() {
    let mirror = Bsdf::from(Conductor::new(GOLD.0, GOLD.1, Spectrum::ONE));
    for distribution in [Distribution::Beckmann, Distribution::Ggx] {
        for wi in [Vec3::Z, polar(0.7, 0.2), polar(1.4, 3.0)] {
            let truth = mirror.sample(wi, Mode::Radiance, 0.0, Vec2::ZERO).unwrap().weight;
            let albedo = metal(distribution, 0.0, 0.0).albedo(wi);
            assert!((truth - albedo).0.abs().max_element() < 1e-3, "{distribution:?} {wi}: {truth:?} {albedo:?}");
        }
    }
}

#[test]
fn a_rough_coat_is_tabulated_once() {
    let of = |alpha| RoughTransmittance::of(Distribution::Ggx, alpha, 1.4);
    assert!(std::ptr::eq(of(0.25), of(0.25)) && !std::ptr::eq(of(0.25), of(0.26)));
}
