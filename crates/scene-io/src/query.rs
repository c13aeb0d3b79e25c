//! Asking an object for its properties: typed, with defaults, and each mistake at its place.

use crate::diagnostic::{At, Report, any_of, nearest};
use crate::document::{Class, Document, Object, ObjectId, Property, Value};
use crate::value;
use manylight_math::{DAffine3, DVec3};
use std::cell::{Cell, RefCell};
use std::ops::RangeInclusive;

/// One reading of one object. What is asked for is what it may have: `finish` reports the rest.
pub(crate) struct Query<'a> {
    pub(crate) document: &'a Document,
    pub(crate) object: &'a Object,
    pub(crate) report: &'a Report,
    used: Vec<Cell<bool>>,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Query<'a> {
    pub(crate) fn new(document: &'a Document, id: ObjectId, report: &'a Report) -> Self {
        let object = document.object(id);
        let used = vec![Cell::new(false); object.properties.len()];
        Query { document, object, report, used, asked: RefCell::default() }
    }

    /// The property of a name, whatever its kind.
    pub(crate) fn get(&self, name: &'static str) -> Option<&'a Property> {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&name) {
            asked.push(name);
        }
        drop(asked);
        let i = self.object.properties.iter().position(|p| p.name == name)?;
        self.used[i].set(true);
        Some(&self.object.properties[i])
    }
    /// Is there a property of this name? (Asking does not use it.)
    pub(crate) fn has(&self, name: &str) -> bool {
        self.object.properties.iter().any(|p| p.name == name)
    }
    /// These may be given, and change nothing here.
    pub(crate) fn ignore(&self, names: &[&'static str]) {
        for name in names {
            self.get(name);
        }
    }
    /// Whatever else it has is accepted.
    pub(crate) fn ignore_rest(&self) {
        self.used.iter().for_each(|u| u.set(true));
    }

    fn typed<T>(&self, name: &'static str, expected: &str, read: impl Fn(&Value) -> Option<T>) -> Option<(T, At)> {
        let p = self.get(name)?;
        let found = read(&p.value);
        if found.is_none() && !matches!(p.value, Value::Reference(_)) {
            self.report.error(p.at, format!("`{name}` must be {expected}, not <{}>", self.tag_of(&p.value)));
        }
        found.map(|v| (v, p.value_at))
    }
    /// The tag that a value was written with.
    pub(crate) fn tag_of(&self, value: &Value) -> &'static str {
        match value {
            Value::Object(id) => self.document.object(*id).class.tag(),
            other => other.tag(),
        }
    }

    pub(crate) fn float_at(&self, name: &'static str) -> Option<(f64, At)> {
        self.typed(name, "a number (<float>)", |v| match v {
            Value::Float(x) => Some(*x),
            Value::Integer(i) => Some(*i as f64),
            _ => None,
        })
    }
    pub(crate) fn float(&self, name: &'static str, default: f64) -> f64 {
        self.float_at(name).map_or(default, |(x, _)| x)
    }
    /// A number above zero.
    pub(crate) fn positive(&self, name: &'static str, default: f64) -> f64 {
        match self.float_at(name) {
            // f32 is what it becomes: 1e-50 is zero.
            Some((x, _)) if x as f32 > 0.0 => x,
            Some((x, at)) => {
                self.report.error(at, format!("`{name}` must be greater than zero, not {x}"));
                default
            }
            None => default,
        }
    }
    pub(crate) fn integer(&self, name: &'static str, range: RangeInclusive<i64>, default: i64) -> i64 {
        let found = self.typed(name, "a whole number (<integer>)", |v| match v {
            Value::Integer(i) => Some(*i),
            _ => None,
        });
        match found {
            Some((i, _)) if range.contains(&i) => i,
            Some((i, at)) => {
                let (lo, hi) = (range.start(), range.end());
                self.report.error(at, format!("`{name}` must be between {lo} and {hi}, not {i}"));
                default
            }
            None => default,
        }
    }
    pub(crate) fn boolean(&self, name: &'static str, default: bool) -> bool {
        let found = self.typed(name, "true or false (<boolean>)", |v| match v {
            Value::Boolean(b) => Some(*b),
            _ => None,
        });
        found.map_or(default, |(b, _)| b)
    }
    pub(crate) fn text(&self, name: &'static str) -> Option<(&'a str, At)> {
        let p = self.get(name)?;
        match &p.value {
            Value::Text(text) => Some((text, p.value_at)),
            Value::Reference(_) => None,
            other => {
                let tag = self.tag_of(other);
                self.report.error(p.at, format!("`{name}` must be a text (<string>), not <{tag}>"));
                None
            }
        }
    }
    /// A text that must be one of a few.
    pub(crate) fn choice<T: Copy>(&self, name: &'static str, choices: &[(&'static str, T)], default: T) -> T {
        let Some((text, at)) = self.text(name) else { return default };
        if let Some((_, value)) = choices.iter().find(|(word, _)| *word == text) {
            return *value;
        }
        let words = any_of(choices.iter().map(|(word, _)| *word));
        self.report.error(at, format!("`{name}` must be {words}, not `{text}`"));
        default
    }
    pub(crate) fn point(&self, name: &'static str) -> Option<DVec3> {
        let read = |v: &Value| if let Value::Point(p) | Value::Vector(p) = v { Some(*p) } else { None };
        self.typed(name, "a point (<point>)", read).map(|(p, _)| p)
    }
    pub(crate) fn vector_at(&self, name: &'static str) -> Option<(DVec3, At)> {
        let read = |v: &Value| if let Value::Point(p) | Value::Vector(p) = v { Some(*p) } else { None };
        self.typed(name, "a vector (<vector>)", read)
    }
    pub(crate) fn transform_at(&self, name: &'static str) -> Option<(DAffine3, At)> {
        let read = |v: &Value| if let Value::Transform(t) = v { Some(*t) } else { None };
        self.typed(name, "a transform (<transform>)", read)
    }
    /// `to_world`, not singular; the identity where there is none or it is wrong.
    pub(crate) fn to_world(&self) -> (DAffine3, At) {
        match self.transform_at("to_world") {
            Some((t, at)) => (value::refuse_singular(&t, at, self.report).unwrap_or(DAffine3::IDENTITY), at),
            None => (DAffine3::IDENTITY, self.object.at),
        }
    }

    /// The nested objects of a class, named or not.
    pub(crate) fn children(&self, class: Class) -> Vec<(ObjectId, &'a Property)> {
        let mut found = Vec::new();
        for (p, used) in self.object.properties.iter().zip(&self.used) {
            if let Value::Object(id) = p.value
                && self.document.object(id).class == class
            {
                used.set(true);
                found.push((id, p));
            }
        }
        found
    }
    /// The only nested object of a class; a second one is a mistake.
    pub(crate) fn child(&self, class: Class) -> Option<ObjectId> {
        let children = self.children(class);
        if let Some((_, second)) = children.get(1) {
            let tag = class.tag();
            self.report.error(second.at, format!("{} has a <{tag}> already: it takes only one", self.name()));
        }
        children.first().map(|(id, _)| *id)
    }

    /// "the shape `obj`".
    pub(crate) fn name(&self) -> String {
        match self.object.class {
            Class::Scene => "the scene".into(),
            class => format!("the {} `{}`", class.tag(), self.object.plugin),
        }
    }
    /// A mistake about the object as a whole, at its type.
    pub(crate) fn error(&self, message: impl Into<String>) {
        self.report.error(self.object.plugin_at, message);
    }

    /// Reports what was not asked for: as in Mitsuba, an unused property is a mistake.
    pub(crate) fn finish(self) {
        let asked = self.asked.into_inner();
        for (p, _) in self.object.properties.iter().zip(&self.used).filter(|(_, used)| !used.get()) {
            let (class, plugin) = (self.object.class.tag(), &self.object.plugin);
            let owner =
                if self.object.class == Class::Scene { "a scene".into() } else { format!("the {class} `{plugin}`") };
            if let Value::Reference(_) = p.value {
                continue; // Nobody knows what it would have been.
            }
            if p.name.is_empty() {
                let tag = match &p.value {
                    Value::Object(id) => self.document.object(*id).class.tag(),
                    other => other.tag(),
                };
                self.report.error(p.at, format!("{owner} takes no <{tag}> here (or it needs a name)"));
                continue;
            }
            let help = match nearest(&p.name, asked.iter().copied()) {
                Some(near) => Some(format!("did you mean `{near}`?")),
                None if asked.is_empty() => None,
                None => Some(format!("it takes {}", any_of(asked.iter().copied()))),
            };
            let message = format!("{owner} has no property `{}`", p.name);
            match help {
                Some(help) => self.report.error_help(p.at, message, help),
                None => self.report.error(p.at, message),
            }
        }
    }
}
