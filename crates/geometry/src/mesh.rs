//! Triangle meshes.

use manylight_math::{Aabb, DAffine3, DMat3, Vec2, Vec3};

/// Triangles over shared vertices, in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// \[m\]
    pub positions: Vec<Vec3>,
    /// Shading normals: empty, or one per vertex. Unit.
    pub normals: Vec<Vec3>,
    /// Texture coordinates: empty, or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

/// What is wrong with a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    IndexOutOfRange {
        /// Which triangle.
        triangle: usize,
        /// Which vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A position, normal or texture coordinate is NaN or infinite.
    #[error("{what} {vertex} is not finite")]
    NotFinite {
        /// "position", "normal" or "texture coordinate".
        what: &'static str,
        /// Which vertex.
        vertex: usize,
    },
    /// There are neither none nor as many as vertices.
    #[error("{count} {what}s for {vertices} vertices: expected none or one per vertex")]
    Count {
        /// "normal" or "texture coordinate".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many vertices.
        vertices: usize,
    },
    /// A coordinate is so large that squared distances overflow.
    #[error("position {vertex} lies beyond 1e15 m of the origin, where squared distances overflow")]
    TooFar {
        /// Which vertex.
        vertex: usize,
    },
}

impl TriangleMesh {
    /// The square [-1, 1]^2 in the xy plane, normal +z, texture coordinates [0, 1]^2, under a transform.
    pub fn rectangle(to_world: &DAffine3) -> Self {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let mut mesh = TriangleMesh {
            positions: corners.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect(),
            normals: vec![Vec3::Z; 4],
            uvs: corners.iter().map(|&(x, y)| Vec2::new(0.5 * x + 0.5, 0.5 * y + 0.5)).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        mesh.transform(to_world);
        mesh
    }
    /// The cube [-1, 1]^3 with normals outwards and, on each face, the texture coordinates [0, 1]^2 of Mitsuba's `cube`,
    /// under a transform.
    pub fn cube(to_world: &DAffine3) -> Self {
        let mut mesh = TriangleMesh::default();
        // Normal, and the way u grows; v grows along s x n, so that images are seen mirrored from outside.
        for (n, s) in [
            (Vec3::X, Vec3::Y),
            (Vec3::NEG_X, Vec3::Y),
            (Vec3::Y, Vec3::NEG_X),
            (Vec3::NEG_Y, Vec3::Z),
            (Vec3::Z, Vec3::Y),
            (Vec3::NEG_Z, Vec3::NEG_Y),
        ] {
            let t = s.cross(n);
            let base = mesh.positions.len() as u32;
            for (a, b) in [(-1.0f32, -1.0f32), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions.push(n + s * a + t * b);
                mesh.normals.push(n);
                mesh.uvs.push(Vec2::new(0.5 * a + 0.5, 0.5 * b + 0.5));
            }
            mesh.triangles.extend([[base, base + 2, base + 1], [base, base + 3, base + 2]]);
        }
        mesh.transform(to_world);
        mesh
    }
    /// Moves positions and, by the inverse transpose, normals.
    pub fn transform(&mut self, to_world: &DAffine3) {
        for p in &mut self.positions {
            *p = to_world.transform_point3(p.as_dvec3()).as_vec3();
        }
        let normal: DMat3 = to_world.matrix3.inverse().transpose();
        let turned = normal != DMat3::IDENTITY;
        for n in &mut self.normals {
            // What is unit to rounding and stays where it is is not moved by rounding once more.
            if turned || (n.as_dvec3().length_squared() - 1.0).abs() > 1e-6 {
                *n = (normal * n.as_dvec3()).normalize_or_zero().as_vec3();
            }
        }
    }
    /// Gives each vertex the mean of its triangles' normals, weighted by their angles at it (Thürmer and Wüthrich 1998).
    pub fn compute_smooth_normals(&mut self) {
        let mut sums = vec![manylight_math::DVec3::ZERO; self.positions.len()];
        for t in &self.triangles {
            let v = t.map(|i| self.positions[i as usize].as_dvec3());
            let n = (v[1] - v[0]).cross(v[2] - v[0]).normalize_or_zero();
            for k in 0..3 {
                let (a, b) = (v[(k + 1) % 3] - v[k], v[(k + 2) % 3] - v[k]);
                let angle = a.normalize_or_zero().dot(b.normalize_or_zero()).clamp(-1.0, 1.0).acos();
                sums[t[k] as usize] += n * angle;
            }
        }
        // A vertex without area has no say: any unit normal will do.
        self.normals = sums.into_iter().map(|n| n.normalize_or(manylight_math::DVec3::Z).as_vec3()).collect();
    }
    /// Turns all normals round (and the winding with them).
    pub fn flip_normals(&mut self) {
        self.normals.iter_mut().for_each(|n| *n = -*n);
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    /// The three corners of triangle `i`. \[m\]
    pub fn corners(&self, i: usize) -> [Vec3; 3] {
        self.triangles[i].map(|v| self.positions[v as usize])
    }
    /// Area of triangle `i`. [m^2]
    pub fn triangle_area(&self, i: usize) -> f64 {
        let [a, b, c] = self.corners(i).map(|p| p.as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    }
    /// The smallest box around all vertices.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.positions.iter().copied())
    }
    /// Are all indices in range, all numbers finite, all counts right?
    pub fn validate(&self) -> Result<(), MeshError> {
        let vertices = self.positions.len();
        for (what, count) in [("normal", self.normals.len()), ("texture coordinate", self.uvs.len())] {
            if count != 0 && count != vertices {
                return Err(MeshError::Count { what, count, vertices });
            }
        }
        for (vertex, p) in self.positions.iter().enumerate() {
            if !p.is_finite() {
                return Err(MeshError::NotFinite { what: "position", vertex });
            }
            if p.abs().max_element() > 1e15 {
                return Err(MeshError::TooFar { vertex });
            }
        }
        if let Some(vertex) = self.normals.iter().position(|n| !n.is_finite()) {
            return Err(MeshError::NotFinite { what: "normal", vertex });
        }
        if let Some(vertex) = self.uvs.iter().position(|n| !n.is_finite()) {
            return Err(MeshError::NotFinite { what: "texture coordinate", vertex });
        }
        for (triangle, t) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = t.iter().find(|&&v| v as usize >= vertices) {
                return Err(MeshError::IndexOutOfRange { triangle, vertex, vertices });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_is_closed_and_faces_outwards() {
        let cube = TriangleMesh::cube(&DAffine3::IDENTITY);
        let area: f64 = (0..12).map(|i| cube.triangle_area(i)).sum();
        assert!((area - 24.0).abs() < 1e-9);
        for i in 0..12 {
            let [a, b, c] = cube.corners(i);
            let n = (b - a).cross(c - a);
            assert!(n.dot(a + b + c) > 0.0 && n.normalize().dot(cube.normals[cube.triangles[i][0] as usize]) > 0.999);
        }
    }
    #[test]
    fn bad_meshes_say_what_is_wrong() {
        let mut mesh = TriangleMesh::rectangle(&DAffine3::IDENTITY);
        assert_eq!(mesh.validate(), Ok(()));
        mesh.triangles[1][2] = 9;
        assert_eq!(mesh.validate(), Err(MeshError::IndexOutOfRange { triangle: 1, vertex: 9, vertices: 4 }));
        mesh.positions[3].y = f32::NAN;
        assert_eq!(mesh.validate(), Err(MeshError::NotFinite { what: "position", vertex: 3 }));
        mesh.normals.pop();
        assert_eq!(mesh.validate(), Err(MeshError::Count { what: "normal", count: 3, vertices: 4 }));
    }
    #[test]
    fn smooth_normals_of_a_sphere_like_mesh_point_outwards() {
        let mut cube = TriangleMesh {
            positions: (0..8).map(|i| Aabb { lo: -Vec3::ONE, hi: Vec3::ONE }.corner(i)).collect(),
            ..TriangleMesh::default()
        };
        cube.triangles = vec![
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6],
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3],
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5],
        ];
        cube.compute_smooth_normals();
        for (p, n) in cube.positions.iter().zip(&cube.normals) {
            assert!((p.normalize() - *n).length() < 1e-5, "the weights by angle make it symmetric: {n}");
        }
    }
}
