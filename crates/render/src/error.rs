//! What can go wrong.

use manylight_framework::PassError;
use std::io;
use std::path::{Path, PathBuf};

/// Why an image could not be rendered, read or written. Each message is one sentence that names the thing.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The file could not be written; what stood there before still does.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is not an OpenEXR image that can be read here.
    #[error("{} is not a readable OpenEXR image: {reason}", path.display())]
    NotAnImage {
        /// The file.
        path: PathBuf,
        /// What is the matter with it.
        reason: String,
    },
    /// Two images that should have the same size do not.
    #[error("an image of {}x{} pixels cannot be added to one of {}x{}", found.0, found.1, expected.0, expected.1)]
    Size {
        /// Width and height so far.
        expected: (usize, usize),
        /// Width and height of the other image.
        found: (usize, usize),
    },
    /// The threads could not be started.
    #[error("the threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Cancelled before there was anything to show.
    #[error("interrupted before the first pixel: nothing is written")]
    Interrupted,
    /// The method gave up.
    #[error(transparent)]
    Pass(PassError),
}

impl RenderError {
    pub(crate) fn write(path: &Path, source: impl Into<io::Error>) -> Self {
        RenderError::Write { path: path.into(), source: source.into() }
    }
    pub(crate) fn read(path: &Path, source: io::Error) -> Self {
        RenderError::Read { path: path.into(), source }
    }
    pub(crate) fn not_an_image(path: &Path, reason: impl ToString) -> Self {
        RenderError::NotAnImage { path: path.into(), reason: reason.to_string() }
    }
}
