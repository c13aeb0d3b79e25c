//! A hard case.

use super::site::{Made, Units};
use manylight_scene::Scene;

/// Mean radiance of the image by channel, where it is known. [W/(m^2 sr)]
pub type Truth = Option<[f64; 3]>;

/// A scene that is built to break things.
#[derive(Clone, Copy)]
pub struct Case {
    /// What it is called.
    pub name: &'static str,
    /// What is hard about it.
    pub about: &'static str,
    pub(super) make: fn(Units) -> Made,
    /// In paths of at most so many edges.
    pub(super) truth: fn(u32) -> Truth,
    /// Is the geometry term bounded, so that unbounded lights have a finite variance too?
    pub(super) bounded_g: bool,
}

impl Case {
    pub(super) const fn new(
        name: &'static str,
        about: &'static str,
        make: fn(Units) -> Made,
        truth: fn(u32) -> Truth,
    ) -> Case {
        Case { name, about, make, truth, bounded_g: false }
    }
    /// All of them.
    pub fn all() -> impl Iterator<Item = &'static Case> {
        super::surfaces::CASES.iter().chain(super::media::CASES)
    }
    /// The scene in some units; `Err`: the case itself is broken.
    pub fn scene(&self, units: Units) -> Result<Scene, String> {
        (self.make)(units)
    }
    /// Mean radiance of the image in [`Units::PLAIN`], by paths of at most so many edges. [W/(m^2 sr)]
    pub fn truth(&self, edges: u32) -> Truth {
        (self.truth)(edges)
    }
}
