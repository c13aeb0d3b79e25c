//! `manylight explain`.

use crate::args::Explain;
use crate::failure::Failure;
use crate::interrupt;
use crate::output::{say, table};
use manylight_framework::Explained;
use manylight_math::{Spectrum, Vec3};
use manylight_render::{Budget, RenderError, Settings};
use manylight_scene::Edge;
use manylight_scene_io::LoadOptions;

/// Says which lights made a pixel of a pass, what the bound took of them, and what compensation gave back.
pub fn run(args: &Explain) -> Result<(), Failure> {
    let cancel = interrupt::flag()?;
    let options = LoadOptions { defines: args.defines.clone(), size: args.size, filter: None };
    let scene = crate::loading::load(&args.scene, &options, false)?.scene;
    let (width, height) = scene.camera().size;
    let (x, y) = args.pixel;
    if x >= width || y >= height {
        return Err(Failure::Mistake(format!(
            "pixel ({x}, {y}): the image has {width} x {height} pixels, counted from 0 at the upper left"
        )));
    }
    let method = args.method.as_deref().unwrap_or(manylight_recipes::default_method(&scene));
    let recipe = manylight_recipes::build(method, &args.parameters, &scene)?;
    let settings = Settings { budget: Budget::Passes(1), seed: args.seed, spp: recipe.spp, threads: None };
    let pixel = y as usize * width as usize + x as usize;
    let told = match manylight_render::explain(&scene, &*recipe.method, &settings, (args.pass, pixel), &cancel) {
        Err(RenderError::Interrupted) => return Err(Failure::InterruptedEarly),
        told => told?,
    };
    // A light set that draws weighs what it is told, which only it knows; media weigh it, too.
    let plain = recipe.parameters.iter().any(|(name, value)| name == "lights" && value == "all") && !scene.has_media();
    let per_sample = 1.0 / recipe.spp as f32;
    let mut lights = told.explanation.lights;
    // A sum over samples, as the pixel is: each counts by its share.
    let sum =
        |f: &dyn Fn(&Explained) -> Spectrum| lights.iter().map(f).fold(Spectrum::BLACK, |a, b| a + b) * per_sample;
    let (kept, taken) = (sum(&|l| l.contribution), sum(&taken));
    let residuals = told.explanation.residuals.iter().filter(|r| r.0.level == 0);
    let residual = residuals.map(|r| r.1).fold(Spectrum::BLACK, |a, b| a + b) * per_sample;
    let lit = lights.iter().filter(|l| !l.contribution.is_black()).count();
    say(format!("{}, method {}, pixel ({x}, {y}) of pass {}", args.scene.display(), recipe.name, args.pass));
    say(format!("  the pixel: {}", rgb(told.value)));
    let row = |what: &str, v: Spectrum| [what.to_string(), rgb(v)];
    let rows = [
        row("virtual lights", kept),
        row("taken by the bound", taken),
        row("compensation", residual),
        row("the rest: emission, direct light", told.value - kept - residual),
    ];
    match plain {
        true => say(table(&rows).trim_end()),
        false => say(
            "  (lights=all on a scene without media tells the lights' share; what follows is before the light set weighs it)",
        ),
    }
    say(format!("{} lights asked by a shadow ray, {lit} of them seen. The brightest:", lights.len()));
    lights.sort_by(|a, b| b.contribution.luminance().total_cmp(&a.contribution.luminance()));
    let head = ["share", "contribution", "G [1/m^2]", "kept", "edges", "at [m]"].map(String::from);
    let whole = told.value.luminance();
    let brightest = lights.iter().take(args.lights).filter(|l| !l.contribution.is_black());
    let rows: Vec<[String; 6]> = std::iter::once(head)
        .chain(brightest.map(|l| {
            [
                if plain {
                    format!("{:.2} %", 100.0 * l.contribution.luminance() * per_sample / whole)
                } else {
                    "-".into()
                },
                rgb(l.contribution * per_sample),
                if l.g > 0.0 { format!("{:.4}", l.g) } else { "-".into() },
                format!("{:.3}", l.keep),
                l.edges.to_string(),
                place(&l.edge),
            ]
        }))
        .collect();
    say(table(&rows).trim_end());
    if scene.has_delta_lobes() {
        say("Behind mirrors or glass, lights and compensation are told before these take their part.");
    }
    Ok(())
}

/// What the bound took of a light, which is only known if it left something.
fn taken(l: &Explained) -> Spectrum {
    if l.keep > 0.0 { l.contribution * ((1.0 - l.keep) / l.keep) } else { Spectrum::BLACK }
}

fn rgb(v: Spectrum) -> String {
    let [r, g, b] = v.to_array();
    format!("{r:.6} {g:.6} {b:.6}")
}

fn place(edge: &Edge) -> String {
    let text = |p: Vec3| format!("{:.4} {:.4} {:.4}", p.x, p.y, p.z);
    match edge {
        Edge::Between(_, light) => text(light.p),
        Edge::ToInfinity(_, w) => format!("infinity, towards {}", text(*w)),
    }
}
