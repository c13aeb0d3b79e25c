//! A lamp over a sheet with holes, rough glass, a bumpy floor and blended walls (`scenes/veil.xml`), and principled materials under
//! spot lights (`scenes/gallery.xml`): light paths and eye paths see the same surfaces as each other, and as Mitsuba 3.

use manylight_integration::{block_runs, effort, load_scene, mitsuba_blocks, recipe, scenes_folder};
use manylight_scene::Scene;
use manylight_stats::{BlockTest, Reference};

const GRID: usize = 4;

fn scene(name: &str) -> Scene {
    load_scene(&scenes_folder().join(format!("{name}.xml")), (32, 32))
}
fn agrees(name: &str, method: &str, params: &[&str], spp: u32, passes: u64) {
    let scene = scene(name);
    let r = recipe(method, params, &scene);
    let runs = block_runs(&scene, &*r.method, spp, 77, effort(passes), GRID);
    let (mean, std_error) = mitsuba_blocks(name);
    // Of 48 runs.
    let reference = Reference::Estimate { mean: &mean, std_error: &std_error, degrees: 47.0 };
    let verdict = BlockTest::default().run(&runs, reference).unwrap();
    println!("{name}, {method} {params:?}: {verdict}");
    assert!(verdict.passes(), "{name}, {method} {params:?}: {verdict}");
}

#[test]
fn paths_from_either_end_agree_with_mitsuba() {
    // Virtual lights at the rough glass have too heavy a tail for a verdict.
    for (method, spp) in [("path", 32), ("path-lights", 32), ("bidirectional", 16)] {
        agrees("veil", method, &[], spp, 32);
    }
}

#[test]
fn principled_materials_under_spot_lights_through_a_lens_are_those_of_mitsuba() {
    for (method, params, spp) in [
        ("path", &[][..], 32),
        ("path-lights", &["lights=stochastic-lightcuts"], 32),
        ("bidirectional", &[], 16),
        ("light-tracing", &[], 64),
    ] {
        agrees("gallery", method, params, spp, 32);
    }
}
