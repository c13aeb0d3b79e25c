//! The file as objects (plugins) with typed properties; ids and references resolved.

use crate::assets::{self, Failure};
use crate::diagnostic::{At, Report, any_of, nearest, suggestion};
use crate::spectrum;
use crate::value;
use crate::xml::{Attribute, Element, Folders, upgrade};
use manylight_math::{DAffine3, DVec3};
use std::collections::HashMap;

/// Chains of references longer than this are circles, or no scene.
const MOST_REFERENCES: usize = 40;

/// What kind of object an element makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Scene,
    Integrator,
    Sensor,
    Film,
    Filter,
    Sampler,
    Bsdf,
    Shape,
    Emitter,
    Texture,
    Medium,
    Volume,
    Phase,
}

/// Every class but the scene, by its tag.
const CLASSES: [(&str, Class); 12] = [
    ("integrator", Class::Integrator),
    ("sensor", Class::Sensor),
    ("film", Class::Film),
    ("rfilter", Class::Filter),
    ("sampler", Class::Sampler),
    ("bsdf", Class::Bsdf),
    ("shape", Class::Shape),
    ("emitter", Class::Emitter),
    ("texture", Class::Texture),
    ("medium", Class::Medium),
    ("volume", Class::Volume),
    ("phase", Class::Phase),
];
const PROPERTIES: [&str; 10] =
    ["boolean", "integer", "float", "string", "rgb", "spectrum", "vector", "point", "transform", "ref"];

impl Class {
    /// Its tag in the file.
    pub(crate) fn tag(self) -> &'static str {
        CLASSES.iter().find(|(_, c)| *c == self).map_or("scene", |(tag, _)| tag)
    }
}

/// Place of an object in its document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct ObjectId(pub(crate) usize);

/// A typed value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Boolean(bool),
    Integer(i64),
    Float(f64),
    Text(String),
    Rgb([f64; 3]),
    Spectrum(f64),
    /// Wavelengths [nm], rising, and values.
    Table(Vec<[f64; 2]>),
    Vector(DVec3),
    Point(DVec3),
    Transform(DAffine3),
    Object(ObjectId),
    /// By id; none is left after `resolve` unless the id is unknown.
    Reference(String),
}

impl Value {
    /// The tag that writes it.
    pub(crate) fn tag(&self) -> &'static str {
        match self {
            Value::Boolean(_) => "boolean",
            Value::Integer(_) => "integer",
            Value::Float(_) => "float",
            Value::Text(_) => "string",
            Value::Rgb(_) => "rgb",
            Value::Spectrum(_) | Value::Table(_) => "spectrum",
            Value::Vector(_) => "vector",
            Value::Point(_) => "point",
            Value::Transform(_) => "transform",
            Value::Object(_) => "object",
            Value::Reference(_) => "ref",
        }
    }
}

/// A value with its name (empty for most nested objects).
#[derive(Debug)]
pub(crate) struct Property {
    pub(crate) name: String,
    pub(crate) at: At,
    /// Where the value stands.
    pub(crate) value_at: At,
    pub(crate) value: Value,
}

/// A plugin with its properties.
#[derive(Debug)]
pub(crate) struct Object {
    pub(crate) class: Class,
    pub(crate) plugin: String,
    pub(crate) plugin_at: At,
    pub(crate) id: Option<String>,
    pub(crate) at: At,
    pub(crate) properties: Vec<Property>,
    /// It has children that could not be read: absence of a property proves nothing.
    pub(crate) broken: bool,
}

impl Object {
    /// The value of a name, without using it.
    pub(crate) fn value(&self, name: &str) -> Option<&Value> {
        self.properties.iter().find(|p| p.name == name).map(|p| &p.value)
    }
}

/// All objects of a file; the scene itself is the last.
#[derive(Debug)]
pub(crate) struct Document {
    objects: Vec<Object>,
}

impl Document {
    pub(crate) fn object(&self, id: ObjectId) -> &Object {
        &self.objects[id.0]
    }
    pub(crate) fn objects(&self) -> &[Object] {
        &self.objects
    }
    pub(crate) fn scene(&self) -> ObjectId {
        ObjectId(self.objects.len() - 1)
    }
    /// Reads a whole tree. `None` if its root is no scene of a version that is understood.
    pub(crate) fn read(mut root: Element, folders: &Folders, report: &Report) -> Option<Document> {
        if check_root(&root, report)? < 2 {
            report.warn(
                root.at,
                "a file older than Mitsuba 2: its names are read in snake_case (`toWorld` as `to_world`)",
            );
            upgrade(&mut root);
        }
        let root = &root;
        let mut reader = Reader { objects: Vec::new(), ids: HashMap::new(), folders, report };
        reader.scene(root);
        let mut document = Document { objects: reader.objects };
        document.resolve(&reader.ids, report);
        document.refuse_circles(report)?;
        Some(document)
    }

    fn resolve(&mut self, ids: &HashMap<String, ObjectId>, report: &Report) {
        for object in &mut self.objects {
            for p in &mut object.properties {
                let Value::Reference(id) = &p.value else { continue };
                if let Some(target) = ids.get(id) {
                    p.value = Value::Object(*target);
                } else {
                    let near = report.wants_help().then(|| nearest(id, ids.keys().map(String::as_str))).flatten();
                    let help = match near {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => "give an object this `id`".into(),
                    };
                    report.error_help(p.value_at, format!("no object has the id `{id}`"), help);
                    object.broken = true;
                }
            }
        }
    }
    /// References that lead back to where they start would never be done with.
    fn refuse_circles(&self, report: &Report) -> Option<()> {
        let mut done = vec![false; self.objects.len()];
        for i in 0..self.objects.len() {
            if let Err(at) = self.descend(ObjectId(i), 0, &mut done) {
                report
                    .error(at, format!("references lead in a circle (or through more than {MOST_REFERENCES} objects)"));
                return None;
            }
        }
        Some(())
    }
    fn descend(&self, id: ObjectId, depth: usize, done: &mut [bool]) -> Result<(), At> {
        let object = self.object(id);
        if done[id.0] {
            return Ok(());
        }
        for p in &object.properties {
            if let Value::Object(child) = p.value {
                if depth > MOST_REFERENCES {
                    return Err(p.value_at);
                }
                self.descend(child, depth + 1, done)?;
            }
        }
        done[id.0] = true;
        Ok(())
    }
}

/// The major number of the version.
fn check_root(root: &Element, report: &Report) -> Option<u32> {
    if root.tag != "scene" {
        report.error(root.at, format!("the root element is <{}>: expected <scene version=\"3.0.0\">", root.tag));
        return None;
    }
    root.expect_attributes(&["version", "id"], report);
    let Some(version) = root.attribute("version").filter(|a| !a.unknown) else {
        report.error(root.at, "<scene> needs the attribute `version`: \"3.0.0\" if it was written for Mitsuba 3");
        return None;
    };
    let text = version.value.trim();
    let mut parts = text.split('.').map(str::parse::<u32>);
    let major = parts.next().and_then(Result::ok).filter(|_| parts.all(|p| p.is_ok()));
    if major.is_none() {
        report.error(version.value_at, format!("`{text}` is not a version: expected one such as 3.0.0"));
    }
    major
}

struct Reader<'a> {
    folders: &'a Folders,
    objects: Vec<Object>,
    ids: HashMap<String, ObjectId>,
    report: &'a Report,
}

impl Reader<'_> {
    fn scene(&mut self, root: &Element) {
        let (properties, broken) = self.children(root);
        let (plugin, id) = ("scene".into(), None);
        let scene = Object { class: Class::Scene, plugin, plugin_at: root.at, id, at: root.at, properties, broken };
        self.objects.push(scene);
    }

    fn children(&mut self, e: &Element) -> (Vec<Property>, bool) {
        let mut properties: Vec<Property> = Vec::new();
        let mut first: HashMap<String, At> = HashMap::new();
        let mut broken = false;
        for c in &e.children {
            if c.tag == "default" {
                c.expect_no_children(self.report);
                if e.tag != "scene" {
                    self.report.error(c.at, format!("<default> cannot stand inside <{}>", e.tag));
                }
                continue;
            }
            if c.tag == "alias" {
                self.alias(c);
                continue;
            }
            let Some(p) = self.property(c) else {
                broken = true;
                continue;
            };
            // Nested objects may share a name where they have none to speak of (`<bsdf/><bsdf/>` of a twosided).
            if !p.name.is_empty() {
                if let Some(before) = first.get(&p.name) {
                    let place = self.report.place(*before);
                    self.report.error(p.at, format!("`{}` is given twice (first at {place})", p.name));
                    continue;
                }
                first.insert(p.name.clone(), p.at);
            }
            properties.push(p);
        }
        (properties, broken)
    }

    /// `<alias id="a" as="b"/>`: another id of an object that stands before it.
    fn alias(&mut self, e: &Element) {
        e.expect_attributes(&["id", "as"], self.report);
        e.expect_no_children(self.report);
        let (Some(id), Some(other)) = (e.required("id", self.report), e.required("as", self.report)) else { return };
        let Some(object) = self.ids.get(&id.value).copied() else {
            let help = match nearest(&id.value, self.ids.keys().map(String::as_str)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "write the <alias> after the object".into(),
            };
            self.report.error_help(id.value_at, format!("no object before here has the id `{}`", id.value), help);
            return;
        };
        if let Some(first) = self.ids.insert(other.value.clone(), object) {
            let place = self.report.place(self.objects[first.0].at);
            self.report.error(other.value_at, format!("the id `{}` is given twice (first at {place})", other.value));
        }
    }

    fn property(&mut self, e: &Element) -> Option<Property> {
        if let Some((_, class)) = CLASSES.iter().find(|(tag, _)| *tag == e.tag) {
            return self.object(e, *class);
        }
        let report = self.report;
        let name = e.attribute("name");
        let property = |value: Value, value_at: At| {
            let name = name.map_or(String::new(), |a| a.value.clone());
            Some(Property { name, at: e.at, value_at, value })
        };
        if !matches!(e.tag.as_str(), "transform") {
            e.expect_no_children(report);
        }
        match e.tag.as_str() {
            "ref" => {
                e.expect_attributes(&["id", "name"], report);
                let id = e.required("id", report).filter(|a| !a.unknown)?;
                property(Value::Reference(id.value.clone()), id.value_at)
            }
            "vector" | "point" => {
                e.expect_attributes(&["name", "x", "y", "z", "value"], report);
                e.required("name", report)?;
                let v = value::vector(e, None, report)?;
                property(if e.tag == "point" { Value::Point(v) } else { Value::Vector(v) }, e.at)
            }
            "transform" => {
                e.expect_attributes(&["name"], report);
                let t = value::transform(e, report);
                e.required("name", report)?;
                property(Value::Transform(t?), e.at)
            }
            "boolean" => self.simple(e, |a| value::parse(a, report, value::boolean).map(Value::Boolean)),
            "integer" => self.simple(e, |a| value::parse(a, report, value::integer).map(Value::Integer)),
            "float" => self.simple(e, |a| value::parse(a, report, value::number).map(Value::Float)),
            "string" => self.simple(e, |a| value::parse(a, report, |text| Ok(Value::Text(text.to_owned())))),
            "rgb" => self.simple(e, |a| value::parse(a, report, value::rgb).map(Value::Rgb)),
            "spectrum" if e.attribute("type").is_some() => {
                report.error_help(e.at, "spectrum plugins are not supported yet", "write the colour as <rgb>");
                None
            }
            "spectrum" if e.attribute("filename").is_some() => {
                e.expect_attributes(&["name", "filename"], report);
                let file = e.required("filename", report).filter(|a| !a.unknown)?;
                e.required("name", report)?;
                let table = self.spectrum_file(&file.value);
                let table = table.map_err(|(message, help)| match help {
                    Some(help) => report.error_help(file.value_at, message, help),
                    None => report.error(file.value_at, message),
                });
                property(Value::Table(table.ok()?), file.value_at)
            }
            "spectrum" => self.simple(e, |a| {
                if a.value.contains(':') {
                    value::parse(a, report, spectrum::parse).map(Value::Table)
                } else {
                    value::parse(a, report, value::spectrum).map(Value::Spectrum)
                }
            }),
            "srgb" => {
                report.error_help(
                    e.at,
                    "<srgb> is no element of a Mitsuba 3 scene",
                    "write the linear colour as <rgb>",
                );
                None
            }
            other => {
                let known = PROPERTIES.into_iter().chain(CLASSES.map(|(tag, _)| tag));
                let help = match nearest(other, known) {
                    Some(near) => format!("did you mean <{near}>?"),
                    None => format!("properties are {}", any_of(PROPERTIES)),
                };
                report.error_help(e.at, format!("<{other}> is no element of a Mitsuba 3 scene"), help);
                None
            }
        }
    }

    fn spectrum_file(&self, name: &str) -> Result<Vec<[f64; 2]>, Failure> {
        let path = self.folders.find(name);
        let text = String::from_utf8(assets::read_bytes(&path)?);
        let text = text.map_err(|_| (format!("`{name}` is not a text"), None))?;
        spectrum::read(&text).map_err(|e| (format!("`{name}`: {e}"), None))
    }

    fn simple(&self, e: &Element, parse: impl Fn(&Attribute) -> Option<Value>) -> Option<Property> {
        e.expect_attributes(&["name", "value"], self.report);
        let name = e.required("name", self.report);
        let attribute = e.required("value", self.report)?;
        let value = parse(attribute);
        Some(Property { name: name?.value.clone(), at: e.at, value_at: attribute.value_at, value: value? })
    }

    fn object(&mut self, e: &Element, class: Class) -> Option<Property> {
        e.expect_attributes(&["type", "id", "name"], self.report);
        // The children first: their mistakes are worth knowing even if this one is no object.
        let (properties, broken) = self.children(e);
        let plugin = e.required("type", self.report).filter(|a| !a.unknown)?;
        let id = e.attribute("id").map(|a| a.value.clone());
        let (plugin, plugin_at) = (plugin.value.clone(), plugin.value_at);
        let object_id = ObjectId(self.objects.len());
        self.objects.push(Object { class, plugin, plugin_at, id: id.clone(), at: e.at, properties, broken });
        if let Some(a) = e.attribute("id") {
            match self.ids.get(&a.value) {
                Some(first) => {
                    let place = self.report.place(self.objects[first.0].at);
                    self.report.error(a.value_at, format!("the id `{}` is given twice (first at {place})", a.value));
                }
                None => {
                    self.ids.insert(a.value.clone(), object_id);
                }
            }
        }
        let name = e.attribute("name").map_or(String::new(), |a| a.value.clone());
        Some(Property { name, at: e.at, value_at: e.at, value: Value::Object(object_id) })
    }
}

/// The mistake of a plugin that is not there: unknown, or Mitsuba's but not supported yet.
pub(crate) fn refuse_plugin(object: &Object, supported: &[&str], mitsuba: &[&str], report: &Report) {
    let (class, plugin) = (object.class.tag(), object.plugin.as_str());
    if mitsuba.contains(&plugin) {
        let help = format!("supported are {}", any_of(supported.iter().copied()));
        report.error_help(object.plugin_at, format!("the {class} `{plugin}` is not supported yet"), help);
    } else {
        let known = supported.iter().chain(mitsuba).copied();
        let help = match nearest(plugin, known) {
            Some(near) => format!("did you mean `{near}`?"),
            None => suggestion(plugin, supported.iter().copied()),
        };
        report.error_help(object.plugin_at, format!("there is no {class} `{plugin}`"), help);
    }
}
