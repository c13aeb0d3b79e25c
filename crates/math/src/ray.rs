//! Rays.

use crate::Vec3;

/// A half line, or a segment of it.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts. \[m\]
    pub origin: Vec3,
    /// Unit direction.
    pub dir: Vec3,
    /// Where it ends; infinity for a half line. \[m\]
    pub t_max: f32,
}

impl Ray {
    /// A half line. `dir` must be unit.
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        Ray { origin, dir, t_max: f32::INFINITY }
    }
    /// The point at distance `t`. \[m\]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.dir * t
    }
}
