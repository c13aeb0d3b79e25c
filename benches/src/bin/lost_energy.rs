//! What a bound takes from an image, and what each compensation gives back: pictures, and shares of energy and time.
//!
//! ```text
//! cargo run --release -p manylight-benches --bin lost_energy -- SCENE.xml WxH PASSES DIRECTORY [key=value ..]
//! ```
//!
//! Writes reference.png (path tracing for as long as all the rest took), unbounded.png, bounded.png, lost.png (their difference),
//! and for each compensation residual-NAME.png and sum-NAME.png; differences are four times as bright as the rest. All methods are
//! given the same light paths, so that differences have little noise. The parameters are those of `many-lights`.

use manylight_framework::{Film, Image, Probe, Scheduler};
use manylight_math::Spectrum;
use manylight_recipes::{Recipe, build};
use manylight_render::files::{Exposure, write_png};
use manylight_scene::{FilterSampler, Scene};
use manylight_scene_io::{LoadOptions, load};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const COMPENSATIONS: &[&str] = &["kollig-keller", "local", "screen-space"];
/// Differences are brighter by so many stops.
const STOPS: f32 = 2.0;

fn main() -> Outcome<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [scene, size, passes, directory, more @ ..] = &args[..] else {
        return Err("usage: lost_energy SCENE.xml WxH PASSES DIRECTORY [key=value ..]".into());
    };
    let (w, h) = size.split_once('x').ok_or("expected WxH")?;
    let options = LoadOptions { size: Some((w.parse()?, h.parse()?)), ..LoadOptions::default() };
    let scene = load(scene.as_ref(), &options)?.scene;
    let passes: u64 = passes.parse()?;
    let directory = Path::new(directory);
    std::fs::create_dir_all(directory)?;
    let many_lights = |own: &[(&str, &str)]| -> Outcome<Recipe> {
        let given = more.iter().map(|w| w.split_once('=').ok_or("expected key=value"));
        let mut pairs: Vec<(String, String)> = own.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        for pair in given {
            let (k, v) = pair?;
            if !own.iter().any(|o| o.0 == k) {
                pairs.push((k.into(), v.into()));
            }
        }
        Ok(build("many-lights", &pairs, &scene)?)
    };
    let begin = Instant::now();
    let none = ("compensation", "none");
    let bounded = run(&scene, &many_lights(&[none])?, |n, _| n < passes)?;
    let unbounded = run(&scene, &many_lights(&[none, ("bound", "none")])?, |n, _| n < passes)?;
    let mut rows = Vec::new();
    for name in COMPENSATIONS {
        rows.push((name, run(&scene, &many_lights(&[("compensation", name)])?, |n, _| n < passes)?));
    }
    let long = begin.elapsed().as_secs_f64();
    let depths = more.iter().filter(|w| w.contains("-depth=")).filter_map(|w| w.split_once('='));
    let depths: Vec<_> = depths.map(|(k, v)| (k.to_string(), v.to_string())).collect();
    let reference = run(&scene, &build("path", &depths, &scene)?, |_, s| s < long)?;

    let ev = write_png(&directory.join("reference.png"), &reference.image, Exposure::Auto)?;
    let write = |name: String, image: &Image, ev: f32| write_png(&directory.join(name), image, Exposure::Ev(ev));
    write("unbounded.png".into(), &unbounded.image, ev)?;
    write("bounded.png".into(), &bounded.image, ev)?;
    write("lost.png".into(), &difference(&unbounded.image, &bounded.image), ev + STOPS)?;
    println!(
        "{passes} passes; mean luminance: path {:.6}, unbounded {:.6}, bounded {:.6}: {:.2} % of the path tracer's light is lost",
        reference.mean(),
        unbounded.mean(),
        bounded.mean(),
        100.0 * (1.0 - bounded.mean() / reference.mean())
    );
    println!("bounded: {:.2} s", bounded.seconds);
    for (name, r) in &rows {
        write(format!("residual-{name}.png"), &difference(&r.image, &bounded.image), ev + STOPS)?;
        write(format!("sum-{name}.png"), &r.image, ev)?;
        println!(
            "{name}: {:.2} s, of which {:.1} % for compensation, which brings {:.2} % of the image's light ({:.1} % of what was lost)",
            r.seconds,
            100.0 * (1.0 - bounded.seconds / r.seconds),
            100.0 * (1.0 - bounded.mean() / r.mean()),
            100.0 * (r.mean() - bounded.mean()) / (reference.mean() - bounded.mean()),
        );
    }
    Ok(())
}

struct Run {
    image: Image,
    seconds: f64,
}

impl Run {
    fn mean(&self) -> f64 {
        self.image.pixels.iter().map(|p| p.luminance() as f64).sum::<f64>() / self.image.pixels.len() as f64
    }
}

/// The mean of passes 0, 1, .. while `go_on(passes, seconds)`.
fn run(scene: &Scene, r: &Recipe, go_on: impl Fn(u64, f64) -> bool) -> Outcome<Run> {
    let filter = FilterSampler::new(scene.filter());
    let (start, mut n, mut probe) = (Instant::now(), 0u64, Probe::default());
    let mut sums: Vec<[f64; 3]> = Vec::new();
    while n == 0 || go_on(n, start.elapsed().as_secs_f64()) {
        let mut film = Film::new(*scene.camera(), &filter, 0, n, r.spp, &Threads);
        r.method.pass(scene, &mut film, &mut probe)?;
        sums.resize(film.image.pixels.len(), [0.0; 3]);
        for (sum, p) in sums.iter_mut().zip(&film.image.pixels) {
            sum.iter_mut().zip(p.to_array()).for_each(|(s, c)| *s += c as f64);
        }
        n += 1;
    }
    let seconds = start.elapsed().as_secs_f64();
    let pixels = sums.iter().map(|s| Spectrum::from(s.map(|c| (c / n as f64) as f32))).collect();
    let (width, height) = scene.camera().size;
    Ok(Run { image: Image { width: width as usize, height: height as usize, pixels }, seconds })
}

/// What `a` has more than `b`.
fn difference(a: &Image, b: &Image) -> Image {
    let more = |(a, b): (&Spectrum, &Spectrum)| {
        Spectrum::from([0, 1, 2].map(|c| (a.to_array()[c] - b.to_array()[c]).max(0.0)))
    };
    Image { pixels: a.pixels.iter().zip(&b.pixels).map(more).collect(), ..*a }
}

/// All cores, by rayon.
struct Threads;
impl Scheduler for Threads {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        (0..count).into_par_iter().for_each(task);
    }
}
