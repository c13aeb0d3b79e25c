//! No model makes light, and albedos are what they say.

mod common;

use common::*;
use manylight_bsdf::*;
use manylight_math::{Spectrum, Vec2, Vec3};

/// Albedo by quadrature: the integral of f cos, channel by channel.
fn integrated(bsdf: &Bsdf, wi: Vec3) -> Spectrum {
    let grid = Grid { rows: 1, columns: 1, wi };
    Spectrum(grid.integrate(80, |wo| (bsdf.eval(wi, wo) * wo.z).0.as_dvec3())[0].as_vec3())
}
fn views() -> [Vec3; 5] {
    [Vec3::Z, polar(0.5, 1.0), polar(1.0, 2.5), polar(1.3, -0.4), polar(1.5, 4.0)]
}
/// What delta lobes reflect, from one sample of each.
fn delta_energy(bsdf: &Bsdf, wi: Vec3) -> Spectrum {
    let sample = bsdf.sample(wi, Mode::Importance, 0.0, Vec2::splat(0.5));
    sample.filter(|x| x.delta).map_or(Spectrum::BLACK, |x| x.weight * x.pdf)
}

#[test]
fn albedos_are_the_integrals_they_stand_for() {
    let (mut worst, mut worst_of_plastic, mut worst_of_principled) = (0.0f32, 0.0f32, 0.0f32);
    for (name, bsdf) in smooth_models() {
        // Closed forms, tables, and the means of a few samples.
        let tolerance = match bsdf {
            Bsdf::Diffuse(_) | Bsdf::Plastic(_) => 1e-4,
            Bsdf::RoughPlastic(_) => 5e-4,
            Bsdf::Principled(_) => 0.03,
            _ => 0.015,
        };
        for wi in views() {
            let (truth, claim) = (integrated(&bsdf, wi), bsdf.albedo(wi));
            let error = (truth - claim).0.abs().max_element();
            assert!(error < tolerance, "{name} from {wi}: {truth:?} {claim:?}");
            worst = worst.max(error);
            if matches!(bsdf, Bsdf::Principled(_)) {
                worst_of_principled = worst_of_principled.max(error);
            }
            if matches!(bsdf, Bsdf::RoughPlastic(_)) {
                worst_of_plastic = worst_of_plastic.max(error);
            }
        }
    }
    println!(
        "largest error of an albedo: {worst:.4}; rough plastic {worst_of_plastic:.4}, principled {worst_of_principled:.4}"
    );
}

#[test]
fn nothing_reflects_more_than_it_gets() {
    let mut models = smooth_models();
    for distribution in [Distribution::Beckmann, Distribution::Ggx] {
        for (alpha_u, alpha_v) in [(0.1, 0.1), (0.3, 0.8), (1.0, 1.0)] {
            models.push((format!("white {distribution:?}"), white_metal(distribution, alpha_u, alpha_v)));
        }
        for alpha in [0.1, 0.4, 0.9] {
            let name = format!("white plastic {distribution:?} {alpha}");
            models.push((name, rough_plastic(distribution, alpha, Spectrum::ONE, Spectrum::ONE)));
        }
    }
    for (name, bsdf) in models {
        for wi in views() {
            let total = integrated(&bsdf, wi) + delta_energy(&bsdf, wi);
            // The fit of the internal reflectance of a smooth coat, which we share with Mitsuba 3, makes 0.11 % of light.
            let tolerance = match bsdf {
                Bsdf::Plastic(_) => 1.2e-3,
                // As published: its lobes are added, not shared out. (Values are Mitsuba's: see `mitsuba.rs`.)
                Bsdf::Principled(_) => 0.6,
                _ => 1e-3,
            };
            assert!(total.largest() <= 1.0 + tolerance, "{name} from {wi}: {total:?}");
        }
    }
}

#[test]
fn a_white_coated_surface_gives_back_what_it_gets() {
    let bsdf = Bsdf::from(Plastic::new(1.5, 1.0, Spectrum::ONE, Spectrum::ONE, true));
    for wi in views() {
        let total = integrated(&bsdf, wi) + delta_energy(&bsdf, wi);
        assert!((total.0.x - 1.0).abs() < 1.2e-3, "{wi}: {total:?}");
    }
}

/// Energy of both lobes of the glass, each weight times its probability.
fn lobes_of_glass(wi: Vec3, mode: Mode) -> (BsdfSample, Option<BsdfSample>) {
    let reflected = glass().sample(wi, mode, 0.0, Vec2::ZERO).unwrap();
    let refracted = glass().sample(wi, mode, 0.99999994, Vec2::ZERO).filter(|x| x.wo.z * wi.z < 0.0);
    assert!(reflected.delta && reflected.wo.z * wi.z > 0.0);
    (reflected, refracted)
}

#[test]
fn glass_keeps_importance_and_scales_radiance_by_the_square_of_the_index() {
    for i in 0..200 {
        let wi = polar(std::f32::consts::PI * (i as f32 + 0.5) / 200.0, 0.7);
        let (reflected, refracted) = lobes_of_glass(wi, Mode::Importance);
        let Some(refracted) = refracted else {
            assert!(wi.z < 0.0 && (1.0 - wi.z * wi.z).sqrt() > 1.0 / 1.5 - 1e-3, "{wi}: nothing refracted");
            assert_eq!((reflected.weight, reflected.pdf), (Spectrum::ONE, 1.0));
            continue;
        };
        let energy = reflected.weight * reflected.pdf + refracted.weight * refracted.pdf;
        assert!((energy.0 - Vec3::ONE).abs().max_element() < 1e-5, "{wi}: {energy:?}");

        let radiance = lobes_of_glass(wi, Mode::Radiance).1.unwrap();
        let eta = if wi.z > 0.0 { 1.5f32 } else { 1.0 / 1.5 };
        assert!((radiance.eta / eta - 1.0).abs() < 1e-6);
        // Radiance is squeezed, and what comes back along the path is divided by eta^2.
        assert!((radiance.weight.0 * eta * eta - refracted.weight.0).abs().max_element() < 1e-5);
        assert_eq!((radiance.wo, radiance.pdf), (refracted.wo, refracted.pdf));

        // Snell's law, and back on the same way: radiance in and out of the glass is unchanged.
        assert!(
            (radiance.wo.truncate() * eta + wi.truncate()).length() < 1e-5 && (radiance.wo.length() - 1.0).abs() < 1e-5
        );
        let Some(back) = lobes_of_glass(radiance.wo, Mode::Radiance).1 else { panic!("{wi}: no way back") };
        assert!((back.wo - wi).length() < 2e-2, "{wi} {back:?}");
        assert!((back.weight.0 * radiance.weight.0 - Vec3::ONE).abs().max_element() < 1e-5);
    }
}

#[test]
fn modes_differ_in_refraction_alone() {
    for (name, bsdf) in smooth_models() {
        for (i, u) in squares(200).enumerate() {
            let wi = polar(0.9, 0.3);
            let u_lobe = i as f32 / 200.0;
            let of = |mode| bsdf.sample(wi, mode, u_lobe, u);
            assert_eq!(of(Mode::Radiance), of(Mode::Importance), "{name}");
        }
    }
}

#[test]
fn an_interface_between_equal_media_is_not_there() {
    let air = Bsdf::from(Dielectric::new(1.3, 1.3, Spectrum::ONE, Spectrum::ONE));
    for wi in [Vec3::Z, polar(1.0, 0.3), polar(2.5, 0.3)] {
        for (mode, u_lobe) in [(Mode::Radiance, 0.0), (Mode::Importance, 0.5)] {
            let s = air.sample(wi, mode, u_lobe, Vec2::ZERO).unwrap();
            assert!((s.wo + wi).length() < 1e-6 && s.weight == Spectrum::ONE && s.pdf == 1.0 && s.eta == 1.0);
        }
    }
}
