//! Mitsuba's own meshes: several to a file, each compressed, with a table of their places at the end.
//!
//! Little endian: format and version (3 or 4), then a zlib stream of flags, a name (version 4), the numbers of vertices and triangles,
//! positions, normals, texture coordinates, colours and indices. The file ends with the place of each mesh and how many there are.

use super::RawMesh;
use flate2::read::ZlibDecoder;
use manylight_math::{Vec2, Vec3};
use std::io::{Read, Seek, SeekFrom, Take};

const FORMAT: u16 = 0x041c;
const NORMALS: u32 = 0x1;
const UVS: u32 = 0x2;
const COLOURS: u32 = 0x8;
const DOUBLE: u32 = 0x2000;
/// More vertices or triangles than this are not promised by an honest file of so many bytes: deflate shrinks to 1/1032 at best.
const MOST_SHRUNK: u64 = 1032;
/// Numbers that are read at a time, so that a promise alone takes no memory.
const CHUNK: usize = 1 << 14;

/// Reads the mesh of an index. A flag that asks for face normals is passed over, as by Mitsuba 3.
pub(crate) fn read(file: &mut (impl Read + Seek), index: u32) -> Result<RawMesh, String> {
    let short = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::UnexpectedEof => "the file ends too early".to_string(),
        _ => e.to_string(),
    };
    let size = file.seek(SeekFrom::End(0)).map_err(short)?;
    file.seek(SeekFrom::Start(0)).map_err(short)?;
    let version = header(file).map_err(short)??;
    let mut end = size;
    if index > 0 {
        let entry = if version == 4 { 8 } else { 4 };
        file.seek(SeekFrom::End(-4)).map_err(short)?;
        let count = u64::from(u32::from_le_bytes(bytes(file).map_err(short)?));
        if u64::from(index) >= count {
            return Err(format!("it holds {count} meshes: there is no number {index} (counted from 0)"));
        }
        let table = size.checked_sub(4 + entry * count).ok_or("the file is shorter than its table of meshes")?;
        file.seek(SeekFrom::Start(table + entry * u64::from(index))).map_err(short)?;
        let mut place = || -> std::io::Result<u64> {
            Ok(if version == 4 {
                u64::from_le_bytes(bytes(file)?)
            } else {
                u64::from(u32::from_le_bytes(bytes(file)?))
            })
        };
        let start = place().map_err(short)?;
        end = if u64::from(index) + 1 < count { place().map_err(short)? } else { table };
        if !(start < end && end <= table) {
            return Err(format!("the place of mesh {index} lies outside of the file"));
        }
        file.seek(SeekFrom::Start(start)).map_err(short)?;
        header(file).map_err(short)??;
        end -= start;
    }
    // No further than the mesh itself, so that what follows costs nothing.
    Mesh { stream: ZlibDecoder::new(file.take(end)), limit: end.saturating_mul(MOST_SHRUNK) }
        .read(version)
        .map_err(short)?
}

/// The version.
fn header(file: &mut impl Read) -> std::io::Result<Result<u16, String>> {
    let [format, version] = [u16::from_le_bytes(bytes(file)?), u16::from_le_bytes(bytes(file)?)];
    Ok(match (format, version) {
        (FORMAT, 3 | 4) => Ok(version),
        (FORMAT, other) => Err(format!("its version is {other}: expected 3 or 4")),
        _ => Err("it is no serialized mesh: it does not begin with 1c 04".into()),
    })
}

fn bytes<const N: usize>(file: &mut impl Read) -> std::io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

struct Mesh<R> {
    stream: ZlibDecoder<Take<R>>,
    /// \[byte\]
    limit: u64,
}

impl<R: Read> Mesh<R> {
    fn read(mut self, version: u16) -> std::io::Result<Result<RawMesh, String>> {
        let flags = u32::from_le_bytes(bytes(&mut self.stream)?);
        if version == 4 {
            // Its name, which nobody asks for.
            let mut length = 0;
            while bytes::<1>(&mut self.stream)? != [0] {
                length += 1;
                if length > 1 << 16 {
                    return Ok(Err("its name has no end".into()));
                }
            }
        }
        let [vertices, triangles] =
            [u64::from_le_bytes(bytes(&mut self.stream)?), u64::from_le_bytes(bytes(&mut self.stream)?)];
        let promised = vertices.saturating_add(triangles).saturating_mul(12);
        if promised > self.limit || vertices > u64::from(u32::MAX) {
            let what = format!("it promises {vertices} vertices and {triangles} triangles, more than the file holds");
            return Ok(Err(what));
        }
        let (vertices, triangles) = (vertices as usize, triangles as usize);
        let double = flags & DOUBLE != 0;
        let positions = self.numbers(3 * vertices, double)?;
        let normals = if flags & NORMALS != 0 { self.numbers(3 * vertices, double)? } else { Vec::new() };
        let uvs = if flags & UVS != 0 { self.numbers(2 * vertices, double)? } else { Vec::new() };
        if flags & COLOURS != 0 {
            self.numbers(3 * vertices, double)?;
        }
        let mut indices = Vec::new();
        self.chunks(3 * triangles, |b: [u8; 4]| indices.push(u32::from_le_bytes(b)))?;
        let points = |x: Vec<f32>| x.as_chunks::<3>().0.iter().map(|p| Vec3::from_array(*p)).collect();
        let raw = RawMesh {
            positions: points(positions),
            normals: points(normals),
            uvs: uvs.as_chunks::<2>().0.iter().map(|p| Vec2::from_array(*p)).collect(),
            triangles: indices.as_chunks::<3>().0.to_vec(),
            remarks: Vec::new(),
        };
        Ok(raw.check())
    }
    fn numbers(&mut self, count: usize, double: bool) -> std::io::Result<Vec<f32>> {
        let mut all = Vec::new();
        if double {
            self.chunks(count, |b: [u8; 8]| all.push(f64::from_le_bytes(b) as f32))?;
        } else {
            self.chunks(count, |b: [u8; 4]| all.push(f32::from_le_bytes(b)))?;
        }
        Ok(all)
    }
    fn chunks<const N: usize>(&mut self, count: usize, mut take: impl FnMut([u8; N])) -> std::io::Result<()> {
        let mut buffer = vec![0; N * CHUNK.min(count)];
        let mut left = count;
        while left > 0 {
            let now = left.min(CHUNK);
            self.stream.read_exact(&mut buffer[..N * now])?;
            buffer[..N * now].as_chunks::<N>().0.iter().for_each(|b| take(*b));
            left -= now;
        }
        Ok(())
    }
}
