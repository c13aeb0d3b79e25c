//! Files that are there whole or not at all.

use crate::RenderError;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes `bytes` to a temporary file beside `path`, makes sure it is on the disk, and renames it to `path`. Whatever
/// fails, `path` holds either what it held before or all of `bytes`, and the temporary file is gone.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), RenderError> {
    write_with(path, |file| file.write_all(bytes)).map_err(|e| RenderError::write(path, e))
}

/// Whether [`write_atomically`] can write here: tried out with a temporary file, before hours of rendering depend on it.
pub fn check_writable(path: &Path) -> Result<(), RenderError> {
    temporary_beside(path).map(drop).map_err(|e| RenderError::write(path, e))
}

fn write_with(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let mut temporary = temporary_beside(path)?;
    fill(temporary.as_file_mut())?;
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|e| e.error)?;
    sync_directory(path)
}

fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    if path.file_name().is_none() {
        return Err(io::Error::other("this is not the name of a file"));
    }
    // A rename would replace a device or a pipe by a file, and fails on a directory only once all work is done.
    if fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        return Err(io::Error::other("it exists and is not a regular file"));
    }
    let directory = directory_of(path);
    if !directory.is_dir() {
        return Err(io::Error::other(format!("there is no directory {}", directory.display())));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".manylight-").suffix(".part");
    // Temporary files are private by default; images are as readable as the user's other new files.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // What tempfile says names the temporary file, which nobody knows.
    builder.tempfile_in(directory).map_err(|e| e.kind().into())
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The rename itself reaches the disk with the directory. Only Unix lets one open a directory to say so.
fn sync_directory(path: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(directory_of(path))?.sync_all() } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(directory: &Path) -> Vec<String> {
        let names = fs::read_dir(directory).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        names.collect()
    }
    #[test]
    fn a_write_that_fails_half_way_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("image.exr");
        write_atomically(&path, b"old").unwrap();
        let failed = write_with(&path, |file| {
            file.write_all(b"half of the n")?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "disk full");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names_in(directory.path()), ["image.exr"]);
    }
    #[test]
    fn a_file_is_replaced_whole() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("image.exr");
        write_atomically(&path, b"a longer old file").unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names_in(directory.path()), ["image.exr"]);
    }
    #[test]
    fn an_unwritable_place_is_found_out_beforehand_and_named() {
        let directory = tempfile::tempdir().unwrap();
        let missing = directory.path().join("nowhere").join("image.exr");
        for path in [missing.as_path(), directory.path(), Path::new("..")] {
            let before = check_writable(path).unwrap_err().to_string();
            assert_eq!(before, write_atomically(path, b"").unwrap_err().to_string());
            assert!(before.contains(&path.display().to_string()), "{before}");
        }
        let fine = directory.path().join("image.exr");
        check_writable(&fine).unwrap();
        assert!(names_in(directory.path()).is_empty(), "trying out leaves nothing behind");
    }
    #[cfg(unix)]
    #[test]
    fn a_device_is_not_replaced_by_a_file() {
        assert!(write_atomically(Path::new("/dev/null"), b"").unwrap_err().to_string().contains("regular file"));
    }
    #[cfg(unix)]
    #[test]
    fn a_new_file_is_as_readable_as_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let (ours, plain) = (directory.path().join("ours"), directory.path().join("plain"));
        write_atomically(&ours, b"").unwrap();
        fs::write(&plain, b"").unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(ours), mode(plain));
    }
}
