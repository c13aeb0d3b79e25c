//! Values of Mitsuba 3, in `mitsuba_oracle.txt` (printed by `mitsuba_oracle.py`).

use manylight_bsdf::*;
use manylight_math::{Spectrum, Vec2, Vec3};

const DIFFUSE: Spectrum = Spectrum::rgb(0.1, 0.5, 0.9);
const SPECULAR: Spectrum = Spectrum::rgb(1.0, 0.8, 0.3);

/// Relative, over what the other program's single precision resolves.
fn close(ours: f32, theirs: f32, tolerance: f32) -> bool {
    (ours - theirs).abs() <= tolerance * theirs.abs() + 1e-7
}

fn numbers(field: &str) -> Vec<f32> {
    field.split_whitespace().map(|x| x.parse().unwrap()).collect()
}
fn vector(field: &str) -> Vec3 {
    Vec3::from_slice(&numbers(field))
}
fn distribution(name: &str) -> Distribution {
    match name {
        "beckmann" => Distribution::Beckmann,
        "ggx" => Distribution::Ggx,
        _ => panic!("distribution {name}"),
    }
}
fn metal(ior: &[f32]) -> (Spectrum, Spectrum) {
    (Spectrum(Vec3::from_slice(&ior[..3])), Spectrum(Vec3::from_slice(&ior[3..])))
}

fn model(name: &str, parameters: &str) -> Bsdf {
    let (word, rest) = parameters.split_once(' ').unwrap_or((parameters, ""));
    match name {
        "diffuse" => Diffuse::new(DIFFUSE).into(),
        "conductor" => {
            let (eta, k) = metal(&numbers(parameters));
            Conductor::new(eta, k, SPECULAR).into()
        }
        "roughconductor" => {
            let p = numbers(rest);
            let (eta, k) = metal(&p[2..]);
            RoughConductor::new(distribution(word), p[0], p[1], eta, k, SPECULAR).into()
        }
        "dielectric" => {
            let p = numbers(parameters);
            Dielectric::new(p[0], p[1], SPECULAR, DIFFUSE).into()
        }
        "plastic" | "plastic-delta" => {
            let p = numbers(parameters);
            Plastic::new(p[0], 1.0, DIFFUSE, SPECULAR, p[1] == 1.0).into()
        }
        "roughplastic" => {
            let p = numbers(rest);
            let coat = RoughTransmittance::of(distribution(word), p[0], p[1]);
            RoughPlastic::new(coat, DIFFUSE, SPECULAR, p[2] == 1.0).into()
        }
        "principled" => {
            let mut p = PrincipledParameters { base_color: DIFFUSE, ..Default::default() };
            for (name, value) in parameters.split(' ').filter_map(|given| given.split_once('=')) {
                let value: f32 = value.parse().unwrap();
                match name {
                    "roughness" => p.roughness = value,
                    "anisotropic" => p.anisotropic = value,
                    "metallic" => p.metallic = value,
                    "spec_trans" => p.spec_trans = value,
                    "eta" => p.eta = value,
                    "specular" => p.eta = PrincipledParameters::eta_of_specular(value),
                    "spec_tint" => p.spec_tint = value,
                    "sheen" => p.sheen = value,
                    "sheen_tint" => p.sheen_tint = value,
                    "flatness" => p.flatness = value,
                    "clearcoat" => p.clearcoat = value,
                    "clearcoat_gloss" => p.clearcoat_gloss = value,
                    _ => panic!("parameter {name}"),
                }
            }
            Principled::new(&p).into()
        }
        _ => panic!("model {name}"),
    }
}

fn lines() -> impl Iterator<Item = Vec<&'static str>> {
    include_str!("mitsuba_oracle.txt").lines().map(|line| line.split(" | ").collect())
}

#[test]
fn smooth_lobes_have_the_values_and_densities_of_mitsuba() {
    let (mut compared, mut bright, mut worst, mut worst_pdf) = (0, 0, 0.0f32, 0.0f32);
    for line in lines().filter(|line| line.len() == 6) {
        let bsdf = model(line[0], line[1]);
        let (wi, wo) = (vector(line[2]), vector(line[3]));
        let (theirs, their_pdf) = (vector(line[4]), numbers(line[5])[0]);
        // `eval` is of importance, theirs of radiance.
        let ours = (bsdf.eval(wi, wo) * (bsdf.radiance_factor(wi, wo) * wo.z.abs())).0;
        for channel in 0..3 {
            assert!(close(ours[channel], theirs[channel], 1e-4), "{line:?}: {ours}");
            if theirs[channel] > 1e-4 {
                bright += 1;
                worst = worst.max((ours[channel] / theirs[channel] - 1.0).abs());
            }
        }
        // Beckmann: they divide by the fit of the masking, we by the masking with which samples are drawn.
        let tolerance = if line[1].starts_with("beckmann") { 4e-3 } else { 1e-4 };
        let pdf = bsdf.pdf_sa(wi, wo);
        assert!(close(pdf, their_pdf, tolerance), "{line:?}: {pdf}");
        if their_pdf > 1e-4 {
            worst_pdf = worst_pdf.max((pdf / their_pdf - 1.0).abs());
        }
        compared += 1;
    }
    println!("{compared} compared, largest relative difference {worst:.1e}, of densities {worst_pdf:.1e}");
    assert!(compared > 1000 && bright > 2000, "{compared} {bright}");
}

#[test]
fn delta_lobes_have_the_weights_and_directions_of_mitsuba() {
    let mut compared = 0;
    for line in lines().filter(|line| line.len() == 7) {
        let bsdf = model(line[0], line[1]);
        let (wi, wo, weight) = (vector(line[2]), vector(line[3]), vector(line[4]));
        let (pdf, eta) = (numbers(line[5])[0], numbers(line[6])[0]);
        // What they draw tells which lobe it was: refraction goes to the other side.
        let u_lobe = if wi.z * wo.z < 0.0 { 0.999999 } else { 0.0 };
        let s = bsdf.sample(wi, Mode::Radiance, u_lobe, Vec2::splat(0.5)).unwrap();
        assert!(s.delta && (s.wo - wo).length() < 1e-5, "{line:?}: {s:?}");
        assert!((0..3).all(|c| close(s.weight.0[c], weight[c], 1e-3)), "{line:?}: {s:?}");
        assert!(close(s.pdf, pdf, 1e-3) && close(s.eta, eta, 1e-5), "{line:?}: {s:?}");
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
}
