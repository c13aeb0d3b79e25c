//! All shapes of a scene under one tree.

use crate::offset::error_bound;
use crate::wide::{Met, Rounds, Solid, Wide};
use crate::{Disk, MeshError, Occluders, Simd, Sphere, TriangleMesh};
use manylight_math::{Aabb, Ray, Vec2, Vec3};
use std::collections::HashSet;

/// One shape.
#[derive(Clone, Debug)]
pub enum ShapeGeometry {
    /// Triangles.
    Mesh(TriangleMesh),
    /// A sphere.
    Sphere(Sphere),
    /// A flat disc.
    Disk(Disk),
}

impl ShapeGeometry {
    /// [m^2]
    pub fn area(&self) -> f64 {
        match self {
            ShapeGeometry::Mesh(m) => (0..m.triangles.len()).map(|i| m.triangle_area(i)).sum(),
            ShapeGeometry::Sphere(s) => s.area() as f64,
            ShapeGeometry::Disk(d) => d.area() as f64,
        }
    }
    /// The smallest box around it.
    pub fn bounds(&self) -> Aabb {
        match self {
            ShapeGeometry::Mesh(m) => m.bounds(),
            ShapeGeometry::Sphere(s) => s.bounds(),
            ShapeGeometry::Disk(d) => d.bounds(),
        }
    }
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray. \[m\]
    pub t: f32,
    /// Index of the shape.
    pub shape: u32,
    /// Triangle within the shape's mesh; 0 on a sphere or disc.
    pub triangle: u32,
    /// Barycentrics of the triangle's second and third vertex.
    pub barycentrics: Vec2,
}

/// A point on a shape with what shading needs.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// \[m\]
    pub p: Vec3,
    /// Bound on the rounding error of `p`, for `offset_from`. \[m\]
    pub error: f32,
    /// Geometric normal, unit, on the side of the shading normal.
    pub ng: Vec3,
    /// Shading normal, unit.
    pub ns: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Derivative of `p` by `u`, not unit; zero if unknown.
    pub dpdu: Vec3,
}

/// Why a tree could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GeometryError {
    /// A mesh is broken.
    #[error("shape {shape}: {error}")]
    Mesh {
        /// Index of the shape.
        shape: usize,
        /// What is wrong.
        error: MeshError,
    },
    /// A sphere or disc is broken.
    #[error("shape {shape}: its centre must be finite and its radius positive and finite")]
    Round {
        /// Index of the shape.
        shape: usize,
    },
    /// More primitives than an index holds.
    #[error("{primitives} primitives: at most 2^30 - 1 are possible")]
    TooMany {
        /// How many.
        primitives: usize,
    },
}

/// What the tree knows by a number: its place in the order of shapes and triangles.
#[derive(Clone, Copy, Debug)]
struct Primitive {
    shape: u32,
    /// Triangle within the mesh; 0 of a sphere or disc.
    triangle: u32,
}

/// All shapes of a scene, and the tree over them.
pub struct Geometry {
    shapes: Vec<ShapeGeometry>,
    primitives: Vec<Primitive>,
    wide: Wide,
    bounds: Aabb,
}

impl Geometry {
    /// Builds the tree. Triangles without area, and repetitions of a triangle within one shape, can not be hit: they are taken
    /// out of their meshes, so that what has an area, and may shine, is what rays meet.
    pub fn build(mut shapes: Vec<ShapeGeometry>) -> Result<Self, GeometryError> {
        let mut bounds = Aabb::EMPTY;
        for (i, shape) in shapes.iter_mut().enumerate() {
            validate(i, shape)?;
            bounds = bounds.join(&shape.bounds());
            if let ShapeGeometry::Mesh(mesh) = shape {
                drop_what_cannot_be_hit(mesh);
            }
        }
        let (primitives, solids) = list(&shapes);
        if primitives.len() > Wide::MOST {
            return Err(GeometryError::TooMany { primitives: primitives.len() });
        }
        let wide = Wide::build(&solids);
        Ok(Geometry { shapes, primitives, wide, bounds })
    }
    /// Chooses what traces rays; `Simd::Auto` if not called. What they meet does not depend on it.
    pub fn set_simd(&mut self, simd: Simd) {
        self.wide.set_simd(simd);
    }
    /// Checks the tree: every primitive in one leaf, every box in its parent's, every number in range. What is wrong, if not:
    /// for tests.
    pub fn validate(&self) -> Result<(), String> {
        self.wide.validate(&list(&self.shapes).1)
    }
    /// The shapes, in the order they were given; their meshes without what can not be hit.
    pub fn shapes(&self) -> &[ShapeGeometry] {
        &self.shapes
    }
    /// The smallest box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
    /// Number of primitives in the tree.
    pub fn primitive_count(&self) -> usize {
        self.primitives.len()
    }
    /// Memory of the tree and its primitives. \[byte\]
    pub fn bytes(&self) -> usize {
        self.wide.bytes() + self.primitives.len() * size_of::<Primitive>()
    }

    /// The first thing that a ray meets, in (0, t_max); of equally near ones the first in the order of shapes and triangles. The
    /// direction must be unit.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.wide.closest(ray, self.rounds(ray), |_| true).map(|met| self.hit(&met))
    }
    /// The first thing that a ray meets, of those that `counts` says true of: what it does not, the ray passes. It is asked of
    /// some hits in (0, t_max), in no order.
    pub fn intersect_where(&self, ray: &Ray, mut counts: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        self.wide.closest(ray, self.rounds(ray), |met| counts(&self.hit(met))).map(|met| self.hit(&met))
    }
    /// Is anything in (0, t_max)? The direction must be unit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.wide.any(ray, self.rounds(ray), |_| true)
    }
    /// Is anything in (0, t_max) of each of up to 64 rays, a bit for each? The same answers as of `occluded`, sooner. `shared` is
    /// the end of each ray that later ones have too, such as the light's: what stopped one of them is tried first.
    pub fn occluded_of(&self, rays: &[Ray], shared: &[Vec3], occluders: &mut Occluders) -> u64 {
        assert!(rays.len() <= 64 && rays.len() == shared.len(), "up to 64 rays, and an end of each");
        self.wide.any_of(rays, shared, occluders, |r, id, limit| self.rounds(&rays[r])(id, limit))
    }
    /// Is anything in (0, t_max) that `counts` says true of?
    pub fn occluded_where(&self, ray: &Ray, mut counts: impl FnMut(&Hit) -> bool) -> bool {
        self.wide.any(ray, self.rounds(ray), |met| counts(&self.hit(met)))
    }
    /// Everything that a ray meets in (0, t_max), in no order. A hit on an edge that triangles share may be reported for each.
    pub fn every(&self, ray: &Ray, visit: impl FnMut(Hit)) {
        let visit = std::cell::RefCell::new(visit);
        let round = |id: u32, _: f32| {
            for t in self.every_on_round(id, ray).into_iter().flatten() {
                (visit.borrow_mut())(self.hit(&Met { t, id, b1: 0.0, b2: 0.0 }));
            }
            None
        };
        self.wide.any(ray, round, |met| {
            (visit.borrow_mut())(self.hit(met));
            false
        });
    }
    fn hit(&self, met: &Met) -> Hit {
        let Primitive { shape, triangle } = self.primitives[met.id as usize];
        Hit { t: met.t, shape, triangle, barycentrics: Vec2::new(met.b1, met.b2) }
    }
    fn rounds(&self, ray: &Ray) -> impl Rounds {
        |id, limit| match &self.shapes[self.primitives[id as usize].shape as usize] {
            ShapeGeometry::Sphere(s) => s.intersect(ray, limit),
            ShapeGeometry::Disk(d) => d.intersect(ray, limit),
            ShapeGeometry::Mesh(_) => None,
        }
    }
    fn every_on_round(&self, id: u32, ray: &Ray) -> [Option<f32>; 2] {
        match &self.shapes[self.primitives[id as usize].shape as usize] {
            ShapeGeometry::Sphere(s) => s.both(ray),
            ShapeGeometry::Disk(d) => [d.intersect(ray, ray.t_max), None],
            ShapeGeometry::Mesh(_) => [None; 2],
        }
    }

    /// The surface at a hit.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        match &self.shapes[hit.shape as usize] {
            ShapeGeometry::Mesh(_) => self.surface_on_triangle(hit.shape, hit.triangle, hit.barycentrics),
            ShapeGeometry::Sphere(s) => sphere_surface(s, (ray.at(hit.t) - s.centre).normalize_or(Vec3::Z)),
            ShapeGeometry::Disk(d) => disk_surface(d, ray.at(hit.t)),
        }
    }
    /// Derivatives of the position by u and by v at a hit, whose surface is `x`; zero where texture coordinates say nothing. \[m\]
    pub fn derivatives(&self, hit: &Hit, x: &Surface) -> (Vec3, Vec3) {
        match &self.shapes[hit.shape as usize] {
            ShapeGeometry::Mesh(mesh) if mesh.uvs.is_empty() => (Vec3::ZERO, Vec3::ZERO),
            ShapeGeometry::Mesh(mesh) => {
                let [v0, v1, v2] = mesh.corners(hit.triangle as usize);
                let [t0, t1, t2] = mesh.triangles[hit.triangle as usize].map(|i| mesh.uvs[i as usize]);
                let (d1, d2) = (t1 - t0, t2 - t0);
                let det = d1.x * d2.y - d1.y * d2.x;
                if det == 0.0 {
                    return (Vec3::ZERO, Vec3::ZERO);
                }
                (((v1 - v0) * d2.y - (v2 - v0) * d1.y) / det, ((v2 - v0) * d1.x - (v1 - v0) * d2.x) / det)
            }
            ShapeGeometry::Sphere(s) => s.derivatives(x.ns),
            ShapeGeometry::Disk(d) => d.derivatives(x.p),
        }
    }
    /// The surface at given barycentrics (second and third vertex) of a triangle. Panics if the shape is no mesh.
    pub fn surface_on_triangle(&self, shape: u32, triangle: u32, b: Vec2) -> Surface {
        let ShapeGeometry::Mesh(mesh) = &self.shapes[shape as usize] else { panic!("shape {shape} is no mesh") };
        mesh_surface(mesh, triangle as usize, b)
    }
    /// The surface of a sphere in a unit direction from its centre. Panics if the shape is no sphere.
    pub fn surface_on_sphere(&self, shape: u32, out: Vec3) -> Surface {
        let ShapeGeometry::Sphere(s) = &self.shapes[shape as usize] else { panic!("shape {shape} is no sphere") };
        sphere_surface(s, out)
    }
    /// The surface of a disc at a point of the unit disc. Panics if the shape is no disc.
    pub fn surface_on_disk(&self, shape: u32, at: Vec2) -> Surface {
        let ShapeGeometry::Disk(d) = &self.shapes[shape as usize] else { panic!("shape {shape} is no disc") };
        disk_surface(d, d.centre + (d.frame.s * at.x + d.frame.t * at.y) * d.radius)
    }
}

/// All primitives, as shapes have them and as the tree sees them.
fn list(shapes: &[ShapeGeometry]) -> (Vec<Primitive>, Vec<Solid>) {
    let (mut primitives, mut solids) = (Vec::new(), Vec::new());
    for (shape, geometry) in shapes.iter().enumerate() {
        let count = if let ShapeGeometry::Mesh(mesh) = geometry { mesh.triangles.len() } else { 1 };
        for triangle in 0..count {
            primitives.push(Primitive { shape: shape as u32, triangle: triangle as u32 });
            solids.push(match geometry {
                ShapeGeometry::Mesh(mesh) => Solid::Triangle(mesh.corners(triangle)),
                round => Solid::Round(round.bounds()),
            });
        }
    }
    (primitives, solids)
}

fn validate(i: usize, shape: &ShapeGeometry) -> Result<(), GeometryError> {
    let round = |c: Vec3, r: f32| {
        let ok = c.is_finite() && r > 0.0 && r <= 1e15 && c.abs().max_element() <= 1e15;
        if ok { Ok(()) } else { Err(GeometryError::Round { shape: i }) }
    };
    match shape {
        ShapeGeometry::Mesh(mesh) => mesh.validate().map_err(|error| GeometryError::Mesh { shape: i, error }),
        ShapeGeometry::Sphere(s) => round(s.centre, s.radius),
        ShapeGeometry::Disk(d) => round(d.centre, d.radius),
    }
}

fn drop_what_cannot_be_hit(mesh: &mut TriangleMesh) {
    let mut seen = HashSet::with_capacity(mesh.triangles.len());
    let hittable = |t: &usize| {
        let mut key = mesh.corners(*t).map(|p| p.to_array().map(f32::to_bits));
        key.sort_unstable();
        mesh.triangle_area(*t) > 0.0 && seen.insert(key)
    };
    mesh.triangles = (0..mesh.triangles.len()).filter(hittable).map(|t| mesh.triangles[t]).collect();
}

fn mesh_surface(mesh: &TriangleMesh, triangle: usize, b: Vec2) -> Surface {
    let ids = mesh.triangles[triangle].map(|i| i as usize);
    let [v0, v1, v2] = mesh.corners(triangle);
    let b0 = 1.0 - b.x - b.y;
    let largest = v0.abs().max(v1.abs()).max(v2.abs()).max_element();
    let mix = |values: &[Vec3]| values[ids[0]] * b0 + values[ids[1]] * b.x + values[ids[2]] * b.y;
    // Slivers lose their normal to cancellation in f32.
    let ng = (v1 - v0).as_dvec3().cross((v2 - v0).as_dvec3()).normalize_or(manylight_math::DVec3::Z).as_vec3();
    let ns = if mesh.normals.is_empty() { ng } else { mix(&mesh.normals).normalize_or(ng) };
    let (uv, dpdu) = if mesh.uvs.is_empty() {
        (b, v1 - v0)
    } else {
        let [t0, t1, t2] = ids.map(|i| mesh.uvs[i]);
        let (d1, d2) = (t1 - t0, t2 - t0);
        let det = d1.x * d2.y - d1.y * d2.x;
        let dpdu = if det == 0.0 { Vec3::ZERO } else { ((v1 - v0) * d2.y - (v2 - v0) * d1.y) / det };
        (t0 * b0 + t1 * b.x + t2 * b.y, dpdu)
    };
    Surface {
        p: v0 * b0 + v1 * b.x + v2 * b.y,
        error: error_bound(largest),
        ng: if ng.dot(ns) < 0.0 { -ng } else { ng },
        ns,
        uv,
        dpdu,
    }
}
fn sphere_surface(s: &Sphere, out: Vec3) -> Surface {
    let (p, n) = s.surface(out);
    let error = error_bound(s.centre.abs().max_element() + s.radius);
    Surface { p, error, ng: n, ns: n, uv: s.uv(n), dpdu: s.dpdu(n) }
}
fn disk_surface(d: &Disk, p: Vec3) -> Surface {
    let p = d.surface(p);
    let n = d.frame.n;
    let error = error_bound(d.centre.abs().max_element() + d.radius);
    Surface { p, error, ng: n, ns: n, uv: d.uv(p), dpdu: (p - d.centre).normalize_or(d.frame.s) }
}
