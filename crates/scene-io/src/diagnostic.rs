//! Mistakes with their places: `file:line:col: message`, the line, a caret, what to write instead.

use std::cell::RefCell;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Mistakes beyond this many are counted, not listed.
const MOST_LISTED: usize = 100;
/// Source lines are cut to a window of this many characters around the caret.
const WINDOW: usize = 160;

/// One mistake, and where it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The file it is in.
    pub file: PathBuf,
    /// Its line, from 1; 0 if it belongs to no line (a file that is missing, a `-D` that nothing reads).
    pub line: u32,
    /// Its column in characters, from 1; 0 with `line`.
    pub col: u32,
    /// The line itself (of a very long one the part around the mistake).
    pub source_line: String,
    /// How many characters of `source_line` stand before the caret.
    pub caret: usize,
    /// What is wrong.
    pub message: String,
    /// What to write instead, where that is known.
    pub help: Option<String>,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if self.line == 0 {
            write!(f, ": {}", self.message)?;
        } else {
            let number = self.line.to_string();
            let gutter = " ".repeat(number.len());
            let pad: String =
                self.source_line.chars().take(self.caret).map(|c| if c == '\t' { c } else { ' ' }).collect();
            write!(f, ":{}:{}: {}", self.line, self.col, self.message)?;
            write!(f, "\n  {number} | {}\n  {gutter} | {pad}^", self.source_line)?;
        }
        match &self.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

/// Every mistake that was found, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Errors(pub Vec<Diagnostic>);

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, d) in self.0.iter().enumerate() {
            write!(f, "{}{d}", if i == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

impl std::error::Error for Errors {}

/// A place: a byte of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct At {
    pub(crate) source: u32,
    pub(crate) offset: usize,
}

/// A mistake before its place is looked up.
struct Found {
    at: Option<At>,
    message: String,
    help: Option<String>,
}

struct SourceText {
    path: PathBuf,
    text: Arc<str>,
    /// Where each line starts.
    lines: Vec<usize>,
}

/// Collects the texts that were read, and the mistakes and warnings about them.
#[derive(Default)]
pub(crate) struct Report {
    sources: Vec<SourceText>,
    found: RefCell<Vec<Found>>,
    warnings: RefCell<Vec<String>>,
}

impl Report {
    /// Takes a text in; its number goes into every `At`.
    pub(crate) fn add_source(&mut self, path: &Path, text: String) -> u32 {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        self.sources.push(SourceText { path: path.to_owned(), text: text.into(), lines });
        (self.sources.len() - 1) as u32
    }
    pub(crate) fn text(&self, source: u32) -> Arc<str> {
        self.sources[source as usize].text.clone()
    }
    pub(crate) fn error(&self, at: At, message: impl Into<String>) {
        self.found.borrow_mut().push(Found { at: Some(at), message: message.into(), help: None });
    }
    pub(crate) fn error_help(&self, at: At, message: impl Into<String>, help: impl Into<String>) {
        self.found.borrow_mut().push(Found { at: Some(at), message: message.into(), help: Some(help.into()) });
    }
    /// A mistake that belongs to no line.
    pub(crate) fn error_nowhere(&self, message: impl Into<String>, help: Option<String>) {
        self.found.borrow_mut().push(Found { at: None, message: message.into(), help });
    }
    pub(crate) fn warn(&self, at: At, message: impl fmt::Display) {
        let (line, col, ..) = self.locate(at);
        let file = self.sources[at.source as usize].path.display();
        self.warnings.borrow_mut().push(format!("{file}:{line}:{col}: {message}"));
    }
    /// "file:line:col", for "first at ..".
    pub(crate) fn place(&self, at: At) -> String {
        let (line, col, ..) = self.locate(at);
        format!("{}:{line}:{col}", self.sources[at.source as usize].path.display())
    }
    /// Is it worth while to look for what was meant? (Not for those that will not be listed.)
    pub(crate) fn wants_help(&self) -> bool {
        self.found.borrow().len() < 2 * MOST_LISTED
    }
    pub(crate) fn has_errors(&self) -> bool {
        !self.found.borrow().is_empty()
    }
    pub(crate) fn take_warnings(&self) -> Vec<String> {
        std::mem::take(&mut self.warnings.borrow_mut())
    }
    /// The mistakes so far, ordered by place.
    pub(crate) fn errors(&self) -> Errors {
        let mut found = self.found.take();
        found.sort_by_key(|f| f.at);
        found.dedup_by(|a, b| a.at == b.at && a.message == b.message);
        let further = found.len().saturating_sub(MOST_LISTED);
        let file = self.sources.first().map(|s| s.path.clone()).unwrap_or_default();
        let nowhere = |message, help| Diagnostic {
            file: file.clone(),
            line: 0,
            col: 0,
            source_line: String::new(),
            caret: 0,
            message,
            help,
        };
        let mut list: Vec<Diagnostic> = found
            .into_iter()
            .take(MOST_LISTED)
            .map(|f| match f.at {
                None => nowhere(f.message, f.help),
                Some(at) => {
                    let (line, col, source_line, caret) = self.locate(at);
                    let file = self.sources[at.source as usize].path.clone();
                    Diagnostic { file, line, col, source_line, caret, message: f.message, help: f.help }
                }
            })
            .collect();
        if further > 0 {
            list.push(nowhere(format!("and {further} further mistakes"), None));
        }
        Errors(list)
    }
    /// Line, column, the line (or a window of it) and the caret's place in that.
    fn locate(&self, at: At) -> (u32, u32, String, usize) {
        let text = &*self.sources[at.source as usize].text;
        let offset = floor_char_boundary(text, at.offset);
        let lines = &self.sources[at.source as usize].lines;
        let line = lines.partition_point(|&start| start <= offset);
        let start = lines[line - 1];
        let end = text[offset..].find('\n').map_or(text.len(), |i| offset + i);
        let before = text[start..offset].chars().count();
        let skip = if before < WINDOW { 0 } else { before - WINDOW / 2 };
        let window: String = text[start..end].trim_end_matches('\r').chars().skip(skip).take(WINDOW).collect();
        (line as u32, before as u32 + 1, window, before - skip)
    }
}

fn floor_char_boundary(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

/// The candidate that was probably meant, if one is near: camelCase counts as snake_case.
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > 64 {
        return None;
    }
    let snake = snake_case(name);
    let length = snake.chars().count();
    let most = if length < 4 { 1 } else { (length / 3).max(2) };
    let near = candidates.into_iter().filter_map(|candidate| {
        if candidate.len().abs_diff(snake.len()) > 4 * most {
            return None; // Spares the table; four bytes a character at most.
        }
        let lower = candidate.to_lowercase();
        let distance = strsim::osa_distance(&snake, &lower);
        // Two slips and another first letter: that is another word.
        let same_word = distance < 2 || snake.chars().next() == lower.chars().next();
        (distance <= most && same_word).then_some((distance, candidate))
    });
    near.min_by_key(|&(distance, _)| distance).map(|(_, candidate)| candidate)
}

/// `faceNormals` as Mitsuba 3 writes it: `face_normals`.
pub(crate) fn snake_case(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 4);
    let mut lower_before = false;
    for c in name.chars() {
        if c.is_uppercase() && lower_before {
            out.push('_');
        }
        lower_before = c.is_lowercase() || c.is_ascii_digit();
        out.extend(c.to_lowercase());
    }
    out
}

/// "`a`, `b` or `c`".
pub(crate) fn any_of<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = names.into_iter().map(|n| format!("`{n}`")).collect();
    match quoted.split_last() {
        None => "nothing".into(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
    }
}

/// "did you mean `x`?", or the whole list if no name is near.
pub(crate) fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(name, known.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("expected {}", any_of(known)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_is_shown_with_its_line_and_a_caret_under_it() {
        let mut report = Report::default();
        let source = report.add_source(Path::new("a.xml"), "<scene>\n\t<é foo=\"1\"/>\n</scene>".into());
        report.error_help(At { source, offset: 13 }, "no `foo`", "write `bar`");
        let errors = report.errors();
        assert_eq!(errors.0[0].line, 2);
        assert_eq!(errors.0[0].col, 5);
        let want = "a.xml:2:5: no `foo`\n  2 | \t<é foo=\"1\"/>\n    | \t   ^\n  help: write `bar`";
        assert_eq!(errors.to_string(), want);
    }
    #[test]
    fn a_long_line_is_cut_around_the_caret() {
        let mut report = Report::default();
        let source = report.add_source(Path::new("a.xml"), "x".repeat(100_000));
        report.error(At { source, offset: 50_000 }, "here");
        let d = &report.errors().0[0];
        assert_eq!((d.col, d.source_line.len(), d.caret), (50_001, WINDOW, WINDOW / 2));
    }
    #[test]
    fn beyond_a_hundred_mistakes_the_rest_is_counted() {
        let mut report = Report::default();
        let source = report.add_source(Path::new("a.xml"), "x".repeat(200));
        (0..150).for_each(|offset| report.error(At { source, offset }, "here"));
        let errors = report.errors();
        assert_eq!(errors.0.len(), 101);
        assert_eq!(errors.0[100].message, "and 50 further mistakes");
    }
    #[test]
    fn the_nearest_name_sees_through_camel_case_and_typos() {
        let known = ["face_normals", "flip_normals", "to_world"];
        assert_eq!(nearest("faceNormals", known), Some("face_normals"));
        assert_eq!(nearest("toWorld", known), Some("to_world"));
        assert_eq!(nearest("flip_normal", known), Some("flip_normals"));
        assert_eq!(nearest("radius", known), None);
    }
}
