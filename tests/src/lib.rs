//! What the integration tests share: small scenes of known radiance, runs of a method as blocks, and a bounded path tracer.
//!
//! All pixels of a pass share its lights, so the pass is the unit of every statistic: a test compares block means over passes
//! (`block_runs`), never pixels. Seeds are fixed; each test states its significance through `manylight_stats::BlockTest`.

pub mod bounded_path;
pub mod fogs;
pub mod rooms;

use manylight_framework::{Film, Image, Method, Probe, Sequential};
use manylight_recipes::{Recipe, build};
use manylight_render::files::read_exr;
use manylight_scene::{Filter, FilterSampler, Scene};
use manylight_scene_io::{LoadOptions, load};
use manylight_stats::Runs;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// One pass of a method. Panics if it fails: tests render scenes that they know.
pub fn pass(scene: &Scene, method: &dyn Method, spp: u32, seed: u64, pass: u64) -> (Image, Probe) {
    let filter = FilterSampler::new(scene.filter());
    let mut film = Film::new(*scene.camera(), &filter, seed, pass, spp, &Sequential);
    let mut probe = Probe::default();
    method.pass(scene, &mut film, &mut probe).unwrap_or_else(|e| panic!("pass {pass}: {e}"));
    assert_eq!(probe.non_finite.count, 0, "samples that are not finite, first {:?}", probe.non_finite.first);
    assert_eq!(probe.broken_paths, 0, "light paths whose flux is not finite");
    (film.image, probe)
}

/// Means over `grid` x `grid` blocks of the image and three channels, for each of `passes` passes: runs x blocks.
pub fn block_runs(scene: &Scene, method: &dyn Method, spp: u32, seed: u64, passes: u64, grid: usize) -> Runs {
    let rows: Vec<Vec<f64>> =
        (0..passes).into_par_iter().map(|i| blocks(&pass(scene, method, spp, seed, i).0, grid)).collect();
    Runs::new(rows).unwrap_or_else(|e| panic!("{e}"))
}

/// Means over `grid` x `grid` blocks of an image, three channels each.
pub fn blocks(image: &Image, grid: usize) -> Vec<f64> {
    let mut sums = vec![0.0f64; grid * grid * 3];
    let mut counts = vec![0u32; grid * grid];
    for (i, p) in image.pixels.iter().enumerate() {
        let (x, y) = (i % image.width * grid / image.width, i / image.width * grid / image.height);
        let block = y * grid + x;
        counts[block] += 1;
        for (sum, c) in sums[block * 3..].iter_mut().zip(p.to_array()) {
            *sum += c as f64;
        }
    }
    sums.iter().enumerate().map(|(i, s)| s / counts[i / 3] as f64).collect()
}

/// The folder of small scenes that Mitsuba has rendered.
pub fn scenes_folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes")
}
/// Block means (4 x 4) and their standard errors over 48 runs by Mitsuba, of a scene in `scenes_folder`: see its `make.py`.
pub fn mitsuba_blocks(scene: &str) -> (Vec<f64>, Vec<f64>) {
    let path = scenes_folder().join(format!("{scene}.txt"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let row = |l: &str| l.split(' ').map(|x| x.parse().unwrap_or_else(|_| panic!("{l}"))).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = text.lines().filter(|l| !l.starts_with('#')).map(row).collect();
    let part = |from: usize| rows.iter().flat_map(|r| r[from..from + 3].to_vec()).collect();
    (part(0), part(3))
}

/// A method by name, with parameters as `name=value`. Panics if there is no such thing.
pub fn recipe(name: &str, params: &[&str], scene: &Scene) -> Recipe {
    let pairs: Vec<(String, String)> = params
        .iter()
        .map(|p| p.split_once('=').unwrap_or_else(|| panic!("`{p}` is no name=value")))
        .map(|(n, v)| (n.to_string(), v.to_string()))
        .collect();
    build(name, &pairs, scene).unwrap_or_else(|e| panic!("{e}"))
}

/// A scene of the folder `scenes/` at a size, with a box filter. Panics with the loader's words if it cannot be read.
pub fn our_scene(name: &str, size: (u32, u32)) -> Scene {
    load_scene(&repository().join("scenes").join(name).join("scene.xml"), size)
}

/// A scene file at a size, with a box filter.
pub fn load_scene(path: &Path, size: (u32, u32)) -> Scene {
    let options = LoadOptions { size: Some(size), filter: Some(Filter::Box), ..LoadOptions::default() };
    load(path, &options).unwrap_or_else(|e| panic!("{e}")).scene
}

/// The top of the repository.
pub fn repository() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A folder beside the repository with scenes and images from elsewhere; `None`, and a word, where it is missing: a clone alone
/// must pass.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let path = repository().join("../shared").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: there is no folder ../shared/{folder} beside the repository");
    None
}

/// A reference image as block means with their standard errors, from `NAME.exr` and `NAME.stderr.exr` (whose pixels are
/// independent: they are path traced).
pub fn reference_blocks(path: &Path, grid: usize) -> (Vec<f64>, Vec<f64>) {
    let read = |p: &Path| read_exr(p).unwrap_or_else(|e| panic!("{e}")).image;
    let mean = read(path);
    let mut variance = read(&path.with_extension("stderr.exr"));
    variance.pixels.iter_mut().for_each(|p| *p *= *p);
    let pixels = (mean.pixels.len() / (grid * grid)) as f64;
    let errors = blocks(&variance, grid).iter().map(|v| (v / pixels).sqrt()).collect();
    (blocks(&mean, grid), errors)
}

/// Passes of a test: `n`, times the number in the environment variable `MANYLIGHT_EFFORT` (1 if it is not set). Four times the
/// passes see half the bias.
pub fn effort(n: u64) -> u64 {
    match std::env::var("MANYLIGHT_EFFORT") {
        Ok(text) => {
            n * text.parse::<u64>().unwrap_or_else(|_| panic!("MANYLIGHT_EFFORT={text}: expected a whole number"))
        }
        Err(_) => n,
    }
}
