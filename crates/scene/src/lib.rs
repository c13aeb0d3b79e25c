//! What is rendered: shapes, materials, emitters and a camera; and the two kinds of ends that light transport connects.
//!
//! A path's contribution is a product over its edges and vertices; seen from the eye, an edge from x to y brings
//!
//! > |ns_x . w| |ng_y . w| / |x - y|^2 x visibility,
//!
//! the *shading* normal at the end nearer to the eye, the *geometric* one at the end nearer to the light (Veach 1997,
//! section 5.3). A [`Vertex`] knows on which side it stands by its [`Mode`] and keeps both cosines right.
//!
//! ```
//! use manylight_geometry::{ShapeGeometry, TriangleMesh};
//! use manylight_math::{DAffine3, DVec3, Spectrum, Vec2};
//! use manylight_scene::{Camera, Emitter, Material, Mode, Model, Scene, Shape, Source};
//! let mut builder = Scene::builder();
//! let grey = Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.5)) };
//! let material = builder.material(Material::one_sided("grey", grey));
//! let floor = ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::IDENTITY));
//! builder.shape(Shape { name: "floor".into(), geometry: floor, material, radiance: None });
//! builder.emitter(Emitter::Constant { radiance: Spectrum::ONE });
//! let to_world = DAffine3::from_translation(DVec3::new(0.0, 0.0, -4.0));
//! builder.camera(Camera::perspective(to_world, 40.0, (64, 48))?);
//! let scene = builder.build()?;
//! let ray = scene.camera().ray(Vec2::new(32.0, 24.0));
//! assert!(scene.intersect(&ray, Mode::Radiance).is_some());
//! # Ok::<(), manylight_scene::SceneError>(())
//! ```

mod camera;
mod emitter;
mod environment;
mod filter;
mod hash;
mod inventory;
mod mask;
mod material;
mod media;
mod relief;
mod scene;
mod spot;
mod texture;
mod vertex;
mod visibility;

pub use camera::{Camera, View};
pub use emitter::{Emission, Emitter, EmitterPart, EmitterSample, Emitters, Part, PartAxis};
pub use environment::Environment;
pub use filter::{Filter, FilterSampler};
pub use inventory::Inventory;
pub use manylight_bsdf::{Bsdf, Lobe, Mode};
pub use manylight_geometry::{Occluders, Simd};
pub use manylight_media::{
    Flight, Glow, Grid, HenyeyGreenstein, Heterogeneous, Homogeneous, Interpolation, Medium, MediumError, Volume,
};
pub use material::{Material, MaterialId, Model, PrincipledSources};
pub use media::{Boundary, Run};
pub use relief::Relief;
pub use scene::{Scene, SceneBuilder, SceneError, Shape, ShapeId};
pub use spot::Spot;
pub use texture::{Bitmap, Source, Texture, TextureFilter, TextureId, Wrap};
pub use vertex::{Edge, EmitterPoint, End, MediumPoint, Scatter, Sides, Span, SurfacePoint, Vertex, VertexSample};
