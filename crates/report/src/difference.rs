//! What the comparison of two images found, as data.

use crate::{Block, Flip, ReportError};
use serde::Serialize;
use std::fmt;

/// One of the two images.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ImageSummary {
    /// Pixels with a NaN in any channel.
    pub nan: usize,
    /// Pixels with an infinity in any channel, and no NaN.
    pub infinite: usize,
    /// Column and row of the first pixel that is not finite.
    pub first_non_finite: Option<[usize; 2]>,
    /// Mean of each channel over the pixels compared.
    pub mean: [f64; 3],
}

/// A pixel with a large error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WorstPixel {
    /// Column.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// What the image has there.
    pub image: [f32; 3],
    /// What the reference has there.
    pub reference: [f32; 3],
    /// sqrt(mean over channels of (I - R)^2 / (R^2 + eps)); sqrt(mean of (I - R)^2) if the reference is black.
    pub error: f64,
}

/// Differences of an image I and a reference R. Means are over the pixels compared and their three channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Pixels that are finite in both images. All sums are over these.
    pub compared: usize,
    /// Pixels that are NaN or infinite in either: counted here, in no sum.
    pub excluded: usize,
    /// The image.
    pub image: ImageSummary,
    /// The reference.
    pub reference: ImageSummary,
    /// sqrt(mean (I - R)^2).
    pub rmse: f64,
    /// mean (I - R)^2 / (R^2 + eps). `None` if the reference is black. The reference's own noise is in it;
    /// `compare_halves` has it without.
    pub relmse: Option<f64>,
    /// eps = 0.01 (mean R)^2.
    pub relmse_epsilon: f64,
    /// mean |I - R| / (|R| + 0.01 |mean R|). `None` if the reference is black.
    pub mape: Option<f64>,
    /// mean 2 |I - R| / (|I| + |R|), where 0 / 0 is 0: from 0 to 2, symmetric.
    pub smape: f64,
    /// 99.9th percentile (nearest rank) of the pixels' errors as in `WorstPixel`: blotches and fireflies, which RMSE hides.
    pub percentile_999: f64,
    /// The pixels with the largest errors, largest first.
    pub worst: Vec<WorstPixel>,
    /// Means of both over tiles, if they were asked for.
    pub blocks: Vec<Block>,
    /// What a viewer would see.
    pub flip: Flip,
}

impl Difference {
    /// As JSON. Numbers that are not finite become null.
    pub fn to_json(&self) -> Result<String, ReportError> {
        Ok(serde_json::to_string_pretty(self)?)
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let rgb = |c: [f64; 3]| c.map(|x| format!("{x:>12.6}")).concat();
        let optional = |x: Option<f64>| x.map_or("none: the reference is black".to_owned(), |x| format!("{x:.6e}"));
        writeln!(f, "{:<12}{} x {} pixels, {} compared", "size", self.width, self.height, self.compared)?;
        for (name, image) in [("image", &self.image), ("reference", &self.reference)] {
            write!(f, "{name:<12}mean{}", rgb(image.mean))?;
            if let Some([x, y]) = image.first_non_finite {
                write!(f, "; {} NaN, {} infinite, the first at ({x}, {y})", image.nan, image.infinite)?;
            }
            writeln!(f)?;
        }
        writeln!(f, "{:<12}{:.6e}", "RMSE", self.rmse)?;
        writeln!(f, "{:<12}{} (eps {:.3e})", "relMSE", optional(self.relmse), self.relmse_epsilon)?;
        writeln!(f, "{:<12}{}", "MAPE", optional(self.mape))?;
        writeln!(f, "{:<12}{:.6e}", "sMAPE", self.smape)?;
        writeln!(f, "{:<12}{:.6e}", "99.9 %", self.percentile_999)?;
        match &self.flip {
            Flip::Measured { mean, exposure } => writeln!(f, "{:<12}{mean:.6} (exposure {exposure:+.2})", "FLIP")?,
            Flip::Absent(why) => writeln!(f, "{:<12}{why}", "FLIP")?,
        }
        for p in &self.worst {
            let place = format!("({}, {})", p.x, p.y);
            let (image, reference) = (rgb(p.image.map(f64::from)), rgb(p.reference.map(f64::from)));
            writeln!(f, "{:<12}{place:<14}{image}  instead of{reference}  error {:.3e}", "worst", p.error)?;
        }
        Ok(())
    }
}
