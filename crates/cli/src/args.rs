//! The command line, as data.

use crate::compare::spec::{self, Foreign, Methods};
use crate::output::did_you_mean;
use clap::{Args, Parser, Subcommand};
use manylight_render::files::Exposure;
use manylight_report::Cost;
use manylight_scene::{Filter, Simd};
use std::path::PathBuf;
use std::time::Duration;

/// Renders scenes with virtual point lights and other many-light methods, and compares the images.
///
/// Exit codes: 0 done, 1 a mistake in what was asked for, 2 a check failed, 3 interrupted (what was rendered is written).
#[derive(Debug, Parser)]
#[command(name = "manylight", version)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Renders a scene to an EXR image, with a PNG beside it to look at
    Render(Render),
    /// Writes where a method puts its virtual point lights, as a PLY file
    Lights(Lights),
    /// Says how far two images are apart
    Diff(Diff),
    /// Renders a scene by several methods in turns, and says which has the least error in the time there is
    Compare(Compare),
    /// Holds methods against what they claim
    Verify(Verify),
    /// Computes the comparison figures of the field: one HTML page
    Gallery(Gallery),
    /// Says which virtual lights made a pixel, what the bound took, and what compensation gave
    Explain(Explain),
    /// Says what a scene holds, which methods suit it, and what they miss of it
    Info(Info),
    /// Lists the methods, or describes one with its parameters
    List(List),
    /// Writes one of the parametric scenes, or lists them
    #[command(disable_help_flag = true)]
    Scene(Scene),
}

/// Renders a scene to an EXR image, with a PNG beside it to look at.
#[derive(Debug, Args)]
pub struct Render {
    /// Scene file (Mitsuba 3 XML)
    #[arg(value_name = "SCENE.xml")]
    pub scene: PathBuf,
    /// Image to write; the PNG has the same name [default: the scene's name, in the current directory]
    #[arg(short, long, value_name = "OUT.exr", value_parser = exr_path)]
    pub output: Option<PathBuf>,
    /// Method; `manylight list` shows them all [default: instant-radiosity, or vrl where the scene has media]
    #[arg(long, value_name = "NAME")]
    pub method: Option<String>,
    /// Sets a parameter of the method; `manylight list NAME` shows them (may be repeated)
    #[arg(short = 'P', value_name = "key=value", value_parser = key_value)]
    pub parameters: Vec<(String, String)>,
    /// Fills in $name in the scene file (may be repeated)
    #[arg(short = 'D', value_name = "name=value", value_parser = key_value)]
    pub defines: Vec<(String, String)>,
    /// Renders so many passes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), conflicts_with = "time")]
    pub passes: Option<u64>,
    /// Renders for about so long, such as 30s, 5m or 1.5h; two passes always finish [default: 30s]
    #[arg(long, value_parser = duration)]
    pub time: Option<Duration>,
    /// What all random numbers follow from
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Threads; the image does not depend on them [default: one for each core]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// What traces rays: auto is the best that the processor has, portable uses no vector unit; the image is the same
    #[arg(long, value_name = "auto|portable", default_value = "auto", value_parser = simd)]
    pub simd: Simd,
    /// Size of the image in pixels, instead of the scene's own
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// Pixel filter, instead of the scene's own: box, tent, gaussian, mitchell, catmullrom or lanczos
    #[arg(long, value_name = "NAME", value_parser = filter)]
    pub filter: Option<Filter>,
    /// Exposure of the PNG: radiance is multiplied by 2^EV; auto finds a fitting one
    #[arg(long, value_name = "EV|auto", default_value = "auto", allow_hyphen_values = true, value_parser = exposure)]
    pub exposure: Exposure,
    /// Writes what was done and counted as JSON
    #[arg(long, value_name = "OUT.json")]
    pub stats: Option<PathBuf>,
    /// Renders frames A to B, each for --time or --passes and with --seed plus its number, into an image each (OUT-A.exr, or the
    /// number where -o says $frame) and an animated PNG of them all. $frame is the number in values of -D, too; where none
    /// says so, the scene's parameter `frame` is it. 001..048 writes it with three digits
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub frames: Option<Frames>,
    /// Prints warnings and errors only
    #[arg(long, short)]
    pub quiet: bool,
}

/// Numbers of frames, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// The first.
    pub first: u32,
    /// The last; not before the first.
    pub last: u32,
    /// Digits that numbers are filled up to with zeros.
    pub digits: usize,
}

/// Writes where a method puts its virtual point lights, as a PLY file.
///
/// Each vertex has position (x, y, z) \[m\], flux (flux_r, flux_g, flux_b) \[W\], the edges from the emitter, and a colour (red,
/// green, blue) for viewers: the flux's, at full brightness.
#[derive(Debug, Args)]
pub struct Lights {
    /// Scene file (Mitsuba 3 XML)
    #[arg(value_name = "SCENE.xml")]
    pub scene: PathBuf,
    /// PLY file to write
    #[arg(short, long, value_name = "OUT.ply", value_parser = ply_path)]
    pub output: PathBuf,
    /// Method that has a generator of point lights; `manylight list` shows them all
    #[arg(long, value_name = "NAME", default_value = manylight_recipes::methods()[0].name)]
    pub method: String,
    /// Sets a parameter of the method; `manylight list NAME` shows them (may be repeated)
    #[arg(short = 'P', value_name = "key=value", value_parser = key_value)]
    pub parameters: Vec<(String, String)>,
    /// Fills in $name in the scene file (may be repeated)
    #[arg(short = 'D', value_name = "name=value", value_parser = key_value)]
    pub defines: Vec<(String, String)>,
    /// Which pass's lights
    #[arg(long, default_value_t = 0)]
    pub pass: u64,
    /// What all random numbers follow from
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Writes text instead of binary numbers
    #[arg(long)]
    pub ascii: bool,
}

/// Says how far two images are apart.
#[derive(Debug, Args)]
pub struct Diff {
    /// Image to judge
    #[arg(value_name = "A.exr")]
    pub image: PathBuf,
    /// Reference
    #[arg(value_name = "B.exr")]
    pub reference: PathBuf,
    /// Prints JSON
    #[arg(long)]
    pub json: bool,
    /// Ends with exit code 2 if the relative mean squared error is above this
    #[arg(long, value_name = "RELMSE", value_parser = positive)]
    pub fail_above: Option<f64>,
}

/// Renders a scene by several methods in turns, and says which has the least error in the time there is.
///
/// Writes a directory: index.html (one page that needs no network), rows.csv (an image a line), study.json (with the summary and
/// what the columns mean), plots as SVG, and the images of the first run. An error is measured against a reference, without that
/// reference's own noise where its standard error is known (layer `stderr`, or NAME.stderr.exr beside it).
#[derive(Debug, Args)]
pub struct Compare {
    /// Scene file (Mitsuba 3 XML)
    #[arg(value_name = "SCENE.xml")]
    pub scene: PathBuf,
    /// Methods with their parameters: path,vsl:paths=64,bound=none (may be repeated)
    #[arg(short, long, value_name = "LIST", required = true, value_parser = spec::methods)]
    pub methods: Vec<Methods>,
    /// Directory to write
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Times to compare at, such as 1s,4s,16s; two passes always finish [default: 1s,2s,4s]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spec::time, conflicts_with = "passes")]
    pub times: Vec<Cost>,
    /// Numbers of passes to compare at, instead of times
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spec::passes)]
    pub passes: Vec<Cost>,
    /// Independent runs, which intervals and tests are made of
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
    /// Reference image [default: reference.exr beside the scene]; its size is rendered
    #[arg(long, value_name = "REF.exr")]
    pub reference: Option<PathBuf>,
    /// An image from elsewhere, with what it took (may be repeated)
    #[arg(long = "image", value_name = "NAME=FILE.exr@SECONDS", value_parser = spec::foreign)]
    pub images: Vec<Foreign>,
    /// Method that the others' speed is measured by [default: the first]
    #[arg(long, value_name = "METHOD")]
    pub baseline: Option<String>,
    /// Fills in $name in the scene file (may be repeated)
    #[arg(short = 'D', value_name = "name=value", value_parser = key_value)]
    pub defines: Vec<(String, String)>,
    /// Seed of the first run; the next has the next
    #[arg(long, default_value_t = 1000)]
    pub seed: u64,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Size of the image in pixels, which has to be the reference's
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// Pixel filter, instead of the scene's own
    #[arg(long, value_name = "NAME", value_parser = filter)]
    pub filter: Option<Filter>,
    /// Exposure of FLIP, and of the page to begin with; auto finds one that fits the reference
    #[arg(long, value_name = "EV|auto", default_value = "auto", allow_hyphen_values = true, value_parser = exposure)]
    pub exposure: Exposure,
    /// Prints warnings and errors only
    #[arg(long, short)]
    pub quiet: bool,
}

/// Holds methods against what they claim.
///
/// Reads a method's claim and makes the checks that it calls for, in small scenes with known truths: block means over passes
/// (two-sided, or one-sided for methods that only darken), and biases at both ends of the knobs that they are to vanish with. Each line
/// says the smallest bias that would have been seen. A right method fails once in a thousand times. Exit code 2: a claim is broken.
#[derive(Debug, Args)]
pub struct Verify {
    /// Method; without it, all of them
    #[arg(value_name = "METHOD")]
    pub method: Option<String>,
    /// Verifies all methods, as without METHOD
    #[arg(long, conflicts_with = "method")]
    pub all: bool,
    /// Verifies compositions of parts (`many-lights`): a few in which every pair of parts stands, or all with --thorough
    #[arg(long, conflicts_with_all = ["method", "all"])]
    pub compositions: bool,
    /// Puts methods through scenes that are built to break things: tiny, huge, coincident, touching, grazing, sharp, dense, ..
    #[arg(long, conflicts_with_all = ["compositions", "scene"])]
    pub stability: bool,
    /// Writes the table of --stability as CSV, or as JSON if the name ends so
    #[arg(long, value_name = "FILE", requires = "stability", value_parser = table_path)]
    pub table: Option<PathBuf>,
    /// Sets a parameter of the method (may be repeated)
    #[arg(short = 'P', value_name = "key=value", value_parser = key_value, requires = "method")]
    pub parameters: Vec<(String, String)>,
    /// Verifies in this scene, against path tracing, instead of the built-in ones
    #[arg(long, value_name = "SCENE.xml")]
    pub scene: Option<PathBuf>,
    /// Fills in $name in the scene file (may be repeated)
    #[arg(short = 'D', value_name = "name=value", value_parser = key_value, requires = "scene")]
    pub defines: Vec<(String, String)>,
    /// Size of that scene's image in pixels: the smaller, the more passes there are
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "16x12", requires = "scene")]
    pub size: (u32, u32),
    /// Looks much harder: sees a quarter of the bias, and takes some sixty times as long
    #[arg(long)]
    pub thorough: bool,
    /// Looks until a bias of so many percent of the whole image's mean would be seen, however long that takes
    #[arg(long, value_name = "PERCENT", value_parser = percent, conflicts_with_all = ["thorough", "stability"])]
    pub sees: Option<f64>,
    /// What all random numbers follow from
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

/// Renders and draws the figures by which many-light methods are explained, each with its command and its numbers, into DIR/gallery.html
/// (which needs no other file), with a PNG or SVG of each beside it.
#[derive(Debug, Args)]
pub struct Gallery {
    /// Directory to write
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Small images and few passes: minutes instead of hours
    #[arg(long)]
    pub quick: bool,
    /// Size of the images in pixels [default: 352x264, with --quick 176x132]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// Only these figures (may be repeated, or joined by commas)
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub only: Vec<String>,
    /// The repository's folder of scenes
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub scenes: PathBuf,
    /// What all random numbers follow from
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Says nothing on the way
    #[arg(short, long)]
    pub quiet: bool,
}

/// Says which virtual lights made a pixel of a pass: for splotches, fireflies and dark corners.
#[derive(Debug, Args)]
pub struct Explain {
    /// Scene file (Mitsuba 3 XML)
    #[arg(value_name = "SCENE.xml")]
    pub scene: PathBuf,
    /// The pixel, counted from 0,0 at the upper left
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: (u32, u32),
    /// Method; `manylight list` shows them all [default: instant-radiosity, or vrl where the scene has media]
    #[arg(long, value_name = "NAME")]
    pub method: Option<String>,
    /// Sets a parameter of the method (may be repeated)
    #[arg(short = 'P', value_name = "key=value", value_parser = key_value)]
    pub parameters: Vec<(String, String)>,
    /// Fills in $name in the scene file (may be repeated)
    #[arg(short = 'D', value_name = "name=value", value_parser = key_value)]
    pub defines: Vec<(String, String)>,
    /// Size of the image in pixels, instead of the scene's own
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// What all random numbers follow from
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// The pass to look at, from 0
    #[arg(long, default_value_t = 0)]
    pub pass: u64,
    /// Lights to show, the brightest first
    #[arg(long, default_value_t = 10)]
    pub lights: usize,
}

/// Says what a scene holds: shapes, materials, lights, media, textures and memory; and what each method leaves out of it.
#[derive(Debug, Args)]
pub struct Info {
    /// Scene file (Mitsuba 3 XML)
    #[arg(value_name = "SCENE.xml")]
    pub scene: PathBuf,
    /// Only this method, with its parameters
    #[arg(long, value_name = "NAME")]
    pub method: Option<String>,
    /// Sets a parameter of the method (may be repeated)
    #[arg(short = 'P', value_name = "key=value", value_parser = key_value, requires = "method")]
    pub parameters: Vec<(String, String)>,
    /// Fills in $name in the scene file (may be repeated)
    #[arg(short = 'D', value_name = "name=value", value_parser = key_value)]
    pub defines: Vec<(String, String)>,
}

/// Lists the methods, or describes one with its parameters.
#[derive(Debug, Args)]
pub struct List {
    /// Method to describe
    #[arg(value_name = "NAME")]
    pub method: Option<String>,
}

/// Writes one of the parametric scenes, or lists them.
#[derive(Debug, Args)]
pub struct Scene {
    /// Scene to write; without it, the scenes and their parameters are listed
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
    /// Describes the scene and its parameters
    #[arg(short, long)]
    pub help: bool,
    /// Directory to write to: `-o DIR`; and the scene's parameters: `--key value`
    #[arg(value_name = "-o DIR | --key value", trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<String>,
}

/// The budget where none is asked for.
pub const DEFAULT_TIME: Duration = Duration::from_secs(30);

fn exr_path(s: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(s);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("exr") => Ok(path),
        _ => Err("the name must end in .exr (a PNG is written beside it)".into()),
    }
}

fn frames(s: &str) -> Result<Frames, String> {
    let wrong = || "expected two whole numbers, the smaller one first, such as 1..48".to_string();
    let (first, last) = s.split_once("..").ok_or_else(wrong)?;
    // As it is written: 001 has three digits, 1 has one.
    let digits = if first.starts_with('0') { first.len() } else { 1 };
    let (first, last): (u32, u32) = (first.parse().map_err(|_| wrong())?, last.parse().map_err(|_| wrong())?);
    if first <= last { Ok(Frames { first, last, digits }) } else { Err(wrong()) }
}

fn table_path(s: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(s);
    match path.extension() {
        Some(extension) if extension == "csv" || extension == "json" => Ok(path),
        _ => Err("the name must end in .csv or .json".into()),
    }
}

fn pixel(s: &str) -> Result<(u32, u32), String> {
    let numbers = s.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    numbers.ok_or_else(|| "expected two whole numbers, such as 12,34".into())
}

fn ply_path(s: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(s);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("ply") => Ok(path),
        _ => Err("the name must end in .ply".into()),
    }
}

fn key_value(s: &str) -> Result<(String, String), String> {
    match s.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.into(), value.into())),
        _ => Err("expected name=value".into()),
    }
}

/// `30s`, `5m`, `1.5h`, `250ms`; a number alone is refused, since nobody knows of what.
pub fn duration(s: &str) -> Result<Duration, String> {
    let expected = || "expected a number and a unit, such as 30s, 5m or 1.5h".to_string();
    let digits = s.find(|c: char| c.is_ascii_alphabetic()).ok_or_else(expected)?;
    let (number, unit) = s.split_at(digits);
    let seconds = match unit {
        "ms" => 1e-3,
        "s" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(expected()),
    };
    let number: f64 = number.trim_end().parse().map_err(|_| expected())?;
    match Duration::try_from_secs_f64(number * seconds) {
        Ok(time) if !time.is_zero() => Ok(time),
        Ok(_) => Err("a time must be above zero".into()),
        Err(_) => Err(expected()),
    }
}

fn size(s: &str) -> Result<(u32, u32), String> {
    let size = s.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match size {
        Some((w, h)) if (1..=65_536).contains(&w) && (1..=65_536).contains(&h) => Ok((w, h)),
        _ => Err("expected width x height in pixels, such as 640x360, at most 65536 each".into()),
    }
}

fn simd(s: &str) -> Result<Simd, String> {
    match s {
        "auto" => Ok(Simd::Auto),
        "portable" => Ok(Simd::Portable),
        _ => Err("expected auto or portable".into()),
    }
}

/// By the names, and with the widths, that Mitsuba 3 gives them.
fn filter(s: &str) -> Result<Filter, String> {
    const THIRD: f32 = 1.0 / 3.0;
    let filters = [
        ("box", Filter::Box),
        ("tent", Filter::Tent { radius: 1.0 }),
        ("gaussian", Filter::Gaussian { stddev: 0.5 }),
        ("mitchell", Filter::Mitchell { b: THIRD, c: THIRD }),
        ("catmullrom", Filter::CatmullRom),
        ("lanczos", Filter::Lanczos { lobes: 3.0 }),
    ];
    let found = filters.iter().find(|(name, _)| *name == s).map(|(_, filter)| *filter);
    found.ok_or_else(|| {
        let names = filters.map(|(name, _)| name);
        format!("there is no such filter{}; expected {}", did_you_mean(s, names.into_iter()), names.join(", "))
    })
}

fn exposure(s: &str) -> Result<Exposure, String> {
    if s == "auto" {
        return Ok(Exposure::Auto);
    }
    match s.parse() {
        Ok(ev) if f32::is_finite(ev) => Ok(Exposure::Ev(ev)),
        _ => Err("expected a number, such as -1.5, or auto".into()),
    }
}

fn positive(s: &str) -> Result<f64, String> {
    match s.parse() {
        Ok(x) if x >= 0.0 && f64::is_finite(x) => Ok(x),
        _ => Err("expected a number that is not negative".into()),
    }
}

fn percent(s: &str) -> Result<f64, String> {
    match s.trim_end_matches('%').parse() {
        Ok(x) if x > 0.0 && x < 100.0 => Ok(x),
        _ => Err("expected a number of percent above 0, such as 0.5".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }
    #[test]
    fn durations_have_a_unit() {
        let seconds = |s| duration(s).map(|d| d.as_secs_f64());
        assert_eq!(seconds("30s"), Ok(30.0));
        assert_eq!(seconds("5m"), Ok(300.0));
        assert_eq!(seconds("1.5h"), Ok(5400.0));
        assert_eq!(seconds("250ms"), Ok(0.25));
        for wrong in ["30", "s", "", "-1s", "0s", "1d", "infs", "1e300h", "5m3s", "nans"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
    }
    #[test]
    fn sizes_exposures_and_pairs_are_read_or_refused() {
        assert_eq!(size("640x360"), Ok((640, 360)));
        assert!(["640", "0x3", "3x0", "x", "1e3x2", "99999999x1"].iter().all(|s| size(s).is_err()));
        assert_eq!(exposure("-1.5"), Ok(Exposure::Ev(-1.5)));
        assert_eq!(exposure("auto"), Ok(Exposure::Auto));
        assert!(["nan", "inf", "bright", ""].iter().all(|s| exposure(s).is_err()));
        assert_eq!(filter("tent"), Ok(Filter::Tent { radius: 1.0 }));
        assert!(filter("guassian").unwrap_err().contains("did you mean `gaussian`?"));
        assert_eq!(key_value("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert!(key_value("a").is_err() && key_value("=a").is_err());
        assert!(exr_path("a.png").is_err() && exr_path("exr").is_err() && exr_path("a.EXR").is_ok());
    }
    #[test]
    fn options_that_contradict_each_other_are_refused() {
        let parse = |args: &str| Cli::try_parse_from(args.split(' ')).map(drop);
        assert!(parse("manylight render a.xml --passes 3 --exposure -1").is_ok());
        assert!(parse("manylight render a.xml --passes 3 --time 3s").is_err());
        assert!(parse("manylight render a.xml --passes 0").is_err());
        assert!(parse("manylight scene many-lamps --lamps 10 -o dir").is_ok());
    }
}
