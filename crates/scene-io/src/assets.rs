//! The files that a scene names: each read once, all in parallel.

use crate::document::{Class, Document, Object, Value};
use crate::mesh::{RawMesh, obj, ply, serialized};
use crate::vol::{self, RawGrid};
use crate::xml::Folders;
use crate::{Loading, diagnostic, image};
use manylight_scene::Bitmap;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Larger files than this are not scenes. [bytes]
pub(crate) const MOST_BYTES: u64 = 16 << 30;

/// What is in a file, and how it is to be understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Kind {
    Obj,
    Ply,
    /// The mesh of an index in the file.
    Serialized(u32),
    Grid,
    /// `raw`: values are not colours, they are taken as they are.
    Image {
        raw: bool,
    },
}

/// A failure: message and help.
pub(crate) type Failure = (String, Option<String>);
type Key = (PathBuf, Kind);

enum Content {
    Mesh(RawMesh),
    /// And the least and largest value of its channels.
    Image(Arc<Bitmap>, [f32; 2]),
    Grid(RawGrid),
}

/// All files, by path and kind.
pub(crate) struct Assets<'a> {
    folders: &'a Folders,
    content: HashMap<Key, Result<Content, Failure>>,
    /// In the order in which the scene names them.
    pub(crate) paths: Vec<PathBuf>,
}

impl<'a> Assets<'a> {
    /// Reads every mesh and image that the document names.
    pub(crate) fn read(document: &Document, folders: &'a Folders, watch: &(dyn Fn(Loading) + Sync)) -> Self {
        let mut keys: Vec<Key> = Vec::new();
        let mut known = HashSet::new();
        for object in document.objects() {
            if let Some((name, kind)) = wanted(object) {
                let key = (folders.find(name), kind);
                if known.insert(key.clone()) {
                    keys.push(key);
                }
            }
        }
        let (done, all) = (AtomicUsize::new(0), keys.len());
        let read = |(path, kind): &Key| {
            let content = read_one(path, *kind);
            watch(Loading::Files { done: 1 + done.fetch_add(1, Ordering::Relaxed), all });
            content
        };
        // One at a time: they are of very different sizes.
        let content: Vec<_> = keys.par_iter().with_max_len(1).map(read).collect();
        let mut listed = HashSet::new();
        let paths = keys.iter().map(|(path, _)| path.clone()).filter(|path| listed.insert(path.clone())).collect();
        Assets { folders, content: keys.into_iter().zip(content).collect(), paths }
    }
    pub(crate) fn mesh(&self, name: &str, kind: Kind) -> Result<&RawMesh, Failure> {
        match self.content.get(&(self.folders.find(name), kind)) {
            Some(Ok(Content::Mesh(mesh))) => Ok(mesh),
            Some(Err(failure)) => Err(failure.clone()),
            _ => Err((format!("`{name}` was not read"), None)),
        }
    }
    pub(crate) fn grid(&self, name: &str) -> Result<&RawGrid, Failure> {
        match self.content.get(&(self.folders.find(name), Kind::Grid)) {
            Some(Ok(Content::Grid(grid))) => Ok(grid),
            Some(Err(failure)) => Err(failure.clone()),
            _ => Err((format!("`{name}` was not read"), None)),
        }
    }
    /// And the least and largest value of its channels.
    pub(crate) fn image(&self, name: &str, raw: bool) -> Result<(Arc<Bitmap>, [f32; 2]), Failure> {
        match self.content.get(&(self.folders.find(name), Kind::Image { raw })) {
            Some(Ok(Content::Image(image, extent))) => Ok((image.clone(), *extent)),
            Some(Err(failure)) => Err(failure.clone()),
            _ => Err((format!("`{name}` was not read"), None)),
        }
    }
}

/// The file that an object is made from.
fn wanted(object: &Object) -> Option<(&str, Kind)> {
    let kind = match (object.class, object.plugin.as_str()) {
        (Class::Shape, "obj") => Kind::Obj,
        (Class::Shape, "ply") => Kind::Ply,
        (Class::Shape, "serialized") => Kind::Serialized(match object.value("shape_index") {
            Some(Value::Integer(i)) => u32::try_from(*i).ok()?,
            _ => 0,
        }),
        (Class::Volume, "gridvolume") => Kind::Grid,
        (Class::Texture, "bitmap") => Kind::Image { raw: object.value("raw") == Some(&Value::Boolean(true)) },
        (Class::Emitter, "envmap") => Kind::Image { raw: false },
        _ => return None,
    };
    match object.value("filename") {
        Some(Value::Text(name)) => Some((name, kind)),
        _ => None,
    }
}

fn read_one(path: &Path, kind: Kind) -> Result<Content, Failure> {
    let shown = path.file_name().map_or_else(|| path.to_string_lossy(), |n| n.to_string_lossy()).into_owned();
    let bytes = || read_bytes(path);
    let result = match kind {
        // A part of a file that may hold all meshes of a scene.
        Kind::Serialized(index) => serialized::read(&mut BufReader::new(open(path)?), index).map(Content::Mesh),
        Kind::Obj => obj::read(&bytes()?).map(Content::Mesh),
        Kind::Ply => ply::read(&bytes()?).map(Content::Mesh),
        Kind::Grid => vol::read(&bytes()?).map(Content::Grid),
        Kind::Image { raw } => {
            image::read(&bytes()?, raw).map(|(image, extent)| Content::Image(Arc::new(image), extent))
        }
    };
    result.map_err(|e| (format!("`{shown}`: {e}"), None))
}

/// The bytes of a regular file of a bounded size.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let read = open(path)?.read_to_end(&mut bytes);
    read.map_err(|e| (format!("cannot read `{}`: {e}", path.display()), None))?;
    Ok(bytes)
}

/// A regular file of a bounded size.
fn open(path: &Path) -> Result<File, Failure> {
    let shown = path.display();
    let meta = std::fs::metadata(path).map_err(|e| (format!("cannot read `{shown}`: {e}"), near_file(path)))?;
    if !meta.is_file() {
        return Err((format!("cannot read `{shown}`: it is not a file"), None));
    }
    if meta.len() > MOST_BYTES {
        return Err((format!("cannot read `{shown}`: its {} bytes are more than {MOST_BYTES}", meta.len()), None));
    }
    File::open(path).map_err(|e| (format!("cannot read `{shown}`: {e}"), None))
}

/// A file beside the missing one that may have been meant.
fn near_file(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let directory = path.parent()?;
    let entries = std::fs::read_dir(if directory.as_os_str().is_empty() { Path::new(".") } else { directory }).ok()?;
    let mut names: Vec<String> = entries.take(10_000).filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    diagnostic::nearest(name, names.iter().map(String::as_str)).map(|near| format!("did you mean `{near}`?"))
}
