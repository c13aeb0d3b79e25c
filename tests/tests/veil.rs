//! A lamp over a sheet with holes, rough glass, a bumpy floor and blended walls (`scenes/veil.xml`): light paths and eye paths see
//! the same surfaces as each other, and as Mitsuba 3.

use manylight_integration::{block_runs, effort, load_scene, recipe};
use manylight_scene::Scene;
use manylight_stats::{BlockTest, Reference, Verdict};
use std::path::PathBuf;

const GRID: usize = 4;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes")
}
fn veil() -> Scene {
    load_scene(&folder().join("veil.xml"), (32, 32))
}
/// Block means and their standard errors by Mitsuba's `volpath`.
fn mitsuba() -> (Vec<f64>, Vec<f64>) {
    let text = std::fs::read_to_string(folder().join("veil.txt")).unwrap();
    let rows = text.lines().filter(|l| !l.starts_with('#'));
    let rows: Vec<Vec<f64>> = rows.map(|l| l.split(' ').map(|x| x.parse().unwrap()).collect()).collect();
    let part = |from: usize| rows.iter().flat_map(|r| r[from..from + 3].to_vec()).collect();
    (part(0), part(3))
}
fn against_mitsuba(scene: &Scene, name: &str, spp: u32, passes: u64) -> Verdict {
    let r = recipe(name, &[], scene);
    let runs = block_runs(scene, &*r.method, spp, 77, effort(passes), GRID);
    let (mean, std_error) = mitsuba();
    // Of 48 runs.
    let reference = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: 47.0 };
    let verdict = BlockTest::default().run(&runs, reference).unwrap();
    println!("{name}: {verdict}");
    verdict
}

#[test]
fn paths_from_either_end_agree_with_mitsuba() {
    let scene = veil();
    // Virtual lights at the rough glass have too heavy a tail for a verdict.
    for (name, spp) in [("path", 32), ("path-lights", 32), ("bidirectional", 16)] {
        let verdict = against_mitsuba(&scene, name, spp, 32);
        assert!(verdict.passes(), "{name}: {verdict}");
    }
}
