//! `manylight render --frames`.

use super::{Rendered, Target, default_output, image, spares};
use crate::args::{Frames, Render};
use crate::failure::Failure;
use crate::output::say;
use manylight_render::files::{Animation, Exposure};
use manylight_report::{ImageView, Sequence};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What stands for the number of a frame.
const FRAME: &str = "$frame";
/// The scene's parameter that is the number, if no `-D` says it.
const PARAMETER: &str = "frame";

/// Renders frames one by one, all at the first one's exposure.
pub fn run(args: &Render, frames: Frames, cancel: &Arc<AtomicBool>) -> Result<(), Failure> {
    let output = pattern(&args.output.clone().unwrap_or_else(|| default_output(&args.scene)))?;
    let stats = args.stats.as_deref().map(pattern).transpose()?;
    let outputs = Outputs { image: output, stats };
    let all = named(&outputs.image, "animation", "png");
    for number in frames.first..=frames.last {
        Target::new(&of_frame(args, &outputs, frames, number))?;
    }
    manylight_render::files::check_writable(&all)?;

    let (mut sequence, mut animation, mut exposure) = (Sequence::default(), Animation::default(), args.exposure);
    let mut interrupted = false;
    for number in frames.first..=frames.last {
        let args = Render { exposure, ..of_frame(args, &outputs, frames, number) };
        let Rendered { image, ev, whole, files } = match image(&args, cancel) {
            // What there is can be played.
            Err(Failure::InterruptedEarly) if number > frames.first => {
                interrupted = true;
                break;
            }
            rendered => rendered?,
        };
        spares([all.as_path()].into_iter(), &files)?;
        if !whole {
            interrupted = true;
            break;
        }
        exposure = Exposure::Ev(ev);
        if let Err(e) = sequence.add(&ImageView::new(image.width, image.height, &image.pixels)?) {
            return Err(Failure::Mistake(format!("frame {number} has another size than the first: {e}")));
        }
        animation.add(&image, ev);
    }
    if interrupted && animation.frames() < 2 {
        return Err(Failure::Interrupted);
    }
    animation.write(&all)?;
    if !args.quiet {
        say(format!("wrote {}", all.display()));
        if let Some(steadiness) = sequence.steadiness() {
            say(steadiness);
        }
    }
    if interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Files of each frame, with a place for its number.
struct Outputs {
    image: PathBuf,
    stats: Option<PathBuf>,
}

/// The arguments that render one frame alone.
fn of_frame(args: &Render, outputs: &Outputs, frames: Frames, number: u32) -> Render {
    let digits = frames.digits;
    let written = format!("{number:0digits$}");
    // Names of images sort as the frames do.
    let sorted = format!("{number:0width$}", width = digits.max(frames.last.to_string().len()));
    let mut defines: Vec<(String, String)> =
        args.defines.iter().map(|(k, v)| (k.clone(), v.replace(FRAME, &written))).collect();
    if defines == args.defines && !defines.iter().any(|(k, _)| k == PARAMETER) {
        defines.push((PARAMETER.into(), written));
    }
    let filled = |path: &Path| PathBuf::from(path.to_string_lossy().replace(FRAME, &sorted));
    Render {
        output: Some(filled(&outputs.image)),
        stats: outputs.stats.as_deref().map(filled),
        seed: args.seed.wrapping_add(number.into()),
        defines,
        frames: None,
        scene: args.scene.clone(),
        method: args.method.clone(),
        parameters: args.parameters.clone(),
        ..*args
    }
}

/// A file of each frame, with a place for the number.
fn pattern(file: &Path) -> Result<PathBuf, Failure> {
    let (Some(name), Some(stem), Some(extension)) =
        (file.to_str(), file.file_stem().and_then(OsStr::to_str), file.extension().and_then(OsStr::to_str))
    else {
        let what = format!("{}: --frames needs file names in Unicode, with an extension", file.display());
        return Err(Failure::Mistake(what));
    };
    Ok(if name.contains(FRAME) { file.into() } else { file.with_file_name(format!("{stem}-{FRAME}.{extension}")) })
}

/// The name of a file that belongs to all frames.
fn named(pattern: &Path, what: &str, extension: &str) -> PathBuf {
    PathBuf::from(pattern.to_string_lossy().replace(FRAME, what)).with_extension(extension)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_is_put_where_the_output_says_or_behind_it() {
        assert_eq!(pattern(Path::new("a/fire.exr")).unwrap(), Path::new("a/fire-$frame.exr"));
        assert_eq!(pattern(Path::new("a/$frame/x.exr")).unwrap(), Path::new("a/$frame/x.exr"));
        assert_eq!(named(Path::new("a/fire-$frame.exr"), "animation", "png"), Path::new("a/fire-animation.png"));
    }
}
