//! Wavefront OBJ. As in Mitsuba, a file is one mesh: groups, objects, materials and vertex colours are passed over.
//!
//! Written out rather than taken from tobj 4.0.5: that knows no line numbers, overflows on negative texture and normal
//! indices, mixes up normals that only some faces have, and panics on legal MTL files.

use super::RawMesh;
use manylight_math::{Vec2, Vec3};
use std::borrow::Cow;
use std::collections::HashMap;

/// Reads a file's content.
pub(crate) fn read(bytes: &[u8]) -> Result<RawMesh, String> {
    let mut file = File::default();
    for (number, line) in lines(bytes) {
        file.line(number, &line).map_err(|e| format!("line {number}: {e}"))?;
    }
    file.finish()?.check()
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

/// Indices of position, texture coordinate and normal.
type Corner = [u32; 3];
const MISSING: u32 = u32::MAX;
const WHAT: [&str; 3] = ["vertices", "texture coordinates", "normals"];

/// What has been read so far.
#[derive(Default)]
struct File {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    triangles: Vec<[Corner; 3]>,
    /// Faces may come before their vertices: the largest index of each kind, and its line.
    largest: [(u32, usize); 3],
    incomplete_faces: usize,
}

impl File {
    fn line(&mut self, number: usize, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => self.positions.push(Vec3::from(numbers(words, 3)?)),
            Some("vn") => self.normals.push(Vec3::from(numbers(words, 3)?)),
            Some("vt") => {
                let [u, v, _] = numbers(words.take(2), 1)?;
                self.uvs.push(Vec2::new(u, v));
            }
            Some("f") => self.face(number, words)?,
            _ => {}
        }
        Ok(())
    }

    /// A polygon, as a fan.
    fn face<'a>(&mut self, number: usize, mut words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let mut corner = || words.next().map(|word| self.corner(number, word)).transpose();
        let (Some(first), Some(mut before)) = (corner()?, corner()?) else {
            self.incomplete_faces += 1;
            return Ok(());
        };
        let mut whole = false;
        for word in words {
            let next = self.corner(number, word)?;
            self.triangles.push([first, before, next]);
            (before, whole) = (next, true);
        }
        self.incomplete_faces += usize::from(!whole);
        Ok(())
    }

    /// v, v/vt, v//vn or v/vt/vn; counted from 1, or below zero backwards from the last.
    fn corner(&mut self, line: usize, word: &str) -> Result<Corner, String> {
        let malformed = || format!("`{}` is no corner of a face: expected v, v/vt, v//vn or v/vt/vn", shorten(word));
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [MISSING; 3];
        for (i, index) in word.split('/').enumerate() {
            if i >= 3 {
                return Err(malformed());
            }
            if index.is_empty() && i > 0 {
                continue;
            }
            let signed: i64 = index.parse().map_err(|_| malformed())?;
            let place = if signed < 0 { signed.saturating_add(counts[i] as i64) } else { signed - 1 };
            if !(0..i64::from(MISSING)).contains(&place) {
                return Err(format!("`{}` names number {signed} of {} {}", shorten(word), counts[i], WHAT[i]));
            }
            corner[i] = place as u32;
            self.largest[i] = self.largest[i].max((place as u32 + 1, line));
        }
        Ok(corner)
    }

    /// One vertex for each distinct corner, in the order of their first use.
    fn finish(self) -> Result<RawMesh, String> {
        for (i, count) in [self.positions.len(), self.uvs.len(), self.normals.len()].into_iter().enumerate() {
            let (largest, line) = self.largest[i];
            if largest as usize > count {
                return Err(format!("line {line}: a face names number {largest} of {count} {}", WHAT[i]));
            }
        }
        let mut raw = RawMesh::default();
        let mut remark = |what: String| raw.remarks.push(what);
        let has = |i: usize| {
            let mut corners = self.triangles.as_flattened().iter().map(|c| c[i] != MISSING);
            (corners.clone().any(|b| b), corners.all(|b| b))
        };
        let (some_uvs, all_uvs) = has(1);
        let (some_normals, all_normals) = has(2);
        if some_uvs && !all_uvs {
            remark("some faces have texture coordinates and some have none: all are passed over".into());
        }
        if some_normals && !all_normals {
            remark("some faces have normals and some have none: all are computed".into());
        }
        if self.incomplete_faces > 0 {
            remark(format!("{} faces of fewer than three corners are passed over", self.incomplete_faces));
        }
        let mut vertices: HashMap<Corner, u32> = HashMap::with_capacity(self.positions.len());
        for triangle in &self.triangles {
            raw.triangles.push(triangle.map(|corner| {
                *vertices.entry(corner).or_insert_with(|| {
                    let [p, t, n] = corner.map(|i| i as usize);
                    raw.positions.push(self.positions[p]);
                    if some_uvs && all_uvs {
                        raw.uvs.push(self.uvs[t]);
                    }
                    if some_normals && all_normals {
                        raw.normals.push(self.normals[n]);
                    }
                    raw.positions.len() as u32 - 1
                })
            }));
        }
        Ok(raw)
    }
}

/// Up to three numbers, at least `least`; what follows (colours, weights) is passed over.
fn numbers<'a>(words: impl Iterator<Item = &'a str>, least: usize) -> Result<[f32; 3], String> {
    let mut out = [0f32; 3];
    let mut found = 0;
    for (x, word) in out.iter_mut().zip(words) {
        *x = word.parse().map_err(|_| format!("`{}` is not a number", shorten(word)))?;
        if !x.is_finite() {
            return Err(format!("`{}` is not finite", shorten(word)));
        }
        found += 1;
    }
    if found < least { Err(format!("expected {least} numbers, found {found}")) } else { Ok(out) }
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
