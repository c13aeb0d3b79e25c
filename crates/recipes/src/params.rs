//! Parameters, as data.

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A whole number in a range.
    Integer {
        /// Smallest.
        min: u64,
        /// Largest.
        max: u64,
    },
    /// One of some words.
    Choice(&'static [&'static str]),
    /// One of some words, or several joined by `+`.
    Sum(&'static [&'static str]),
    /// A number in a range.
    Number {
        /// Smallest.
        min: f32,
        /// Largest.
        max: f32,
    },
    /// One of some words, or a positive number.
    NumberOr(&'static [&'static str]),
    /// A whole number in a range, or one of some words.
    IntegerOr {
        /// Smallest.
        min: u64,
        /// Largest.
        max: u64,
        /// The words.
        words: &'static [&'static str],
    },
}

impl Kind {
    /// In words.
    pub fn expected(&self) -> String {
        match self {
            Kind::Integer { min, max } => format!("a whole number from {min} to {max}"),
            Kind::Choice(words) => list(words),
            Kind::Sum(words) => format!("{}, or several joined by `+`", list(words)),
            Kind::Number { min, max } => format!("a number from {min} to {max}"),
            Kind::NumberOr(words) => format!("a positive number, {}", list(words)),
            Kind::IntegerOr { min, max, words } => format!("a whole number from {min} to {max}, or {}", list(words)),
        }
    }
    /// Does a value fit?
    pub fn accepts(&self, value: &str) -> bool {
        let integer = |min: u64, max: u64| value.parse().is_ok_and(|n: u64| (min..=max).contains(&n));
        match self {
            Kind::Integer { min, max } => integer(*min, *max),
            Kind::Choice(words) => words.contains(&value),
            Kind::Sum(words) => {
                let terms: Vec<_> = value.split('+').collect();
                let once = |t: &&str| terms.iter().filter(|o| o == &t).count() == 1;
                terms.iter().all(|t| words.contains(t) && once(t))
            }
            Kind::Number { min, max } => value.parse().is_ok_and(|x: f32| (*min..=*max).contains(&x)),
            Kind::NumberOr(words) => {
                words.contains(&value) || value.parse().is_ok_and(|x: f32| x > 0.0 && x.is_finite())
            }
            Kind::IntegerOr { min, max, words } => words.contains(&value) || integer(*min, *max),
        }
    }
}

fn list(words: &[&str]) -> String {
    words.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>().join(" or ")
}

/// One parameter of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Param {
    /// As written in `-P name=value`.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Taken if it is not given.
    pub default: &'static str,
    /// Of a number; empty if it has none.
    pub unit: &'static str,
    /// What it does, in a sentence.
    pub help: &'static str,
    /// Another parameter, and the values of it with which this one is read: given with any other it is an error. `None`: always.
    pub part_of: Option<(&'static str, &'static [&'static str])>,
}

impl Param {
    /// A parameter without unit that is always read.
    pub(crate) const fn new(name: &'static str, kind: Kind, default: &'static str, help: &'static str) -> Param {
        Param { name, kind, default, unit: "", help, part_of: None }
    }
    pub(crate) const fn unit(self, unit: &'static str) -> Param {
        Param { unit, ..self }
    }
    /// Read only if the parameter `other` has one of these values (as a term, where it is a sum).
    pub(crate) const fn part_of(self, other: &'static str, values: &'static [&'static str]) -> Param {
        Param { part_of: Some((other, values)), ..self }
    }
}

/// The largest whole number that parameters take.
pub(crate) const WHOLE: u64 = u32::MAX as u64;

/// Of every method.
pub(crate) const COMMON: &[Param] = &[
    Param::new("spp", Kind::Integer { min: 1, max: 65536 }, "1", "camera samples a pixel and pass"),
    Param::new(
        "max-depth",
        Kind::IntegerOr { min: 1, max: WHOLE, words: &["scene", "none"] },
        "scene",
        "longest path from emitter to eye (1: emission seen directly, 2: direct light); `scene`: what the file says",
    )
    .unit("edges"),
    Param::new(
        "min-depth",
        Kind::Integer { min: 1, max: WHOLE },
        "1",
        "shortest path that counts: together with max-depth it isolates path lengths",
    )
    .unit("edges"),
];

/// Of the path tracer.
pub(crate) const PATH: &[Param] = &[
    Param::new(
        "rr-depth",
        Kind::IntegerOr { min: 1, max: WHOLE, words: &["scene"] },
        "scene",
        "path length from which Russian roulette may end a path; `scene`: what the file says, or 5",
    )
    .unit("edges"),
    Param::new(
        "nee",
        Kind::Choice(&["on", "off"]),
        "on",
        "sample the emitters at each vertex; `off`: find light by chance only",
    ),
];

/// Of whatever traces light paths to the camera.
pub(crate) const TRACERS: &[Param] = &[Param::new(
    "rr-depth",
    Kind::IntegerOr { min: 1, max: WHOLE, words: &["scene"] },
    "scene",
    "path length from which Russian roulette may end a path from either end; `scene`: what the file says, or 5",
)
.unit("edges")];

/// Of the bidirectional path tracer.
pub(crate) const BIDIRECTIONAL: &[Param] = &[Param::new(
    "heuristic",
    Kind::Choice(&["balance", "power"]),
    "balance",
    "by which the ways to make a path are weighed",
)];
