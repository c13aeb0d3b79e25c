#![no_main]

use libfuzzer_sys::fuzz_target;
use manylight_scene_io::{LoadOptions, parse};
use std::path::Path;

fuzz_target!(|text: &str| {
    let _ = parse(text, Path::new("fuzz.xml"), Path::new("/nonexistent"), &LoadOptions::default());
});
