//! What can be wrong with a name or a parameter.

/// What is wrong, and what to write instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecipeError {
    /// There is no such method.
    #[error("there is no method `{name}`{}; `manylight list` shows all", nearest(near))]
    Method {
        /// As given.
        name: String,
        /// The nearest name.
        near: Option<String>,
    },
    /// The method has no such parameter.
    #[error("method `{method}` has no parameter `{name}`{}; `manylight list {method}` shows all", nearest(near))]
    Param {
        /// The method.
        method: String,
        /// As given.
        name: String,
        /// The nearest name.
        near: Option<String>,
    },
    /// A value does not fit.
    #[error("{name}={value}: expected {expected}")]
    Value {
        /// The parameter.
        name: String,
        /// As given.
        value: String,
        /// What would fit.
        expected: String,
    },
    /// A parameter is given twice.
    #[error("parameter `{0}` is given twice: give it once")]
    Twice(String),
    /// The method does not scatter in media.
    #[error("the scene has media, and `{method}` knows nothing of them: use {}", all(use_))]
    Media {
        /// The method.
        method: String,
        /// Those that do.
        use_: &'static [&'static str],
    },
    /// The method does not see media shine.
    #[error("a medium of the scene emits light, and `{method}` would leave it out: use {}", all(use_))]
    Fire {
        /// The method.
        method: String,
        /// Those that do.
        use_: &'static [&'static str],
    },
    /// Two parameters say contrary things.
    #[error("{0}")]
    Contrary(String),
}

fn all(names: &[&str]) -> String {
    names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(" or ")
}

fn nearest(near: &Option<String>) -> String {
    near.as_ref().map_or(String::new(), |n| format!(": did you mean `{n}`?"))
}

/// The candidate most like `name`, if any is like it at all.
pub(crate) fn near<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    candidates
        .map(|c| (strsim::jaro_winkler(name, c), c))
        .filter(|(score, _)| *score > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, c)| c.to_string())
}
