//! `manylight diff`.

use crate::args::Diff;
use crate::failure::Failure;
use crate::output::say;
use manylight_render::files::read_exr;
use manylight_report::{Difference, ImageView, compare};
use std::path::Path;

/// Compares two images.
pub fn run(args: &Diff) -> Result<(), Failure> {
    let difference = difference(&args.image, &args.reference)?;
    if args.json {
        say(difference.to_json()?);
    } else {
        say(difference.to_string().trim_end());
    }
    match args.fail_above {
        Some(limit) => check(&difference, limit, &args.image),
        None => Ok(()),
    }
}

fn difference(image: &Path, reference: &Path) -> Result<Difference, Failure> {
    let (a, b) = (read_exr(image)?.image, read_exr(reference)?.image);
    let about = |e| Failure::Mistake(format!("{} and {}: {e}", image.display(), reference.display()));
    ImageView::new(a.width, a.height, &a.pixels)
        .and_then(|a| compare(&a, &ImageView::new(b.width, b.height, &b.pixels)?))
        .map_err(about)
}

/// Pixels that are not finite are in no mean: an image that has some where the reference has none fails whatever the limit,
/// and so does every image that differs from a black reference.
fn check(difference: &Difference, limit: f64, image: &Path) -> Result<(), Failure> {
    let fail = |what: String| Err(Failure::CheckFailed(format!("{}: {what}", image.display())));
    let broken = difference.image.nan + difference.image.infinite;
    match difference.relmse {
        _ if broken > 0 => fail(format!("{broken} pixels are not finite")),
        Some(relmse) if relmse <= limit => Ok(()),
        Some(relmse) => fail(format!("relMSE {relmse:.6e} is above {limit:e}")),
        None if difference.rmse == 0.0 => Ok(()),
        None => fail("the reference is black and the image is not".into()),
    }
}
