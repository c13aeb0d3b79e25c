//! Transport between one receiver and one light, and what is known of a receiver and a cluster.

use crate::Promise;
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Edge, Scene};

/// One sampled connection.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// f / pdf without what stands between. [W/(m^2 sr)]
    pub value: Spectrum,
    /// What has to be clear.
    pub edge: Edge,
    /// What a bounding may see.
    pub pair: Pair,
}

/// What a bounding may look at: two points and their lobes, never the light's flux.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// cos cos / d^2; zero towards infinity. [1/m^2]
    pub g: f32,
    /// Largest channel of the product of both lobes [1/sr^2]. `None` where the light's lobe is not known yet (a residual ray).
    pub lobes: Option<f32>,
}

/// Transport between one kind of receiver and one kind of light: E\[value\] = contribution without occlusion.
#[diagnostic::on_unimplemented(message = "kernel `{Self}` cannot connect a receiver `{R}` to a light `{L}`")]
pub trait Kernel<R, L>: Promise + Sync {
    /// `None`: nothing can arrive, whatever lies between.
    fn connect(&self, scene: &Scene, receiver: &R, light: &L, s: &mut Stream) -> Option<Connection>;
}

/// A kernel that can bound a cluster: never below the truth (of the expectation, if the kernel is noisy).
#[diagnostic::on_unimplemented(
    message = "kernel `{Self}` has no upper bound on cluster `{C}` at a receiver `{R}`",
    note = "`lightcuts` asks for bounds; `stochastic-lightcuts` needs only `Reaches`, `all` and `power` need neither"
)]
pub trait Bounds<R, C>: Sync {
    /// With `cap` the largest keep x G of the bounding: intensity x min(f_cos_max(x) f_cos_max(y) / near^2,
    /// f_max(x) f_max(y) cap), since a capped contribution has no cosine left. [W/(m^2 sr)]
    fn upper_bound(&self, receiver: &R, cluster: &C, cap: f32) -> f32;
}

/// A kernel that can state the facts about a cluster; a light set forms its own probabilities from them.
#[diagnostic::on_unimplemented(
    message = "kernel `{Self}` cannot say how a cluster `{C}` reaches a receiver `{R}`",
    note = "`stochastic-lightcuts` and `light-bvh` ask for `Reaches`; `all` and `power` do not"
)]
pub trait Reaches<R, C>: Sync {
    /// The facts. With `cap` the largest keep x G of the bounding, no squared distance counts as smaller than 1 / cap.
    fn reach(&self, receiver: &R, cluster: &C, cap: f32) -> Reach;
}

/// Facts about a cluster seen from a receiver. Only a `facing` of zero is a promise: nothing in the cluster can contribute.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// What the cluster emits along its lights' axes [W/sr]; for light from infinity, irradiance [W/m^2]: then all distances are one.
    pub intensity: f32,
    /// Largest eval of the receiver towards the box, times the largest cosine of the lights towards the receiver. [1/sr]
    pub facing_max: f32,
    /// The same towards the box's centre, or a guess of it. It may be zero where `facing_max` is not. [1/sr]
    pub facing_guess: f32,
    /// Smallest squared distance to the box. [m^2]
    pub near2: f32,
    /// Largest squared distance to the box. [m^2]
    pub far2: f32,
    /// Squared distance to the box's centre. [m^2]
    pub centre2: f32,
    /// Square of half the box's diagonal. [m^2]
    pub radius2: f32,
}
