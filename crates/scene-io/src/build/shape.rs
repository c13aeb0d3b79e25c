//! Shapes.

use super::{Builder, filename};
use crate::assets::Kind;
use crate::diagnostic::At;
use crate::document::{Class, ObjectId, Property, Value, refuse_plugin};
use crate::mesh::{self, Placement, RawMesh};
use crate::query::Query;
use manylight_geometry::{Disk, ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DVec3, Frame, Vec2};
use manylight_scene::{Boundary, MaterialId, Shape, Sides, Source};
use rayon::prelude::*;

const SHAPES: [&str; 11] =
    ["obj", "ply", "serialized", "rectangle", "cube", "sphere", "disk", "cylinder", "shapegroup", "instance", "merge"];
const MITSUBA: [&str; 6] = ["bsplinecurve", "linearcurve", "sdfgrid", "ellipsoids", "ellipsoidsmesh", "mesh"];

/// Instances are copied out: more triangles than this are more than they are meant for.
const MOST_TRIANGLES: usize = 50_000_000;

/// A shape that is read, but whose mesh is not yet placed.
struct Plan<'a> {
    name: String,
    geometry: Planned<'a>,
    /// `None`: it does nothing but part media.
    material: Option<MaterialId>,
    radiance: Option<Source>,
    sides: Option<Sides>,
}

enum Planned<'a> {
    Ready(ShapeGeometry, At),
    Mesh(&'a RawMesh, Placement, At),
    Cylinder(Cylinder, At),
}

/// Open at both ends.
struct Cylinder {
    ends: [DVec3; 2],
    radius: f64,
    to_world: DAffine3,
    flip_normals: bool,
}

/// Facets of a cylinder.
const SIDES: u32 = 512;

impl<'a> Builder<'a> {
    /// All shapes, in the order of the file; meshes are placed in parallel.
    pub(super) fn shapes(&mut self, scene: &Query<'a>) {
        let shapes = scene.children(Class::Shape);
        if shapes.is_empty() && !scene.object.broken {
            self.report.error(scene.object.at, "the scene has no shapes");
        }
        // What is merged renders as if it stood beside.
        let shapes: Vec<_> = shapes.into_iter().flat_map(|shape| self.unmerged(shape)).collect();
        let mut plans: Vec<Plan> = Vec::new();
        let mut triangles = 0;
        for (id, p) in &shapes {
            let first = plans.len();
            match self.document.object(*id).plugin.as_str() {
                // What is in it shows where there are instances; its mistakes count in any case.
                "shapegroup" => drop(self.group(*id, &DAffine3::IDENTITY)),
                "instance" => plans.extend(self.instance(*id)),
                _ => plans.extend(self.plan(*id, &DAffine3::IDENTITY)),
            }
            triangles += plans[first..].iter().map(|p| p.geometry.triangles()).sum::<usize>();
            if triangles > MOST_TRIANGLES {
                let message = format!("more than {MOST_TRIANGLES} triangles, as every instance is a copy");
                self.report.error(p.at, message);
                return;
            }
        }
        let placed: Vec<_> = plans.par_iter().map(|p| p.geometry.place()).collect();
        for (plan, placed) in plans.into_iter().zip(placed) {
            self.place(plan, placed);
        }
    }

    /// A shape, or those inside a `merge`, which says that they may be one.
    fn unmerged(&self, shape: (ObjectId, &'a Property)) -> Vec<(ObjectId, &'a Property)> {
        if self.document.object(shape.0).plugin != "merge" {
            return vec![shape];
        }
        let q = self.query(shape.0);
        let inside = q.children(Class::Shape);
        if inside.is_empty() && !q.object.broken {
            q.error("a `merge` needs shapes inside it");
        }
        q.finish();
        let (merges, others): (Vec<_>, Vec<_>) =
            inside.into_iter().partition(|shape| self.document.object(shape.0).plugin == "merge");
        if let Some((_, p)) = merges.first() {
            self.report.error(p.at, "a `merge` cannot hold `merge`");
        }
        others
    }

    fn place(&mut self, plan: Plan<'a>, placed: Result<(Option<ShapeGeometry>, usize), String>) {
        let Plan { name, geometry: planned, material, radiance, sides } = plan;
        let at = match planned {
            Planned::Mesh(raw, _, at) => {
                raw.remarks.iter().for_each(|r| self.report.warn(at, format!("`{name}`: {r}")));
                at
            }
            Planned::Ready(_, at) | Planned::Cylinder(_, at) => at,
        };
        match placed {
            Ok((Some(geometry), dropped)) => {
                if dropped > 0 {
                    self.report.warn(at, format!("`{name}`: {dropped} triangles without area are left out"));
                }
                match (material, sides) {
                    (Some(material), sides) => {
                        let shape = self.scene.shape(Shape { name, geometry, material, radiance });
                        if let Some(sides) = sides {
                            self.scene.parts(shape, sides);
                        }
                    }
                    (None, Some(sides)) => self.scene.boundary(Boundary { name, geometry, sides }),
                    // Nobody could tell that it is there.
                    (None, None) => {}
                }
            }
            // Real scenes have such meshes (flat labels and the like).
            Ok((None, all)) => {
                self.report.warn(at, format!("`{name}`: none of its {all} triangles has an area: it is left out"))
            }
            Err(e) => self.report.error(at, format!("`{name}`: {e}")),
        }
    }

    /// The shapes of a `shapegroup`, moved by `outer`.
    fn group(&mut self, id: ObjectId, outer: &DAffine3) -> Vec<Plan<'a>> {
        let q = self.query(id);
        let members = q.children(Class::Shape);
        if members.is_empty() && !q.object.broken {
            q.error("a `shapegroup` needs shapes inside it");
        }
        q.finish();
        let mut plans = Vec::new();
        for (member, p) in members {
            let object = self.document.object(member);
            if matches!(object.plugin.as_str(), "shapegroup" | "instance" | "merge") {
                self.report.error(p.at, format!("a `shapegroup` cannot hold `{}`", object.plugin));
            } else if object.properties.iter().any(|p| self.class_of(&p.value) == Some(Class::Emitter)) {
                self.report.error(p.at, "a shape inside a `shapegroup` cannot shine: write it beside the group");
            } else {
                plans.extend(self.plan(member, outer));
            }
        }
        plans
    }
    fn instance(&mut self, id: ObjectId) -> Vec<Plan<'a>> {
        let q = self.query(id);
        let (to_world, _) = q.to_world();
        let group = q.child(Class::Shape);
        let is_group = group.is_some_and(|g| self.document.object(g).plugin == "shapegroup");
        if !is_group && !q.object.broken {
            q.error("an `instance` needs a reference to a `shapegroup`");
        }
        q.finish();
        match group {
            Some(group) if is_group => self.group(group, &to_world),
            _ => Vec::new(),
        }
    }
    fn class_of(&self, value: &Value) -> Option<Class> {
        match value {
            Value::Object(id) => Some(self.document.object(*id).class),
            _ => None,
        }
    }

    fn plan(&mut self, id: ObjectId, outer: &DAffine3) -> Option<Plan<'a>> {
        let q = self.query(id);
        if !SHAPES.contains(&q.object.plugin.as_str()) {
            refuse_plugin(q.object, &SHAPES, &MITSUBA, self.report);
            return None;
        }
        let radiance = self.radiance(&q);
        let emits = !q.children(Class::Emitter).is_empty();
        let material = match q.child(Class::Bsdf) {
            Some(id) if self.is_null(id) => {
                if emits {
                    q.error("a shape whose BSDF is `null` cannot shine here: give it a BSDF, or take the emitter out");
                }
                Some(None)
            }
            Some(id) => self.material(id).map(Some),
            None => Some(Some(self.default_material(emits))),
        };
        if let Some(id) = q.children(Class::Bsdf).first().map(|(id, _)| *id)
            && emits
            && self.document.object(id).plugin == "mask"
        {
            q.error("a shape whose BSDF is a `mask` cannot shine here: take the mask or the emitter out");
        }
        let sides = self.sides(&q);
        let geometry = self.geometry(&q, outer);
        let file = match q.object.value("filename") {
            Some(Value::Text(file)) => Some(file.clone()),
            _ => None,
        };
        let name = q.object.id.clone().or(file).unwrap_or_else(|| q.object.plugin.clone());
        q.finish();
        Some(Plan { name, geometry: geometry?, material: material?, radiance, sides })
    }

    fn geometry(&mut self, q: &Query<'a>, outer: &DAffine3) -> Option<Planned<'a>> {
        let (to_world, at) = q.to_world();
        let to_world = *outer * to_world;
        let flip_normals = q.boolean("flip_normals", false);
        let ready = match q.object.plugin.as_str() {
            "rectangle" => flat_faced(TriangleMesh::rectangle(&to_world), &to_world, flip_normals),
            "cube" => {
                q.ignore(&["face_normals"]);
                flat_faced(TriangleMesh::cube(&to_world), &to_world, flip_normals)
            }
            "sphere" => {
                let centre = q.point("center").unwrap_or(DVec3::ZERO);
                let radius = q.positive("radius", 1.0);
                let Some(sphere) = sphere(&to_world, centre, radius, flip_normals) else {
                    self.report.error(at, "the `to_world` of a sphere must scale all axes alike");
                    return None;
                };
                ShapeGeometry::Sphere(sphere)
            }
            "cylinder" => {
                let ends = [("p0", DVec3::ZERO), ("p1", DVec3::Z)].map(|(n, default)| q.point(n).unwrap_or(default));
                let radius = q.positive("radius", 1.0);
                if (ends[1] - ends[0]).try_normalize().is_none() {
                    q.error("`p0` and `p1` of a cylinder must not be the same point");
                    return None;
                }
                return Some(Planned::Cylinder(Cylinder { ends, radius, to_world, flip_normals }, q.object.at));
            }
            "disk" => {
                let Some(disk) = disk(&to_world, flip_normals) else {
                    self.report.error(at, "the `to_world` of a disk must scale x and y alike");
                    return None;
                };
                ShapeGeometry::Disk(disk)
            }
            plugin => {
                // Image rows run downwards, and so does v: OBJ files count it upwards.
                let (kind, flip_v) = match plugin {
                    "obj" => (Kind::Obj, true),
                    "ply" => (Kind::Ply, false),
                    _ => (Kind::Serialized(q.integer("shape_index", 0..=i64::from(u32::MAX), 0) as u32), false),
                };
                if matches!(q.object.value("shape_index"), Some(Value::Integer(i)) if u32::try_from(*i).is_err()) {
                    q.ignore(&["filename", "face_normals"]); // There is no such mesh: said already.
                    return None;
                }
                let face_normals = q.boolean("face_normals", false);
                let flip_v = if plugin == "serialized" { false } else { q.boolean("flip_tex_coords", flip_v) };
                let (name, at) = filename(q)?;
                return match self.assets.mesh(name, kind) {
                    Ok(raw) => Some(Planned::Mesh(raw, Placement { to_world, face_normals, flip_normals, flip_v }, at)),
                    Err(failure) => {
                        self.fail(at, failure);
                        None
                    }
                };
            }
        };
        Some(Planned::Ready(ready, q.object.at))
    }
}

impl Planned<'_> {
    fn triangles(&self) -> usize {
        match self {
            Planned::Ready(ShapeGeometry::Mesh(mesh), _) => mesh.triangles.len(),
            Planned::Ready(..) => 1,
            Planned::Mesh(raw, ..) => raw.triangles.len(),
            Planned::Cylinder(..) => 2 * SIDES as usize,
        }
    }
    /// The geometry, if any of it has an area, and how many triangles were dropped.
    fn place(&self) -> Result<(Option<ShapeGeometry>, usize), String> {
        match self {
            Planned::Ready(geometry, _) => Ok((Some(geometry.clone()), 0)),
            Planned::Cylinder(cylinder, _) => {
                Ok((Some(flat_faced(cylinder.mesh(), &cylinder.to_world, cylinder.flip_normals)), 0))
            }
            Planned::Mesh(raw, placement, _) => {
                mesh::place(raw, placement).map(|(mesh, dropped)| (mesh.map(ShapeGeometry::Mesh), dropped))
            }
        }
    }
}

fn flat_faced(mut mesh: TriangleMesh, to_world: &DAffine3, flip_normals: bool) -> ShapeGeometry {
    mesh::face_as_the_normals(&mut mesh, to_world);
    if flip_normals {
        mesh.flip_normals();
    }
    ShapeGeometry::Mesh(mesh)
}

impl Cylinder {
    /// A mesh with its normals and texture coordinates (u around, v along): no farther than 2e-5 radii from it.
    fn mesh(&self) -> TriangleMesh {
        let [p0, p1] = self.ends;
        let frame = Frame::around((p1 - p0).normalize_or(DVec3::Z).as_vec3());
        let mut mesh = TriangleMesh::default();
        for i in 0..=SIDES {
            let u = f64::from(i) / f64::from(SIDES);
            let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
            let out = frame.s.as_dvec3() * cos + frame.t.as_dvec3() * sin;
            for (v, end) in [(0.0, p0), (1.0, p1)] {
                mesh.positions.push((end + out * self.radius).as_vec3());
                mesh.normals.push(out.as_vec3());
                mesh.uvs.push(Vec2::new(u as f32, v));
            }
            if i < SIDES {
                let a = 2 * i;
                mesh.triangles.extend([[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
            }
        }
        mesh.transform(&self.to_world);
        mesh
    }
}

/// The unit vectors along the axes of a transform; left-handed if it mirrors.
fn axes(t: &DAffine3) -> [DVec3; 3] {
    [t.matrix3.x_axis, t.matrix3.y_axis, t.matrix3.z_axis].map(DVec3::normalize)
}

/// `None` if the axes are not equally long and at right angles. A mirroring turns the normals, as in Mitsuba.
fn sphere(to_world: &DAffine3, centre: DVec3, radius: f64, flip_normals: bool) -> Option<Sphere> {
    let scale = to_world.matrix3.determinant().abs().cbrt();
    let [s, t, n] = axes(to_world);
    let lengths = [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis].map(DVec3::length);
    let uniform = lengths.iter().all(|l| (l / scale - 1.0).abs() < 1e-3);
    let right = s.dot(t).abs() < 1e-3 && t.dot(n).abs() < 1e-3 && n.dot(s).abs() < 1e-3;
    let mirrored = to_world.matrix3.determinant() < 0.0;
    (uniform && right).then(|| Sphere {
        centre: to_world.transform_point3(centre).as_vec3(),
        radius: (radius * scale) as f32,
        frame: Frame { s: s.as_vec3(), t: t.as_vec3(), n: n.as_vec3() },
        flipped: flip_normals != mirrored,
    })
}

/// `None` if the transform makes an ellipse of it.
fn disk(to_world: &DAffine3, flip_normals: bool) -> Option<Disk> {
    let m = to_world.matrix3;
    let radius = m.x_axis.length();
    let [s, t, _] = axes(to_world);
    let round = (m.y_axis.length() / radius - 1.0).abs() < 1e-3 && s.dot(t).abs() < 1e-3;
    let n = (m.inverse().transpose() * DVec3::Z).normalize();
    let n = if flip_normals { -n } else { n };
    round.then(|| Disk {
        centre: to_world.translation.as_vec3(),
        radius: radius as f32,
        frame: Frame { s: s.as_vec3(), t: t.as_vec3(), n: n.as_vec3() },
    })
}
