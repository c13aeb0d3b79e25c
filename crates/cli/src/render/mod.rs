//! `manylight render`.

mod frames;

use crate::args::{DEFAULT_TIME, Render};
use crate::failure::Failure;
use crate::output::say;
use crate::progress::Report;
use crate::{interrupt, units};
use manylight_framework::Image;
use manylight_recipes::Recipe;
use manylight_render::files::{self, Picture};
use manylight_render::{Budget, RenderError, Rendering, Settings, Stats, Subject};
use manylight_scene::Scene;
use manylight_scene_io::{LoadOptions, Loaded};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Renders a scene, or frames of it, and writes images, PNGs beside them and statistics.
pub fn run(args: &Render) -> Result<(), Failure> {
    let cancel = interrupt::flag()?;
    match args.frames {
        Some(frames) => frames::run(args, frames, &cancel),
        None => match image(args, &cancel)? {
            Rendered { whole: true, .. } => Ok(()),
            _ => Err(Failure::Interrupted),
        },
    }
}

/// An image that is rendered and written.
struct Rendered {
    image: Image,
    /// Exposure value of its PNG.
    ev: f32,
    /// It was not interrupted.
    whole: bool,
    /// What the scene was read from.
    files: Vec<PathBuf>,
}

/// Renders a scene, and writes the image, the PNG beside it and the statistics.
fn image(args: &Render, cancel: &Arc<AtomicBool>) -> Result<Rendered, Failure> {
    let target = Target::new(args)?;
    let start = Instant::now();
    let Loaded { mut scene, warnings, files } = load(args)?;
    scene.set_simd(args.simd);
    spares(target.paths(), &files)?;
    warn(&warnings);
    let load = start.elapsed();
    let start = Instant::now();
    let method = args.method.as_deref().unwrap_or(manylight_recipes::default_method(&scene));
    let recipe = manylight_recipes::build(method, &args.parameters, &scene)?;
    let build = start.elapsed();
    warn(&recipe.warnings);

    let settings =
        Settings { budget: budget(args), seed: args.seed, spp: recipe.spp, threads: args.threads.map(usize::from) };
    if !args.quiet {
        announce(args, &recipe, &scene, settings.budget);
    }
    let mut report = Report::new(settings.budget, args.quiet);
    let rendering = match manylight_render::render(&scene, &*recipe.method, &settings, &mut report, cancel) {
        Err(RenderError::Interrupted) => return Err(Failure::InterruptedEarly),
        result => result?,
    };
    report.finish();

    let subject = Subject {
        method: recipe.name.into(),
        parameters: recipe.parameters,
        claim: recipe.claim.to_string(),
        scene_hash: scene.hash(),
        load,
        build,
    };
    let stats = Stats::new(&subject, &settings, &rendering);
    let ev = target.write(&rendering, &stats, args)?;
    warn_of_rare_events(&stats);
    warn_of_broken_paths(&stats);
    if !args.quiet {
        summarise(&target, &rendering, &stats, ev);
    }
    Ok(Rendered { image: rendering.image, ev, whole: !rendering.interrupted, files })
}

fn budget(args: &Render) -> Budget {
    match args.passes {
        Some(passes) => Budget::Passes(passes),
        None => Budget::Time(args.time.unwrap_or(DEFAULT_TIME)),
    }
}

fn load(args: &Render) -> Result<Loaded, Failure> {
    let options = LoadOptions { defines: args.defines.clone(), size: args.size, filter: args.filter };
    crate::loading::load(&args.scene, &options, args.quiet)
}

fn warn(warnings: &[impl std::fmt::Display]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}

fn announce(args: &Render, recipe: &Recipe, scene: &Scene, budget: Budget) {
    let (width, height) = scene.camera().size;
    let budget = match budget {
        Budget::Passes(1) => "1 pass".into(),
        Budget::Passes(n) => format!("{n} passes"),
        Budget::Time(time) if args.time.is_none() => format!("{} (the default; see --time)", units::time(time)),
        Budget::Time(time) => units::time(time),
    };
    say(format!("{}: {width}x{height} pixels, method {}, {budget}", args.scene.display(), recipe.name));
}

/// The files to be written.
struct Target {
    exr: PathBuf,
    png: PathBuf,
    stats: Option<PathBuf>,
}

impl Target {
    /// Finds out whether everything can be written before anything is rendered.
    fn new(args: &Render) -> Result<Self, Failure> {
        let exr = args.output.clone().unwrap_or_else(|| default_output(&args.scene));
        let target = Target { png: exr.with_extension("png"), exr, stats: args.stats.clone() };
        target.paths().try_for_each(files::check_writable)?;
        Ok(target)
    }
    fn paths(&self) -> impl Iterator<Item = &Path> {
        [&self.exr, &self.png].into_iter().chain(&self.stats).map(PathBuf::as_path)
    }
    /// Writes them all, and returns the exposure of the PNG.
    fn write(&self, rendering: &Rendering, stats: &Stats, args: &Render) -> Result<f32, Failure> {
        let picture = Picture {
            image: rendering.image.clone(),
            standard_error: rendering.standard_error.clone(),
            maps: rendering.maps.clone(),
            attributes: stats.attributes(),
        };
        files::write_exr(&self.exr, &picture)?;
        let ev = files::write_png(&self.png, &picture.image, args.exposure)?;
        if let Some(path) = &self.stats {
            stats.write(path)?;
        }
        Ok(ev)
    }
}

/// Is none of the outputs a file that the scene was read from, and none named twice?
fn spares<'a>(outputs: impl Iterator<Item = &'a Path>, read: &[PathBuf]) -> Result<(), Failure> {
    let real = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.into());
    let outputs: Vec<PathBuf> = outputs.map(real).collect();
    for (i, output) in outputs.iter().enumerate() {
        if read.iter().any(|r| real(r) == *output) {
            let what = format!("{} belongs to the scene and would be overwritten: choose another -o", output.display());
            return Err(Failure::Mistake(what));
        }
        if outputs[..i].contains(output) {
            return Err(Failure::Mistake(format!(
                "{} is named for two outputs: choose another name",
                output.display()
            )));
        }
    }
    Ok(())
}

/// In the current directory, with the name of the scene file; where that is `scene.xml`, with the name of its directory.
fn default_output(scene: &Path) -> PathBuf {
    let whole = scene.canonicalize().unwrap_or_else(|_| scene.into());
    let directory = whole.parent().and_then(Path::file_name);
    let name = match (whole.file_stem(), directory) {
        (Some(stem), Some(directory)) if stem == "scene" => directory,
        (Some(stem), _) => stem,
        (None, _) => "image".as_ref(),
    };
    let mut name = name.to_os_string();
    name.push(".exr");
    name.into()
}

fn warn_of_rare_events(stats: &Stats) {
    let lost = &stats.non_finite;
    if lost.count > 0 {
        let places: Vec<String> = lost.first.iter().map(ToString::to_string).collect();
        let first = places.join("; ");
        eprintln!("warning: {} samples were NaN, infinite or negative and count as black (first: {first})", lost.count);
    }
}

fn warn_of_broken_paths(stats: &Stats) {
    if stats.broken_paths > 0 {
        let n = stats.broken_paths;
        eprintln!(
            "warning: {n} light paths carried a NaN or infinite flux and their light is missing: is an emitter too bright?"
        );
    }
}

fn summarise(target: &Target, rendering: &Rendering, stats: &Stats, ev: f32) {
    let files: Vec<String> = target.paths().map(|path| path.display().to_string()).collect();
    say(format!("wrote {} (exposure of the PNG: {ev:+.1} EV)", files.join(", ")));
    let passes = match stats.passes {
        0 => "part of the first pass".into(),
        1 => "1 pass".into(),
        n => format!("{n} passes"),
    };
    let time = |seconds| units::time(Duration::from_secs_f64(seconds));
    let spent = units::time(rendering.elapsed);
    say(format!("{passes} in {spent} ({} for light paths and trees)", time(stats.seconds.generate)));
    let [camera, path, shadow, lights] =
        [stats.rays.camera, stats.rays.path, stats.rays.shadow, stats.lights].map(|n| units::count(n as f64));
    say(format!("rays: {camera} camera, {path} path, {shadow} shadow; virtual lights: {lights}"));
    match stats.estimated_error {
        Some(error) => say(format!("estimated relMSE by noise: {error:.2e}")),
        None => say("estimated relMSE by noise: unknown, it takes two passes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_named_after_the_scene() {
        assert_eq!(default_output(Path::new("scenes/cornell-box/scene.xml")), Path::new("cornell-box.exr"));
        assert_eq!(default_output(Path::new("dir/ajar.xml")), Path::new("ajar.exr"));
        assert_eq!(default_output(Path::new("/scene.xml")), Path::new("scene.exr"));
    }
}
