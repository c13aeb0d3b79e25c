//! Scenes that a program writes, as large as one asks for. The files are as any other scene's, for Mitsuba 3 as well.
//!
//! ```
//! use manylight_scene_io::{LoadOptions, load, parametric};
//! let dir = tempfile::tempdir()?;
//! let files = parametric::write("many-lamps", &[("lamps".into(), "12".into())], dir.path())?;
//! let loaded = load(&files[0], &LoadOptions::default())?;
//! assert_eq!(loaded.scene.emitters().len(), 12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod many_lamps;

use crate::diagnostic::nearest;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A parameter of a parametric scene: a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneParam {
    /// As written in `--name value`.
    pub name: &'static str,
    /// Taken if it is not given.
    pub default: u64,
    /// Smallest.
    pub min: u64,
    /// Largest.
    pub max: u64,
    /// What it does, in a sentence.
    pub help: &'static str,
}

/// A scene that is written by a program, as data.
#[derive(Clone, Copy, Debug)]
pub struct ParametricScene {
    /// Its name.
    pub name: &'static str,
    /// What it is for, in a sentence.
    pub summary: &'static str,
    /// What can be chosen.
    pub params: &'static [SceneParam],
    /// From values in the order of `params` to files; the scene's own comes first.
    files: fn(&[u64]) -> Vec<NewFile>,
}

/// A file's name and content.
type NewFile = (String, Vec<u8>);

/// Why a parametric scene could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ParametricError {
    /// There is no such scene.
    #[error("there is no parametric scene `{name}`: expected {expected}")]
    Scene {
        /// As given.
        name: String,
        /// Those that are there.
        expected: String,
    },
    /// The scene has no such parameter.
    #[error("the scene `{scene}` has no parameter `{name}`{}; it has {expected}", did_you_mean(near))]
    Param {
        /// The scene.
        scene: &'static str,
        /// As given.
        name: String,
        /// The nearest name.
        near: Option<&'static str>,
        /// Those that it has.
        expected: String,
    },
    /// A value does not fit.
    #[error("{name}={value}: expected a whole number from {min} to {max}")]
    Value {
        /// The parameter.
        name: &'static str,
        /// As given.
        value: String,
        /// Smallest.
        min: u64,
        /// Largest.
        max: u64,
    },
    /// A parameter is given twice.
    #[error("parameter `{0}` is given twice: give it once")]
    Twice(&'static str),
    /// A file or its folder could not be written.
    #[error("cannot write `{}`: {error}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
}

fn did_you_mean(near: &Option<&'static str>) -> String {
    near.map_or(String::new(), |n| format!(": did you mean `{n}`?"))
}

/// All parametric scenes.
pub fn parametric_scenes() -> &'static [ParametricScene] {
    &[many_lamps::SCENE]
}

/// Writes a scene into a folder, which is made if it is not there: `scene.xml` and the meshes that it names. The files
/// appear whole or not at all, `scene.xml` last. Returns what was written, `scene.xml` first.
pub fn write(name: &str, params: &[(String, String)], dir: &Path) -> Result<Vec<PathBuf>, ParametricError> {
    let scene = parametric_scenes().iter().find(|s| s.name == name).ok_or_else(|| ParametricError::Scene {
        name: name.into(),
        expected: list(parametric_scenes().iter().map(|s| s.name)),
    })?;
    let values = scene.values(params)?;
    std::fs::create_dir_all(dir).map_err(|error| ParametricError::Write { path: dir.into(), error })?;
    let files = (scene.files)(&values);
    for (name, content) in files.iter().rev() {
        let path = dir.join(name);
        write_whole(&path, dir, content).map_err(|error| ParametricError::Write { path, error })?;
    }
    Ok(files.into_iter().map(|(name, _)| dir.join(name)).collect())
}

impl ParametricScene {
    /// The values of all parameters, in their order.
    fn values(&self, given: &[(String, String)]) -> Result<Vec<u64>, ParametricError> {
        let mut values = vec![None; self.params.len()];
        for (name, value) in given {
            let i = self.params.iter().position(|p| p.name == name).ok_or_else(|| ParametricError::Param {
                scene: self.name,
                name: name.clone(),
                near: nearest(name, self.params.iter().map(|p| p.name)),
                expected: list(self.params.iter().map(|p| p.name)),
            })?;
            let SceneParam { name, min, max, .. } = self.params[i];
            let number = value.parse().ok().filter(|n| (min..=max).contains(n));
            let number = number.ok_or_else(|| ParametricError::Value { name, value: value.clone(), min, max })?;
            if values[i].replace(number).is_some() {
                return Err(ParametricError::Twice(name));
            }
        }
        Ok(values.iter().zip(self.params).map(|(v, p)| v.unwrap_or(p.default)).collect())
    }
}

fn list(names: impl Iterator<Item = &'static str>) -> String {
    names.map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
}

/// Writes to a temporary file in the same folder, and renames it once it is on the disk.
pub(crate) fn write_whole(path: &Path, dir: &Path, content: &[u8]) -> std::io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".manylight-").suffix(".part");
    // Temporary files are private by default; a scene is as readable as the user's other new files.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporary = builder.tempfile_in(dir)?;
    temporary.write_all(content)?;
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|e| e.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(scene: &str, params: &[(&str, &str)]) -> String {
        let dir = tempfile::tempdir().unwrap();
        let params: Vec<_> = params.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        let error = write(scene, &params, dir.path()).unwrap_err().to_string();
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0, "nothing is written after a mistake");
        error
    }

    #[test]
    fn a_mistake_says_what_was_expected() {
        assert_eq!(error("many-lamp", &[]), "there is no parametric scene `many-lamp`: expected `many-lamps`");
        let unknown = error("many-lamps", &[("lamp", "3")]);
        assert_eq!(
            unknown,
            "the scene `many-lamps` has no parameter `lamp`: did you mean `lamps`?; it has `lamps`, `seed`"
        );
        for value in ["0", "1000001", "-1", "ten", "", "1e3"] {
            let message = error("many-lamps", &[("lamps", value)]);
            assert_eq!(message, format!("lamps={value}: expected a whole number from 1 to 1000000"));
        }
        let twice = error("many-lamps", &[("lamps", "3"), ("lamps", "4")]);
        assert_eq!(twice, "parameter `lamps` is given twice: give it once");
    }
    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let message = write("many-lamps", &[], file.path()).unwrap_err().to_string();
        assert!(message.starts_with(&format!("cannot write `{}`: ", file.path().display())), "{message}");
    }
    #[test]
    fn every_default_is_in_its_range_and_no_name_stands_twice() {
        for scene in parametric_scenes() {
            for p in scene.params {
                assert!((p.min..=p.max).contains(&p.default), "{}: {}", scene.name, p.name);
                assert_eq!(scene.params.iter().filter(|q| q.name == p.name).count(), 1);
            }
        }
    }
}
