//! Loading a scene, and saying on stderr how far it is where that takes a while.

use crate::failure::Failure;
use indicatif::{ProgressBar, ProgressStyle};
use manylight_scene_io::{LoadOptions, Loaded, Loading, load_watched};
use std::io::IsTerminal;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Nobody is told of what takes less than this.
const PATIENCE: Duration = Duration::from_millis(500);
/// Where there is no terminal, time between two lines.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Loads a scene; what is wrong with it is the user's mistake.
pub fn load(path: &Path, options: &LoadOptions, quiet: bool) -> Result<Loaded, Failure> {
    let start = Instant::now();
    let bar = (!quiet && std::io::stderr().is_terminal()).then(bar);
    // Of the next line. [ms]
    let next = AtomicU64::new(BETWEEN_LINES.as_millis() as u64);
    let loaded = load_watched(path, options, &|at| {
        let elapsed = start.elapsed();
        if let Some(bar) = bar.as_ref().filter(|_| elapsed >= PATIENCE) {
            if let Loading::Files { done, all } = at {
                bar.set_length(all as u64);
                bar.set_position(done as u64);
            }
            bar.set_message(line(at));
        }
        let (now, due) = (elapsed.as_millis() as u64, next.load(Ordering::Relaxed));
        let later = now + BETWEEN_LINES.as_millis() as u64;
        // Of several threads one says it.
        let mine = |_| next.compare_exchange(due, later, Ordering::Relaxed, Ordering::Relaxed).is_ok();
        if !quiet && bar.is_none() && Some(now).filter(|now| *now >= due).is_some_and(mine) {
            eprintln!("{}: {}", path.display(), line(at));
        }
    });
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    loaded.map_err(Failure::mistake)
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1);
    let style = ProgressStyle::with_template("{spinner} {bar:30} {wide_msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

fn line(at: Loading) -> String {
    match at {
        Loading::Files { done, all } => format!("{done} of {all} meshes and textures"),
        Loading::Building => "placing shapes".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_told_of_once_and_then_the_building() {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/scenes/veil.xml");
        let told = std::sync::Mutex::new(Vec::new());
        load_watched(&scene, &LoadOptions::default(), &|at| told.lock().unwrap().push(line(at))).unwrap();
        let mut told = told.into_inner().unwrap();
        assert_eq!(told.pop().unwrap(), "placing shapes");
        told.sort();
        // Colours, and normals.
        assert_eq!(told, ["1 of 2 meshes and textures", "2 of 2 meshes and textures"]);
    }
}
