//! `many-lamps`: a closed hall with pillars and any number of small lamps.

use super::{NewFile, ParametricScene, SceneParam};
use manylight_math::{Frame, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use std::f64::consts::PI;

pub(super) const SCENE: ParametricScene = ParametricScene {
    name: "many-lamps",
    summary: "a closed hall with pillars and many small lamps: the cost of a method over the number of its lights",
    params: &[
        SceneParam { name: "lamps", default: 1000, min: 1, max: 1_000_000, help: "how many lamps there are" },
        SceneParam { name: "seed", default: 0, min: 0, max: u64::MAX, help: "another number places them elsewhere" },
    ],
    files: |values| files(values[0], values[1]),
};

/// Up to this many lamps are shapes of their own; above it those of a kind share a mesh.
const MOST_SHAPES: u64 = 10_000;
/// Luminance of what all lamps emit. [W]
const POWER: f64 = 500.0;
/// Half the size of the hall. Its floor is at y = 0, its middle at x = z = 0. [m]
const HALF: Vec3 = Vec3::new(12.0, 3.0, 8.0);
/// Half the thickness of a pillar, and where pillars stand. [m]
const PILLAR: f32 = 0.4;
const PILLARS_X: [f32; 4] = [-7.5, -2.5, 2.5, 7.5];
const PILLARS_Z: [f32; 2] = [-3.0, 3.0];
/// The camera, as in the template. [m]
const EYE: Vec3 = Vec3::new(-11.0, 2.0, -1.0);
/// Least distance of a lamp's middle from walls and pillars. The largest lamp reaches 0.32 m. [m]
const CLEAR: f32 = 0.4;
/// Least distance of a lamp's middle from the camera. [m]
const CLEAR_OF_EYE: f32 = 2.0;

/// Colours: candle, bulb, daylight, blue, rose.
const COLOURS: [[f32; 3]; 5] =
    [[1.0, 0.45, 0.1], [1.0, 0.75, 0.45], [0.85, 0.92, 1.0], [0.35, 0.6, 1.0], [1.0, 0.4, 0.5]];
/// How bright a lamp is in proportion to others of its size.
const STRENGTHS: [f64; 3] = [1.0, 4.0, 16.0];
const KINDS: usize = COLOURS.len() * STRENGTHS.len();

const LAMPS: Purpose = Purpose(0x6c61_6d70);

/// A square that shines to one side.
struct Lamp {
    middle: Vec3,
    frame: Frame,
    /// Half a side. [m]
    half: f32,
    /// Its colour and strength.
    kind: usize,
}

fn files(lamps: u64, seed: u64) -> Vec<NewFile> {
    // All lamps together have about 4 m^2, but none is larger than it looks good.
    let half = (0.9 / (lamps as f32).sqrt()).min(0.15);
    let lamps: Vec<Lamp> = (0..lamps).map(|i| lamp(seed, i, half)).collect();
    let emitted: f64 = lamps.iter().map(|l| PI * 4.0 * f64::from(l.half).powi(2) * strength(l.kind)).sum();
    let radiance = |kind: usize| {
        let colour = Spectrum::from(COLOURS[kind / STRENGTHS.len()]);
        colour * (strength(kind) * POWER / emitted / f64::from(colour.luminance())) as f32
    };
    let mut xml = String::from(include_str!("many_lamps.xml"));
    pillars(&mut xml);
    let mut meshes = Vec::new();
    if lamps.len() as u64 <= MOST_SHAPES {
        lamps.iter().for_each(|l| rectangle(&mut xml, l, radiance(l.kind)));
    } else {
        for kind in 0..KINDS {
            let of_kind: Vec<&Lamp> = lamps.iter().filter(|l| l.kind == kind).collect();
            if !of_kind.is_empty() {
                let name = format!("lamps-{kind:02}.ply");
                mesh(&mut xml, &name, radiance(kind));
                meshes.push((name, ply(&of_kind)));
            }
        }
    }
    xml.push_str("</scene>\n");
    let mut files = vec![("scene.xml".to_owned(), xml.into_bytes())];
    files.append(&mut meshes);
    files
}

fn strength(kind: usize) -> f64 {
    STRENGTHS[kind % STRENGTHS.len()]
}

fn lamp(seed: u64, i: u64, half: f32) -> Lamp {
    let mut s = Stream::new(seed, [i, 0, 0], LAMPS);
    let kind = s.next_below(KINDS);
    let half = half * (0.5 + s.next_f32());
    loop {
        let (middle, normal) = site(&mut s);
        if is_clear(middle) {
            return Lamp { middle, frame: Frame::around(normal), half, kind };
        }
    }
}

/// A place and the direction in which the lamp shines: below the ceiling, before a wall, or anywhere in the upper hall.
fn site(s: &mut Stream) -> (Vec3, Vec3) {
    let choice = s.next_f32();
    let u = Vec3::new(s.next_f32(), s.next_f32(), s.next_f32());
    // In [-1, 1] x [0, 1] x [-1, 1], times the hall's half size. Depths vary, so that no two lamps lie in one plane.
    let depth = CLEAR + 0.3 * s.next_f32();
    let inside = Vec3::new(2.0 * u.x - 1.0, 2.0 * u.y, 2.0 * u.z - 1.0) * HALF;
    if choice < 0.4 {
        return (Vec3::new(inside.x, 2.0 * HALF.y - depth, inside.z), Vec3::NEG_Y);
    }
    if choice < 0.6 {
        let side = if choice < 0.5 { 1.0 } else { -1.0 };
        return (Vec3::new(inside.x, inside.y, side * (HALF.z - depth)), Vec3::Z * -side);
    }
    if choice < 0.7 {
        let side = if choice < 0.65 { 1.0 } else { -1.0 };
        return (Vec3::new(side * (HALF.x - depth), inside.y, inside.z), Vec3::X * -side);
    }
    (Vec3::new(inside.x, HALF.y * (0.8 + u.y), inside.z), warp::sphere(s.next_2d()))
}

/// Is a point far enough from walls, pillars and camera?
fn is_clear(p: Vec3) -> bool {
    let from_middle = (p - Vec3::Y * HALF.y).abs();
    let in_hall = from_middle.cmple(HALF - CLEAR).all();
    let near_pillar = |x: f32, z: f32| (p.x - x).abs().max((p.z - z).abs()) < PILLAR + CLEAR;
    let clear_of_pillars = !PILLARS_X.iter().any(|&x| PILLARS_Z.iter().any(|&z| near_pillar(x, z)));
    in_hall && clear_of_pillars && p.distance(EYE) >= CLEAR_OF_EYE
}

fn pillars(xml: &mut String) {
    for x in PILLARS_X {
        for z in PILLARS_Z {
            let y = HALF.y;
            *xml += &format!(
                r#"    <shape type="cube">
        <transform name="to_world">
            <scale x="{PILLAR}" y="{y}" z="{PILLAR}"/>
            <translate x="{x}" y="{y}" z="{z}"/>
        </transform>
        <ref id="stone"/>
    </shape>
"#
            );
        }
    }
}

fn rectangle(xml: &mut String, l: &Lamp, radiance: Spectrum) {
    let (s, t, n, p) = (l.frame.s * l.half, l.frame.t * l.half, l.frame.n, l.middle);
    let row = |i: usize| format!("{} {} {} {}", s[i], t[i], n[i], p[i]);
    let matrix = format!("{} {} {} 0 0 0 1", row(0), row(1), row(2));
    let to_world = format!(r#"<transform name="to_world"><matrix value="{matrix}"/></transform>"#);
    *xml += &format!("    <shape type=\"rectangle\">{to_world}<ref id=\"black\"/>{}</shape>\n", area(radiance));
}

fn mesh(xml: &mut String, name: &str, radiance: Spectrum) {
    let file = format!(r#"<string name="filename" value="{name}"/>"#);
    *xml += &format!("    <shape type=\"ply\">{file}<ref id=\"black\"/>{}</shape>\n", area(radiance));
}

fn area(radiance: Spectrum) -> String {
    let [r, g, b] = radiance.to_array();
    format!(r#"<emitter type="area"><rgb name="radiance" value="{r} {g} {b}"/></emitter>"#)
}

/// Binary PLY, two triangles a lamp.
fn ply(lamps: &[&Lamp]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        4 * lamps.len(),
        2 * lamps.len()
    )
    .into_bytes();
    for l in lamps {
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let p = l.middle + (l.frame.s * x + l.frame.t * y) * l.half;
            p.to_array().iter().for_each(|c| bytes.extend(c.to_le_bytes()));
        }
    }
    for first in (0..lamps.len() as u32).map(|i| 4 * i) {
        for triangle in [[0, 1, 2], [0, 2, 3]] {
            bytes.push(3);
            triangle.iter().for_each(|corner| bytes.extend((first + corner).to_le_bytes()));
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadOptions, Loaded, load};
    use manylight_geometry::ShapeGeometry;

    fn written(lamps: u64, seed: u64) -> Loaded {
        let dir = tempfile::tempdir().unwrap();
        let params = [("lamps".to_owned(), lamps.to_string()), ("seed".to_owned(), seed.to_string())];
        let paths = super::super::write("many-lamps", &params, dir.path()).unwrap();
        let loaded = load(&paths[0], &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(loaded.files, paths, "every file is read, and there is no other");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), paths.len());
        loaded
    }
    /// Triangles of the meshes that shine.
    fn shining_triangles(loaded: &Loaded) -> usize {
        let scene = &loaded.scene;
        let triangles = scene.geometry().shapes().iter().map(|s| match s {
            ShapeGeometry::Mesh(m) => m.triangles.len(),
            _ => 0,
        });
        triangles.sum::<usize>() - 6 * 2 - PILLARS_X.len() * PILLARS_Z.len() * 12
    }

    #[test]
    fn each_lamp_is_a_shape_up_to_ten_thousand_and_a_quad_of_a_mesh_above() {
        for (lamps, emitters) in [(1, 1), (100, 100), (MOST_SHAPES, 10_000), (MOST_SHAPES + 1, KINDS)] {
            let loaded = written(lamps, 0);
            assert_eq!(loaded.warnings, [""; 0]);
            assert_eq!(loaded.scene.emitters().len(), emitters);
            assert_eq!(shining_triangles(&loaded) as u64, 2 * lamps);
        }
    }
    #[test]
    fn the_power_does_not_depend_on_the_number_of_lamps() {
        for lamps in [1, 7, 1000, 30_000] {
            let power = written(lamps, 3).scene.emitters().power();
            assert!((power / POWER - 1.0).abs() < 1e-4, "{lamps} lamps: {power} W, expected {POWER} W");
        }
    }
    #[test]
    fn lamps_stay_clear_of_everything_else_even_at_their_corners() {
        for i in 0..20_000 {
            let l = lamp(1, i, 0.15);
            let reach = l.half * 2f32.sqrt();
            let from_middle = (l.middle - Vec3::Y * HALF.y).abs();
            let to_walls = (HALF - from_middle).min_element();
            assert!(to_walls - reach > 0.05, "lamp {i} is {to_walls} m from a wall");
            for (x, z) in PILLARS_X.iter().flat_map(|x| PILLARS_Z.map(|z| (*x, z))) {
                let to_pillar = (l.middle.x - x).abs().max((l.middle.z - z).abs()) - PILLAR;
                assert!(to_pillar - reach > 0.05, "lamp {i} is {to_pillar} m from a pillar");
            }
        }
    }
    #[test]
    fn lamps_under_the_ceiling_shine_downwards_as_shapes_and_in_meshes() {
        for lamps in [3000, MOST_SHAPES + 1] {
            let loaded = written(lamps, 0);
            let mut seen = 0;
            for shape in &loaded.scene.geometry().shapes()[6 + PILLARS_X.len() * PILLARS_Z.len()..] {
                let ShapeGeometry::Mesh(mesh) = shape else { panic!("a lamp is a square") };
                for [a, b, c] in (0..mesh.triangles.len()).map(|i| mesh.corners(i)) {
                    let from_walls = (HALF - (a - Vec3::Y * HALF.y).abs()).with_y(f32::INFINITY).min_element();
                    if a.y > 1.81 * HALF.y && from_walls > CLEAR + 0.3 + 0.05 {
                        let normal = (b - a).cross(c - a).normalize();
                        assert!(normal.y < -0.99, "a lamp at {a} shines along {normal}");
                        seen += 1;
                    }
                }
            }
            // Of the 0.4 that hang there, 0.57 are in the slice that is looked at, and 0.9 of those away from the walls.
            assert!(seen as f64 > 0.15 * 2.0 * lamps as f64, "{seen} triangles");
        }
    }
    #[test]
    fn one_seed_gives_one_scene_and_another_seed_another() {
        assert_eq!(files(20_000, 5), files(20_000, 5));
        assert_ne!(files(50, 5), files(50, 6));
    }
    #[test]
    fn the_template_names_the_camera_that_lamps_stay_clear_of() {
        let origin = format!(r#"origin="{}, {}, {}""#, EYE.x, EYE.y, EYE.z);
        assert!(include_str!("many_lamps.xml").contains(&origin));
    }
}
