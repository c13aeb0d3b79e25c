//! Wavefront OBJ through tobj. As in Mitsuba, a file is one mesh: groups, objects and materials are passed over.

use super::RawMesh;
use manylight_math::{Vec2, Vec3};
use std::borrow::Cow;

/// Reads a file's content.
pub(crate) fn read(bytes: &[u8]) -> Result<RawMesh, String> {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let Some(clean) = geometry_only(bytes) else {
        return Err(explain(bytes).unwrap_or_else(|| "faces name what is not there".into()));
    };
    // The material callback is never called: `geometry_only` has removed `mtllib`.
    let (models, _) = tobj::load_obj_buf(&mut clean.as_slice(), &options, |_| Err(tobj::LoadError::GenericFailure))
        .map_err(|e| explain(bytes).unwrap_or_else(|| e.to_string()))?;
    let mut raw = RawMesh::default();
    for model in models {
        append(&mut raw, model.mesh);
    }
    raw.check().map_err(|e| explain(bytes).unwrap_or(e))
}

fn append(raw: &mut RawMesh, mesh: tobj::Mesh) {
    let base = raw.positions.len() as u32;
    raw.positions.extend(mesh.positions.chunks_exact(3).map(Vec3::from_slice));
    let vertices = mesh.positions.len() / 3;
    if mesh.normals.len() == 3 * vertices {
        raw.normals.extend(mesh.normals.chunks_exact(3).map(Vec3::from_slice));
    } else if !mesh.normals.is_empty() {
        raw.remarks.push("some faces have normals and some have none: all are computed".into());
    }
    if mesh.texcoords.len() == 2 * vertices {
        raw.uvs.extend(mesh.texcoords.chunks_exact(2).map(Vec2::from_slice));
    } else if !mesh.texcoords.is_empty() {
        raw.remarks.push("some faces have texture coordinates and some have none: all are passed over".into());
    }
    raw.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [base + t[0], base + t[1], base + t[2]]));
}

/// The lines that make geometry, each with the numbers that Mitsuba reads: no colours, no weights, no materials, no groups.
/// `None` if faces name texture coordinates or normals of which there are none (tobj would pass over that).
fn geometry_only(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(bytes.len());
    let (mut has, mut wants) = ([false; 2], [false; 2]);
    for (_, line) in lines(bytes) {
        let mut words = line.split_ascii_whitespace();
        let Some(keyword) = words.next() else { continue };
        let most = match keyword {
            "v" | "vn" => 3,
            "vt" => 2,
            "f" => usize::MAX,
            _ => continue,
        };
        out.extend_from_slice(keyword.as_bytes());
        let mut count = 0;
        match keyword {
            "vt" => has[0] = true,
            "vn" => has[1] = true,
            _ => {}
        }
        for word in words.take(most) {
            if keyword == "f" {
                let mut parts = word.split('/').skip(1);
                wants.iter_mut().for_each(|w| *w |= parts.next().is_some_and(|p| !p.is_empty()));
            }
            out.push(b' ');
            out.extend_from_slice(word.as_bytes());
            count += 1;
        }
        // One-dimensional texture coordinates are legal.
        if keyword == "vt" && count == 1 {
            out.extend_from_slice(b" 0");
        }
        out.push(b'\n');
    }
    (0..2).all(|i| has[i] || !wants[i]).then_some(out)
}

/// Lines with their numbers, comments cut off, lines that end in a backslash joined with the next.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut rest = bytes.split(|&b| b == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (number, first) = rest.next()?;
        let mut line = String::from_utf8_lossy(first);
        while let Some(joined) = line.trim_end().strip_suffix('\\') {
            let Some((_, next)) = rest.next() else { break };
            line = Cow::Owned(format!("{joined} {}", String::from_utf8_lossy(next)));
        }
        let code = line.find('#').map(|i| line[..i].to_owned());
        Some((number + 1, code.map_or(line, Cow::Owned)))
    })
}

/// tobj's errors carry no line: finds the first bad one.
fn explain(bytes: &[u8]) -> Option<String> {
    let (mut v, mut vt, mut vn) = (0i64, 0i64, 0i64);
    for (number, line) in lines(bytes) {
        let mut words = line.split_ascii_whitespace();
        let keyword = words.next().unwrap_or("");
        let words: Vec<&str> = words.collect();
        let found = match keyword {
            "v" => {
                v += 1;
                check_numbers(&words, 3, 3)
            }
            "vn" => {
                vn += 1;
                check_numbers(&words, 3, 3)
            }
            "vt" => {
                vt += 1;
                check_numbers(&words, 1, 2)
            }
            "f" => words.iter().try_for_each(|corner| check_corner(corner, [v, vt, vn])),
            _ => Ok(()),
        };
        if let Err(what) = found {
            return Some(format!("line {number}: {what}"));
        }
    }
    None
}

fn check_numbers(words: &[&str], least: usize, most: usize) -> Result<(), String> {
    if words.len() < least {
        return Err(format!("expected {least} numbers, found {}", words.len()));
    }
    for word in words.iter().take(most) {
        match word.parse::<f32>() {
            Ok(x) if x.is_finite() => {}
            Ok(_) => return Err(format!("`{word}` is not finite")),
            Err(_) => return Err(format!("`{}` is not a number", word.chars().take(40).collect::<String>())),
        }
    }
    Ok(())
}

fn check_corner(corner: &str, counts: [i64; 3]) -> Result<(), String> {
    let what = ["vertices", "texture coordinates", "normals"];
    let shown: String = corner.chars().take(40).collect();
    for (i, index) in corner.split('/').enumerate() {
        if i >= 3 {
            return Err(format!("`{shown}` is no corner of a face: expected v, v/vt, v//vn or v/vt/vn"));
        }
        if index.is_empty() && i > 0 {
            continue;
        }
        let index: i64 = index.parse().map_err(|_| format!("`{shown}` is no corner of a face: expected v, v/vt, v//vn or v/vt/vn"))?;
        if index == 0 || index > counts[i] || index < -counts[i] {
            return Err(format!("`{shown}` names number {index} of {} {}", counts[i], what[i]));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        read(text.as_bytes()).unwrap_err()
    }
    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn groups_and_materials_are_passed_over_and_the_mesh_stays_one() {
        let text = format!("mtllib no.mtl\no a\n{SQUARE}usemtl x\nf 1 2 3\ng b\nusemtl y\nf 1 3 4\n");
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2));
    }
    #[test]
    fn colours_weights_continued_lines_comments_and_negative_indices_are_read() {
        let text = "v 0 0 0 1 1 1 # red\nv 1 0 \\\r\n 0 1\nv 1 1 0\nvt 0.5\nf -3/1 -2/1 -1/1\n";
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.positions[1], Vec3::X);
        assert_eq!(mesh.uvs, vec![Vec2::new(0.5, 0.0); 3]);
    }
    #[test]
    fn normals_of_some_faces_only_count_as_none() {
        let mesh = read(format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n").as_bytes()).unwrap();
        assert!(mesh.normals.is_empty() && mesh.remarks.len() == 1, "{mesh:?}");
    }
    #[test]
    fn mistakes_name_their_line() {
        for (text, want) in [
            ("v 0 0\nf 1 1 1", "line 1: expected 3 numbers, found 2"),
            ("v 0 0 nan\nv 0 0 0\nv 1 0 0\nf 1 2 3", "line 1: `nan` is not finite"),
            ("v 0 0 1e99\nv 0 0 0\nv 1 0 0\nf 1 2 3", "line 1: `1e99` is not finite"),
            ("v 0 0 zero", "line 1: `zero` is not a number"),
            ("v 0 0 0\nf 1 2 3", "line 2: `2` names number 2 of 1 vertices"),
            ("v 0 0 0\nf 0 0 0", "line 2: `0` names number 0 of 1 vertices"),
            ("v 0 0 0\nf 1//7 1 1", "line 2: `1//7` names number 7 of 0 normals"),
            ("v 0 0 0\nf 1/x 1 1", "line 2: `1/x` is no corner of a face: expected v, v/vt, v//vn or v/vt/vn"),
            ("v 0 0 0\n", "the mesh has no faces"),
            ("", "the mesh has no faces"),
        ] {
            assert_eq!(message(text), want, "{text}");
        }
    }
}
