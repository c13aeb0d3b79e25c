//! Wavefront OBJ through tobj. As in Mitsuba, a file is one mesh: groups, objects, materials and vertex colours are passed
//! over.
//!
//! tobj 4.0.5 names no lines, accepts numbers that are not finite, overflows on negative texture and normal indices, divides
//! by weights that Mitsuba passes over, and panics on legal MTL files: [`Prepared`] checks each line first, and writes down
//! anew what tobj reads without surprise.

use super::RawMesh;
use manylight_math::{Vec2, Vec3};
use std::borrow::Cow;
use std::path::Path;

/// Reads a file's content.
pub(crate) fn read(bytes: &[u8]) -> Result<RawMesh, String> {
    let mut prepared = Prepared { text: String::with_capacity(bytes.len()), ..Prepared::default() };
    for (number, line) in lines(bytes) {
        prepared.line(number, &line).map_err(|e| format!("line {number}: {e}"))?;
    }
    prepared.mesh()?.check()
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

/// What lines declare: keyword, least and most numbers (weights and colours that follow are passed over), name of many.
const KINDS: [(&str, usize, usize, &str); 3] =
    [("v", 3, 3, "vertices"), ("vt", 1, 2, "texture coordinates"), ("vn", 3, 3, "normals")];

/// The geometry alone, in lines that tobj cannot stumble on.
#[derive(Default)]
struct Prepared {
    text: String,
    counts: [usize; 3],
    /// Faces may come before their vertices: the largest index of each kind, and its line.
    largest: [(i64, usize); 3],
    incomplete_faces: usize,
}

impl Prepared {
    fn line(&mut self, number: usize, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        let keyword = words.next().unwrap_or_default();
        if let Some(kind) = KINDS.iter().position(|k| k.0 == keyword) {
            self.numbers(kind, words)
        } else if keyword == "f" {
            self.face(number, words)
        } else {
            Ok(())
        }
    }

    fn numbers<'a>(&mut self, kind: usize, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let (keyword, least, most, _) = KINDS[kind];
        self.text += keyword;
        let mut found = 0;
        for word in words.take(most) {
            let x: f32 = word.parse().map_err(|_| format!("`{}` is not a number", shorten(word)))?;
            if !x.is_finite() {
                return Err(format!("`{}` is not finite", shorten(word)));
            }
            self.text.extend([" ", word]);
            found += 1;
        }
        if found < least {
            return Err(format!("expected {least} numbers, found {found}"));
        }
        self.text.extend(std::iter::repeat_n(" 0", most - found));
        self.text.push('\n');
        self.counts[kind] += 1;
        Ok(())
    }

    fn face<'a>(&mut self, number: usize, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let start = self.text.len();
        self.text.push('f');
        let mut corners = 0;
        for word in words {
            self.corner(number, word)?;
            corners += 1;
        }
        if corners < 3 {
            self.text.truncate(start);
            self.incomplete_faces += 1;
        } else {
            self.text.push('\n');
        }
        Ok(())
    }

    /// v, v/vt, v//vn or v/vt/vn; counted from 1, or below zero backwards from the last.
    fn corner(&mut self, line: usize, word: &str) -> Result<(), String> {
        let malformed = || format!("`{}` is no corner of a face: expected v, v/vt, v//vn or v/vt/vn", shorten(word));
        for (i, index) in word.split('/').enumerate() {
            if i >= KINDS.len() {
                return Err(malformed());
            }
            self.text.push(if i == 0 { ' ' } else { '/' });
            if index.is_empty() && i > 0 {
                continue;
            }
            let signed: i64 = index.parse().map_err(|_| malformed())?;
            let count = self.counts[i];
            let place = if signed < 0 { signed.saturating_add(count as i64 + 1) } else { signed };
            if !(1..=i64::from(u32::MAX)).contains(&place) {
                return Err(format!("`{}` names number {signed} of {count} {}", shorten(word), KINDS[i].3));
            }
            self.largest[i] = self.largest[i].max((place, line));
            let resolved = (signed < 0).then(|| place.to_string());
            self.text += resolved.as_deref().unwrap_or(index);
        }
        Ok(())
    }

    /// One vertex for each distinct corner, in the order of their first use; polygons as fans.
    fn mesh(self) -> Result<RawMesh, String> {
        for ((largest, line), (count, kind)) in self.largest.into_iter().zip(self.counts.into_iter().zip(KINDS)) {
            if largest > count as i64 {
                return Err(format!("line {line}: a face names number {largest} of {count} {}", kind.3));
            }
        }
        let no_materials = |_: &Path| Err(tobj::LoadError::GenericFailure);
        let (models, _) = tobj::load_obj_buf(&mut self.text.as_bytes(), &tobj::GPU_LOAD_OPTIONS, no_materials)
            .map_err(|e| e.to_string())?;
        let mesh = models.into_iter().next().map(|model| model.mesh).unwrap_or_default();
        let mut raw = RawMesh {
            positions: mesh.positions.chunks_exact(3).map(Vec3::from_slice).collect(),
            normals: mesh.normals.chunks_exact(3).map(Vec3::from_slice).collect(),
            uvs: mesh.texcoords.chunks_exact(2).map(Vec2::from_slice).collect(),
            triangles: mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            remarks: Vec::new(),
        };
        // tobj leaves out what a corner does not have: the rest has lost its vertices.
        let vertices = raw.positions.len();
        if !raw.uvs.is_empty() && raw.uvs.len() < vertices {
            raw.uvs.clear();
            raw.remarks.push("some faces have texture coordinates and some have none: all are passed over".into());
        }
        if !raw.normals.is_empty() && raw.normals.len() < vertices {
            raw.normals.clear();
            raw.remarks.push("some faces have normals and some have none: all are computed".into());
        }
        if self.incomplete_faces > 0 {
            raw.remarks.push(format!("{} faces of fewer than three corners are passed over", self.incomplete_faces));
        }
        Ok(raw)
    }
}

fn shorten(word: &str) -> String {
    word.chars().take(40).collect()
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
    fn faces_may_come_before_their_vertices() {
        let mesh = read(format!("f 1 2 3 4\n{SQUARE}").as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }
    #[test]
    fn mistakes_name_their_line() {
        for (text, want) in [
            ("v 0 0\nf 1 1 1", "line 1: expected 3 numbers, found 2"),
            ("v 0 0 nan\nv 0 0 0\nv 1 0 0\nf 1 2 3", "line 1: `nan` is not finite"),
            ("v 0 0 1e99\nv 0 0 0\nv 1 0 0\nf 1 2 3", "line 1: `1e99` is not finite"),
            ("v 0 0 zero", "line 1: `zero` is not a number"),
            ("v 0 0 0\nf 1 2 3", "line 2: a face names number 3 of 1 vertices"),
            ("v 0 0 0\nf 0 0 0", "line 2: `0` names number 0 of 1 vertices"),
            ("v 0 0 0\nf 1//7 1 1", "line 2: a face names number 7 of 0 normals"),
            (
                "v 0 0 0\nf 9223372036854775807 1 1",
                "line 2: `9223372036854775807` names number 9223372036854775807 of 1 vertices",
            ),
            ("v 0 0 0\nf 1/-1 1 1", "line 2: `1/-1` names number -1 of 0 texture coordinates"),
            ("v 0 0 0\nf 1/x 1 1", "line 2: `1/x` is no corner of a face: expected v, v/vt, v//vn or v/vt/vn"),
            ("v 0 0 0\n", "the mesh has no faces"),
            ("", "the mesh has no faces"),
        ] {
            assert_eq!(message(text), want, "{text}");
        }
    }
}
