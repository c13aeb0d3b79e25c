//! `manylight compare`: methods x budgets x runs on one scene.

pub mod spec;
mod truth;
mod turns;

use crate::args::Compare;
use crate::failure::Failure;
use crate::output::{say, table};
use crate::{interrupt, units};
use manylight_framework::Image;
use manylight_recipes::Recipe;
use manylight_render::files::{self, read_exr};
use manylight_report::{Axis, Comparison, Cost, Flip, ImageView, Picture, Row, Study, Subject, separate};
use manylight_scene_io::{LoadOptions, Loaded};
use spec::{Foreign, Spec};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use truth::{Truth, view};
use turns::Snapshot;

/// A method that takes part.
pub struct Entry {
    label: String,
    recipe: Recipe,
}

/// Pictures of the first run, for the page.
struct Shown {
    /// Those with the largest budgets first: keys reach the first nine.
    budget: f64,
    name: String,
    caption: String,
    image: Image,
}

/// Renders, measures, and writes the directory.
pub fn run(args: &Compare) -> Result<(), Failure> {
    let specs: Vec<&Spec> = args.methods.iter().flat_map(|m| &m.0).collect();
    distinct(specs.iter().map(|s| s.label.as_str()).chain(args.images.iter().map(|i| i.name.as_str())))?;
    let budgets = budgets(args);
    let truth = Truth::find(args)?;
    truth.differs_from(args)?;
    let baseline = baseline(args, &specs)?;
    let cancel = interrupt::flag()?;
    let options =
        LoadOptions { defines: args.defines.clone(), size: Some(truth.size(args.size)?), filter: args.filter };
    let Loaded { scene, warnings, files } = crate::loading::load(&args.scene, &options, args.quiet)?;
    warnings.iter().for_each(|w| eprintln!("warning: {w}"));
    let entry = |s: &&Spec| -> Result<Entry, Failure> {
        let recipe = manylight_recipes::build(&s.method, &s.parameters, &scene)
            .map_err(|e| Failure::Mistake(format!("{}: {e}", s.label)))?;
        recipe.warnings.iter().for_each(|w| eprintln!("warning: {}: {w}", s.label));
        Ok(Entry { label: s.label.clone(), recipe })
    };
    let entries = specs.iter().map(entry).collect::<Result<Vec<_>, _>>()?;
    let exposure = args.exposure.ev(&truth.image);
    let largest = budgets.last().map_or(0.0, |b| b.value());
    let mut judge = Judge { truth: &truth, exposure, largest, noise: None, rows: Vec::new(), shown: Vec::new() };
    for image in &args.images {
        judge.foreign(image)?;
    }
    // Whatever is wrong has been found: from here on there is something to write.
    let directory = Directory::new(&args.output, &files)?;
    let whole = rendered(args, &scene, &entries, &budgets, &cancel, &directory, &mut judge)?;
    if !judge.rows.iter().any(|r| r.passes.is_some()) {
        return Err(Failure::InterruptedEarly);
    }
    let study = Study {
        scene: args.scene.display().to_string(),
        scene_hash: format!("{:016x}", scene.hash()),
        reference: truth.path.display().to_string(),
        reference_noise: judge.noise.map(|n| n.0),
        reference_spread: judge.noise.map(|n| n.1),
        exposure,
        threads: threads(args),
        baseline,
        subjects: subjects(&entries, &args.images),
        budgets,
        rows: judge.rows,
    };
    judge.shown.sort_by(|a, b| b.budget.total_cmp(&a.budget));
    directory.write(&study, &truth, &judge.shown)?;
    if !args.quiet {
        summarise(&study, &directory);
    }
    if whole { Ok(()) } else { Err(Failure::Interrupted) }
}

/// All runs of all methods; `false`: interrupted.
fn rendered(
    args: &Compare,
    scene: &manylight_scene::Scene,
    entries: &[Entry],
    budgets: &[Cost],
    cancel: &std::sync::Arc<std::sync::atomic::AtomicBool>,
    directory: &Directory,
    judge: &mut Judge,
) -> Result<bool, Failure> {
    let start = Instant::now();
    for run in 0..args.runs {
        let seed = args.seed.wrapping_add(run.into());
        let mut seen = |s: Snapshot| {
            let file = (run == 0).then(|| image_name(s.entry, &entries[s.entry].label, s.budget));
            if let Some(file) = &file {
                directory.image(file, &s.rendering)?;
            }
            judge.snapshot(&s, &entries[s.entry].label, run, seed, file)
        };
        let threads = args.threads.map(usize::from);
        if !turns::run(scene, entries, budgets, (seed, threads), cancel, &mut seen)? {
            return Ok(false);
        }
        if !args.quiet {
            eprintln!("run {} of {}: {}", run + 1, args.runs, units::time(start.elapsed()));
        }
    }
    Ok(true)
}

/// Measures images against the reference.
struct Judge<'t> {
    truth: &'t Truth,
    exposure: f32,
    /// Budget.
    largest: f64,
    /// The reference's own, and its spread; `None` if it is not known.
    noise: Option<(f64, f64)>,
    rows: Vec<Row>,
    shown: Vec<Shown>,
}

impl Judge<'_> {
    fn snapshot(
        &mut self,
        s: &Snapshot,
        label: &str,
        run: u32,
        seed: u64,
        file: Option<String>,
    ) -> Result<(), Failure> {
        let (r, probe) = (&s.rendering, &s.rendering.probe);
        let mut row = self.measured(label, s.budget, &r.image, s.halves.as_ref())?;
        (row.run, row.seed, row.passes) = (run, Some(seed), Some(r.passes));
        (row.seconds, row.seconds_preparing) = (r.elapsed.as_secs_f64(), Some(r.preparing.as_secs_f64()));
        (row.camera_rays, row.path_rays, row.shadow_rays) =
            (Some(probe.camera_rays), Some(probe.path_rays), Some(probe.shadow_rays));
        (row.lights, row.non_finite) = (Some(probe.lights), probe.non_finite.count);
        row.file = file;
        if run == 0 {
            let name = format!("{label}, {}", s.budget);
            let rays = units::count(probe.rays() as f64);
            let spent = units::time(Duration::from_secs_f64(row.seconds));
            let caption = format!("{name}: relMSE {:.3e}, {} passes in {spent}, {rays} rays", row.relmse, r.passes);
            self.shown.push(Shown { budget: s.budget.value(), name, caption, image: r.image.clone() });
        }
        self.rows.push(row);
        Ok(())
    }
    fn foreign(&mut self, from: &Foreign) -> Result<(), Failure> {
        let image = read_exr(&from.path)?.image;
        let about =
            |e: Failure| Failure::Mistake(format!("{} and {}: {e}", from.path.display(), self.truth.path.display()));
        let mut row = self.measured(&from.name, Cost::Seconds(from.seconds), &image, None).map_err(about)?;
        row.seconds = from.seconds;
        row.non_finite = image.pixels.iter().filter(|p| !p.is_finite()).count() as u64;
        row.file = Some(from.path.display().to_string());
        let caption = format!("{}: relMSE {:.3e} in {} s", from.name, row.relmse, from.seconds);
        // After those with the largest budget.
        let budget = self.largest;
        self.shown.push(Shown { budget, name: from.name.clone(), caption, image });
        self.rows.push(row);
        Ok(())
    }
    fn measured(
        &mut self,
        label: &str,
        budget: Cost,
        image: &Image,
        halves: Option<&[Image; 2]>,
    ) -> Result<Row, Failure> {
        let (image, reference) = (view(image)?, view(&self.truth.image)?);
        let std_error = self.truth.std_error.as_ref().map(view).transpose()?;
        let halves: Option<[ImageView; 2]> = match halves {
            Some([a, b]) => Some([view(a)?, view(b)?]),
            None => None,
        };
        let pair = halves.as_ref().map(|[a, b]| [a, b]);
        let black =
            || Failure::Mistake(format!("{} is black: no error can be measured against it", self.truth.path.display()));
        let parts = separate(&image, pair, &reference, std_error.as_ref())?.ok_or_else(black)?;
        self.noise = self.truth.std_error.as_ref().map(|_| (parts.reference, parts.spread));
        let comparison = Comparison { worst: 0, blocks: None, exposure: Some(self.exposure) };
        let difference = comparison.run(&image, &reference)?;
        let mut row = Row {
            method: label.into(),
            budget,
            run: 0,
            seed: None,
            passes: None,
            seconds: 0.0,
            seconds_preparing: None,
            camera_rays: None,
            path_rays: None,
            shadow_rays: None,
            lights: None,
            non_finite: 0,
            relmse: 0.0,
            relmse_net: 0.0,
            bias: None,
            noise: None,
            rmse: difference.rmse,
            mape: difference.mape.ok_or_else(black)?,
            flip: match difference.flip {
                Flip::Measured { mean, .. } => Some(mean),
                Flip::Absent(_) => None,
            },
            percentile_999: difference.percentile_999,
            file: None,
        };
        parts.note(&mut row);
        Ok(row)
    }
}

/// Where everything is written, file by file, each whole or not at all.
struct Directory(PathBuf);

impl Directory {
    /// Makes it, if no file of the scene lies in it.
    fn new(path: &Path, read: &[PathBuf]) -> Result<Directory, Failure> {
        let real = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.into());
        if let Some(file) = read.iter().find(|r| real(r).parent() == Some(&real(path))) {
            return Err(Failure::Mistake(format!(
                "{} belongs to the scene and lies in the directory that is to be written: choose another -o",
                file.display()
            )));
        }
        std::fs::create_dir_all(path.join("images"))
            .map_err(|e| Failure::Mistake(format!("the directory {} cannot be made: {e}", path.display())))?;
        let directory = Directory(path.into());
        for name in ["rows.csv", "study.json", "index.html"] {
            files::check_writable(&directory.at(name))?;
        }
        Ok(directory)
    }
    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
    fn image(&self, name: &str, rendering: &manylight_render::Rendering) -> Result<(), Failure> {
        let picture = files::Picture {
            image: rendering.image.clone(),
            standard_error: rendering.standard_error.clone(),
            maps: rendering.maps.clone(),
            attributes: Default::default(),
        };
        Ok(files::write_exr(&self.at(name), &picture)?)
    }
    fn write(&self, study: &Study, truth: &Truth, shown: &[Shown]) -> Result<(), Failure> {
        let text = |name: &str, text: &str| files::write_atomically(&self.at(name), text.as_bytes());
        text("rows.csv", &study.csv())?;
        text("study.json", &(study.json()? + "\n"))?;
        for (axis, name) in
            [(Axis::RelMse, "relmse.svg"), (Axis::Flip, "flip.svg"), (Axis::Percentile, "percentile.svg")]
        {
            if let Some(svg) = study.plot(axis)? {
                text(name, &svg)?;
            }
        }
        let reference = Picture {
            name: "reference".into(),
            caption: format!("reference {}", truth.path.display()),
            image: view(&truth.image)?,
        };
        let mut pictures = vec![reference];
        for s in shown {
            pictures.push(Picture { name: s.name.clone(), caption: s.caption.clone(), image: view(&s.image)? });
        }
        text("index.html", &study.page(&pictures)?)?;
        Ok(())
    }
}

/// `images/1-vsl-paths-64-4-s.exr`.
fn image_name(entry: usize, label: &str, budget: Cost) -> String {
    let plain: String = format!("{label} {budget}")
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' })
        .collect();
    format!("images/{}-{plain}.exr", entry + 1)
}

fn distinct<'a>(labels: impl Iterator<Item = &'a str>) -> Result<(), Failure> {
    let mut seen: Vec<&str> = Vec::new();
    for label in labels {
        if seen.contains(&label) {
            return Err(Failure::Mistake(format!("`{label}` is named twice: name it once")));
        }
        seen.push(label);
    }
    Ok(())
}

/// Ascending, each once.
fn budgets(args: &Compare) -> Vec<Cost> {
    let mut all = match (&args.times[..], &args.passes[..]) {
        ([], []) => vec![Cost::Seconds(1.0), Cost::Seconds(2.0), Cost::Seconds(4.0)],
        ([], passes) => passes.to_vec(),
        (times, _) => times.to_vec(),
    };
    all.sort_by(|a, b| a.value().total_cmp(&b.value()));
    all.dedup();
    all
}

fn baseline(args: &Compare, specs: &[&Spec]) -> Result<String, Failure> {
    let labels: Vec<&str> = specs.iter().map(|s| s.label.as_str()).collect();
    match &args.baseline {
        None => Ok(labels[0].into()),
        Some(b) if labels.contains(&b.as_str()) => Ok(b.clone()),
        Some(b) => Err(Failure::Mistake(format!("--baseline {b} is none of the methods: {}", labels.join(" ")))),
    }
}

fn threads(args: &Compare) -> usize {
    let all = || std::thread::available_parallelism().map_or(1, usize::from);
    args.threads.map_or_else(all, usize::from)
}

fn subjects(entries: &[Entry], images: &[Foreign]) -> Vec<Subject> {
    let own = entries.iter().map(|e| Subject {
        method: e.label.clone(),
        claim: e.recipe.claim.to_string(),
        parameters: e.recipe.parameters.clone(),
    });
    let foreign = images.iter().map(|i| Subject {
        method: i.name.clone(),
        claim: "an image from elsewhere".into(),
        parameters: vec![("file".into(), i.path.display().to_string())],
    });
    own.chain(foreign).collect()
}

fn summarise(study: &Study, directory: &Directory) {
    let head = ["method", "budget", "time", "relMSE", "speed-up", "slope"].map(String::from);
    let dash = || "-".to_string();
    let rows = study.summary().into_iter().map(|s| {
        let range = |e: &manylight_report::Estimate, digits: fn(f64) -> String| match (e.low, e.high) {
            (Some(l), Some(h)) => format!("{} [{}, {}]", digits(e.mean), digits(l), digits(h)),
            _ => digits(e.mean),
        };
        [
            s.method,
            if s.passes.is_some() { s.budget.to_string() } else { "image".into() },
            units::time(Duration::from_secs_f64(s.seconds)),
            range(&s.relmse_net, |x| format!("{x:.2e}")),
            s.speedup.map_or_else(dash, |e| range(&e, |x| format!("{x:.2}"))),
            s.slope.map_or_else(dash, |e| range(&e, |x| format!("{x:.2}"))),
        ]
    });
    say(table(&std::iter::once(head).chain(rows).collect::<Vec<_>>()).trim_end());
    for v in study.verdict() {
        let against = |d: &manylight_report::Duel| {
            let word = if d.significant { "significant" } else { "not significant" };
            format!("; {} has {:.2} times its error ({word})", d.method, d.ratio.mean)
        };
        say(format!(
            "in {}: {} has the least error{}",
            v.budget,
            v.best,
            v.duels.first().map_or(String::new(), against)
        ));
        if !v.late.is_empty() {
            say(format!("  not ranked, since two passes took much longer: {}", v.late.join(", ")));
        }
        if !v.untold.is_empty() {
            say(format!(
                "  nothing can be said of {}: their errors drown in the reference's noise",
                v.untold.join(", ")
            ));
        }
    }
    say(format!("wrote {}", directory.at("index.html").display()));
}
