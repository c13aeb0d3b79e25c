//! What became of a method in a hard case.

use crate::finding::Outcome;
use serde::Serialize;

/// One method in one case.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// The method.
    pub subject: String,
    /// The case.
    pub case: &'static str,
    /// How it ended.
    #[serde(serialize_with = "word")]
    pub outcome: Outcome,
    /// Passes rendered.
    pub passes: u64,
    /// Samples that were NaN, infinite or negative.
    pub non_finite: u64,
    /// Light paths whose flux was.
    pub broken_paths: u64,
    /// Of the channel that is the furthest from what is known in its standard errors: (mean - truth) / truth.
    pub error: Option<f64>,
    /// Standard error of that. Of skewed passes it says too little.
    pub std_error: Option<f64>,
    /// Largest difference of a pixel, relative to it or to the image's mean if that is larger, when the metre is 2^20 or 2^-20.
    pub longer: Option<f64>,
    /// The same when the watt is.
    pub brighter: Option<f64>,
    /// In words: what failed, or why nothing could be said.
    pub why: String,
}

fn word<S: serde::Serializer>(outcome: &Outcome, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(outcome.word())
}

/// A column of the table.
pub struct Column {
    /// In the first line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its cell; empty where a value is not known.
    pub value: fn(&Cell) -> String,
}

fn some(value: Option<f64>) -> String {
    value.map_or(String::new(), |x| format!("{x:.3e}"))
}

/// The columns, in their order.
pub const COLUMNS: &[Column] = &[
    Column { name: "method", about: "the method with its parameters", value: |c| c.subject.clone() },
    Column { name: "case", about: "the scene", value: |c| c.case.into() },
    Column {
        name: "outcome",
        about: "`holds`, `FAILS`, `no verdict` (where the claim promises nothing or the passes are too skewed), `skipped`",
        value: |c| c.outcome.word().into(),
    },
    Column { name: "passes", about: "rendered", value: |c| c.passes.to_string() },
    Column {
        name: "non_finite",
        about: "samples that were NaN, infinite or negative",
        value: |c| c.non_finite.to_string(),
    },
    Column {
        name: "broken_paths",
        about: "light paths whose flux was not finite",
        value: |c| c.broken_paths.to_string(),
    },
    Column {
        name: "error",
        about: "(mean - truth) / truth of the channel that is furthest off in standard errors",
        value: |c| some(c.error),
    },
    Column { name: "std_error", about: "standard error of that", value: |c| some(c.std_error) },
    Column {
        name: "longer",
        about: "largest relative difference of a pixel when all lengths are 2^20 or 2^-20 times what they were",
        value: |c| some(c.longer),
    },
    Column { name: "brighter", about: "the same for all light", value: |c| some(c.brighter) },
    Column { name: "why", about: "what failed, or why nothing can be said", value: |c| c.why.clone() },
];

/// Cells as CSV: a first line with the names of [`COLUMNS`], and a line each.
pub fn csv(cells: &[Cell]) -> String {
    let quoted = |text: String| {
        if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
    };
    let line = |values: Vec<String>| values.into_iter().map(quoted).collect::<Vec<_>>().join(",") + "\n";
    let head = line(COLUMNS.iter().map(|c| c.name.to_string()).collect());
    head + &cells.iter().map(|cell| line(COLUMNS.iter().map(|c| (c.value)(cell)).collect())).collect::<String>()
}
