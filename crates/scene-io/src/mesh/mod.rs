//! Triangle meshes from files: reading (`obj`, `ply`, `serialized`), then placing in the world.

pub(crate) mod obj;
pub(crate) mod ply;
pub(crate) mod serialized;

use manylight_geometry::TriangleMesh;
use manylight_math::{DAffine3, Vec2, Vec3};

/// A mesh as its file has it, in object space. Every index is in range, every number finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RawMesh {
    pub(crate) positions: Vec<Vec3>,
    /// Empty, or one a vertex; not unit.
    pub(crate) normals: Vec<Vec3>,
    /// Empty, or one a vertex; as in the file.
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// What was passed over in reading.
    pub(crate) remarks: Vec<String>,
}

impl RawMesh {
    /// The invariants above, for readers that do not prove them on the way.
    fn check(self) -> Result<Self, String> {
        let bad = |what: &str, i: usize| Err(format!("{what} of vertex {i} is not a finite number"));
        if let Some(i) = self.positions.iter().position(|p| !p.is_finite()) {
            return bad("the position", i);
        }
        if let Some(i) = self.normals.iter().position(|n| !n.is_finite()) {
            return bad("the normal", i);
        }
        if let Some(i) = self.uvs.iter().position(|uv| !uv.is_finite()) {
            return bad("the texture coordinate", i);
        }
        let vertices = self.positions.len();
        if let Some(i) = self.triangles.iter().flatten().find(|i| **i as usize >= vertices) {
            return Err(format!("a face names vertex {i} of {vertices} (counted from 0)"));
        }
        if self.triangles.is_empty() {
            return Err("the mesh has no faces".into());
        }
        Ok(self)
    }
}

/// How a shape wants its mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub(crate) to_world: DAffine3,
    pub(crate) face_normals: bool,
    pub(crate) flip_normals: bool,
    /// v becomes 1 - v.
    pub(crate) flip_v: bool,
}

/// Transforms, drops triangles without area (their number is returned; no mesh if all are), completes normals. As Mitsuba 3:
/// the file's normals, or smooth ones where it has none, or with `face_normals` none at all.
pub(crate) fn place(raw: &RawMesh, placement: &Placement) -> Result<(Option<TriangleMesh>, usize), String> {
    let mut mesh = TriangleMesh {
        positions: raw.positions.clone(),
        normals: if placement.face_normals { Vec::new() } else { raw.normals.clone() },
        uvs: raw.uvs.clone(),
        triangles: raw.triangles.clone(),
    };
    mesh.transform(&placement.to_world);
    if placement.flip_v {
        mesh.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
    }
    if let Some(i) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(format!("`to_world` moves vertex {i} to infinity"));
    }
    let mut i = 0;
    let areas: Vec<bool> = (0..mesh.triangles.len()).map(|i| mesh.triangle_area(i) > 0.0).collect();
    mesh.triangles.retain(|_| {
        i += 1;
        areas[i - 1]
    });
    let dropped = raw.triangles.len() - mesh.triangles.len();
    if mesh.triangles.is_empty() {
        return Ok((None, dropped));
    }
    if mesh.normals.iter().any(|n| n.length_squared() < 0.5) {
        mesh.normals.clear(); // A zero normal is none.
    }
    if !mesh.normals.is_empty() {
        face_as_the_normals(&mut mesh, &placement.to_world);
    } else if !placement.face_normals {
        mesh.compute_smooth_normals();
    }
    if placement.flip_normals {
        mesh.flip_normals();
    }
    mesh.validate().map_err(|e| e.to_string())?;
    Ok((Some(mesh), dropped))
}

/// A mirroring transform turns the winding, but not the normals that were given: the winding has to follow them.
pub(crate) fn face_as_the_normals(mesh: &mut TriangleMesh, to_world: &DAffine3) {
    if to_world.matrix3.determinant() < 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
}
