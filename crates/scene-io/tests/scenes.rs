//! Real scenes load. They lie beside the repository, and the tests pass with a word where they are not.

use manylight_scene_io::{LoadOptions, load};
use std::path::PathBuf;

fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes").join(name).join("scene.xml");
    if !path.exists() {
        println!("skipped: {name} is not here");
    }
    path.exists().then_some(path)
}

#[test]
fn the_cornell_box_loads() {
    let Some(path) = shared("cornell-box") else { return };
    let loaded = load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.scene.camera().size, (1024, 1024));
    assert_eq!(loaded.scene.max_depth(), Some(65));
    assert_eq!(loaded.warnings, [""; 0]);
    assert_eq!(loaded.files, [path]);
}

#[test]
fn veach_ajar_loads_at_the_size_that_is_asked_for() {
    let Some(path) = shared("veach-ajar") else { return };
    let defines = vec![("resx".to_owned(), "320".to_owned()), ("resy".to_owned(), "180".to_owned())];
    let loaded = load(&path, &LoadOptions { defines, ..LoadOptions::default() }).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.scene.camera().size, (320, 180));
    assert_eq!(loaded.scene.max_depth(), Some(13));
    // The scene file, 15 OBJ, 2 PLY (each used three times), 3 textures.
    assert_eq!(loaded.files.len(), 21);
    println!("{:#?}", loaded.warnings);
}

#[test]
fn what_the_other_scenes_still_need_is_said_with_its_place() {
    for (name, expected) in [
        ("modern-hall", None),
        ("classroom", None),
        ("wooden-staircase", Some("the bsdf `bumpmap` is not supported yet")),
        ("volumetric-caustic", Some("media are not supported yet")),
        ("combustion-plume", Some("not supported yet")),
    ] {
        let Some(path) = shared(name) else { continue };
        let start = std::time::Instant::now();
        let result = load(&path, &LoadOptions::default());
        println!("{name}: {:.2} s", start.elapsed().as_secs_f64());
        match (result, expected) {
            (Ok(loaded), None) => println!("{:#?}", loaded.warnings),
            (Err(e), Some(expected)) => {
                assert!(e.0.iter().all(|d| d.line > 0), "{e}");
                assert!(e.to_string().contains(expected), "{e}");
            }
            (Err(e), None) => panic!("{name}: {e}"),
            (Ok(_), Some(expected)) => panic!("{name} loads, although `{expected}`"),
        }
    }
}
