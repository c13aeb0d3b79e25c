//! Parameters with their values.

use crate::error::near;
use crate::{MethodInfo, RecipeError};
use manylight_scene::Scene;

/// Every parameter of a method with its value, checked against its kind.
pub(crate) struct Values {
    all: Vec<(&'static str, String)>,
    given: Vec<&'static str>,
}

impl Values {
    pub fn new(method: &MethodInfo, given: &[(String, String)]) -> Result<Self, RecipeError> {
        let mut values = Values {
            all: method.params().map(|p| (p.name, method.default_of(&p).to_string())).collect(),
            given: Vec::new(),
        };
        for (name, value) in given {
            let Some(param) = method.params().find(|p| p.name == name) else {
                let near = near(name, method.params().map(|p| p.name).collect::<Vec<_>>().into_iter());
                return Err(RecipeError::Param { method: method.name.into(), name: name.clone(), near });
            };
            if values.given.contains(&param.name) {
                return Err(RecipeError::Twice(name.clone()));
            }
            if !param.kind.accepts(value) {
                return Err(RecipeError::Value {
                    name: name.clone(),
                    value: value.clone(),
                    expected: param.kind.expected(),
                });
            }
            values.given.push(param.name);
            if let Some(slot) = values.all.iter_mut().find(|v| v.0 == param.name) {
                slot.1 = value.clone();
            }
        }
        for param in method.params().filter(|p| values.is_given(p.name)) {
            // What another is part of may itself be part of a third.
            let mut reader = Some(param);
            while let Some((other, with)) = reader.and_then(|p| p.part_of) {
                if !with.iter().any(|w| values.has_term(other, w)) {
                    return Err(RecipeError::Contrary(format!(
                        "`{}` is read only with {other}={}, and {other} is `{}`: leave it out, or say so",
                        param.name,
                        with.join("|"),
                        values.text(other)
                    )));
                }
                reader = method.params().find(|p| p.name == other);
            }
        }
        Ok(values)
    }
    /// Is this the value, or one of the terms of a sum?
    pub fn has_term(&self, name: &str, term: &str) -> bool {
        self.text(name).split('+').any(|t| t == term)
    }
    /// The value of a parameter that the method has. Panics otherwise: a recipe that reads what it does not declare is wrong.
    pub fn text(&self, name: &str) -> &str {
        match self.all.iter().find(|v| v.0 == name) {
            Some(v) => &v.1,
            None => panic!("a recipe reads `{name}`, which its table of parameters does not declare"),
        }
    }
    /// A whole number; its kind has been checked.
    pub fn integer(&self, name: &str) -> Result<u64, RecipeError> {
        self.parse(name, "a whole number")
    }
    /// A number; its kind has been checked.
    pub fn number(&self, name: &str) -> Result<f32, RecipeError> {
        self.parse(name, "a number")
    }
    fn parse<T: std::str::FromStr>(&self, name: &str, expected: &str) -> Result<T, RecipeError> {
        let value = self.text(name);
        value.parse().map_err(|_| RecipeError::Value {
            name: name.into(),
            value: value.into(),
            expected: expected.into(),
        })
    }
    /// Was it given by the user?
    pub fn is_given(&self, name: &str) -> bool {
        self.given.contains(&name)
    }
    /// (shortest, longest) path, in edges.
    pub fn depths(&self, scene: &Scene) -> Result<(u32, u32), RecipeError> {
        let max = match self.text("max-depth") {
            "scene" => scene.max_depth().unwrap_or(u32::MAX),
            "none" => u32::MAX,
            _ => self.integer("max-depth")? as u32,
        };
        let min = self.integer("min-depth")? as u32;
        if max == 0 {
            return Err(RecipeError::Contrary(
                "the scene file's max_depth is 0, which leaves no path: say max-depth=..".into(),
            ));
        }
        if min > max {
            return Err(RecipeError::Contrary(format!("min-depth={min} lies above max-depth={max}: no path is left")));
        }
        Ok((min, max))
    }
    pub fn into_pairs(self) -> Vec<(String, String)> {
        self.all.into_iter().map(|(n, v)| (n.to_string(), v)).collect()
    }
}
