//! Studies: methods x budgets x runs, as data.

mod columns;
mod noise;
mod summary;

pub use columns::{COLUMNS, Column};
pub use noise::{Noise, separate};
pub use summary::{Duel, Estimate, Summary, Verdict};

use crate::ReportError;
use serde::Serialize;

/// What a method may spend, from its start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cost {
    /// \[s\]
    Seconds(f64),
    /// Passes.
    Passes(u64),
}

impl Cost {
    /// Its number, in its own unit.
    pub fn value(self) -> f64 {
        match self {
            Cost::Seconds(s) => s,
            Cost::Passes(n) => n as f64,
        }
    }
}

impl std::fmt::Display for Cost {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Cost::Seconds(s) => write!(f, "{s} s"),
            Cost::Passes(1) => write!(f, "1 pass"),
            Cost::Passes(n) => write!(f, "{n} passes"),
        }
    }
}

/// One image: a method, at a budget, in a run. Errors are against the study's reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// As it was asked for, with its parameters.
    pub method: String,
    /// What it might spend; of an image from elsewhere, what it took.
    pub budget: Cost,
    /// From 0. All methods of a run have its seed, and took turns.
    pub run: u32,
    /// What all random numbers followed from; `None` of an image from elsewhere, and so on below.
    pub seed: Option<u64>,
    /// Complete passes.
    pub passes: Option<u64>,
    /// What it took. \[s\]
    pub seconds: f64,
    /// Of that, before the first tile of each pass: light paths, trees. \[s\]
    pub seconds_preparing: Option<f64>,
    /// From the camera.
    pub camera_rays: Option<u64>,
    /// Along paths.
    pub path_rays: Option<u64>,
    /// Between two points that may see each other.
    pub shadow_rays: Option<u64>,
    /// Virtual lights made.
    pub lights: Option<u64>,
    /// Samples that were NaN, infinite or negative (black in the image), or pixels that are in an image from elsewhere.
    pub non_finite: u64,
    /// mean (I - R)^2 / (R^2 + eps), eps = 0.01 (mean R)^2: the reference's noise is in it.
    pub relmse: f64,
    /// The same without the reference's variance, where that is known.
    pub relmse_net: f64,
    /// Of `relmse_net`, the part that more passes do not take away: may come out below zero. `None`: fewer than two passes.
    pub bias: Option<f64>,
    /// Of `relmse_net`, the part that they do.
    pub noise: Option<f64>,
    /// sqrt(mean (I - R)^2).
    pub rmse: f64,
    /// mean |I - R| / (|R| + 0.01 |mean R|).
    pub mape: f64,
    /// Mean LDR-FLIP at the study's exposure; `None` in a build without it.
    pub flip: Option<f64>,
    /// 99.9th percentile of the pixels' relative errors.
    pub percentile_999: f64,
    /// The image, if it was written.
    pub file: Option<String>,
}

/// A method of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Subject {
    /// As in [`Row::method`].
    pub method: String,
    /// What it promises, in a sentence.
    pub claim: String,
    /// All its parameters with their values.
    pub parameters: Vec<(String, String)>,
}

/// What was compared, with what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Study {
    /// The scene file.
    pub scene: String,
    /// Hash of the scene, hexadecimal.
    pub scene_hash: String,
    /// The reference image.
    pub reference: String,
    /// mean Var(R) / (R^2 + eps): the reference's own noise in `relmse`. `None`: it is not known, and not subtracted.
    pub reference_noise: Option<f64>,
    /// Standard deviation of what the reference's noise adds to `bias`, in all runs alike, for Gaussian noise independent from pixel to
    /// pixel: sqrt(2 sum Var(R)^2 / (R^2 + eps)^2) / n.
    pub reference_spread: Option<f64>,
    /// Of FLIP, and of the images to begin with. \[stops\]
    pub exposure: f32,
    /// Threads.
    pub threads: usize,
    /// What the others are measured by.
    pub baseline: String,
    /// The methods, in the order they were named, then images from elsewhere.
    pub subjects: Vec<Subject>,
    /// What they may spend, ascending.
    pub budgets: Vec<Cost>,
    /// All images.
    pub rows: Vec<Row>,
}

impl Study {
    /// The rows of a method at a budget, by run.
    pub fn rows<'a>(&'a self, method: &'a str, budget: Cost) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |r| r.method == method && r.budget == budget)
    }
    /// The rows as CSV, a line of names first: [`COLUMNS`].
    pub fn csv(&self) -> String {
        columns::csv(&self.rows)
    }
    /// All of it, with the summary and what the columns mean.
    pub fn json(&self) -> Result<String, ReportError> {
        let columns: serde_json::Map<_, _> = COLUMNS.iter().map(|c| (c.name.to_string(), c.about.into())).collect();
        let whole = serde_json::json!({ "study": self, "summary": self.summary(), "verdict": self.verdict(), "columns": columns });
        Ok(serde_json::to_string_pretty(&whole)?)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Methods whose relMSE is factor / seconds, with noise of 2 % that follows from names and numbers.
    pub fn study(methods: &[(&str, f64)], seconds: &[f64], runs: u32) -> Study {
        let mut rows = Vec::new();
        for (method, factor) in methods {
            for (run, t) in (0..runs).flat_map(|r| seconds.iter().map(move |t| (r, *t))) {
                let place = method.bytes().map(u64::from).sum::<u64>() * 1000 + u64::from(run) * 77 + t.to_bits() / 3;
                let mut noise = 0.0;
                for k in 0..12u64 {
                    let mixed = (place + k).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                    noise += ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64
                        / (1u64 << 53) as f64
                        - 0.5;
                }
                let error = factor / t * (0.02 * noise).exp();
                rows.push(Row {
                    method: (*method).into(),
                    budget: Cost::Seconds(t),
                    run,
                    seed: Some(run.into()),
                    passes: Some(t as u64),
                    seconds: t,
                    seconds_preparing: Some(0.1 * t),
                    camera_rays: Some(10),
                    path_rays: Some(20),
                    shadow_rays: Some(30),
                    lights: Some(5),
                    non_finite: 0,
                    relmse: error + 0.001,
                    relmse_net: error,
                    bias: Some(0.0),
                    noise: Some(error),
                    rmse: error.sqrt(),
                    mape: error.sqrt(),
                    flip: None,
                    percentile_999: 5.0 * error.sqrt(),
                    file: None,
                });
            }
        }
        let subject =
            |m: &(&str, f64)| Subject { method: m.0.into(), claim: "unbiased".into(), parameters: Vec::new() };
        Study {
            scene: "<scene>".into(),
            scene_hash: "0".into(),
            reference: "r.exr".into(),
            reference_noise: Some(0.001),
            reference_spread: Some(0.0001),
            exposure: 0.0,
            threads: 2,
            baseline: methods[0].0.into(),
            subjects: methods.iter().map(subject).collect(),
            budgets: seconds.iter().map(|t| Cost::Seconds(*t)).collect(),
            rows,
        }
    }
    #[test]
    fn a_page_shows_all_methods_and_no_name_becomes_markup() {
        let s = study(&[("a<b", 1.0), ("</script>", 2.0)], &[1.0, 2.0], 2);
        let pixels = [manylight_math::Spectrum::ONE; 6];
        let image = crate::ImageView::new(3, 2, &pixels).unwrap();
        let picture = |name: &str| crate::Picture { name: name.into(), caption: "x".into(), image };
        let page = s.page(&[picture("reference"), picture("</script>")]).unwrap();
        assert!(page.contains("a&lt;b") && page.contains("&lt;scene&gt;"));
        // That of the data, that of the script.
        assert_eq!(page.matches("</script>").count(), 2);
        assert!(!page.contains("{{"), "a place was left open");
        assert!(s.csv().lines().count() == 9 && s.json().unwrap().contains("columns"));
    }
}
