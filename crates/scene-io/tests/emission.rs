//! Media that emit, from scene files: an extension of ours, since Mitsuba 3 has none.

use manylight_math::{Spectrum, Vec3};
use manylight_scene::{Medium, Scene};
use manylight_scene_io::{LoadOptions, parse};
use std::path::Path;

/// A grid of 1 x 1 x n values.
fn vol(folder: &Path, name: &str, values: &[f32]) {
    let mut bytes = b"VOL\x03".to_vec();
    for n in [1, 1, 1, values.len() as i32, 1] {
        bytes.extend(n.to_le_bytes());
    }
    for x in [0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().chain(values) {
        bytes.extend(x.to_le_bytes());
    }
    std::fs::write(folder.join(name), bytes).unwrap();
}
fn scene(folder: &Path, medium: &str) -> Scene {
    let text = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{medium}<shape type=\"sphere\"><ref id=\"m\" name=\"interior\"/>\
         <bsdf type=\"null\"/></shape></scene>"
    );
    match parse(&text, Path::new("t.xml"), folder, &LoadOptions::default()) {
        Ok(loaded) => loaded.scene,
        Err(e) => panic!("{e}"),
    }
}
fn emission(scene: &Scene, z: f32) -> Spectrum {
    match scene.media().next() {
        Some((_, Medium::Heterogeneous(m))) => m.emission().unwrap().at(Vec3::new(0.5, 0.5, z)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn media_emit_what_the_file_says() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    vol(at, "d.vol", &[2.0, 4.0]);
    vol(at, "t.vol", &[1.0, 0.0]);
    let grid = |name: &str, file: &str| {
        format!(
            "<volume name=\"{name}\" type=\"gridvolume\"><string name=\"filename\" value=\"{file}\"/>\
             <string name=\"filter_type\" value=\"nearest\"/></volume>"
        )
    };
    let medium = |more: &str| {
        let sigma = grid("sigma_t", "d.vol");
        format!("<medium type=\"heterogeneous\" id=\"m\">{sigma}<float name=\"albedo\" value=\"0.75\"/>{more}</medium>")
    };
    let t = grid("temperature", "t.vol");
    let near = |a: Spectrum, b: Spectrum| assert!((a.0 - b.0).length() <= 1e-5 * b.0.length(), "{a:?} {b:?}");
    // By a grid of its own.
    let s = scene(at, &medium(&format!("{}<float name=\"emission_scale\" value=\"3\"/>", grid("emission", "d.vol"))));
    near(emission(&s, 0.2), Spectrum::gray(6.0));
    assert!(s.media_emit());
    // A glowing gas: sigma_a B(300 + 1200).
    let kelvins =
        "<float name=\"temperature_scale\" value=\"1200\"/><float name=\"temperature_offset\" value=\"300\"/>";
    let s = scene(at, &medium(&format!("{t}{kelvins}")));
    let body = manylight_media::blackbody::radiance;
    near(emission(&s, 0.2), body(1500.0) * (2.0 * 0.25));
    near(emission(&s, 0.8), body(300.0) * (4.0 * 0.25));
    // Colours by value, whatever it absorbs.
    let s = scene(at, &medium(&format!("{t}<string name=\"ramp\" value=\"0.5: 0 0 0; 1.5: 4 2 0\"/>")));
    near(emission(&s, 0.2), Spectrum::rgb(2.0, 1.0, 0.0));
    assert!(emission(&s, 0.8).is_black());
    // The same everywhere.
    let s = scene(at, "<medium type=\"homogeneous\" id=\"m\"><rgb name=\"emission\" value=\"1 2 3\"/></medium>");
    assert_eq!(s.media().next().unwrap().1.homogeneous().unwrap().emission, Spectrum::rgb(1.0, 2.0, 3.0));
    let s = scene(at, &medium(""));
    assert!(s.has_media() && !s.media_emit());
}
