//! Bounding of the geometry term: what the lights keep of each connection.
//!
//! With G = cos cos / d^2 unbounded, a light next to a surface makes a splotch there. The bound b keeps min(G, b): a part
//! keep = min(1, b / G) of each connection, which darkens corners. 1 - keep is left to a compensator.
//!
//! ```
//! use manylight_compensation::Bound;
//! use manylight_framework::{Bounding, Pair};
//! let near = Pair { g: 50.0, lobes: None };
//! assert_eq!(Bound::Geometry(10.0).keep(&near), 0.2);
//! assert_eq!(Bound::None.keep(&near), 1.0);
//! ```

mod bound;
mod kollig_keller;
mod plan;

pub use bound::Bound;
pub use kollig_keller::{Arrival, KolligKeller};
pub use plan::{BoundPlan, Bounded, Level};
