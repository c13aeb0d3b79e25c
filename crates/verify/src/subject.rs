//! What is held against its claim.

use manylight_framework::Method;
use manylight_scene::Scene;

/// Values of knobs, by the names of [`KnobSet::names`](manylight_framework::KnobSet::names); those that are not named stay as they are.
pub type Knobs = [(&'static str, &'static str)];

/// A method that renders a scene.
pub struct Built {
    /// What renders.
    pub method: Box<dyn Method>,
    /// Camera samples a pixel and pass.
    pub spp: u32,
}

/// Something that makes a method for any scene and any setting of its knobs.
pub trait Subject: Sync {
    /// What it is called.
    fn name(&self) -> String;
    /// The method, or why there is none for this scene with these knobs.
    fn build(&self, scene: &Scene, knobs: &Knobs) -> Result<Built, String>;
    /// Is it the path tracer itself? Then it is held against bidirectional path tracing.
    fn is_path_tracer(&self) -> bool {
        false
    }
}

/// A subject made of a closure.
pub struct Made<F> {
    /// What it is called.
    pub name: String,
    /// Makes the method.
    pub make: F,
}

impl<F> Subject for Made<F>
where
    F: Fn(&Scene, &Knobs) -> Result<Built, String> + Sync,
{
    fn name(&self) -> String {
        self.name.clone()
    }
    fn build(&self, scene: &Scene, knobs: &Knobs) -> Result<Built, String> {
        (self.make)(scene, knobs)
    }
}
