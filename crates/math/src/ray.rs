//! Rays.

use crate::Vec3;

/// Which medium of the scene, or vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MediumId(u16);

impl MediumId {
    /// No medium.
    pub const VACUUM: MediumId = MediumId(u16::MAX);
    /// The most media that a scene can have.
    pub const MOST: usize = u16::MAX as usize;

    /// Of a place in the scene's list, which must lie below `MOST`.
    pub const fn new(index: u16) -> Self {
        MediumId(index)
    }
    /// Place in the scene's list; `None` for vacuum.
    pub fn index(self) -> Option<usize> {
        (self != MediumId::VACUUM).then_some(self.0 as usize)
    }
}

/// A half line, or a segment of it.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts. \[m\]
    pub origin: Vec3,
    /// Unit direction.
    pub dir: Vec3,
    /// Where it ends; infinity for a half line. \[m\]
    pub t_max: f32,
    /// The medium that it starts in. Vertices that it meets know their media by it.
    pub medium: MediumId,
}

impl Ray {
    /// A half line that starts in vacuum. `dir` must be unit.
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        Ray { origin, dir, t_max: f32::INFINITY, medium: MediumId::VACUUM }
    }
    /// The same ray in a medium.
    pub fn within(self, medium: MediumId) -> Self {
        Ray { medium, ..self }
    }
    /// The point at distance `t`. \[m\]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.dir * t
    }
}
