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
}

const WHOLE: u64 = u32::MAX as u64;

/// Of every method.
pub(crate) const COMMON: &[Param] = &[
    Param {
        name: "spp",
        kind: Kind::Integer { min: 1, max: 65536 },
        default: "1",
        unit: "",
        help: "camera samples a pixel and pass",
    },
    Param {
        name: "max-depth",
        kind: Kind::IntegerOr { min: 1, max: WHOLE, words: &["scene", "none"] },
        default: "scene",
        unit: "edges",
        help: "longest path from emitter to eye (1: emission seen directly, 2: direct light); `scene`: what the file says",
    },
    Param {
        name: "min-depth",
        kind: Kind::Integer { min: 1, max: WHOLE },
        default: "1",
        unit: "edges",
        help: "shortest path that counts: together with max-depth it isolates path lengths",
    },
];

/// Of every composition of virtual lights.
pub(crate) const MANY_LIGHTS: &[Param] = &[
    Param {
        name: "generator",
        kind: Kind::Choice(&["keller"]),
        default: "keller",
        unit: "",
        help: "where the virtual lights come from",
    },
    Param {
        name: "paths",
        kind: Kind::Integer { min: 1, max: 1 << 24 },
        default: "64",
        unit: "",
        help: "light paths a pass",
    },
    Param {
        name: "rr-depth",
        kind: Kind::Integer { min: 1, max: WHOLE },
        default: "1",
        unit: "edges",
        help: "light path length from which Russian roulette may end a path",
    },
    Param {
        name: "glossy-vpls",
        kind: Kind::Choice(&["on", "off"]),
        default: "on",
        unit: "",
        help: "lights emit by their BSDF; `off`: as diffuse surfaces of the same albedo (keeps the energy, not its directions)",
    },
    Param {
        name: "lights",
        kind: Kind::Choice(&["all", "power"]),
        default: "all",
        unit: "",
        help: "the light set: which lights each point asks",
    },
    Param {
        name: "samples",
        kind: Kind::Integer { min: 1, max: 1 << 20 },
        default: "64",
        unit: "",
        help: "lights that each point asks, for lights=power",
    },
    Param {
        name: "kernel",
        kind: Kind::Choice(&["point"]),
        default: "point",
        unit: "",
        help: "what a virtual light is",
    },
    Param {
        name: "bound",
        kind: Kind::NumberOr(&["none", "auto"]),
        default: "auto",
        unit: "1/m^2",
        help: "largest geometry term cos cos / d^2; `auto`: pi paths / (surface of the scene), so that no light brings more than the mean irradiance",
    },
    Param {
        name: "compensation",
        kind: Kind::Choice(&["none"]),
        default: "none",
        unit: "",
        help: "estimates what the bound takes away",
    },
    Param {
        name: "direct",
        kind: Kind::Choice(&["sampled", "virtual", "only"]),
        default: "sampled",
        unit: "",
        help: "direct light by sampling the emitters, by virtual lights on them, or direct light alone",
    },
];

/// Of the path tracer.
pub(crate) const PATH: &[Param] = &[
    Param {
        name: "rr-depth",
        kind: Kind::IntegerOr { min: 1, max: WHOLE, words: &["scene"] },
        default: "scene",
        unit: "edges",
        help: "path length from which Russian roulette may end a path; `scene`: what the file says, or 5",
    },
    Param {
        name: "nee",
        kind: Kind::Choice(&["on", "off"]),
        default: "on",
        unit: "",
        help: "sample the emitters at each vertex; `off`: find light by chance only",
    },
];
