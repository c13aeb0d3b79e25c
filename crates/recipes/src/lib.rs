//! Names for compositions: the only list of everything.
//!
//! Methods and their parameters are data ([`methods`], [`Param`]); help, listings and errors are made of it, and [`build`] turns
//! a name with parameters into a [`Method`](manylight_framework::Method). A new method is one entry here.
//!
//! ```
//! let ir = manylight_recipes::method("instant-radiosity")?;
//! assert!(ir.params().any(|p| p.name == "paths"));
//! let error = manylight_recipes::method("instant-radiositi").unwrap_err();
//! assert!(error.to_string().contains("`instant-radiosity`"));
//! # Ok::<(), manylight_recipes::RecipeError>(())
//! ```

mod compositions;
mod error;
mod params;
mod parts;
mod path_lights;
mod registry;
mod values;
mod yardsticks;

pub use compositions::{COMPOSED, Composition, Is, REFUSED, Refusal, compositions, covering};
pub use error::RecipeError;
pub use params::{Kind, Param};
pub use parts::Vpls;
pub use registry::{MethodInfo, Recipe, build, default_method, method, methods, point_lights};
