//! The file as a tree of elements that know their places, with `<default>` and `$name` already applied.

use crate::diagnostic::{At, Report, nearest};
use std::collections::BTreeMap;

/// Deeper nesting than any scene needs; it bounds every recursion over the tree.
const MOST_LEVELS: usize = 40;
/// More elements than any scene has; it bounds the memory of a hostile file.
const MOST_NODES: u32 = 20_000_000;

/// One attribute.
#[derive(Debug)]
pub(crate) struct Attribute {
    pub(crate) name: String,
    pub(crate) value: String,
    /// Where the name stands.
    pub(crate) at: At,
    /// Where the value stands.
    pub(crate) value_at: At,
    /// It asks for a `$name` that is not defined (which is in the report): its value says nothing.
    pub(crate) unknown: bool,
}

/// One element.
#[derive(Debug)]
pub(crate) struct Element {
    pub(crate) tag: String,
    pub(crate) at: At,
    pub(crate) attributes: Vec<Attribute>,
    pub(crate) children: Vec<Element>,
}

impl Element {
    pub(crate) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }
    /// The attribute, or a mistake that says it is missing.
    pub(crate) fn required(&self, name: &str, report: &Report) -> Option<&Attribute> {
        let found = self.attribute(name);
        if found.is_none() {
            report.error(self.at, format!("<{}> needs the attribute `{name}`", self.tag));
        }
        found
    }
    /// Reports attributes that have no meaning here.
    pub(crate) fn expect_attributes(&self, known: &[&str], report: &Report) {
        for a in self.attributes.iter().filter(|a| !known.contains(&a.name.as_str())) {
            let help = crate::diagnostic::suggestion(&a.name, known.iter().copied());
            report.error_help(a.at, format!("<{}> has no attribute `{}`", self.tag, a.name), help);
        }
    }
    /// Reports children where there can be none.
    pub(crate) fn expect_no_children(&self, report: &Report) {
        for c in &self.children {
            report.error(c.at, format!("<{}> cannot stand inside <{}>", c.tag, self.tag));
        }
    }
}

/// An attribute that `$name` swells beyond this is an attack. [bytes]
const MOST_EXPANDED: usize = 1 << 20;

/// What `$name` stands for.
pub(crate) struct Defines {
    values: BTreeMap<String, String>,
    /// From outside: name and whether the file has asked for it.
    outside: BTreeMap<String, bool>,
}

impl Defines {
    pub(crate) fn new(outside: &[(String, String)]) -> Self {
        let values = outside.iter().cloned().collect();
        Defines { values, outside: outside.iter().map(|(name, _)| (name.clone(), false)).collect() }
    }
    /// `<default>`: what came from outside wins.
    fn default(&mut self, name: &str, value: String) {
        self.values.entry(name.to_owned()).or_insert(value);
        if let Some(asked) = self.outside.get_mut(name) {
            *asked = true;
        }
    }
    /// Replaces each `$name` by its value. As in Mitsuba, the longest name that is defined counts (`$resx` before `$res`).
    /// The flag: was there one that is not?
    fn apply(&mut self, text: &str, at: At, report: &Report) -> (String, bool) {
        let mut unknown = false;
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            out.push_str(&rest[..dollar]);
            rest = &rest[dollar + 1..];
            let run = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let name =
                self.values.keys().filter(|k| !k.is_empty() && rest.starts_with(k.as_str())).max_by_key(|k| k.len());
            match name.cloned() {
                Some(name) if out.len() + self.values[&name].len() > MOST_EXPANDED => {
                    report.error(at, format!("`${name}` grows beyond {MOST_EXPANDED} bytes"));
                    return (String::new(), true);
                }
                Some(name) => {
                    out.push_str(&self.values[&name]);
                    rest = &rest[name.len()..];
                    if let Some(asked) = self.outside.get_mut(&name) {
                        *asked = true;
                    }
                }
                None => {
                    let name = &rest[..run];
                    let help = match nearest(name, self.values.keys().map(String::as_str)) {
                        Some(near) => format!("did you mean `${near}`?"),
                        None => format!("write <default name=\"{name}\" value=\"..\"/> above, or give -D {name}=.."),
                    };
                    report.error_help(at, format!("`${name}` is not defined"), help);
                    unknown = true;
                    rest = &rest[run..];
                }
            }
        }
        out.push_str(rest);
        (out, unknown)
    }
    /// Reports what was given from outside and never asked for.
    pub(crate) fn report_unused(&self, report: &Report) {
        for (name, _) in self.outside.iter().filter(|(_, asked)| !**asked) {
            let known = self.values.keys().map(String::as_str).filter(|k| !self.outside.contains_key(*k));
            let help = match nearest(name, known.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None if known.clone().next().is_none() => "it defines no parameters".into(),
                None => format!("it defines {}", known.map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", ")),
            };
            report.error_nowhere(format!("the scene has no parameter `{name}` (given by -D)"), Some(help));
        }
    }
}

/// Reads a text. `None` if it is no XML at all: the mistake is then in the report.
pub(crate) fn read(report: &Report, source: u32, defines: &mut Defines) -> Option<Element> {
    let options = roxmltree::ParsingOptions { nodes_limit: MOST_NODES, ..Default::default() };
    let text = report.text(source);
    match roxmltree::Document::parse_with_options(text, options) {
        Ok(document) => Some(convert(document.root_element(), source, 0, defines, report)),
        Err(e) => {
            // Errors without a position of their own come out as 1:1: an unclosed root is better seen at the end.
            let offset = match e {
                roxmltree::Error::UnclosedRootNode => text.trim_end().len(),
                _ => offset_of(text, e.pos()),
            };
            let message = e.to_string();
            let message = message.rsplit_once(" at ").map_or(message.as_str(), |(m, _)| m);
            report.error(At { source, offset }, format!("not well-formed XML: {message}"));
            None
        }
    }
}

/// roxmltree's row and column (in characters) as a byte.
fn offset_of(text: &str, pos: roxmltree::TextPos) -> usize {
    let row = pos.row.saturating_sub(1) as usize;
    let start: usize = text.split_inclusive('\n').take(row).map(str::len).sum();
    let line = text.get(start..).unwrap_or("");
    start + line.char_indices().nth(pos.col.saturating_sub(1) as usize).map_or(line.len(), |(i, _)| i)
}

fn convert(node: roxmltree::Node, source: u32, level: usize, defines: &mut Defines, report: &Report) -> Element {
    let place = |offset| At { source, offset };
    let at = place(node.range().start);
    let tag = node.tag_name().name().to_owned();
    let is_default = tag == "default";
    let mut attributes = Vec::new();
    for a in node.attributes() {
        let value_at = place(a.range_value().start);
        let (value, unknown) = defines.apply(a.value(), value_at, report);
        attributes.push(Attribute { name: a.name().to_owned(), value, at: place(a.range().start), value_at, unknown });
    }
    let mut element = Element { tag, at, attributes, children: Vec::new() };
    if is_default {
        element.expect_attributes(&["name", "value"], report);
        if let (Some(name), Some(value)) = (element.required("name", report), element.required("value", report))
            && !value.unknown
        {
            defines.default(&name.value, value.value.clone());
        }
    }
    for child in node.children() {
        if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
            let text = child.text().unwrap_or("");
            let offset = child.range().start + (text.len() - text.trim_start().len());
            report.error(place(offset), format!("text has no meaning inside <{}>", element.tag));
        } else if child.is_element() && level >= MOST_LEVELS {
            report.error(place(child.range().start), format!("elements nest deeper than {MOST_LEVELS} levels"));
            break;
        } else if child.is_element() {
            element.children.push(convert(child, source, level + 1, defines, report));
        }
    }
    element
}
