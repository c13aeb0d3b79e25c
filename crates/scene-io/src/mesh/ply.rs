//! Stanford PLY (ascii and both binary orders) through ply-rs-bw; polygons become fans.

use super::RawMesh;
use manylight_math::{Vec2, Vec3};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{BeginList, ElementDef, PropertyAccess, PropertyAccessResult, PropertyType};

/// Reads a file's content.
pub(crate) fn read(bytes: &[u8]) -> Result<RawMesh, String> {
    let said = |e: ply_rs_bw::parser::ParseError| one_line(&e.to_string());
    let mut reader = Reader::new(bytes);
    let header = Parser::<Vertex>::new().read_header(&mut reader).map_err(said)?;
    let mut raw = RawMesh::default();
    for (name, element) in &header.elements {
        // A reader that believes a count could be kept busy for ever by an element without properties.
        if element.properties.is_empty() && element.count > 0 || element.count > bytes.len() {
            return Err(format!("the header promises {} of `{name}`, more than the file holds", element.count));
        }
        match name.as_str() {
            "vertex" => {
                require_coordinates(element)?;
                let vertices = Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header);
                take_vertices(&mut raw, element, &vertices.map_err(said)?);
            }
            "face" => {
                let faces = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header);
                take_faces(&mut raw, &faces.map_err(said)?)?;
            }
            _ => {
                Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, &header).map_err(said)?;
            }
        }
    }
    raw.check()
}

/// The parser's messages run over lines, and quote without end.
fn one_line(message: &str) -> String {
    let lines: Vec<&str> = message.lines().map(|l| l.trim().trim_end_matches('.')).filter(|l| !l.is_empty()).collect();
    lines.join("; ").chars().take(200).collect()
}

fn require_coordinates(element: &ElementDef) -> Result<(), String> {
    match ["x", "y", "z"].iter().find(|p| !has(element, p)) {
        Some(missing) => Err(format!("its vertices have no `{missing}`")),
        None => Ok(()),
    }
}

/// Has the element this property, as a single number?
fn has(element: &ElementDef, name: &str) -> bool {
    element.properties.iter().any(|(n, p)| n == name && matches!(p.data_type, PropertyType::Scalar(_)))
}

fn take_vertices(raw: &mut RawMesh, element: &ElementDef, vertices: &[Vertex]) {
    raw.positions = vertices.iter().map(|v| v.position).collect();
    if ["nx", "ny", "nz"].iter().all(|n| has(element, n)) {
        raw.normals = vertices.iter().map(|v| v.normal).collect();
    }
    if ["u", "v"].iter().all(|n| has(element, n)) || ["s", "t"].iter().all(|n| has(element, n)) {
        raw.uvs = vertices.iter().map(|v| v.uv).collect();
    }
}

fn take_faces(raw: &mut RawMesh, faces: &[Face]) -> Result<(), String> {
    raw.triangles.reserve(faces.len());
    for (i, face) in faces.iter().enumerate() {
        if face.bad {
            return Err(format!("face {i} has an index below zero"));
        }
        if let [first, rest @ ..] = &face.corners[..] {
            raw.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        }
    }
    Ok(())
}

#[derive(Clone, Copy, Default)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
}

impl Vertex {
    fn set(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" => self.normal.x = value,
            "ny" => self.normal.y = value,
            "nz" => self.normal.z = value,
            "u" | "s" => self.uv.x = value,
            "v" | "t" => self.uv.y = value,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Vertex::default()
    }
    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, value)
    }
    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, value as f32)
    }
    fn set_int(&mut self, name: &str, value: i32) -> PropertyAccessResult {
        self.set(name, value as f32)
    }
    fn set_uint(&mut self, name: &str, value: u32) -> PropertyAccessResult {
        self.set(name, value as f32)
    }
    fn set_short(&mut self, name: &str, value: i16) -> PropertyAccessResult {
        self.set(name, f32::from(value))
    }
    fn set_ushort(&mut self, name: &str, value: u16) -> PropertyAccessResult {
        self.set(name, f32::from(value))
    }
    fn set_char(&mut self, name: &str, value: i8) -> PropertyAccessResult {
        self.set(name, f32::from(value))
    }
    fn set_uchar(&mut self, name: &str, value: u8) -> PropertyAccessResult {
        self.set(name, f32::from(value))
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
    bad: bool,
}

impl Face {
    fn set<T: TryInto<u32>>(&mut self, name: &str, list: Vec<T>) -> PropertyAccessResult {
        if !is_corner_list(name) {
            return PropertyAccessResult::Ignored;
        }
        let corners: Option<Vec<u32>> = list.into_iter().map(|i| i.try_into().ok()).collect();
        self.bad = corners.is_none();
        self.corners = corners.unwrap_or_default();
        PropertyAccessResult::Set
    }
}

fn is_corner_list(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Face::default()
    }
    fn begin_list_uint(&mut self, name: &str, _len: usize) -> BeginList<'_, u32> {
        if is_corner_list(name) { BeginList::Fill(&mut self.corners) } else { BeginList::UseSetter }
    }
    fn set_list_int(&mut self, name: &str, value: Vec<i32>) -> PropertyAccessResult {
        self.set(name, value)
    }
    fn set_list_short(&mut self, name: &str, value: Vec<i16>) -> PropertyAccessResult {
        self.set(name, value)
    }
    fn set_list_ushort(&mut self, name: &str, value: Vec<u16>) -> PropertyAccessResult {
        self.set(name, value)
    }
    fn set_list_char(&mut self, name: &str, value: Vec<i8>) -> PropertyAccessResult {
        self.set(name, value)
    }
    fn set_list_uchar(&mut self, name: &str, value: Vec<u8>) -> PropertyAccessResult {
        self.set(name, value)
    }
}

struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Skipped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ascii(vertex: &str, vertices: &[&str], faces: &[&str]) -> String {
        let properties: String = vertex.split(' ').map(|p| format!("property float {p}\n")).collect();
        let head = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\n{properties}element face {}\n",
            vertices.len(),
            faces.len()
        );
        format!(
            "{head}property list uchar int vertex_indices\nend_header\n{}\n{}\n",
            vertices.join("\n"),
            faces.join("\n")
        )
    }

    #[test]
    fn a_quad_becomes_two_triangles_and_s_t_are_u_v() {
        let text = ascii("x y z s t", &["0 0 0 0 0", "1 0 0 1 0", "1 1 0 1 1", "0 1 0 0 1"], &["4 0 1 2 3"]);
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.uvs[2], Vec2::ONE);
        assert!(mesh.normals.is_empty());
    }
    #[test]
    fn both_binary_orders_with_doubles_and_foreign_elements_are_read() {
        for big in [false, true] {
            let order = if big { "big" } else { "little" };
            let mut bytes = format!(
                "ply\nformat binary_{order}_endian 1.0\nelement camera 1\nproperty short id\nelement vertex 3\nproperty double x\n\
                 property double y\nproperty double z\nproperty uchar red\nelement face 1\nproperty uchar flags\n\
                 property list uint ushort vertex_index\nend_header\n"
            )
            .into_bytes();
            let mut put = |x: &[u8]| if big { bytes.extend(x.iter().rev()) } else { bytes.extend(x) };
            put(&7i16.to_le_bytes());
            for p in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0f64]] {
                p.iter().for_each(|x| put(&x.to_le_bytes()));
                put(&[255]);
            }
            put(&[0]);
            put(&3u32.to_le_bytes());
            [0u16, 1, 2].iter().for_each(|i| put(&i.to_le_bytes()));
            let mesh = read(&bytes).unwrap();
            assert_eq!((mesh.positions[2], &mesh.triangles[..]), (Vec3::Y, &[[0, 1, 2]][..]));
        }
    }
    #[test]
    fn mistakes_are_named() {
        let ok = ["0 0 0", "1 0 0", "0 1 0"];
        for (text, want) in [
            (String::new(), "Unexpected"),
            ("solid\n".into(), "Expected magic number 'ply'"),
            (ascii("x y w", &ok, &["3 0 1 2"]), "its vertices have no `z`"),
            (ascii("x y z", &ok, &["3 0 1 3"]), "a face names vertex 3 of 3 (counted from 0)"),
            (ascii("x y z", &ok, &["3 0 1 -1"]), "face 0 has an index below zero"),
            (ascii("x y z", &["0 0 nan", "1 0 0", "0 1 0"], &["3 0 1 2"]), "0 0 nan"),
            (ascii("x y z", &ok, &[]), "the mesh has no faces"),
            (
                ascii("x y z", &ok, &["3 0 1 2"]).replace("vertex 3", "vertex 99999999999"),
                "the header promises 99999999999 of `vertex`",
            ),
            ("ply\nformat ascii 1.0\nelement void 5\nend_header\n".into(), "the header promises 5 of `void`"),
            (ascii("x y z", &ok, &["3 0 1 2"]).replace("vertex 3", "vertex 30"), "(expected 30, got 4)"),
        ] {
            let message = read(text.as_bytes()).unwrap_err();
            assert!(message.contains(want), "{text}\n{message}");
        }
    }
}
