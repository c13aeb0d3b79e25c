//! The lighting grid hierarchy (Yuksel and Yuksel 2017): lights near a receiver as they are, those farther away in averages at the
//! vertices of grids, the coarser the farther.
//!
//! > L(x) = sum_l sum_v B_l(|x - p_v|) c_v(x),    sum_l B_l(d) = 1 for every d,
//!
//! where level 0 are the lights themselves and c_v is what a light, or an average, gives at x. There are no clusters and no
//! decisions: every weight is continuous in the places of the lights and of the receiver, so that animations do not flicker. The
//! price is a small bias without a bound, which vanishes as `alpha`, the reach of each level in its own spacings, grows.
//!
//! Lights that shine alike to all sides are what it is for. Whatever else a [`Blend`](manylight_framework::Blend) averages, the
//! average of lights of several directions shines to none of them in particular.
//!
//! ```
//! use manylight_framework::Promise;
//! use manylight_lgh::{Lattice, Lgh, weight};
//! use manylight_math::{Aabb, Vec3};
//! assert!(!Lgh::default().claim().noisy);
//! let lattice = Lattice::around(&Aabb::around([Vec3::ZERO, Vec3::ONE]), Lattice::levels_for(1000));
//! assert_eq!((lattice.levels, lattice.spacing(1)), (3, 1.01 / 4.0));
//! // At 1.2 r_1 the first level still counts for 0.8, the second begins to.
//! assert!((weight(1, 3, 1.0, 1.2) - 0.8).abs() < 1e-12 && (weight(2, 3, 2.0, 1.2) - 0.2).abs() < 1e-12);
//! ```

mod blending;
mod grid;
mod hierarchy;
mod lattice;
mod points;

pub use blending::{support, weight};
pub use grid::{GridLights, Lgh, Shadows};
pub use hierarchy::{Hierarchy, Met};
pub use lattice::{Lattice, Place, corner, trilinear};
pub use points::Points;
