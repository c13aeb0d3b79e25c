//! The traits that every method plugs into, and what a method promises.
//!
//! A many-light method estimates the radiance that leaves a point x towards the eye as a sum over virtual lights,
//!
//! > L(x) = emission + direct light + sum_i  keep_i  x  f / pdf (x, light_i)  x  visibility   +   what the bounding took,
//!
//! and each part of that line is a trait of its own:
//!
//! | part | trait | says |
//! |---|---|---|
//! | where the lights come from | [`Generator`] | walks exactly N light paths and makes lights of them |
//! | one light's transport | [`Kernel`] | connects one receiver (a vertex, or a span of a medium) to one light |
//! | which lights are asked | [`LightSet`], built by a [`Plan`] | an algorithm that asks questions about one receiver |
//! | the part that is kept | [`Bounding`], by pass from a [`BoundingPlan`] | keep + (1 - keep) = 1 by construction |
//! | the part that was taken | [`Compensator`], [`FrameCompensator`] | an estimate of it at a point, or for a whole frame |
//! | an image | [`Integrator`], and its object-safe face [`Method`] | one pass after another |
//!
//! The light set only gives the sum: emission and direct light are the integrator's, which also walks mirrors and glass.
//!
//! A light set never sees a scene, a BSDF or a ray. It asks ([`Contribute`], [`Unshadowed`], [`BoundCluster`],
//! [`ReachCluster`], [`Located`], [`Limited`]) and [`Gather`] answers, as far as its kernel can: lightcuts over a kernel that
//! cannot bound is a compile error that names the missing answer.
//!
//! # Writing a light set
//!
//! A light set is two types: the plan (its knobs) and what the plan builds from each pass's lights. This one asks every second
//! light, chosen by a coin for the whole set, and doubles it:
//!
//! ```
//! use manylight_framework::{BuildError, Claim, Contribute, LightSet, Occlusion, Plan, Promise, VirtualLight};
//! use manylight_math::Spectrum;
//! use manylight_sampling::Stream;
//!
//! struct EverySecond;
//! struct Halves<L>([Vec<L>; 2]);
//!
//! impl Promise for EverySecond {
//!     fn claim(&self) -> Claim { Claim::UNBIASED } // E[2 x (half of the sum)] = the sum
//! }
//! impl<L: VirtualLight> Plan<Vec<L>> for EverySecond {
//!     type Set = Halves<L>;
//!     fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<Halves<L>, BuildError> {
//!         let half = |k: usize| lights.iter().copied().skip(k).step_by(2).collect();
//!         Ok(Halves([half(0), half(1)]))
//!     }
//! }
//! impl<L: VirtualLight, Q: Contribute<L>> LightSet<Q> for Halves<L> {
//!     fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
//!         let half = &self.0[s.next_below(2)];
//!         half.iter().map(|light| ask.contribution(light, s)).sum::<Spectrum>() * 2.0
//!     }
//! }
//! ```
//!
//! To test it, no scene is needed: a receiver is whatever answers the questions.
//!
//! ```
//! # use manylight_framework::{Contribute, VirtualLight};
//! # use manylight_math::Spectrum;
//! # use manylight_sampling::Stream;
//! #[derive(Clone, Copy)]
//! struct Toy(f32);
//! impl VirtualLight for Toy {
//!     fn intensity(&self) -> f32 { self.0 }
//!     fn edges(&self) -> u32 { 1 }
//! }
//! struct Here;
//! impl Contribute<Toy> for Here {
//!     fn contribution(&mut self, light: &Toy, _: &mut Stream) -> Spectrum { Spectrum::gray(light.0) }
//! }
//! ```
//!
//! To render with it, hand the plan to the composite integrator, `ManyLights` of the crate `manylight-many-lights`. The other
//! parts come from crates of their own; these are what is there to begin with:
//!
//! ```text
//! ManyLights {
//!     generator: Box::new(Keller { .. }),        // manylight-vpl: lights of type Vpl
//!     plan: EverySecond,                         // yours
//!     kernel: Points,                            // manylight-vpl: answers Contribute and Unshadowed about a Vpl
//!     bounding: BoundPlan::AUTO,                // manylight-compensation: the plan of a bound, not a bound
//!     compensation: Compensation::None,          // this crate
//!     max_edges: 6, min_edges: 1,                // path lengths, emitter to eye; 2 is direct light
//!     sharp: 0.0,                                // lobes no rougher than this are walked through
//! }
//! ```
//!
//! It is an [`Integrator`], hence a [`Method`], which `render` of the crate `manylight-render` turns into an image. Two methods
//! that differ in their light set alone have, for the same seed and pass, the same virtual lights and camera rays, and the same
//! direct light where a path first asks for it: compare them pass by pass, and that noise cancels.
//!
//! `examples/outside` is a crate outside the workspace that does all of this: a light and a light set of its own, verified.
//!
//! # What does not fit does not compile
//!
//! A set that asks for more than a kernel can answer is an error where the two meet. This set asks for a bound of all its
//! lights; the kernel knows none:
//!
//! ```compile_fail,E0277
//! # use manylight_framework::{BoundCluster, Bounding, Bounds, Gather, LightSet};
//! # use manylight_math::{Aabb, Spectrum};
//! # use manylight_sampling::Stream;
//! # use manylight_scene::Vertex;
//! struct Cut(Aabb);
//! impl<Q: BoundCluster<Aabb>> LightSet<Q> for Cut {
//!     fn radiance(&self, ask: &mut Q, _: &mut Stream) -> Spectrum {
//!         Spectrum::gray(ask.upper_bound(&self.0))
//!     }
//! }
//! struct Plain; // no `impl Bounds<Vertex, Aabb> for Plain`
//! fn gather<B: Bounding>(cut: &Cut, ask: &mut Gather<Vertex, Plain, B>, s: &mut Stream) -> Spectrum {
//!     cut.radiance(ask, s)
//! }
//! ```
//!
//! > error\[E0277\]: kernel `Plain` has no upper bound on cluster `Aabb` at a receiver `Vertex`
//!
//! With the bound it does:
//!
//! ```
//! # use manylight_framework::{BoundCluster, Bounding, Bounds, Gather, LightSet};
//! # use manylight_math::{Aabb, Spectrum};
//! # use manylight_sampling::Stream;
//! # use manylight_scene::Vertex;
//! # struct Cut(Aabb);
//! # impl<Q: BoundCluster<Aabb>> LightSet<Q> for Cut {
//! #     fn radiance(&self, ask: &mut Q, _: &mut Stream) -> Spectrum {
//! #         Spectrum::gray(ask.upper_bound(&self.0))
//! #     }
//! # }
//! # struct Plain;
//! impl Bounds<Vertex, Aabb> for Plain {
//!     fn upper_bound(&self, _: &Vertex, _: &Aabb, cap: f32) -> f32 {
//!         cap
//!     }
//! }
//! # fn gather<B: Bounding>(cut: &Cut, ask: &mut Gather<Vertex, Plain, B>, s: &mut Stream) -> Spectrum {
//! #     cut.radiance(ask, s)
//! # }
//! ```

mod bounding;
mod claim;
mod film;
mod gather;
mod generator;
mod integrator;
mod kernel;
mod light;
mod light_set;
mod probe;
mod receiver;

pub use bounding::{
    Bounding, BoundingPlan, Compensation, Compensator, Depth, Frame, FrameCompensator, GBuffer, KeepNothing, Onward,
    Pixel,
};
pub use claim::{Claim, KnobSet, PathClasses, Promise};
pub use film::{Film, Image, Scheduler, Sequential, TILE, collect};
pub use gather::{BATCH, Gather};
pub use generator::{Batch, GenerateError, Generator};
pub use integrator::{Integrator, Method, PassError};
pub use kernel::{Bounds, Connection, Kernel, Pair, Reach, Reaches};
pub use light::{Blend, Clustered, VirtualLight};
pub use light_set::{
    BoundCluster, BuildError, Contribute, LightSet, Limited, Located, Notes, Occlusion, Picks, Plan, ReachCluster,
    Stretch, Unshadowed,
};
pub use probe::{Explained, Explanation, NonFinite, Probe};
pub use receiver::Receiver;
