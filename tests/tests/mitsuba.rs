//! Scenes from elsewhere, read as they are, against Mitsuba 3's images of them. Skipped, with a word, where the folders
//! `../shared/scenes` and `../shared/references` are missing.

use manylight_integration::{block_runs, blocks, effort, load_scene, pass, recipe, reference_blocks, shared};
use manylight_render::files::read_exr;
use manylight_scene::Scene;
use manylight_stats::{BlockTest, Moments, Point, Reference, Slope};
use std::path::PathBuf;

/// The scene at the size of its reference image, and that image's path.
fn shared_scene(name: &str, size: (u32, u32)) -> Option<(Scene, PathBuf)> {
    let (scenes, references) = (shared("scenes")?, shared("references")?);
    Some((load_scene(&scenes.join(name).join("scene.xml"), size), references.join(format!("{name}.exr"))))
}

/// The path tracer's blocks and whole image have the reference's means.
fn path_agrees(name: &str, size: (u32, u32), grid: usize, passes: u64) {
    let Some((scene, reference)) = shared_scene(name, size) else { return };
    let path = recipe("path", &[], &scene);
    let runs = block_runs(&scene, &*path.method, path.spp, 31, effort(passes), grid);
    for grid in if grid == 1 { vec![1] } else { vec![1, grid] } {
        let (mean, std_error) = reference_blocks(&reference, grid);
        let rows = runs.rows().iter().map(|row| coarser(row, grid)).collect();
        let runs = manylight_stats::Runs::new(rows).unwrap();
        let estimate = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: f64::INFINITY };
        let verdict = BlockTest::default().run(&runs, estimate).unwrap();
        println!("{name}, {grid} x {grid} blocks: {verdict}");
        assert!(verdict.passes(), "{name}: {verdict}");
    }
}
/// Blocks of a grid joined to a coarser one: all of it (1), or as it is.
fn coarser(row: &[f64], grid: usize) -> Vec<f64> {
    if grid > 1 {
        return row.to_vec();
    }
    let blocks = (row.len() / 3) as f64;
    (0..3).map(|c| row.iter().skip(c).step_by(3).sum::<f64>() / blocks).collect()
}

#[test]
fn path_tracing_agrees_on_the_cornell_box() {
    path_agrees("cornell-box", (256, 256), 4, 32);
}

#[test]
fn path_tracing_agrees_on_the_door_left_ajar() {
    path_agrees("veach-ajar", (320, 180), 2, 40);
}

#[test]
fn path_tracing_agrees_on_the_hall() {
    path_agrees("modern-hall", (160, 90), 2, 32);
}

// Sharp reflections of the sun make rare and bright paths: these two need many passes before their variance can be told, and of
// the second only that of the whole image can.
#[test]
fn path_tracing_agrees_on_the_classroom() {
    path_agrees("classroom", (160, 90), 2, 128);
}

#[test]
fn path_tracing_agrees_on_the_staircase() {
    path_agrees("wooden-staircase", (90, 160), 1, 128);
}

#[test]
fn the_error_of_path_tracing_falls_as_one_over_the_passes() {
    let Some((scene, reference)) = shared_scene("cornell-box", (256, 256)) else { return };
    // Two independent halves of the reference: E[(I - A)(I - B)] is free of its noise.
    let half = |k: u32| {
        let path = reference.with_extension(format!("half{k}.exr"));
        blocks(&read_exr(&path).unwrap_or_else(|e| panic!("{e}")).image, 64)
    };
    let (a, b) = (half(0), half(1));
    let path = recipe("path", &[], &scene);
    let passes = effort(32) as usize;
    let rows: Vec<Vec<f64>> = block_runs(&scene, &*path.method, 1, 32, passes as u64, 64).rows().to_vec();
    let points: Vec<Point> = [1usize, 2, 4, 8]
        .iter()
        .map(|&n| {
            let replicates: Moments = rows
                .chunks_exact(n)
                .map(|rows| {
                    let mean = |k: usize| rows.iter().map(|r| r[k]).sum::<f64>() / n as f64;
                    (0..a.len()).map(|k| (mean(k) - a[k]) * (mean(k) - b[k])).sum::<f64>() / a.len() as f64
                })
                .collect();
            Point::root_of_mean(n as f64, &replicates)
        })
        .collect();
    let slope = Slope::new(&points).unwrap();
    let (low, high) = slope.interval(0.99);
    println!("log RMSE against log passes: slope {:.3}, 99 % interval [{low:.3}, {high:.3}]", slope.slope);
    assert!(low < -0.5 && -0.5 < high && high - low < 0.2, "slope {} in [{low}, {high}]", slope.slope);
}

#[test]
fn bounded_virtual_lights_are_never_brighter_than_the_reference() {
    let Some((scene, reference)) = shared_scene("cornell-box", (32, 32)) else { return };
    let (mean, std_error) = reference_blocks(&reference, 2);
    let r = recipe("instant-radiosity", &["paths=64", "bound=4"], &scene);
    let runs = block_runs(&scene, &*r.method, 1, 33, effort(128), 2);
    let test = BlockTest { alternative: manylight_stats::Alternative::Greater, ..BlockTest::default() };
    let estimate = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: f64::INFINITY };
    let verdict = test.run(&runs, estimate).unwrap();
    println!("{verdict}");
    assert!(verdict.passes(), "{verdict}");
    assert!(pass(&scene, &*r.method, 1, 1, 0).1.lights > 0);
}
