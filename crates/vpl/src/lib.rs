//! Virtual point lights (Keller 1997): light walks that leave a light at each vertex, and the kernel that connects them.
//!
//! Of N paths, the vertex y_j of a path with throughput alpha_j \[W\] becomes a light of flux alpha_j / N that emits by its own
//! BSDF, and brings to a receiver x
//!
//! > f(x) cos_x cos_y / |x - y|^2 f(y) alpha_j / N   x visibility.
//!
//! ```
//! use manylight_framework::{Generator, Probe};
//! use manylight_vpl::{Emission, Keller};
//! # use manylight_scene::{Camera, Emitter, Material, Model, Scene, Shape, Source};
//! # use manylight_geometry::{ShapeGeometry, Sphere};
//! # use manylight_math::{DAffine3, Spectrum, Vec3};
//! # let mut b = Scene::builder();
//! # let material = b.material(Material::two_sided("white", Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.5)) }));
//! # b.shape(Shape { name: "room".into(), geometry: ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), material, radiance: None });
//! # b.emitter(Emitter::Point { position: Vec3::ZERO, intensity: Spectrum::ONE });
//! # b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (4, 4))?);
//! # let scene = b.build()?;
//! // A point light of 1 W/sr in a closed room: the first vertices of all paths carry its 4 pi W.
//! let keller = Keller { paths: 100, max_edges: Some(3), certain_edges: 1, emission: Emission::Full };
//! let batch = keller.generate(&scene, 0, 1, &mut Probe::default())?;
//! let first: f32 = batch.lights.iter().filter(|l| l.edges == 1).map(|l| l.flux.luminance()).sum();
//! assert!((first - 4.0 * std::f32::consts::PI).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bidirectional;
mod cluster;
mod emitters;
mod importance;
mod keller;
mod kernel;
mod rejection;
mod reverse;
mod sum;
mod vpl;
mod walk;

pub use bidirectional::Bidirectional;
pub use cluster::Cluster;
pub use emitters::Emitters;
pub use importance::Importons;
pub use keller::{Emission, Keller, walk_all};
pub use kernel::{Points, connect_vertices};
pub use rejection::Rejection;
pub use sum::{NoLights, Sum};
pub use vpl::Vpl;
pub use walk::{Length, Step, walk, walk_along};
