//! The CSV file, one line an image.

use super::Row;

/// A column of the CSV file.
pub struct Column {
    /// In the first line.
    pub name: &'static str,
    /// What it is, with its unit.
    pub about: &'static str,
    value: fn(&Row) -> String,
}

fn some<T: ToString>(value: Option<T>) -> String {
    value.map_or(String::new(), |v| v.to_string())
}

/// The columns, in their order. Cells are empty where a value is not known.
pub const COLUMNS: &[Column] = &[
    Column {
        name: "method",
        about: "the method with its parameters, or the name of an image from elsewhere",
        value: |r| r.method.clone(),
    },
    Column { name: "budget", about: "what it might spend", value: |r| r.budget.to_string() },
    Column {
        name: "run",
        about: "from 0; methods of one run have one seed and took turns",
        value: |r| r.run.to_string(),
    },
    Column { name: "seed", about: "what all random numbers followed from", value: |r| some(r.seed) },
    Column { name: "passes", about: "complete passes", value: |r| some(r.passes) },
    Column { name: "seconds", about: "wall-clock time of those passes [s]", value: |r| r.seconds.to_string() },
    Column {
        name: "seconds_preparing",
        about: "of that, light paths and trees [s]",
        value: |r| some(r.seconds_preparing),
    },
    Column { name: "camera_rays", about: "rays from the camera", value: |r| some(r.camera_rays) },
    Column { name: "path_rays", about: "rays along paths", value: |r| some(r.path_rays) },
    Column { name: "shadow_rays", about: "rays between two points", value: |r| some(r.shadow_rays) },
    Column { name: "lights", about: "virtual lights made", value: |r| some(r.lights) },
    Column {
        name: "non_finite",
        about: "samples that were NaN, infinite or negative: black",
        value: |r| r.non_finite.to_string(),
    },
    Column {
        name: "relmse",
        about: "mean (I - R)^2 / (R^2 + eps) over pixels and channels, eps = 0.01 (mean R)^2",
        value: |r| r.relmse.to_string(),
    },
    Column {
        name: "relmse_net",
        about: "relmse without the reference's own variance",
        value: |r| r.relmse_net.to_string(),
    },
    Column {
        name: "bias",
        about: "of relmse_net, what stays however long one renders: from two independent halves of the passes; may come out below zero",
        value: |r| some(r.bias),
    },
    Column { name: "noise", about: "of relmse_net, the rest", value: |r| some(r.noise) },
    Column { name: "rmse", about: "sqrt(mean (I - R)^2) [W/(m^2 sr)]", value: |r| r.rmse.to_string() },
    Column { name: "mape", about: "mean |I - R| / (|R| + 0.01 mean R)", value: |r| r.mape.to_string() },
    Column {
        name: "flip",
        about: "mean LDR-FLIP of sRGB images at the study's exposure, 67 pixels per degree",
        value: |r| some(r.flip),
    },
    Column {
        name: "percentile_999",
        about: "99.9th percentile over pixels of sqrt(mean over channels of (I - R)^2 / (R^2 + eps))",
        value: |r| r.percentile_999.to_string(),
    },
    Column { name: "file", about: "the image, if it was written", value: |r| r.file.clone().unwrap_or_default() },
];

pub(super) fn csv(rows: &[Row]) -> String {
    let mut lines = vec![COLUMNS.iter().map(|c| c.name.to_string()).collect::<Vec<_>>().join(",")];
    lines.extend(rows.iter().map(|r| COLUMNS.iter().map(|c| quoted(&(c.value)(r))).collect::<Vec<_>>().join(",")));
    lines.join("\n") + "\n"
}

/// RFC 4180.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_commas_and_quotes_are_quoted() {
        assert_eq!(quoted("vsl:paths=3,bound=none"), "\"vsl:paths=3,bound=none\"");
        assert_eq!((quoted("a\"b"), quoted("plain")), ("\"a\"\"b\"".into(), "plain".into()));
    }
    #[test]
    fn names_are_distinct() {
        let mut names: Vec<_> = COLUMNS.iter().map(|c| c.name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|w| w[0] != w[1]));
    }
}
