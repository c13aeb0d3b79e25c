//! The file as a tree of elements that know their places, with `<default>` and `$name` already applied.

use crate::diagnostic::{At, Report, nearest, snake_case};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Deeper nesting than any scene needs; it bounds every recursion over the tree.
const MOST_LEVELS: usize = 40;
/// More elements than any scene has; it bounds the memory of a hostile file.
const MOST_NODES: u32 = 20_000_000;

/// More included files than any scene has.
const MOST_INCLUDES: usize = 1000;

/// Where files are looked for.
pub(crate) struct Folders {
    base: PathBuf,
    /// By `<path>`, the last first.
    more: Vec<PathBuf>,
    /// Files that were included, in order.
    pub(crate) included: Vec<PathBuf>,
    /// Those that are being read, each included by the one before it.
    open: Vec<PathBuf>,
}

impl Folders {
    /// Of the scene file `path`.
    pub(crate) fn new(base: &Path, path: &Path) -> Self {
        let open = path.canonicalize().into_iter().collect();
        Folders { base: base.to_owned(), more: Vec::new(), included: Vec::new(), open }
    }
    /// The file or folder of a name: the first that is there.
    pub(crate) fn find(&self, name: &str) -> PathBuf {
        let there = self.more.iter().rev().map(|folder| folder.join(name)).find(|path| path.exists());
        there.unwrap_or_else(|| self.base.join(name))
    }
}

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
                    let near =
                        report.wants_help().then(|| nearest(name, self.values.keys().map(String::as_str))).flatten();
                    let help = match near {
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

/// What a text is read with.
pub(crate) struct Reading<'a> {
    pub(crate) report: &'a mut Report,
    pub(crate) defines: &'a mut Defines,
    pub(crate) folders: &'a mut Folders,
}

/// Reads a text and what it includes. `None` if it is no XML at all: the mistake is then in the report.
pub(crate) fn read(with: &mut Reading, source: u32) -> Option<Element> {
    let options = roxmltree::ParsingOptions { nodes_limit: MOST_NODES, ..Default::default() };
    let text = with.report.text(source);
    match roxmltree::Document::parse_with_options(&text, options) {
        Ok(document) => Some(convert(document.root_element(), source, 0, with)),
        Err(e) => {
            // Errors without a position of their own come out as 1:1: an unclosed root is better seen at the end.
            let offset = match e {
                roxmltree::Error::UnclosedRootNode => text.trim_end().len(),
                _ => offset_of(&text, e.pos()),
            };
            let message = e.to_string();
            let message = message.rsplit_once(" at ").map_or(message.as_str(), |(m, _)| m);
            with.report.error(At { source, offset }, format!("not well-formed XML: {message}"));
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

fn convert(node: roxmltree::Node, source: u32, level: usize, with: &mut Reading) -> Element {
    let place = |offset| At { source, offset };
    let at = place(node.range().start);
    let tag = node.tag_name().name().to_owned();
    let is_default = tag == "default";
    let mut attributes = Vec::new();
    for a in node.attributes() {
        let value_at = place(a.range_value().start);
        let (value, unknown) = with.defines.apply(a.value(), value_at, with.report);
        attributes.push(Attribute { name: a.name().to_owned(), value, at: place(a.range().start), value_at, unknown });
    }
    let mut element = Element { tag, at, attributes, children: Vec::new() };
    if is_default {
        element.expect_attributes(&["name", "value"], with.report);
        if let (Some(name), Some(value)) =
            (element.required("name", with.report), element.required("value", with.report))
            && !value.unknown
        {
            with.defines.default(&name.value, value.value.clone());
        }
    }
    for child in node.children() {
        if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
            let text = child.text().unwrap_or("");
            let offset = child.range().start + (text.len() - text.trim_start().len());
            with.report.error(place(offset), format!("text has no meaning inside <{}>", element.tag));
        } else if child.is_element() && level >= MOST_LEVELS {
            with.report.error(place(child.range().start), format!("elements nest deeper than {MOST_LEVELS} levels"));
            break;
        } else if child.is_element() {
            let child = convert(child, source, level + 1, with);
            match child.tag.as_str() {
                "include" => element.children.extend(include(&child, level, with)),
                "path" => add_folder(&child, with),
                _ => element.children.push(child),
            }
        }
    }
    element
}

/// `<path value="..">`: files are looked for there, too.
fn add_folder(e: &Element, with: &mut Reading) {
    e.expect_attributes(&["value"], with.report);
    e.expect_no_children(with.report);
    let Some(value) = e.required("value", with.report).filter(|a| !a.unknown) else { return };
    let folder = with.folders.find(&value.value);
    if folder.is_dir() {
        with.folders.more.push(folder);
    } else {
        with.report.error(value.value_at, format!("there is no folder `{}`", folder.display()));
    }
}

/// The elements of an included file: those inside its <scene>, or its only one.
fn include(e: &Element, level: usize, with: &mut Reading) -> Vec<Element> {
    e.expect_attributes(&["filename"], with.report);
    e.expect_no_children(with.report);
    let Some(name) = e.required("filename", with.report).filter(|a| !a.unknown) else { return Vec::new() };
    let at = name.value_at;
    let path = with.folders.find(&name.value);
    let known = path.canonicalize().unwrap_or_else(|_| path.clone());
    if with.folders.open.contains(&known) {
        with.report.error(at, format!("`{}` includes itself", name.value));
        return Vec::new();
    }
    if with.folders.included.len() >= MOST_INCLUDES {
        with.report.error(at, format!("more than {MOST_INCLUDES} files are included"));
        return Vec::new();
    }
    let bytes = match crate::assets::read_bytes(&path) {
        Ok(bytes) => bytes,
        Err((message, help)) => {
            match help {
                Some(help) => with.report.error_help(at, message, help),
                None => with.report.error(at, message),
            }
            return Vec::new();
        }
    };
    let Ok(text) = String::from_utf8(bytes) else {
        with.report.error(at, format!("`{}` is not UTF-8 text", path.display()));
        return Vec::new();
    };
    with.folders.included.push(path.clone());
    with.folders.open.push(known);
    let source = with.report.add_source(&path, text);
    // The levels of all files together bound every recursion.
    let text = with.report.text(source);
    let options = roxmltree::ParsingOptions { nodes_limit: MOST_NODES, ..Default::default() };
    let root = match roxmltree::Document::parse_with_options(&text, options) {
        Ok(document) => Some(convert(document.root_element(), source, level + 1, with)),
        Err(_) => read(with, source), // Says what is wrong.
    };
    with.folders.open.pop();
    match root {
        Some(root) if root.tag == "scene" => root.children,
        Some(mut root) => {
            root.attributes.retain(|a| a.name != "version");
            vec![root]
        }
        None => Vec::new(),
    }
}

/// Names of a file older than Mitsuba 2, as later ones write them: `toWorld` is `to_world`, `lookAt` is `lookat`, and a texture's `uscale`,
/// `vscale`, `uoffset` and `voffset` are its `to_uv`.
pub(crate) fn upgrade(e: &mut Element) {
    if e.tag == "lookAt" {
        e.tag = "lookat".into();
    }
    if e.tag != "default" {
        for a in e.attributes.iter_mut().filter(|a| a.name == "name") {
            a.value = snake_case(&a.value);
        }
    }
    e.children.iter_mut().for_each(upgrade);
    let diffuse = e.tag == "bsdf" && e.attribute("type").is_some_and(|a| a.value == "diffuse");
    for a in e.children.iter_mut().flat_map(|c| &mut c.attributes) {
        if diffuse && a.name == "name" && a.value == "diffuse_reflectance" {
            a.value = "reflectance".into();
        }
    }
    if e.tag == "texture" {
        let moved = |name: &str| match name {
            "uoffset" => Some(("translate", "x")),
            "voffset" => Some(("translate", "y")),
            "uscale" => Some(("scale", "x")),
            "vscale" => Some(("scale", "y")),
            _ => None,
        };
        let mut steps = ["translate", "scale"].map(|tag| Element {
            tag: tag.into(),
            at: e.at,
            attributes: Vec::new(),
            children: Vec::new(),
        });
        e.children.retain_mut(|c| {
            let Some((tag, axis)) = c.attribute("name").and_then(|a| moved(&a.value)) else { return true };
            let values = c.attributes.drain(..).filter(|a| a.name == "value");
            if let Some(step) = steps.iter_mut().find(|s| s.tag == tag) {
                step.at = c.at;
                step.attributes.extend(values.map(|a| Attribute { name: axis.into(), ..a }));
            }
            false
        });
        let steps: Vec<Element> = steps.into_iter().filter(|s| !s.attributes.is_empty()).collect();
        if let Some(first) = steps.first() {
            let at = first.at;
            let (name, value) = ("name".into(), "to_uv".into());
            let attributes = vec![Attribute { name, value, at, value_at: at, unknown: false }];
            e.children.push(Element { tag: "transform".into(), at, attributes, children: steps });
        }
    }
}
