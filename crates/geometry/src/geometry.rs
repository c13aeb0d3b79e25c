//! All shapes of a scene under one tree.

use crate::offset::error_bound;
use crate::triangle::ShearedRay;
use crate::{Disk, MeshError, Sphere, TriangleMesh};
use manylight_math::{Aabb, Ray, Vec2, Vec3, Vec3A};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::{Boundable, BvhBuildParams};
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
    #[error("{primitives} primitives: at most 2^31 are possible")]
    TooMany {
        /// How many.
        primitives: usize,
    },
}

/// A primitive in the order of the tree's leaves.
#[derive(Clone, Copy, Debug)]
struct Primitive {
    shape: u32,
    /// Triangle within the mesh, or `ROUND`.
    triangle: u32,
}
const ROUND: u32 = u32::MAX;

/// All shapes of a scene, and the tree over them.
pub struct Geometry {
    shapes: Vec<ShapeGeometry>,
    bvh: Bvh2,
    primitives: Vec<Primitive>,
    /// Corners in the order of `primitives`; unused for round shapes.
    corners: Vec<[Vec3; 3]>,
    bounds: Aabb,
}

struct Box3(Aabb);
impl Boundable for Box3 {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        obvhs::aabb::Aabb::new(Vec3A::from(self.0.lo), Vec3A::from(self.0.hi))
    }
}

impl Geometry {
    /// Builds the tree. Triangles without area, and repetitions of a triangle within one shape, can not be hit: they are taken
    /// out of their meshes, so that what has an area, and may shine, is what rays meet.
    pub fn build(mut shapes: Vec<ShapeGeometry>) -> Result<Self, GeometryError> {
        let mut primitives = Vec::new();
        let mut bounds = Aabb::EMPTY;
        for (i, shape) in shapes.iter_mut().enumerate() {
            validate(i, shape)?;
            bounds = bounds.join(&shape.bounds());
            match shape {
                ShapeGeometry::Mesh(mesh) => {
                    drop_what_cannot_be_hit(mesh);
                    let triangles = 0..mesh.triangles.len() as u32;
                    primitives.extend(triangles.map(|triangle| Primitive { shape: i as u32, triangle }));
                }
                _ => primitives.push(Primitive { shape: i as u32, triangle: ROUND }),
            }
        }
        if primitives.len() > 1 << 31 {
            return Err(GeometryError::TooMany { primitives: primitives.len() });
        }
        // The box test of the tree rounds; boxes padded by a little more than that never lose a hit (they decide nothing else).
        let pad = if bounds.is_empty() {
            0.0
        } else {
            bounds.lo.abs().max(bounds.hi.abs()).max_element() * 4.0 * f32::EPSILON
        };
        let boxes: Vec<Box3> = primitives
            .iter()
            .map(|p| {
                let b = match &shapes[p.shape as usize] {
                    ShapeGeometry::Mesh(mesh) => Aabb::around(mesh.corners(p.triangle as usize)),
                    round => round.bounds(),
                };
                Box3(Aabb { lo: b.lo - pad, hi: b.hi + pad })
            })
            .collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut std::time::Duration::default());
        let primitives: Vec<Primitive> = bvh.primitive_indices.iter().map(|&i| primitives[i as usize]).collect();
        let corners = primitives
            .iter()
            .map(|p| match &shapes[p.shape as usize] {
                ShapeGeometry::Mesh(mesh) => mesh.corners(p.triangle as usize),
                _ => [Vec3::ZERO; 3],
            })
            .collect();
        Ok(Geometry { shapes, bvh, primitives, corners, bounds })
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
        self.bvh.nodes.len() * size_of::<obvhs::bvh2::node::Bvh2Node>()
            + self.bvh.primitive_indices.len() * size_of::<u32>()
            + self.primitives.len() * (size_of::<Primitive>() + size_of::<[Vec3; 3]>())
    }

    /// The first thing that a ray meets, in (0, t_max). The direction must be unit.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let sheared = ShearedRay::new(ray);
        let mut found = None;
        let mut nearest = RayHit::none();
        self.bvh.ray_traverse(obvhs_ray(ray)?, &mut nearest, |r, i| {
            let p = self.primitives[i];
            let hit = if p.triangle == ROUND {
                self.round(p, ray, r.tmax).map(|t| (t, Vec2::ZERO))
            } else {
                sheared.intersect(&self.corners[i], r.tmax).map(|(t, b1, b2)| (t, Vec2::new(b1, b2)))
            };
            match hit {
                Some((t, barycentrics)) => {
                    let triangle = if p.triangle == ROUND { 0 } else { p.triangle };
                    found = Some(Hit { t, shape: p.shape, triangle, barycentrics });
                    t
                }
                None => f32::INFINITY,
            }
        });
        found
    }
    /// Is anything in (0, t_max)? The direction must be unit.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let sheared = ShearedRay::new(ray);
        let Some(r) = obvhs_ray(ray) else { return false };
        !self.bvh.ray_traverse_miss(r, |r, i| {
            let p = self.primitives[i];
            let t = if p.triangle == ROUND {
                self.round(p, ray, r.tmax)
            } else {
                sheared.intersect(&self.corners[i], r.tmax).map(|h| h.0)
            };
            t.unwrap_or(f32::INFINITY)
        })
    }
    /// Everything that a ray meets in (0, t_max), in no order. A hit on an edge that triangles share may be reported for each.
    pub fn every(&self, ray: &Ray, mut visit: impl FnMut(Hit)) {
        let sheared = ShearedRay::new(ray);
        let Some(r) = obvhs_ray(ray) else { return };
        self.bvh.ray_traverse_anyhit(r, |_, i| {
            let p = self.primitives[i];
            let mut hit = |t, triangle, barycentrics| visit(Hit { t, shape: p.shape, triangle, barycentrics });
            match &self.shapes[p.shape as usize] {
                ShapeGeometry::Mesh(_) => {
                    if let Some((t, b1, b2)) = sheared.intersect(&self.corners[i], ray.t_max) {
                        hit(t, p.triangle, Vec2::new(b1, b2));
                    }
                }
                ShapeGeometry::Sphere(s) => s.both(ray).into_iter().flatten().for_each(|t| hit(t, 0, Vec2::ZERO)),
                ShapeGeometry::Disk(d) => d.intersect(ray, ray.t_max).into_iter().for_each(|t| hit(t, 0, Vec2::ZERO)),
            }
        });
    }
    fn round(&self, p: Primitive, ray: &Ray, t_max: f32) -> Option<f32> {
        match &self.shapes[p.shape as usize] {
            ShapeGeometry::Sphere(s) => s.intersect(ray, t_max),
            ShapeGeometry::Disk(d) => d.intersect(ray, t_max),
            ShapeGeometry::Mesh(_) => None,
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

/// `None` if the ray is not finite: such a ray meets nothing.
fn obvhs_ray(ray: &Ray) -> Option<ObvhsRay> {
    let finite = ray.origin.is_finite() && ray.dir.is_finite();
    finite.then(|| ObvhsRay::new(ray.origin.into(), ray.dir.into(), 0.0, ray.t_max))
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
