//! The part of a connection that the lights keep, and estimates of the part that was taken.

use crate::{Claim, Image, Pair, PathClasses, Probe, Promise, Scheduler};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Scene, Vertex};

/// Splits each connection into a part that the lights keep and a part that is left to a compensator: `keep` and `1 - keep`, a
/// partition of unity by construction.
pub trait Bounding: Promise + Send + Sync {
    /// The part that is kept, in [0, 1].
    fn keep(&self, pair: &Pair) -> f32;
    /// Largest keep x G that there can be; infinity if none. [1/m^2]
    fn cap(&self) -> f32 {
        f32::INFINITY
    }
    /// Can `keep` be asked about two points that no light has seen? (A method, not a const: `&dyn Bounding` must exist.)
    fn compensable(&self) -> bool {
        true
    }
}

/// The bounding of each pass: `auto` looks at the number of paths, `progressive` at the pass.
pub trait BoundingPlan: Promise + Send + Sync {
    /// A pass's bounding.
    type Pass: Bounding;
    /// The bounding of pass `pass`, whose generator walked `paths` paths.
    fn at(&self, scene: &Scene, pass: u64, paths: u64) -> Self::Pass;
    /// Does it make the variance of any kernel finite?
    fn tames(&self) -> bool;
}

/// Keeps nothing: all light is left to the compensator, which so becomes a path tracer.
#[derive(Clone, Copy, Debug)]
pub struct KeepNothing;
impl Promise for KeepNothing {
    fn claim(&self) -> Claim {
        Claim::DARKENS
    }
}
impl Bounding for KeepNothing {
    fn keep(&self, _: &Pair) -> f32 {
        0.0
    }
    fn cap(&self) -> f32 {
        0.0
    }
}

/// How far along a path a vertex lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Depth {
    /// Edges from the eye.
    pub edges: u32,
    /// Residual steps among them: 0 for what the eye sees.
    pub level: u32,
}

impl Depth {
    /// One residual step further on, of so many edges.
    pub fn step(self, edges: u32) -> Depth {
        Depth { edges: self.edges.saturating_add(edges), level: self.level.saturating_add(1) }
    }
}

/// What a residual path finds where it arrives: the integrator's side of a compensation. Direct light, bounded or not, is the
/// integrator's at every vertex, so that a residual path collects emission behind delta lobes only: never twice.
pub trait Onward: Sync {
    /// Radiance that leaves `y` back along the path through all but its delta lobes: direct light, what the lights bring and the
    /// residual there, without its emission. [W/(m^2 sr)]
    fn scattered(&self, y: &Vertex, at: Depth, probe: &mut Probe, s: &mut Stream) -> Spectrum;
    /// Does a path count that ends on an emitter after so many edges?
    fn counts(&self, edges: u32) -> bool;
    /// May a path go on to an edge of this number? (The last edge of a path leads to an emitter.)
    fn allows(&self, edges: u32) -> bool;
}

/// Estimates, at one point, what the bounding took away.
pub trait Compensator: Send + Sync {
    /// The residual at `x`. [W/(m^2 sr)]
    #[allow(clippy::too_many_arguments)] // each is another party's
    fn residual(
        &self,
        scene: &Scene,
        x: &Vertex,
        at: Depth,
        bounding: &dyn Bounding,
        onward: &dyn Onward,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum;
    /// What a bounding with this claim, and this together, promise.
    fn repairs(&self, bounding: Claim) -> Claim;
    /// Paths that it adds to those that virtual lights make.
    fn finds(&self) -> PathClasses {
        PathClasses::NONE
    }
    /// Are the lights asked where a residual path arrives, `level` residual steps from the eye? If not the bounding there is
    /// [`KeepNothing`].
    fn asks_lights(&self, _level: u32) -> bool {
        true
    }
}

/// Estimates the residual of a whole frame at once: in screen space, or by local virtual lights.
pub trait FrameCompensator: Send + Sync {
    /// What to add to each pixel of the pass. [W/(m^2 sr)]
    fn residual(&self, frame: &Frame, seed: u64, pass: u64, probe: &mut Probe) -> Image;
    /// What a bounding with this claim, and this together, promise.
    fn repairs(&self, bounding: Claim) -> Claim;
    /// What compensates where its residual paths arrive; `None`: nothing does.
    fn deeper(&self) -> Option<&dyn Compensator> {
        None
    }
}

/// Whether, and how, what the bounding took away is estimated.
pub enum Compensation {
    /// It is left.
    None,
    /// At each point.
    Point(Box<dyn Compensator>),
    /// For a whole frame.
    Frame(Box<dyn FrameCompensator>),
}

impl Compensation {
    /// Does it estimate anything? If not, any bounding will do.
    pub fn is_some(&self) -> bool {
        !matches!(self, Compensation::None)
    }
    /// What a bounding with this claim, and this together, promise.
    pub fn repairs(&self, bounding: Claim) -> Claim {
        match self {
            Compensation::None => bounding,
            Compensation::Point(c) => c.repairs(bounding),
            Compensation::Frame(c) => c.repairs(bounding),
        }
    }
    /// What compensates at a point, `level` residual steps from the eye.
    pub fn at(&self, level: u32) -> Option<&dyn Compensator> {
        match self {
            Compensation::Point(c) => Some(&**c),
            Compensation::Frame(c) if level > 0 => c.deeper(),
            _ => None,
        }
    }
    /// Paths that it adds to those that virtual lights make.
    pub fn finds(&self) -> PathClasses {
        match self {
            Compensation::Point(c) => c.finds(),
            _ => PathClasses::NONE,
        }
    }
}

/// What a frame compensator works from.
pub struct Frame<'f> {
    /// The scene.
    pub scene: &'f Scene,
    /// What each pixel's first camera sample sees.
    pub gbuffer: &'f GBuffer,
    /// What was kept.
    pub bounding: &'f dyn Bounding,
    /// The pass as rendered so far.
    pub rendered: &'f Image,
    /// What a residual path finds.
    pub onward: &'f dyn Onward,
    /// Runs tasks.
    pub scheduler: &'f dyn Scheduler,
}

/// What each pixel's first camera sample sees.
pub struct GBuffer {
    /// Pixels in a row.
    pub width: usize,
    /// One a pixel, row by row; `None` where the ray meets nothing that scatters.
    pub pixels: Vec<Option<Pixel>>,
}

/// What the first camera sample of a pixel sees.
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    /// The first vertex with a lobe that is not a delta lobe.
    pub vertex: Vertex,
    /// Edges from the eye.
    pub edges: u32,
    /// Surface that the pixel stands for; a mirror on the way is taken for a window. \[m^2\]
    pub area: f32,
    /// Length of the way from the camera. \[m\]
    pub depth: f32,
    /// Product of the delta lobes on the way from the eye, and the pixel filter's weight.
    pub throughput: Spectrum,
}
