//! Light sets, and the questions that they ask about one receiver.

use crate::{Promise, Reach};
use manylight_math::{Aabb, Ray, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::Edge;

/// Question: what does this light give here, shadows and bounding included?
///
/// A light of too many edges for this receiver, or too few, gives black. With a noisy kernel each answer is a draw of its own,
/// whose expectation is what the light gives. The answer costs one evaluation of the kernel and, unless that is black, one
/// shadow ray.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot say what a light `{L}` gives",
    note = "is there a `Kernel` for this receiver and this light?"
)]
pub trait Contribute<L> {
    /// What one light gives. [W/(m^2 sr)]
    fn contribution(&mut self, light: &L, s: &mut Stream) -> Spectrum;
    /// The same for many at once, so that shadow rays which share an end can be traced together. `out` is as long as `lights`.
    fn contributions(&mut self, lights: &[L], out: &mut [Spectrum], s: &mut Stream) {
        for (l, o) in lights.iter().zip(out) {
            *o = self.contribution(l, s);
        }
    }
}

/// Question: and if nothing stood between? For sets that bring their own shadows, and for those that choose before they trace
/// a ray.
///
/// `Contribute` without its shadow: bounding and limits of edges are included here as well. With an exact kernel this is
/// never below `contribution` in any channel, so that a light which is black here may be left out. With a noisy kernel the two
/// are independent draws: black here says nothing of the next answer. It costs an evaluation of the kernel, and no ray.
pub trait Unshadowed<L> {
    /// What a light gives, without asking for what stands between. [W/(m^2 sr)]
    fn unshadowed(&mut self, light: &L, s: &mut Stream) -> Spectrum;
}

/// Question: at most how much can this cluster give?
pub trait BoundCluster<C> {
    /// Never below the truth. [W/(m^2 sr)]
    fn upper_bound(&self, cluster: &C) -> f32;
}

/// Question: how does this cluster reach here?
pub trait ReachCluster<C> {
    /// Facts to form probabilities from.
    fn reach(&self, cluster: &C) -> Reach;
}

/// Question: where are you? A `Vertex` has one position, a `Span` has none.
#[diagnostic::on_unimplemented(
    message = "receiver `{Self}` has no single position",
    label = "needed by a light set that blends by distance",
    note = "`grid` gathers at points: use `segment = points`, not `span`"
)]
pub trait Located {
    /// \[m\]
    fn position(&self) -> Vec3;
}

/// Question: along what do you lie? A point is a ray without length. For sets that ask the lights nearby alone.
pub trait Stretch {
    /// With a finite `t_max`. \[m\]
    fn stretch(&self) -> Ray;
}

/// Question: how many edges may a path still take, the connection included?
pub trait Limited {
    /// A light of `e` edges can be connected if `e < edges_left`.
    fn edges_left(&self) -> u32;
    /// Lights of fewer edges than this are left out.
    fn edges_least(&self) -> u32 {
        0
    }
}

/// Not a question: a remark for the probe (cut size, certificate). A set that makes some bounds its `Q` by `Notes` too;
/// [`Gather`](crate::Gather) takes them whatever its kernel, and for a receiver in a test `impl Notes for .. {}` is enough.
pub trait Notes {
    /// A named value of this receiver; its mean becomes an image of that name.
    fn note(&mut self, _aov: &'static str, _value: f32) {}
}

/// Estimates the sum of the contributions of all its lights at one receiver. It knows no scene, BSDF or ray: it asks `Q`, and
/// bounds `Q` by exactly the questions that it asks, so that a kernel need only answer what is asked.
///
/// Implement it for every such `Q`, not for one: an integrator asks for it with each [`Gather`](crate::Gather) that borrows a
/// receiver (`for<'g> LightSet<Gather<'g, ..>>`). A set is shared by all threads: what changes lives in `ask` and `s`.
pub trait LightSet<Q>: Sync {
    /// An estimate of the sum; black if there are no lights. [W/(m^2 sr)]
    ///
    /// `s` is the receiver's, and all randomness is drawn from it, so that any sample can be replayed. Keep sums of many lights
    /// in f64: f32 loses three digits over a million.
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum;
}

/// A set that can say which light it would take and with what probability: what multiple importance sampling needs. A light is
/// named by its place in the `Vec` given to `build`. No supertrait: to pick, a set need not be able to connect, and to render, it
/// need not be able to pick.
pub trait Picks<Q>: Sync {
    /// A light and its probability. `None`: no light can contribute.
    fn pick(&self, ask: &mut Q, s: &mut Stream) -> Option<(usize, f64)>;
    /// Probability with which `pick` takes a light.
    fn pmf(&self, ask: &mut Q, light: usize) -> f64;
}

/// What may stand between two ends. A light set sees the scene through this alone, and only while it is built.
pub trait Occlusion: Sync {
    /// Visibility times transmittance; black if blocked. Takes a stream because ratio tracking draws.
    fn transmittance(&self, edge: &Edge, s: &mut Stream) -> Spectrum;
    /// Where there can be receivers.
    fn extent(&self) -> Aabb;
}

/// Why a set could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// A light's numbers are NaN or infinite.
    #[error("light {light} is not finite: its generator is at fault")]
    NotFinite {
        /// Its place.
        light: usize,
    },
    /// More lights than the set can hold.
    #[error("{lights} lights: this light set holds at most {limit}; use fewer paths")]
    TooMany {
        /// How many there are.
        lights: usize,
        /// How many are possible.
        limit: usize,
    },
}

/// An algorithm with its knobs: how to make a light set from lights. Built anew each pass.
///
/// Implement it for `Vec<L>` with `L: VirtualLight` if the set asks about single lights only, with `L: Clustered` if it builds a
/// tree. Its claim is about the sum over the lights it was given, of which a pass has finitely many: that the lights themselves
/// are noisy or few is the generator's claim, and spikes are the kernel's.
pub trait Plan<Lights>: Promise + Send + Sync {
    /// The set.
    type Set: Sync;
    /// Builds the set of one pass. There may be no lights: that is a black set, not an error. Lights of NaN or infinite power
    /// are to be refused here ([`BuildError::NotFinite`]): no one does so before. `s` belongs to this build alone. Rays asked of
    /// `occlusion` are counted.
    fn build(&self, lights: Lights, occlusion: &dyn Occlusion, s: &mut Stream) -> Result<Self::Set, BuildError>;
    /// Does one number stand for several lights, as that of a made-up light does (see [`Blend`](crate::Blend))? Path lengths
    /// are checked light by light when one is asked for, so that one which stands for lights of different edges cannot be cut
    /// off at `max-depth`: a finite depth needs one set an edge count, and the integrator refuses this composition. A set that
    /// asks about given lights alone, and divides by the probability of having drawn each, leaves it at `false`.
    fn merges(&self) -> bool {
        false
    }
}

/// Light adds, so sets add: (surface VPLs by lightcuts, VRLs by brute force) is a light set.
impl<Q, A: LightSet<Q>, B: LightSet<Q>> LightSet<Q> for (A, B) {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        self.0.radiance(ask, s) + self.1.radiance(ask, s)
    }
}
impl<X, Y, A: Plan<X>, B: Plan<Y>> Plan<(X, Y)> for (A, B) {
    type Set = (A::Set, B::Set);
    fn build(&self, l: (X, Y), o: &dyn Occlusion, s: &mut Stream) -> Result<Self::Set, BuildError> {
        Ok((self.0.build(l.0, o, s)?, self.1.build(l.1, o, s)?))
    }
    fn merges(&self) -> bool {
        self.0.merges() || self.1.merges()
    }
}
