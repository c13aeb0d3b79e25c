//! The reference of a comparison.

use crate::args::Compare;
use crate::failure::Failure;
use manylight_framework::Image;
use manylight_render::files::{Attribute, Picture, read_exr};
use manylight_report::ImageView;
use std::path::{Path, PathBuf};

/// An image that errors are measured against.
pub struct Truth {
    /// Its file.
    pub path: PathBuf,
    /// Its pixels.
    pub image: Image,
    /// The seed that it was rendered with, if it says so.
    seed: Option<u64>,
    /// Their standard errors: its own layer `stderr`, or the file `NAME.stderr.exr` beside it.
    pub std_error: Option<Image>,
}

impl Truth {
    /// The reference that was named, or the one beside the scene.
    pub fn find(args: &Compare) -> Result<Truth, Failure> {
        let beside = args.scene.with_file_name("reference.exr");
        match &args.reference {
            Some(path) => Truth::read(path),
            None if beside.is_file() => Truth::read(&beside),
            None => Err(Failure::Mistake(format!(
                "errors are measured against a reference, and there is no {}: name one by --reference, or make one: `manylight render {} \
                 --method path --time 10m -o {}`",
                beside.display(),
                args.scene.display(),
                beside.display()
            ))),
        }
    }
    fn read(path: &Path) -> Result<Truth, Failure> {
        let Picture { image, standard_error, attributes, .. } = read_exr(path)?;
        let seed = match attributes.get("seed") {
            Some(Attribute::Text(seed)) => seed.parse().ok(),
            _ => None,
        };
        let aside = path.with_extension("stderr.exr");
        let std_error = match standard_error {
            None if aside.is_file() => Some(read_exr(&aside)?.image),
            own => own,
        };
        let size = |i: &Image| (i.width, i.height);
        if let Some(other) = std_error.as_ref().filter(|s| size(s) != size(&image)) {
            return Err(Failure::Mistake(format!(
                "{} is {}x{} pixels, and its standard error in {} {}x{}",
                path.display(),
                image.width,
                image.height,
                aside.display(),
                other.width,
                other.height
            )));
        }
        Ok(Truth { path: path.into(), image, seed, std_error })
    }
    /// A run with the reference's random numbers would make its errors too, and so look better than it is.
    pub fn differs_from(&self, args: &Compare) -> Result<(), Failure> {
        match self.seed {
            Some(seed) if seed.wrapping_sub(args.seed) < args.runs.into() => Err(Failure::Mistake(format!(
                "{} was rendered with seed {seed}, which one of the runs would use again: say --seed {}",
                self.path.display(),
                seed.wrapping_add(1)
            ))),
            _ => Ok(()),
        }
    }
    /// The size to render at: the reference's, which the user's own has to be.
    pub fn size(&self, asked: Option<(u32, u32)>) -> Result<(u32, u32), Failure> {
        let own = (self.image.width as u32, self.image.height as u32);
        match asked {
            Some((w, h)) if (w, h) != own => Err(Failure::Mistake(format!(
                "{} is {}x{} pixels, and --size says {w}x{h}: leave --size out, or name another --reference",
                self.path.display(),
                own.0,
                own.1
            ))),
            _ => Ok(own),
        }
    }
}

/// An image as the crate `report` sees it.
pub fn view(image: &Image) -> Result<ImageView<'_>, Failure> {
    Ok(ImageView::new(image.width, image.height, &image.pixels)?)
}
