//! Reads Mitsuba 3 XML, with its meshes and its textures, into a [`Scene`], and writes scenes ([`write()`]).
//!
//! What is understood is a subset; within it defaults and conventions are those of Mitsuba 3. What is not supported, unknown,
//! unused or wrong is an error with its place, and all errors of a file are reported at once.
//!
//! ```
//! use manylight_scene_io::{LoadOptions, parse};
//! let text = r#"<scene version="3.0.0">
//!     <sensor type="perspective"/>
//!     <shape type="sphere"><float name="radios" value="2"/></shape>
//! </scene>"#;
//! let errors = parse(text, "ball.xml".as_ref(), ".".as_ref(), &LoadOptions::default()).unwrap_err();
//! assert_eq!(errors.to_string(), r#"ball.xml:3:26: the shape `sphere` has no property `radios`
//!   3 |     <shape type="sphere"><float name="radios" value="2"/></shape>
//!     |                          ^
//!   help: did you mean `radius`?"#);
//! ```

mod assets;
mod build;
mod diagnostic;
mod document;
pub mod formats;
mod image;
mod ior;
mod mesh;
#[cfg(test)]
mod mutation;
pub mod parametric;
mod query;
mod spectrum;
mod value;
mod vol;
mod write;
mod xml;

pub use diagnostic::{Diagnostic, Errors};
pub use write::{WriteError, write};

use diagnostic::{At, Report};
use manylight_scene::{Filter, Scene};
use std::path::{Path, PathBuf};

/// What may be set from outside the file.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Values of `$name` (`-D name=value`); they win over `<default>`. One that the file does not ask for is an error.
    pub defines: Vec<(String, String)>,
    /// Width and height instead of the film's, in pixels.
    pub size: Option<(u32, u32)>,
    /// Pixel filter instead of the film's.
    pub filter: Option<Filter>,
}

/// A scene and what is known about its file.
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What is legal and yet worth knowing, each with its place.
    pub warnings: Vec<String>,
    /// Every file that was read: the scene's first, then those it includes, then meshes and images in the order in which it names them.
    pub files: Vec<PathBuf>,
}

impl std::fmt::Debug for Loaded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Loaded").field("files", &self.files).field("warnings", &self.warnings).finish_non_exhaustive()
    }
}

/// Where loading stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loading {
    /// Meshes, images and grids that are read, of how many.
    Files {
        /// Read.
        done: usize,
        /// All.
        all: usize,
    },
    /// All are read: shapes are placed, and the tree over them is built.
    Building,
}

/// Loads a scene file. Files that it names are relative to its folder.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, Errors> {
    load_watched(path, options, &|_| {})
}

/// The same, telling how far it is: by several threads, in any order.
pub fn load_watched(path: &Path, options: &LoadOptions, watch: &(dyn Fn(Loading) + Sync)) -> Result<Loaded, Errors> {
    let nowhere = |(message, help)| {
        let mut report = Report::default();
        report.add_source(path, String::new());
        report.error_nowhere(message, help);
        report.errors()
    };
    let bytes = assets::read_bytes(path).map_err(nowhere)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let mut report = Report::default();
        let source = report.add_source(path, String::from_utf8_lossy(e.as_bytes()).into_owned());
        report.error(At { source, offset: at }, "the file is not UTF-8 text");
        report.errors()
    })?;
    let base_dir = path.parent().unwrap_or(Path::new(""));
    let mut loaded = parse_watched(&text, path, base_dir, options, watch)?;
    loaded.files.insert(0, path.to_owned());
    Ok(loaded)
}

/// Reads a scene from a text. Messages name it `path`; files that it names are relative to `base_dir`.
pub fn parse(text: &str, path: &Path, base_dir: &Path, options: &LoadOptions) -> Result<Loaded, Errors> {
    parse_watched(text, path, base_dir, options, &|_| {})
}

fn parse_watched(
    text: &str,
    path: &Path,
    base_dir: &Path,
    options: &LoadOptions,
    watch: &(dyn Fn(Loading) + Sync),
) -> Result<Loaded, Errors> {
    let mut report = Report::default();
    let source = report.add_source(path, text.to_owned());
    let mut defines = xml::Defines::new(&options.defines);
    let mut folders = xml::Folders::new(base_dir, path);
    let mut reading = xml::Reading { report: &mut report, defines: &mut defines, folders: &mut folders };
    let root = xml::read(&mut reading, source);
    let loaded = root.and_then(|root| {
        let document = document::Document::read(root, &folders, &report)?;
        defines.report_unused(&report);
        let assets = assets::Assets::read(&document, &folders, watch);
        watch(Loading::Building);
        let mut loaded = build::build(&document, &report, &assets, options)?;
        loaded.files = folders.included.iter().chain(&assets.paths).cloned().collect();
        Some(loaded)
    });
    match loaded {
        Some(mut loaded) if !report.has_errors() => {
            loaded.warnings = report.take_warnings();
            Ok(loaded)
        }
        _ => Err(report.errors()),
    }
}
