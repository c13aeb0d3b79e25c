//! What generators of virtual lights are worth: 1 / (variance over passes x time), on one scene at one bound.
//!
//! ```text
//! cargo run --release -p manylight-benches --bin generators -- SCENE.xml WxH SECONDS "METHOD key=value .." "METHOD .." ..
//! ```
//!
//! Each method renders each of five seeds for SECONDS and 24 passes at least, turn by turn. Of the 16 blocks of the image, the variance over passes of
//! the mean luminance, times the processor's seconds a pass, is what one second of that method leaves of noise; printed are the ratios to the
//! first method: the median over the seeds (smallest and largest) of the ratio of the blocks' mean efficiencies 1 / (variance x
//! time), and of the blocks' mean variances. Methods whose expectations differ (give all the same `bound`) compare nothing.

use manylight_framework::{Film, Probe};
use manylight_recipes::{Recipe, build};
use manylight_scene::{FilterSampler, Scene};
use manylight_scene_io::{LoadOptions, load};
use rayon::prelude::*;
use std::time::Instant;

const GRID: usize = 4;
const SEEDS: u64 = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [scene, size, seconds, methods @ ..] = &args[..] else {
        return Err("usage: generators SCENE.xml WxH SECONDS \"METHOD key=value ..\" ..".into());
    };
    let (w, h) = size.split_once('x').ok_or("expected WxH")?;
    let options = LoadOptions { size: Some((w.parse()?, h.parse()?)), ..LoadOptions::default() };
    let scene = load(scene.as_ref(), &options)?.scene;
    let seconds: f64 = seconds.parse()?;
    let recipes = methods.iter().map(|m| recipe(m, &scene)).collect::<Result<Vec<_>, _>>()?;
    let mut worth = vec![Vec::new(); recipes.len()];
    for seed in 0..SEEDS {
        for (r, worth) in recipes.iter().zip(&mut worth) {
            worth.push(measure(&scene, r, seed + 1, seconds)?);
        }
    }
    for (name, own) in methods.iter().zip(&worth) {
        let against = |f: fn(&Worth) -> f64| {
            let mut ratios: Vec<f64> = own.iter().zip(&worth[0]).map(|(a, b)| f(a) / f(b)).collect();
            ratios.sort_by(f64::total_cmp);
            format!("{:6.2} ({:.2} to {:.2})", ratios[ratios.len() / 2], ratios[0], ratios[ratios.len() - 1])
        };
        let mean = |f: fn(&Worth) -> f64| own.iter().map(f).sum::<f64>() / own.len() as f64;
        println!(
            "{name}\n  mean efficiency of the blocks x {}   of their mean variance x {}\n  mean {:.5}, {:.3} s a pass, {:.0} lights, {:.0} passes a seed",
            against(|w| w.efficiency),
            against(|w| 1.0 / w.variance),
            mean(|w| w.mean),
            mean(|w| w.seconds),
            mean(|w| w.lights),
            mean(|w| w.passes),
        );
    }
    Ok(())
}

fn recipe(text: &str, scene: &Scene) -> Result<Recipe, Box<dyn std::error::Error>> {
    let mut words = text.split_whitespace();
    let name = words.next().ok_or("a method has no name")?;
    let pair = |w: &str| w.split_once('=').map(|(k, v)| (k.to_string(), v.to_string())).ok_or("expected key=value");
    Ok(build(name, &words.map(pair).collect::<Result<Vec<_>, _>>()?, scene)?)
}

/// One method under one seed.
#[derive(Clone)]
struct Worth {
    /// Mean over the blocks of 1 / (variance x seconds a pass).
    efficiency: f64,
    /// Mean over the blocks of variance x seconds a pass.
    variance: f64,
    mean: f64,
    seconds: f64,
    lights: f64,
    passes: f64,
}

fn measure(scene: &Scene, r: &Recipe, seed: u64, seconds: f64) -> Result<Worth, Box<dyn std::error::Error>> {
    let filter = FilterSampler::new(scene.filter());
    let (start, busy) = (Instant::now(), processor_seconds());
    let (mut passes, mut probe) = (Vec::new(), Probe::default());
    // A variance of fewer passes says nothing.
    while passes.len() < 24 || start.elapsed().as_secs_f64() < seconds {
        let mut film = Film::new(*scene.camera(), &filter, seed, passes.len() as u64, r.spp, &Threads);
        r.method.pass(scene, &mut film, &mut probe)?;
        passes.push(blocks(&film.image));
    }
    let n = passes.len() as f64;
    let spent = processor_seconds().zip(busy).map_or(start.elapsed().as_secs_f64(), |(now, then)| now - then);
    let each = spent / n;
    let (mut efficiency, mut variance, mut mean) = (0.0, 0.0, 0.0);
    for b in 0..GRID * GRID {
        let m = passes.iter().map(|p| p[b]).sum::<f64>() / n;
        let v = passes.iter().map(|p| (p[b] - m).powi(2)).sum::<f64>() / (n - 1.0);
        let share = 1.0 / (GRID * GRID) as f64;
        efficiency += share / (v * each);
        variance += share * v * each;
        mean += share * m;
    }
    Ok(Worth { efficiency, variance, mean, seconds: each, lights: probe.lights as f64 / n, passes: n })
}

/// Time that processors worked for this program, where the system tells (Linux): other programs do not disturb it.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    // Fields 14 and 15 of proc(5), in ticks of 10 ms.
    Some((fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?) / 100.0)
}

/// All cores, by rayon.
struct Threads;
impl manylight_framework::Scheduler for Threads {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        (0..count).into_par_iter().for_each(task);
    }
}

/// Mean luminance of each block.
fn blocks(image: &manylight_framework::Image) -> Vec<f64> {
    let (mut sums, mut counts) = (vec![0.0; GRID * GRID], vec![0.0; GRID * GRID]);
    for (i, p) in image.pixels.iter().enumerate() {
        let block = i / image.width * GRID / image.height * GRID + i % image.width * GRID / image.width;
        sums[block] += p.luminance() as f64;
        counts[block] += 1.0;
    }
    sums.iter().zip(&counts).map(|(s, c)| s / c).collect()
}
