//! Bounding: what the lights keep of each connection; and compensation: estimates of what was taken away.
//!
//! With G = cos cos / d^2 unbounded, a light next to a surface makes a splotch there. The bound b keeps min(G, b): a part
//! keep = min(1, b / G) of each connection, which darkens corners. 1 - keep is left to a compensator: [`KolligKeller`] at each point, in media too,
//! [`Engelhardt`] at points of media, roughly,
//! [`LocalLights`] for tiles of the image, [`ScreenSpace`] by the image itself.
//!
//! ```
//! use manylight_compensation::Bound;
//! use manylight_framework::{Bounding, Pair};
//! let near = Pair { g: 50.0, lobes: None };
//! assert_eq!(Bound::Geometry(10.0).keep(&near), 0.2);
//! assert_eq!(Bound::None.keep(&near), 1.0);
//! ```

mod bound;
mod engelhardt;
mod kollig_keller;
mod local;
mod plan;
mod screen_space;

pub use bound::Bound;
pub use engelhardt::{Engelhardt, lost_fraction};
pub use kollig_keller::{Arrival, KolligKeller};
pub use local::LocalLights;
pub use plan::{BoundPlan, Bounded, Level};
pub use screen_space::ScreenSpace;
