//! Methods against each other, and against Mitsuba's images, over passes on our scenes.
//!
//! Bounded lights are compared with the bounded path tracer: without a bound their variance is infinite where surfaces touch,
//! and no test could conclude. Family-wise significance 0.01 by Holm; each line that is printed says what it would have seen.
//!
//! `MANYLIGHT_EFFORT=16 cargo test --release -p manylight-integration --test agreement -- --nocapture` takes sixteen times as many
//! passes and sees a quarter of the bias.

use manylight_compensation::Bound;
use manylight_integration::bounded_path::BoundedPath;
use manylight_integration::{block_runs, effort, our_scene, recipe, reference_blocks, repository};
use manylight_scene::Scene;
use manylight_stats::{Alternative, BlockTest, Reference, Runs};

fn lights(scene: &Scene, params: &[&str], passes: u64, grid: usize) -> Runs {
    let r = recipe("instant-radiosity", params, scene);
    block_runs(scene, &*r.method, r.spp, 11, passes, grid)
}
fn agree(what: &str, a: &Runs, b: &Runs) {
    let verdict = BlockTest::default().run(&a.clone().with_mean(), Reference::Runs(&b.clone().with_mean())).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}

/// Scene, size, bound [1/m^2], light paths, passes, blocks a side (fewer where light is rare: a block that hardly ever sees any
/// has a heavy tail, and no verdict).
type Case = (&'static str, (u32, u32), f32, u64, u64, usize);
const SCENES: &[Case] = &[
    ("cornell-box", (16, 16), 4.0, 512, 100, 2),
    ("corner", (16, 16), 4.0, 256, 100, 2),
    ("ajar", (16, 10), 1.0, 1024, 120, 1),
    ("furnace", (8, 8), 0.1, 64, 64, 2),
];

#[test]
fn bounded_lights_are_the_bounded_path_tracer() {
    for &(name, size, bound, paths, passes, grid) in SCENES {
        let scene = our_scene(name, size);
        let max_edges = scene.max_depth().unwrap_or(u32::MAX);
        let path = BoundedPath { bounding: Bound::Geometry(bound), max_edges };
        let truth = block_runs(&scene, &path, 128, 12, effort(64), grid);
        let with = |more: &[&str]| {
            let base = [format!("bound={bound}"), format!("paths={paths}"), "min-depth=3".into()];
            let all: Vec<&str> = base.iter().map(String::as_str).chain(more.iter().copied()).collect();
            lights(&scene, &all, effort(passes), grid)
        };
        agree(&format!("{name}, all lights"), &with(&["lights=all"]), &truth);
        agree(&format!("{name}, lights by power"), &with(&["lights=power", "samples=64"]), &truth);
    }
}

#[test]
fn the_bound_only_darkens_and_the_darkening_is_seen() {
    let scene = our_scene("cornell-box", (16, 16));
    let path = recipe("path", &["spp=64"], &scene);
    let truth = block_runs(&scene, &*path.method, path.spp, 5, effort(48), 2);
    let bounded = lights(&scene, &["bound=1", "paths=64"], effort(64), 2);
    let one_sided = BlockTest { alternative: Alternative::Greater, ..BlockTest::default() };
    let verdict = one_sided.run(&bounded, Reference::Runs(&truth)).unwrap();
    assert!(verdict.passes(), "brighter than the truth: {verdict}");
    let verdict = BlockTest::default().run(&bounded, Reference::Runs(&truth)).unwrap();
    assert!(verdict.rejected(), "a bound of 1 takes light from every corner: {verdict}");
}

#[test]
fn roulette_and_fresh_lights_for_the_emitters_do_not_change_the_mean() {
    let scene = our_scene("corner", (16, 16));
    let base = lights(&scene, &["bound=2", "paths=64"], effort(100), 2);
    let late = lights(&scene, &["bound=2", "paths=64", "rr-depth=6"], effort(100), 2);
    agree("roulette from the first or the sixth edge", &base, &late);
    // The lamp hangs far enough from the floor and the wall that the bound never touches direct light.
    let virtual_direct = lights(&scene, &["bound=2", "paths=512", "direct=virtual"], effort(100), 2);
    agree("direct light sampled or by lights on the emitter", &base, &virtual_direct);
}

#[test]
fn path_tracing_agrees_with_mitsuba_on_our_scenes() {
    for (name, size, passes) in
        [("cornell-box", (48, 48), 48), ("corner", (48, 48), 48), ("ajar", (64, 36), 48), ("kitchen", (64, 36), 48)]
    {
        let scene = our_scene(name, size);
        let (mean, std_error) = reference_blocks(&repository().join("scenes").join(name).join("reference.exr"), 4);
        let path = recipe("path", &["spp=16"], &scene);
        let runs = block_runs(&scene, &*path.method, path.spp, 21, effort(passes), 4);
        let reference = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: f64::INFINITY };
        let verdict = BlockTest::default().run(&runs, reference).unwrap();
        println!("{name}: {verdict}");
        assert!(verdict.passes(), "{name}: {verdict}");
        // Two per cent would be seen.
        let brighter = Runs::new(runs.rows().iter().map(|r| r.iter().map(|x| x * 1.02).collect()).collect()).unwrap();
        let verdict = BlockTest::default().run(&brighter, reference).unwrap();
        if name == "corner" {
            assert!(verdict.rejected(), "{name}, 2 % too bright: {verdict}");
        }
    }
}
