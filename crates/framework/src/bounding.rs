//! The part of a connection that the lights keep, and estimates of the part that was taken.

use crate::{Claim, Image, Pair, Probe, Promise};
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

/// Radiance that leaves a vertex after so many further edges: its indirect and direct light, and its emission where the lights
/// cover that (else direct sampling has it already: never twice). The probe goes in as an argument, so that the closure needs
/// no `mut` and can be shared by threads.
pub type Outgoing<'o> = dyn Fn(&Vertex, u32, &mut Probe, &mut Stream) -> Spectrum + Sync + 'o;

/// Estimates, at one point, what the bounding took away.
pub trait Compensator: Send + Sync {
    /// The residual at `x`. [W/(m^2 sr)]
    fn residual(
        &self,
        scene: &Scene,
        x: &Vertex,
        bounding: &dyn Bounding,
        outgoing: &Outgoing,
        probe: &mut Probe,
        s: &mut Stream,
    ) -> Spectrum;
    /// What a bounding with this claim, and this together, promise.
    fn repairs(&self, bounding: Claim) -> Claim;
    /// Does it estimate anything? If not, any bounding will do.
    fn is_some(&self) -> bool {
        true
    }
}

/// Leaves what was taken away.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCompensation;
impl Compensator for NoCompensation {
    fn residual(
        &self,
        _: &Scene,
        _: &Vertex,
        _: &dyn Bounding,
        _: &Outgoing,
        _: &mut Probe,
        _: &mut Stream,
    ) -> Spectrum {
        Spectrum::BLACK
    }
    fn repairs(&self, bounding: Claim) -> Claim {
        bounding
    }
    fn is_some(&self) -> bool {
        false
    }
}

/// Estimates the residual of a whole frame at once: in screen space, or by local virtual lights.
pub trait FrameCompensator: Send + Sync {
    /// What to add to each pixel of the pass. [W/(m^2 sr)]
    fn residual(&self, frame: &Frame, seed: u64, pass: u64, probe: &mut Probe) -> Image;
    /// What a bounding with this claim, and this together, promise.
    fn repairs(&self, bounding: Claim) -> Claim;
}

/// What a frame compensator works from.
pub struct Frame<'f> {
    /// The scene.
    pub scene: &'f Scene,
    /// What each pixel's centre sees.
    pub gbuffer: &'f GBuffer,
    /// What was kept.
    pub bounding: &'f dyn Bounding,
    /// The pass as rendered so far.
    pub rendered: &'f Image,
    /// Radiance that leaves a vertex.
    pub outgoing: &'f Outgoing<'f>,
}

/// What each pixel's centre sees.
pub struct GBuffer {
    /// Pixels in a row.
    pub width: usize,
    /// One a pixel, row by row; `None` where the ray meets nothing that scatters.
    pub pixels: Vec<Option<Pixel>>,
}

/// What a pixel's centre sees.
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    /// The first vertex that scatters into all directions.
    pub vertex: Vertex,
    /// Surface that the pixel stands for. [m^2]
    pub area: f32,
    /// Distance from the camera. \[m\]
    pub depth: f32,
    /// Product of the delta lobes on the way from the eye.
    pub throughput: Spectrum,
}
