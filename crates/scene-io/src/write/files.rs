//! Meshes as PLY, images as EXR.

use manylight_geometry::TriangleMesh;
use manylight_scene::Bitmap;
use std::io::Cursor;

/// Binary, little endian.
pub(super) fn ply(mesh: &TriangleMesh) -> Vec<u8> {
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n");
    let mut columns = vec!["x", "y", "z"];
    let (normals, uvs) = (!mesh.normals.is_empty(), !mesh.uvs.is_empty());
    columns.extend(["nx", "ny", "nz"].iter().filter(|_| normals));
    columns.extend(["u", "v"].iter().filter(|_| uvs));
    columns.iter().for_each(|c| header.push_str(&format!("property float {c}\n")));
    header.push_str(&format!("element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"));
    let mut bytes = header.into_bytes();
    bytes.reserve(vertices * columns.len() * 4 + faces * 13);
    for i in 0..vertices {
        let mut put = |x: f32| bytes.extend(x.to_le_bytes());
        mesh.positions[i].to_array().into_iter().for_each(&mut put);
        if normals {
            mesh.normals[i].to_array().into_iter().for_each(&mut put);
        }
        if uvs {
            mesh.uvs[i].to_array().into_iter().for_each(&mut put);
        }
    }
    for t in &mesh.triangles {
        bytes.push(3);
        t.iter().for_each(|i| bytes.extend(i.to_le_bytes()));
    }
    bytes
}

/// Linear, in single precision.
pub(super) fn exr(image: &Bitmap) -> std::io::Result<Vec<u8>> {
    use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
    let pixel = |p: Vec2<usize>| {
        let [r, g, b] = image.pixels[p.y() * image.width + p.x()].to_array();
        (r, g, b)
    };
    let mut bytes = Cursor::new(Vec::new());
    let channels = SpecificChannels::rgb(pixel);
    let written = Image::from_channels((image.width, image.height), channels).write().to_buffered(&mut bytes);
    written.map_err(std::io::Error::other)?;
    Ok(bytes.into_inner())
}
