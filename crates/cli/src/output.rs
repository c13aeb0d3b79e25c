//! Text for people, on stdout.

use std::io::Write;

/// Prints a text and ends its line. Whoever reads may have read enough (`manylight list | head`): that is no error.
pub fn say(text: impl std::fmt::Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Rows in aligned columns, indented, each on its own line; the last column is as long as it likes.
pub fn table<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let line = |row: &[String; N]| {
        let cells: String = row.iter().zip(&widths).map(|(cell, &width)| format!("  {cell:width$}")).collect();
        format!("{}\n", cells.trim_end())
    };
    rows.iter().map(line).collect()
}

/// What was probably meant, to go on with a sentence: the nearest of `names`, if any is near.
pub fn did_you_mean<'a>(wrong: &str, names: impl Iterator<Item = &'a str>) -> String {
    let near = names.map(|name| (strsim::jaro_winkler(wrong, name), name)).max_by(|a, b| a.0.total_cmp(&b.0));
    near.filter(|(similarity, _)| *similarity > 0.7)
        .map_or(String::new(), |(_, name)| format!(": did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_lines_have_no_spaces_at_their_end() {
        let row = |a: &str, b: &str| [a.to_string(), b.to_string()];
        assert_eq!(table(&[row("paths", "light paths"), row("spp", "")]), "  paths  light paths\n  spp\n");
        assert_eq!(table::<2>(&[]), "");
    }
    #[test]
    fn only_what_is_near_is_suggested() {
        let names = || ["lamps", "pillars"].into_iter();
        assert_eq!(did_you_mean("lmaps", names()), ": did you mean `lamps`?");
        assert_eq!(did_you_mean("zzz", names()), "");
    }
}
