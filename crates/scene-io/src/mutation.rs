//! Thousands of mutated inputs: none panics, and what is made of one is bounded by its size (not by a clock, which measures
//! the machine too). Seeded, so that a failure comes back.

use crate::mesh::{RawMesh, obj, ply, serialized};
use crate::{LoadOptions, image, parse};
use std::path::Path;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// Changes a few places: bits, runs cut out or doubled, words of the format put in.
fn mutate(seed: &[u8], words: &[&str], r: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=r.below(4) {
        let at = r.below(bytes.len() + 1);
        let most = 1 + r.below(40);
        let run = r.below(most).min(bytes.len() - at);
        match r.below(5) {
            0 if at < bytes.len() => bytes[at] ^= 1 << r.below(8),
            1 => drop(bytes.drain(at..at + run)),
            2 => {
                let copy = bytes[at..at + run].to_vec();
                let to = r.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            3 => bytes.truncate(at),
            _ => {
                let word = words[r.below(words.len())].bytes();
                let end = at + run.min(r.below(8));
                bytes.splice(at..end, word);
            }
        }
    }
    bytes
}

/// Runs `read` over mutations of the seeds; how many were accepted. `read` gives the size of what it made of the input: at
/// most `most` for each byte.
fn storm(count: usize, seeds: &[Vec<u8>], words: &[&str], most: usize, read: impl Fn(&[u8]) -> Option<usize>) -> usize {
    let mut r = Random(7);
    let mut accepted = 0;
    for i in 0..count {
        let input = mutate(&seeds[i % seeds.len()], words, &mut r);
        let Some(size) = read(&input) else { continue };
        assert!(size <= most * input.len(), "mutation {i}: {size} from {} bytes", input.len());
        accepted += 1;
    }
    accepted
}

/// Vertices and triangles.
fn size(mesh: RawMesh) -> usize {
    mesh.positions.len() + mesh.triangles.len()
}

const SCENE: &str = r#"<scene version="3.0.0">
    <default name="r" value="2"/><default name="res" value="16"/>
    <integrator type="path"><integer name="max_depth" value="5"/></integrator>
    <sensor type="perspective"><float name="fov" value="40"/><string name="fov_axis" value="smaller"/>
        <transform name="to_world"><lookat origin="0,1,6" target="0,1,5" up="0,1,0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$r"/></sampler>
        <film type="hdrfilm"><integer name="width" value="$res"/><integer name="height" value="$res"/><rfilter type="tent"/></film>
    </sensor>
    <bsdf type="twosided" id="a"><bsdf type="diffuse"><rgb name="reflectance" value="0.1 0.2 0.3"/></bsdf></bsdf>
    <bsdf type="roughconductor" id="b"><string name="material" value="Au"/><float name="alpha" value="0.1"/></bsdf>
    <bsdf type="dielectric" id="c"><string name="int_ior" value="water"/></bsdf>
    <bsdf type="diffuse" id="d"><texture type="checkerboard" name="reflectance">
        <transform name="to_uv"><scale x="2" y="3"/></transform></texture></bsdf>
    <shape type="sphere"><point name="center" x="0" y="1" z="0"/><float name="radius" value="$r"/><ref id="b"/></shape>
    <shape type="cube"><transform name="to_world"><rotate y="1" angle="30"/><scale value="2"/><translate x="1"/></transform><ref id="c"/></shape>
    <shape type="disk"><transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 2 0 0 0 1"/></transform><ref id="d"/></shape>
    <shape type="rectangle"><ref id="a"/><emitter type="area"><rgb name="radiance" value="17 12 4"/></emitter></shape>
    <bsdf type="mask" id="e"><float name="opacity" value="0.4"/><bsdf type="blendbsdf"><float name="weight" value="0.3"/><ref id="a"/>
        <bsdf type="twosided"><bsdf type="roughplastic"><float name="alpha" value="0.2"/></bsdf></bsdf></bsdf></bsdf>
    <bsdf type="roughdielectric" id="f"><texture type="checkerboard" name="alpha"/></bsdf><alias id="f" as="g"/>
    <shape type="shapegroup" id="s"><shape type="cube"><ref id="e"/></shape></shape>
    <shape type="instance"><ref id="s"/><transform name="to_world"><translate y="3"/></transform></shape>
    <shape type="cylinder"><point name="p1" value="0 1 1"/><ref id="g"/></shape>
    <emitter type="point"><point name="position" value="1 2 3"/><spectrum name="intensity" value="3"/></emitter>
    <emitter type="directional"><vector name="direction" x="0" y="-1" z="0"/></emitter>
    <emitter type="constant"/>
</scene>"#;

#[test]
fn mutated_scenes_are_read_or_refused() {
    let words = [
        "\"",
        "<",
        ">",
        "/>",
        "$",
        "$r",
        "$$",
        "nan",
        "inf",
        "1e308",
        "-1",
        "0",
        "&amp;",
        "&#0;",
        "<!--",
        "é",
        "id=\"a\"",
        "<ref id=\"a\"/>",
        "<scale x=\"0\"/>",
        "<shape type=\"obj\">",
        "9999999999",
        "name=\"to_world\"",
        "<transform>",
    ];
    let read = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes);
        match parse(&text, Path::new("t.xml"), Path::new("/nonexistent"), &LoadOptions::default()) {
            Ok(loaded) => Some(loaded.scene.geometry().primitive_count()),
            Err(e) => {
                assert!(!e.0.is_empty() && e.to_string().len() < 200_000);
                None
            }
        }
    };
    // A cylinder is 1024 triangles, whatever its element is.
    let accepted = storm(10_000, &[SCENE.into()], &words, 50, read);
    assert!(accepted > 30, "{accepted}: the mutations are too coarse to get far");
}

#[test]
fn mutated_meshes_are_read_or_refused() {
    let cube = "o cube\nv -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv 0 0 1 0.5 0.5 0.5\nvt 0 0\nvt 1 0\nvt 0.5 1\nvn 0 0 1\nvn 0 1 0\n\
                f 1/1/1 2/2/1 3/3/1 4/1/1\nf 1//1 2//1 5//2\nf -1 -2 -3\nf 3/1 4/2 5/3\nusemtl x\nmtllib a.mtl\ng x\ns 1\n";
    let words = [
        "nan",
        "inf",
        "1e39",
        "0",
        "-1",
        "-9999999999999999999",
        "4294967296",
        "/",
        "//",
        "\\\n",
        "f ",
        "v ",
        "vt ",
        "#",
        "\u{fffd}",
    ];
    let accepted = storm(40_000, &[cube.into()], &words, 1, |b| obj::read(b).ok().map(size));
    assert!(accepted > 100, "{accepted}");

    let head = |format: &str, index: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\nelement face 2\n\
             property list uchar {index} vertex_indices\nend_header\n"
        )
    };
    let vertices =
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.0f32]].map(|[x, y, z]| [x, y, z, 0., 0., 1., x, y]);
    let mut binary = head("binary_little_endian", "int").into_bytes();
    vertices.as_flattened().iter().for_each(|x| binary.extend(x.to_le_bytes()));
    for face in [[0, 1, 2], [0, 2, 3i32]] {
        binary.push(3);
        face.iter().for_each(|i| binary.extend(i.to_le_bytes()));
    }
    let mut ascii = head("ascii", "uint");
    vertices.iter().for_each(|v| ascii += &(v.map(|x| x.to_string()).join(" ") + "\n"));
    ascii += "4 0 1 2 3\n3 0 1 2\n";
    let words = [
        "nan",
        "4294967295",
        "99999999999999999999",
        "property list uint int vertex_index\n",
        "element void 4000000000\n",
        "element x 1\nproperty list uint double y\n",
        "binary_big_endian",
        "ascii",
        "property float x\n",
        "\0",
        "-1",
        "uchar",
        "end_header\n",
    ];
    let accepted = storm(40_000, &[binary, ascii.into_bytes()], &words, 1, |b| ply::read(b).ok().map(size));
    assert!(accepted > 100, "{accepted}");
}

#[test]
fn mutated_images_are_read_or_refused() {
    use std::io::Cursor;
    let picture =
        ::image::RgbImage::from_fn(16, 8, |x, y| ::image::Rgb([(x * 16) as u8, (y * 31) as u8, (x * y) as u8]));
    let encode = |format| {
        let mut bytes = Cursor::new(Vec::new());
        let image = ::image::DynamicImage::ImageRgb8(picture.clone());
        let image = if format == ::image::ImageFormat::Hdr { image.into_rgb32f().into() } else { image };
        image.write_to(&mut bytes, format).expect("it can be written");
        bytes.into_inner()
    };
    let mut exr = Cursor::new(Vec::new());
    {
        use ::exr::prelude::*;
        let pixel = |p: Vec2<usize>| (p.x() as f32, p.y() as f32, 1f32);
        Image::from_channels((16, 8), SpecificChannels::rgb(pixel))
            .write()
            .to_buffered(&mut exr)
            .expect("it can be written");
    }
    let seeds = [
        encode(::image::ImageFormat::Png),
        encode(::image::ImageFormat::Jpeg),
        encode(::image::ImageFormat::Hdr),
        exr.into_inner(),
    ];
    let words = [
        "\u{ff}",
        "\0\0\0\0",
        "\u{7f}\u{7f}\u{7f}\u{7f}",
        "-Y 99999 +X 99999",
        "IHDR",
        "IDAT",
        "dataWindow",
        "channels",
    ];
    let accepted =
        storm(12_000, &seeds, &words, 10_000, |b| image::read(b, false).ok().map(|(image, _)| image.pixels.len()));
    assert!(accepted > 100, "{accepted}");
}

#[test]
fn mutated_grids_are_read_or_refused() {
    let mut grid = b"VOL\x03".to_vec();
    grid.extend([1, 2, 3, 2, 1].iter().flat_map(|i: &i32| i.to_le_bytes()));
    grid.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|x| x.to_le_bytes()));
    grid.extend((0..12).flat_map(|i| (i as f32).to_le_bytes()));
    let words = ["VOL", "\0\0\0\0", "\u{7f}\u{7f}\u{7f}\u{7f}", "\u{1}\0\0\0", "\u{3}"];
    let accepted = storm(40_000, &[grid], &words, 1, |b| crate::vol::read(b).ok().map(|g| g.values.len()));
    assert!(accepted > 100, "{accepted}");
}

#[test]
fn mutated_serialized_meshes_are_read_or_refused() {
    use flate2::{Compression, write::ZlibEncoder};
    use std::io::{Cursor, Write};
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle");
    let seeds = ["quads3", "quads4"].map(|f| std::fs::read(folder.join(format!("{f}.serialized"))).unwrap());
    let words = ["\u{4}\u{1c}", "\0\0\0\0", "\u{7f}\u{7f}\u{7f}\u{7f}", "\u{1}\0\0\0"];
    // Compressed data knows when it is broken: what is inside is mutated apart, and the table at the end.
    let any = |b: &[u8]| (0..3).filter_map(|i| serialized::read(&mut Cursor::new(b), i).ok()).map(size).max();
    let accepted = storm(4_000, &seeds, &words, 500, any);
    let mut inside = vec![0, 16, 0, 0, b'n', 0];
    inside.extend([4u64, 2].iter().flat_map(|n| n.to_le_bytes()));
    inside.extend((0..12).flat_map(|i| (i as f32).to_le_bytes()));
    inside.extend([0u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let accepted_inside = storm(12_000, &[inside], &words, 1, |b| {
        let mut stream = ZlibEncoder::new(vec![0x1c, 4, 4, 0], Compression::fast());
        stream.write_all(b).unwrap();
        serialized::read(&mut Cursor::new(stream.finish().unwrap()), 0).ok().map(size)
    });
    assert!(accepted > 100 && accepted_inside > 100, "{accepted} {accepted_inside}");
}

#[test]
fn what_would_grow_without_end_is_refused() {
    let errors = |body: &str| {
        let text =
            format!("<scene version=\"3.0.0\"><sensor type=\"perspective\"/><shape type=\"cube\"/>{body}</scene>");
        parse(&text, Path::new("t.xml"), Path::new("."), &LoadOptions::default()).unwrap_err().to_string()
    };
    // Each blend is twice the one before it.
    let blends: String = (1..30)
        .map(|i| {
            let inner = format!("<ref id=\"b{}\"/>", i - 1).repeat(2);
            format!("<bsdf type=\"blendbsdf\" id=\"b{i}\"><float name=\"weight\" value=\"0.5\"/>{inner}</bsdf>")
        })
        .collect();
    assert!(errors(&("<bsdf type=\"diffuse\" id=\"b0\"/>".to_owned() + &blends)).contains("blends of more than 64"));
    // 500 instances of 500 cylinders.
    let group = format!("<shape type=\"shapegroup\" id=\"g\">{}</shape>", "<shape type=\"cylinder\"/>".repeat(500));
    let instances = "<shape type=\"instance\"><ref id=\"g\"/></shape>".repeat(500);
    assert!(errors(&(group + &instances)).contains("triangles, as every instance is a copy"));
}

#[test]
fn deep_nesting_and_long_chains_are_refused() {
    let errors = |body: &str| {
        let text = format!("<scene version=\"3.0.0\">{body}</scene>");
        parse(&text, Path::new("t.xml"), Path::new("."), &LoadOptions::default()).unwrap_err().to_string()
    };
    let deep = "<bsdf type=\"twosided\">".repeat(20_000) + &"</bsdf>".repeat(20_000);
    assert!(errors(&deep).contains("elements nest deeper than 40 levels"));
    let chain: String =
        (0..5000).map(|i| format!("<bsdf type=\"twosided\" id=\"{i}\"><ref id=\"{}\"/></bsdf>", i + 1)).collect();
    let last = "<bsdf type=\"diffuse\" id=\"5000\"/>";
    assert!(errors(&(chain + last)).contains("references lead in a circle (or through more than 40 objects)"));
    let bomb = "<default name=\"a\" value=\"xxxxxxxxxx\"/>".to_owned()
        + &(0..60)
            .map(|i| {
                format!(
                    "<default name=\"a{i}x\" value=\"$a{0}$a{0}\"/>",
                    if i == 0 { String::new() } else { format!("{}x", i - 1) }
                )
            })
            .collect::<String>();
    assert!(errors(&bomb).contains("grows beyond"));
}
