//! Surfaces scatter as Mitsuba 3's do: scenes of one shape in `oracle/`, and Mitsuba's values of them (`oracle/make.py`).

use manylight_math::{Ray, Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, End, Mode, Scene, Sides};
use manylight_scene_io::{LoadOptions, load};
use std::collections::BTreeMap;
use std::path::PathBuf;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/oracle")
}

/// A line of the table.
struct Row {
    ray: Ray,
    out: Vec3,
    value: Spectrum,
    through: Spectrum,
}

fn table() -> BTreeMap<String, Vec<Row>> {
    let text = std::fs::read_to_string(folder().join("values.txt")).unwrap();
    let mut rows: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        let (name, numbers) = line.split_once(' ').unwrap();
        let n: Vec<f32> = numbers.split(' ').map(|x| x.parse().unwrap()).collect();
        let v = |i: usize| Vec3::new(n[i], n[i + 1], n[i + 2]);
        let ray = Ray::new(v(0), v(3).normalize());
        let row = Row { ray, out: v(6).normalize(), value: Spectrum(v(9)), through: Spectrum(v(12)) };
        rows.entry(name.into()).or_default().push(row);
    }
    rows
}

/// What light paths along the ray meet here: mean and standard error over rays that start a hair apart, as coins are tossed by them.
fn value(scene: &Scene, row: &Row) -> (Spectrum, f32) {
    const N: usize = 4000;
    let at = |i: usize| {
        let ray = Ray::new(row.ray.origin + row.ray.dir * (i as f32 * 1e-4), row.ray.dir);
        scene.intersect(&ray, Mode::Radiance).map_or(Spectrum::BLACK, |v| v.eval(row.out))
    };
    let values: Vec<Spectrum> = (0..N).map(at).collect();
    let mean = Spectrum(values.iter().map(|v| v.0).sum::<Vec3>() / N as f32);
    let variance = values.iter().map(|v| (v.0 - mean.0).length_squared()).sum::<f32>() / N as f32;
    (mean, (variance / N as f32).sqrt())
}

#[test]
fn surfaces_scatter_as_those_of_mitsuba() {
    let mut files = 0;
    for (name, rows) in table() {
        let scene = load(&folder().join(format!("{name}.xml")), &LoadOptions::default())
            .unwrap_or_else(|e| panic!("{e}"))
            .scene;
        let (mut lit, mut folded) = (0, 0);
        for row in &rows {
            let (got, std_error) = value(&scene, row);
            let difference = (got.0 - row.value.0).length();
            // Where a relief turns the surface from the viewer Mitsuba folds its normal back by the viewer, here it is black: light
            // that comes the other way could not know where it is seen from.
            if got.is_black() && !row.value.is_black() && name.contains("map") {
                folded += 1;
                continue;
            }
            let tolerance = 2e-3 * row.value.largest() + 2e-5 + 5.0 * std_error;
            assert!(
                difference < tolerance,
                "{name}: {got:?}, Mitsuba has {:?} at {:?} to {}",
                row.value,
                row.ray,
                row.out
            );
            lit += usize::from(!row.value.is_black());
        }
        let delta = name == "thindielectric";
        assert!(delta || lit >= 10 && folded * 5 <= lit, "{name}: {lit} lit, {folded} folded");
        files += 1;
    }
    assert!(files >= 10, "{files}");
}

#[test]
fn as_much_comes_through_surfaces_as_through_those_of_mitsuba() {
    let mut partly = 0;
    for (name, rows) in table() {
        let scene = load(&folder().join(format!("{name}.xml")), &LoadOptions::default())
            .unwrap_or_else(|e| panic!("{e}"))
            .scene;
        for row in &rows {
            if name == "thindielectric" {
                // Straight on, but as a vertex of the path, which a shadow ray does not pass.
                let vertex = scene.intersect(&row.ray, Mode::Radiance).unwrap();
                let on = vertex.sample(0.999_999, Vec2::ZERO).unwrap();
                assert!(on.delta && (on.dir - row.ray.dir).length() < 1e-5);
                assert!(
                    (on.weight.0 * on.pdf - row.through.0).length() < 1e-4,
                    "{on:?}, Mitsuba has {:?}",
                    row.through
                );
                continue;
            }
            let end = |p| End { p, surface: None, sides: Sides::VACUUM };
            let edge = Edge::Between(end(row.ray.origin), end(row.ray.origin + row.ray.dir * 6.0));
            let got = scene.transmittance(&edge, &mut Stream::new(1, [0; 3], Purpose::TEST));
            assert!((got.0 - row.through.0).length() < 1e-3, "{name}: {got:?}, Mitsuba has {:?}", row.through);
            partly += usize::from(!row.through.is_black());
        }
    }
    assert!(partly > 20, "{partly}");
}
