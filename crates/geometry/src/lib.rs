//! Where a ray meets the scene: triangle meshes, spheres and discs under one obvhs tree.
//!
//! Triangles are tested watertight (Woop, Benthin and Wald 2013) inside boxes padded against rounding, so that no ray slips
//! through a shared edge. There is no scene-sized epsilon: each hit carries a bound on its own rounding error, and rays leave
//! a surface from just beyond that bound, at both ends of a shadow ray.
//!
//! ```
//! use manylight_geometry::{Geometry, ShapeGeometry, TriangleMesh};
//! use manylight_math::{DAffine3, Ray, Vec3};
//! let quad = ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::IDENTITY));
//! let geometry = Geometry::build(vec![quad])?;
//! let ray = Ray::new(Vec3::new(0.2, 0.3, 2.0), Vec3::NEG_Z);
//! let hit = geometry.intersect(&ray).expect("the ray points at the middle of the quad");
//! assert_eq!(hit.t, 2.0);
//! assert_eq!(geometry.surface(&ray, &hit).ng, Vec3::Z);
//! # Ok::<(), manylight_geometry::GeometryError>(())
//! ```

mod geometry;
mod mesh;
mod offset;
mod round;
mod triangle;
mod wide;

pub use geometry::{Geometry, GeometryError, Hit, ShapeGeometry, Surface};
pub use mesh::{MeshError, TriangleMesh};
pub use offset::{offset_from, shadow_segment};
pub use round::{Disk, Sphere};
pub use wide::{Occluders, Simd};
