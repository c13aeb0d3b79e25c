//! Scenes with media against Mitsuba 3's images of them: ours, and those from elsewhere (skipped, with a word, where the folders
//! `../shared/scenes` and `../shared/references` are missing).

use manylight_integration::{block_runs, effort, load_scene, our_scene, recipe, reference_blocks, repository, shared};
use manylight_scene::Scene;
use manylight_stats::{BlockTest, Reference, Verdict};
use std::path::Path;

fn against(scene: &Scene, reference: &Path, method: &str, params: &[&str], passes: u64, grid: usize) -> Verdict {
    let r = recipe(method, params, scene);
    let runs = block_runs(scene, &*r.method, r.spp, 41, effort(passes), grid);
    let (mean, std_error) = reference_blocks(reference, grid);
    let estimate = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: f64::INFINITY };
    BlockTest::default().run(&runs, estimate).unwrap()
}

#[test]
fn our_scenes_with_media_are_mitsubas() {
    for (name, size, spp, grid, paths) in [
        ("fruit-juice", (48, 48), "spp=16", 1, None),
        ("fog-corridor", (64, 36), "spp=4", 2, Some("paths=256")),
        ("smoky-room", (64, 36), "spp=4", 2, Some("paths=1024")),
    ] {
        let passes = 48;
        let scene = our_scene(name, size);
        let reference = repository().join("scenes").join(name).join("reference.exr");
        let verdict = against(&scene, &reference, "path", &[spp], passes, grid);
        println!("{name}, path: {verdict}");
        assert!(verdict.passes(), "{name}: {verdict}");
        // Point lights on surfaces are not bounded: where the camera sees corners, there is no verdict to be had.
        let Some(paths) = paths else { continue };
        let vrl = [paths, "bound=none", "lights=power", "samples=4"];
        let verdict = against(&scene, &reference, "vrl", &vrl, passes, 1);
        println!("{name}, vrl: {verdict}");
        assert!(verdict.passes(), "{name}: {verdict}");
    }
}

/// Means of the whole image, of point lights with what a compensation gives back; `allowed` is a bias that may be.
fn compensated(name: &str, scene: &Scene, reference: &Path, compensation: &str, passes: u64, allowed: f64) -> Verdict {
    let params = ["paths=512", "lights=power", "samples=8", compensation];
    let r = recipe("media-vpl", &params, scene);
    let runs = block_runs(scene, &*r.method, r.spp, 43, effort(passes), 1).with_mean();
    let (mean, std_error) = reference_blocks(reference, 1);
    let whole = |x: &[f64]| [x, &[x.iter().sum::<f64>() / 3.0]].concat();
    let estimate = Reference::Estimate { mean: &whole(&mean), std_error: &whole(&std_error), degrees: f64::INFINITY };
    let verdict = BlockTest { rounding: allowed, ..BlockTest::default() }.run(&runs, estimate).unwrap();
    let (whole, truth) = (runs.moments(3), mean.iter().sum::<f64>() / 3.0);
    let percent = |x: f64| 100.0 * x / truth;
    let (off, error) = (percent(whole.mean() - truth), percent(whole.std_error()));
    println!("{name}, {compensation}: whole image {off:+.2} % +- {error:.2} %; {verdict}");
    verdict
}

#[test]
fn compensated_lights_in_our_scenes_are_mitsubas() {
    for (name, size, homogeneous) in
        [("fruit-juice", (24, 24), true), ("fog-corridor", (32, 18), true), ("smoky-room", (32, 18), false)]
    {
        let scene = our_scene(name, size);
        let reference = repository().join("scenes").join(name).join("reference.exr");
        let raab = compensated(name, &scene, &reference, "compensation=raab", 96, 0.0);
        assert!(!raab.rejected(), "{name}: {raab}");
        if homogeneous {
            let rough = compensated(name, &scene, &reference, "compensation=engelhardt", 96, 0.03);
            assert!(!rough.rejected(), "{name}: {rough}");
        }
    }
}

#[test]
fn smoke_from_elsewhere_is_mitsubas() {
    // (The caustic in fog is known to three per cent, and has a heavy tail: no test could conclude.)
    let (Some(scenes), Some(references)) = (shared("scenes"), shared("references")) else { return };
    let scene = load_scene(&scenes.join("combustion-plume/scene.xml"), (160, 240));
    let verdict = against(&scene, &references.join("combustion-plume.exr"), "path", &["spp=2"], 24, 2);
    println!("combustion-plume, path: {verdict}");
    assert!(verdict.passes(), "{verdict}");
}
