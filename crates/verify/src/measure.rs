//! Passes as runs of block means, as many as it takes.

use crate::subject::Built;
use manylight_framework::{Film, Image, Probe, Sequential};
use manylight_scene::{FilterSampler, Scene};
use manylight_stats::{Moments, Runs};
use rayon::prelude::*;

/// How hard to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Passes end when the relative standard error of the whole image's mean is below this,
    pub target: f64,
    /// or when so much work is done in one check: rays, lights asked, and five for each light made.
    pub work: u64,
}

impl Effort {
    /// A few seconds a method.
    pub const QUICK: Effort = Effort { target: 0.004, work: 2_000_000 };
    /// Sees a quarter of the bias, or better.
    pub const THOROUGH: Effort = Effort { target: 0.001, work: 200_000_000 };
    /// Sees a bias of so large a part of the image's mean, whatever it takes.
    pub fn seeing(bias: f64) -> Effort {
        // 4.6 standard errors reject, Holm over 13 means and 64 runs allowed for; 1.3 more are seen with a power of 0.9; the truth has
        // its own.
        Effort { target: bias / 6.5, work: u64::MAX }
    }
}

/// Blocks a side.
const GRID: usize = 2;
/// Runs that passes are joined to: means of many passes are nearer to Gaussian.
const RUNS: usize = 64;
/// Passes at first, and at most where work is limited.
const FIRST: u64 = 32;
const MOST: u64 = 1 << 14;

/// A light made, and put into a tree, takes as long as so many rays.
const PER_LIGHT: u64 = 5;

/// Block means of passes `first` .. of a method, 2 x 2 blocks of three channels and the mean of all. `Err`: what went wrong, other than
/// the numbers.
pub(crate) fn measure(scene: &Scene, built: &Built, seed: u64, first: u64, effort: Effort) -> Result<Runs, String> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut work = 0;
    // How many passes there are follows from how noisy they are, not from what they say.
    loop {
        let begin = first + rows.len() as u64;
        let more = FIRST.max(rows.len() as u64);
        let new: Result<Vec<(Vec<f64>, u64)>, String> =
            (begin..begin + more).into_par_iter().map(|i| one(scene, built, seed, i)).collect();
        for (row, cost) in new? {
            rows.push(row);
            work += cost;
        }
        let spent = 2 * work > effort.work || rows.len() as u64 >= MOST;
        if seen(&rows, effort.target) || (spent && effort.work < u64::MAX) {
            return Ok(Runs::new(joined(rows)).map_err(|e| e.to_string())?.with_mean());
        }
    }
}

/// Is the mean of all known that well?
pub(crate) fn seen(rows: &[Vec<f64>], target: f64) -> bool {
    let mean: Moments = rows.iter().map(|r| r.iter().sum::<f64>() / r.len() as f64).collect();
    mean.std_error() <= target * mean.mean().abs()
}

/// Means of consecutive rows, so that there are [`RUNS`] at most.
pub(crate) fn joined(rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let each = rows.len().div_ceil(RUNS);
    let mean = |group: &[Vec<f64>]| {
        (0..group[0].len()).map(|k| group.iter().map(|r| r[k]).sum::<f64>() / group.len() as f64).collect()
    };
    // Powers of two: every group is whole.
    rows.chunks_exact(each).map(mean).collect()
}

/// What a pass took, and what was wrong with it.
pub(crate) struct Passed {
    /// In rays.
    pub cost: u64,
    pub non_finite: u64,
    pub broken_paths: u64,
}

/// A pass.
pub(crate) fn pass(scene: &Scene, built: &Built, seed: u64, pass: u64) -> Result<(Image, Passed), String> {
    let filter = FilterSampler::new(scene.filter());
    let mut film = Film::new(*scene.camera(), &filter, seed, pass, built.spp, &Sequential);
    let mut probe = Probe::default();
    built.method.pass(scene, &mut film, &mut probe).map_err(|e| format!("pass {pass}: {e}"))?;
    let cost = probe.rays() + probe.evaluations + PER_LIGHT * probe.lights;
    Ok((film.image, Passed { cost, non_finite: probe.non_finite.count, broken_paths: probe.broken_paths }))
}

/// Block means of a pass, and what it took.
fn one(scene: &Scene, built: &Built, seed: u64, i: u64) -> Result<(Vec<f64>, u64), String> {
    let (image, passed) = pass(scene, built, seed, i)?;
    match (passed.non_finite, passed.broken_paths) {
        (0, 0) => Ok((means(&image, GRID), passed.cost)),
        (0, n) => Err(format!("{n} light paths of pass {i} (seed {seed}) had a flux that was not finite")),
        (n, _) => Err(format!("{n} samples of pass {i} (seed {seed}) were NaN, infinite or negative")),
    }
}

/// Means over `grid` x `grid` blocks of an image, three channels each.
pub(crate) fn means(image: &Image, grid: usize) -> Vec<f64> {
    let (grid_x, grid_y) = (grid.min(image.width), grid.min(image.height));
    let mut sums = vec![0.0f64; grid_x * grid_y * 3];
    let mut counts = vec![0u32; grid_x * grid_y];
    for (i, p) in image.pixels.iter().enumerate() {
        let (x, y) = (i % image.width * grid_x / image.width, i / image.width * grid_y / image.height);
        let block = y * grid_x + x;
        counts[block] += 1;
        for (sum, c) in sums[block * 3..].iter_mut().zip(p.to_array()) {
            *sum += f64::from(c);
        }
    }
    sums.iter().enumerate().map(|(i, s)| s / f64::from(counts[i / 3])).collect()
}
