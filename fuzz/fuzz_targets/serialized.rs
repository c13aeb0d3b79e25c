#![no_main]

use libfuzzer_sys::fuzz_target;
use manylight_scene_io::formats::{Format, check};

fuzz_target!(|bytes: &[u8]| {
    let _ = check(Format::Serialized, bytes);
});
