//! Real scenes load. They lie beside the repository, and the tests pass with a word where they are not.

use manylight_math::Vec2;
use manylight_scene_io::{LoadOptions, load};
use std::path::PathBuf;

fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes").join(name).join("scene.xml");
    if !path.exists() {
        println!("skipped: {name} is not here");
    }
    path.exists().then_some(path)
}

#[test]
fn the_cornell_box_loads() {
    let Some(path) = shared("cornell-box") else { return };
    let loaded = load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.scene.camera().size, (1024, 1024));
    assert_eq!(loaded.scene.max_depth(), Some(65));
    assert_eq!(loaded.warnings, [""; 0]);
    assert_eq!(loaded.files, [path]);
}

#[test]
fn veach_ajar_loads_at_the_size_that_is_asked_for() {
    let Some(path) = shared("veach-ajar") else { return };
    let defines = vec![("resx".to_owned(), "320".to_owned()), ("resy".to_owned(), "180".to_owned())];
    let loaded = load(&path, &LoadOptions { defines, ..LoadOptions::default() }).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.scene.camera().size, (320, 180));
    assert_eq!(loaded.scene.max_depth(), Some(13));
    // The scene file, 15 OBJ, 2 PLY (each used three times), 3 textures.
    assert_eq!(loaded.files.len(), 21);
    println!("{:#?}", loaded.warnings);
}

#[test]
fn the_other_scenes_load() {
    for name in ["modern-hall", "classroom", "wooden-staircase", "volumetric-caustic", "combustion-plume"] {
        let Some(path) = shared(name) else { continue };
        let start = std::time::Instant::now();
        let loaded = load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        println!("{name}: {:.2} s, {:#?}", start.elapsed().as_secs_f64(), loaded.warnings);
    }
}

/// Scene, point of the image in [0, 1]^2, and of the first surface there: position, shading normal, texture coordinates.
type Row = (&'static str, [f32; 2], [f32; 3], [f32; 3], [f32; 2]);

#[test]
fn what_the_camera_sees_first_is_what_mitsuba_sees() {
    // mitsuba 3.9.1, scalar_rgb: `sensor.sample_ray`, `scene.ray_intersect`.
    #[rustfmt::skip]
    let rows: &[Row] = &[
        ("cornell-box", [0.086, 0.237], [-1.0000, 1.6353, -0.2286], [-1.0000, 0.0000, 0.0000], [0.8176, 0.6143]),
        ("cornell-box", [0.801, 0.582], [0.8069, 0.7802, -1.0000], [0.0000, 0.0000, -1.0000], [0.3901, 0.9034]),
        ("cornell-box", [0.094, 0.433], [-1.0000, 1.1650, -0.3671], [-1.0000, 0.0000, 0.0000], [0.5825, 0.6835]),
        ("cornell-box", [0.479, 0.16], [-0.0563, 1.9114, -1.0000], [0.0000, 0.0000, -1.0000], [0.9557, 0.4719]),
        ("veach-ajar", [0.735, 0.114], [-2.8300, 3.1805, -5.2235], [1.0000, 0.0000, 0.0000], [0.0000, 1.0000]),
        ("veach-ajar", [0.391, 0.517], [-2.8300, 1.3202, -2.3919], [1.0000, 0.0000, 0.0000], [0.0000, 1.0000]),
        ("veach-ajar", [0.431, 0.587], [-1.8840, 1.0889, -2.6515], [0.2224, 0.9718, 0.0780], [0.0000, 1.0000]),
        ("veach-ajar", [0.738, 0.956], [-0.5878, 0.0000, -4.3158], [0.0000, 1.0000, 0.0000], [0.5799, 0.0770]),
        ("veach-ajar", [0.284, 0.649], [-1.7178, 0.8872, -1.6832], [0.8906, 0.2910, 0.3494], [0.0000, 1.0000]),
        ("veach-ajar", [0.696, 0.293], [-2.7144, 2.3338, -4.8501], [0.9564, 0.0000, 0.2922], [0.0150, 0.1638]),
        ("veach-ajar", [0.001, 0.973], [-0.9917, 0.0000, -0.2350], [0.0000, 1.0000, 0.0000], [0.1193, 0.0652]),
        ("veach-ajar", [0.298, 0.314], [-2.8095, 2.2082, -1.6824], [1.0000, 0.0000, 0.0000], [0.0000, 1.0000]),
        ("modern-hall", [0.892, 0.585], [2.9636, 1.2517, -2.9982], [0.0000, 0.0000, 1.0000], [0.1270, 4.4177]),
        ("modern-hall", [0.471, 0.773], [1.0409, 0.2761, 0.0022], [0.0000, 0.0000, 1.0000], [0.0000, 1.0000]),
        ("modern-hall", [0.03, 0.707], [3.5546, 1.1904, 2.9982], [0.0000, 0.0000, -1.0000], [2.9872, -0.7896]),
        ("modern-hall", [0.374, 0.091], [-12.6885, 8.1150, -2.9965], [0.0000, 0.0005, 1.0000], [4.7920, 3.6609]),
        ("modern-hall", [0.661, 0.931], [3.5282, 0.2192, -0.1397], [1.0000, 0.0000, 0.0000], [0.6348, 0.0300]),
        ("modern-hall", [0.207, 0.63], [-10.4888, 0.0000, 1.4871], [0.0000, 1.0000, 0.0000], [-2.1948, 0.1667]),
        ("classroom", [0.298, 0.742], [-2.1409, 0.5334, -0.0032], [0.3103, 0.1418, 0.9400], [0.0000, 1.0000]),
        ("classroom", [0.722, 0.219], [1.5158, 2.9445, -1.6085], [0.0000, -1.0000, 0.0000], [0.0000, 1.0000]),
        ("classroom", [0.83, 0.658], [1.9127, 0.7651, -0.4776], [0.0014, -0.2190, -0.9757], [0.0000, 1.0000]),
        ("classroom", [0.683, 0.82], [0.8679, 0.0000, -0.9294], [0.0000, 1.0000, 0.0000], [0.0000, 1.0000]),
        ("classroom", [0.429, 0.759], [-1.3639, 0.6281, 1.2617], [0.3858, 0.1453, 0.9111], [0.0000, 1.0000]),
        ("classroom", [0.878, 0.102], [1.7033, 2.9445, 0.5488], [0.0000, -1.0000, 0.0000], [0.0000, 1.0000]),
    ];
    for scene_rows in rows.chunk_by(|a, b| a.0 == b.0) {
        let Some(path) = shared(scene_rows[0].0) else { continue };
        let scene = load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}")).scene;
        let (width, height) = scene.camera().size;
        for (name, [x, y], p, n, uv) in scene_rows {
            let ray = scene.camera().ray(Vec2::new(x * width as f32, y * height as f32));
            let hit = scene.geometry().intersect(&ray).expect("a hit");
            let got = scene.geometry().surface(&ray, &hit);
            let far = |a: &[f32], b: &[f32]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 2e-3);
            let wrong = far(&got.p.to_array(), p) || far(&got.ns.to_array(), n) || far(&got.uv.to_array(), uv);
            assert!(!wrong, "{name} at ({x}, {y}): {} {} {}, Mitsuba has {p:?} {n:?} {uv:?}", got.p, got.ns, got.uv);
        }
    }
}
