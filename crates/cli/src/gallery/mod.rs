//! `manylight gallery`: the comparisons of the field, computed, on one page.

mod drawn;
mod figures;

use crate::args::Gallery as Args;
use crate::compare::spec::{self, Spec};
use crate::failure::Failure;
use crate::output::{did_you_mean, say};
use crate::{interrupt, units};
use figures::{Content, FIGURES, Figure, Shot};
use manylight_framework::Image;
use manylight_render::files::{Exposure, write_atomically, write_png};
use manylight_render::{Budget, Progress, RenderError, Rendering, Settings, render};
use manylight_report::{Figure as OnPage, Gallery, ImageView, Picture, Sequence, compare};
use manylight_scene::Scene;
use manylight_scene_io::{LoadOptions, load};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What `--quick` renders.
const QUICK: (u32, u32) = (176, 132);
/// Without it: twice as large, with so many times the passes.
const MORE: u64 = 8;

/// Truths that several figures share, by scene, method and passes.
type Truths = Vec<(String, Taken)>;

/// A shot that was rendered.
#[derive(Clone)]
struct Taken {
    shot: Shot,
    spec: Spec,
    rendering: Rendering,
    /// Over frames, if there are several.
    flicker: Option<f64>,
}

/// Everything that becomes of a figure, but the views of its images.
struct Made<'f> {
    figure: &'f Figure,
    commands: String,
    exposure: f32,
    /// The truth first.
    images: Vec<(String, String, Image)>,
    drawings: Vec<(String, String)>,
    table: (Vec<String>, Vec<Vec<String>>),
}

/// Renders the figures and writes the page, and a PNG of each that has images.
pub fn run(args: &Args) -> Result<(), Failure> {
    let chosen = chosen(&args.only)?;
    if !args.scenes.is_dir() {
        return Err(Failure::Mistake(format!(
            "there is no folder `{}`: name the repository's folder of scenes with --scenes",
            args.scenes.display()
        )));
    }
    let cancel = interrupt::flag()?;
    std::fs::create_dir_all(&args.output)
        .map_err(|e| Failure::Mistake(format!("`{}` cannot be made: {e}", args.output.display())))?;
    let start = Instant::now();
    let mut made = Vec::new();
    let mut truths = Vec::new();
    for figure in chosen {
        let one = match &figure.content {
            Content::Images { scene, defines, truth, shots, frames } => {
                let camera = Set { args, scene, defines, cancel: &cancel };
                let one = camera.figure(figure, truth, shots, *frames, &mut truths);
                // What was done before is on the page.
                one.map_err(|e| match e {
                    Failure::Interrupted if made.is_empty() => Failure::InterruptedEarly,
                    e => e,
                })?
            }
            Content::Drawn(draw) => drawing(figure, draw(&args.scenes)?)?,
        };
        if !one.images.is_empty() {
            let file = args.output.join(format!("{}.png", figure.name));
            let images: Vec<&Image> = one.images.iter().map(|i| &i.2).collect();
            write_png(&file, &beside(&images), Exposure::Ev(one.exposure))?;
        }
        for (i, (svg, _)) in one.drawings.iter().enumerate() {
            write_atomically(&args.output.join(format!("{}-{}.svg", figure.name, i + 1)), svg.as_bytes())?;
        }
        if !args.quiet {
            eprintln!("{}: {}", figure.name, units::time(start.elapsed()));
        }
        made.push(one);
        // After each, so that there is a page whenever it is interrupted.
        write_page(args, &made)?;
    }
    say(format!("wrote {}", args.output.join("gallery.html").display()));
    Ok(())
}

fn chosen(only: &[String]) -> Result<Vec<&'static Figure>, Failure> {
    let find = |name: &String| {
        FIGURES.iter().find(|f| f.name == name).ok_or_else(|| {
            let near = did_you_mean(name, FIGURES.iter().map(|f| f.name));
            let all: Vec<_> = FIGURES.iter().map(|f| f.name).collect();
            Failure::Mistake(format!("there is no figure `{name}`{near}; there are {}", all.join(", ")))
        })
    };
    if only.is_empty() { Ok(FIGURES.iter().collect()) } else { only.iter().map(find).collect() }
}

/// Where the shots of a figure are taken.
struct Set<'a> {
    args: &'a Args,
    scene: &'a str,
    defines: &'a [(&'a str, &'a str)],
    cancel: &'a Arc<AtomicBool>,
}

impl Set<'_> {
    fn size(&self) -> (u32, u32) {
        self.args.size.unwrap_or(if self.args.quick { QUICK } else { (2 * QUICK.0, 2 * QUICK.1) })
    }
    fn load(&self, frame: u64) -> Result<Scene, Failure> {
        let mut defines: Vec<_> = self.defines.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        if frame > 0 {
            defines.push(("frame".into(), frame.to_string()));
        }
        let options = LoadOptions { defines, size: Some(self.size()), filter: None };
        let file = self.args.scenes.join(self.scene).join("scene.xml");
        Ok(load(&file, &options).map_err(Failure::mistake)?.scene)
    }
    fn passes(&self, shot: &Shot) -> u64 {
        if self.args.quick { shot.passes } else { MORE * shot.passes }
    }
    fn take(&self, scene: &Scene, shot: &Shot, frame: u64) -> Result<(Spec, Rendering), Failure> {
        let spec = spec::methods(shot.method).map_err(Failure::Mistake)?.0.swap_remove(0);
        let recipe = manylight_recipes::build(&spec.method, &spec.parameters, scene)
            .map_err(|e| Failure::Mistake(format!("{}: {e}", shot.method)))?;
        // Frame by frame other lights, as an animation has them.
        let seed = self.args.seed.wrapping_add(frame);
        let settings = Settings { budget: Budget::Passes(self.passes(shot)), seed, spp: recipe.spp, threads: None };
        let done = render(scene, &*recipe.method, &settings, &mut |_: &Progress| (), self.cancel);
        match done {
            Ok(r) if r.interrupted => Err(Failure::Interrupted),
            Ok(r) => Ok((spec, r)),
            Err(RenderError::Interrupted) => Err(Failure::Interrupted),
            Err(e) => Err(e.into()),
        }
    }
    fn taken(&self, scenes: &[Scene], shot: &Shot) -> Result<Taken, Failure> {
        let (spec, rendering) = self.take(&scenes[0], shot, 0)?;
        let mut frames = Sequence::default();
        frames.add(&view(&rendering.image)?)?;
        for (frame, scene) in scenes.iter().enumerate().skip(1) {
            let (_, next) = self.take(scene, shot, frame as u64)?;
            frames.add(&view(&next.image)?)?;
        }
        let flicker = frames.steadiness().and_then(|s| s.flicker);
        Ok(Taken { shot: *shot, spec, rendering, flicker })
    }
    fn command(&self, t: &Taken) -> String {
        let (width, height) = self.size();
        let words = |flag: &str, pairs: &[(String, String)]| -> String {
            pairs.iter().map(|(k, v)| format!(" {flag} {k}={v}")).collect()
        };
        let defines: Vec<_> = self.defines.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        format!(
            "manylight render {}/{}/scene.xml --method {}{}{} --passes {} --seed {} --size {width}x{height} -o '{}.exr'",
            self.args.scenes.display(),
            self.scene,
            t.spec.method,
            words("-P", &t.spec.parameters),
            words("-D", &defines),
            self.passes(&t.shot),
            self.args.seed,
            t.shot.name,
        )
    }
    fn figure<'f>(
        &self,
        figure: &'f Figure,
        truth: &Shot,
        shots: &[Shot],
        frames: u64,
        truths: &mut Truths,
    ) -> Result<Made<'f>, Failure> {
        let scenes = (0..frames).map(|f| self.load(f)).collect::<Result<Vec<_>, _>>()?;
        let key = format!("{} {:?} {} {} {frames}", self.scene, self.defines, truth.method, truth.passes);
        let known = truths.iter().find(|t| t.0 == key).map(|t| t.1.clone());
        let first = match known {
            Some(taken) => taken,
            None => self.taken(&scenes, truth)?,
        };
        truths.push((key, first.clone()));
        let mut all = vec![first];
        for s in shots {
            all.push(self.taken(&scenes, s)?);
        }
        let exposure = Exposure::Auto.ev(&all[0].rendering.image);
        let mut head: Vec<String> =
            ["", "method", "passes", "time [s]", "rays", "lights a pass", "relMSE", "RMSE", "MAPE", "99.9 %"]
                .map(String::from)
                .into();
        if frames > 1 {
            head.push("flicker".into());
        }
        let mut rows = Vec::new();
        let mut images = Vec::new();
        for (i, t) in all.iter().enumerate() {
            let (row, caption) = numbers(t, (i > 0).then_some(&all[0]))?;
            rows.push(row);
            images.push((t.shot.name.to_string(), caption, t.rendering.image.clone()));
        }
        let commands = all.iter().map(|t| self.command(t)).collect::<Vec<_>>().join("\n");
        Ok(Made { figure, commands, exposure, images, drawings: Vec::new(), table: (head, rows) })
    }
}

/// A row of the table, and the picture's caption.
fn numbers(t: &Taken, truth: Option<&Taken>) -> Result<(Vec<String>, String), Failure> {
    let r = &t.rendering;
    let seconds = r.elapsed.as_secs_f64();
    let shown = |x: f64| if x >= 0.01 { format!("{x:.3}") } else { format!("{x:.2e}") };
    let lights = r.probe.lights as f64 / r.passes.max(1) as f64;
    let mut row = vec![
        t.shot.name.to_string(),
        t.spec.label.clone(),
        r.passes.to_string(),
        format!("{seconds:.2}"),
        format!("{:.3e}", r.probe.rays() as f64),
        if lights > 0.0 { format!("{lights:.0}") } else { "-".into() },
    ];
    let caption = match truth {
        None => {
            let noise = r.estimated_error.map_or("-".into(), shown);
            row.extend([format!("(own noise {noise})"), "-".into(), "-".into(), "-".into()]);
            format!("{}: the truth, {} passes", t.spec.label, r.passes)
        }
        Some(truth) => {
            let d = compare(&view(&r.image)?, &view(&truth.rendering.image)?)?;
            let or = |x: Option<f64>| x.map_or("-".into(), shown);
            row.extend([or(d.relmse), shown(d.rmse), or(d.mape), shown(d.percentile_999)]);
            format!("{}: {} passes, {seconds:.1} s, relMSE {}", t.spec.label, r.passes, or(d.relmse))
        }
    };
    row.extend(t.flicker.map(|f| format!("{:.2} %", 100.0 * f)));
    Ok((row, caption))
}

fn view(image: &Image) -> Result<ImageView<'_>, Failure> {
    Ok(ImageView::new(image.width, image.height, &image.pixels)?)
}

fn drawing<'f>(figure: &'f Figure, (drawings, table): figures::Drawn) -> Result<Made<'f>, Failure> {
    let drawings = drawings.into_iter().map(|(d, line)| Ok((d.svg()?, line))).collect::<Result<Vec<_>, Failure>>()?;
    let commands = format!("manylight gallery --only {}", figure.name);
    Ok(Made { figure, commands, exposure: 0.0, images: Vec::new(), drawings, table })
}

fn write_page(args: &Args, made: &[Made]) -> Result<(), Failure> {
    let mut figures = Vec::new();
    for m in made {
        let mut pictures = Vec::new();
        for (name, caption, image) in &m.images {
            pictures.push(Picture { name: name.clone(), caption: caption.clone(), image: view(image)? });
        }
        figures.push(OnPage {
            name: m.figure.name.into(),
            title: m.figure.title.into(),
            caption: m.figure.caption.into(),
            commands: m.commands.clone(),
            exposure: m.exposure,
            pictures,
            drawings: m.drawings.clone(),
            table: m.table.clone(),
        });
    }
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let about = format!(
        "Every figure is computed by the command below it{}; seed {}, {threads} threads. The first picture of each is what the others are \
         held against; its own noise is in their errors. Errors of one run say less than `manylight compare`, which has several.",
        if args.quick { " (quick: small and noisy)" } else { "" },
        args.seed,
    );
    let gallery = Gallery { title: "Many-light rendering, computed".into(), about, figures };
    write_atomically(&args.output.join("gallery.html"), gallery.page()?.as_bytes())?;
    Ok(())
}

/// Images of one size, side by side.
fn beside(images: &[&Image]) -> Image {
    const GAP: usize = 2;
    let (w, h) = (images[0].width, images[0].height);
    let mut all = Image::new(images.len() * (w + GAP) - GAP, h);
    for (i, image) in images.iter().enumerate() {
        for y in 0..h {
            let at = y * all.width + i * (w + GAP);
            all.pixels[at..at + w].copy_from_slice(&image.pixels[y * w..(y + 1) * w]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_every_method_can_be_read() {
        let mut names: Vec<_> = FIGURES.iter().map(|f| f.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), FIGURES.len());
        for f in FIGURES {
            let Content::Images { truth, shots, frames, .. } = &f.content else { continue };
            assert!(!shots.is_empty() && *frames > 0, "{}", f.name);
            for s in [truth].into_iter().chain(*shots) {
                let spec = spec::methods(s.method).unwrap_or_else(|e| panic!("{}: {e}", s.method)).0;
                assert!(spec.len() == 1 && manylight_recipes::method(&spec[0].method).is_ok(), "{}", s.method);
                assert!(s.passes > 0);
            }
        }
    }
    #[test]
    fn images_stand_side_by_side() {
        let image = |x: f32| Image { width: 1, height: 2, pixels: vec![manylight_math::Spectrum::gray(x); 2] };
        let all = beside(&[&image(1.0), &image(2.0)]);
        let row: Vec<f32> = all.pixels[4..8].iter().map(|p| p.mean()).collect();
        assert_eq!((all.width, all.height, row), (4, 2, vec![1.0, 0.0, 0.0, 2.0]));
    }
}
