//! Conventions are those of Mitsuba 3. All expected numbers: mitsuba 3.9.1, variant `scalar_rgb`, `scene.ray_intersect` on the
//! same XML (position, shading normal `si.sh_frame.n`, `si.uv`), or `eval` of the texture or emitter.

use manylight_math::{DVec3, Ray, Spectrum, Vec2, Vec3};
use manylight_scene::{Filter, Mode};
use manylight_scene_io::{LoadOptions, Loaded, parse};
use std::path::Path;

fn scene_in(folder: &Path, body: &str) -> Loaded {
    let camera = if body.contains("<sensor") { "" } else { "<sensor type=\"perspective\"/>" };
    let shape = if body.contains("<shape") { "" } else { "<shape type=\"sphere\"/>" };
    let text = format!("<scene version=\"3.0.0\">{body}{camera}{shape}</scene>");
    parse(&text, Path::new("t.xml"), folder, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}
fn scene(body: &str) -> Loaded {
    scene_in(Path::new("."), body)
}
fn close(got: &[f32], want: &[f32], tolerance: f32, what: &str) {
    assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < tolerance), "{what}: {got:?}, Mitsuba has {want:?}");
}

/// Shading normal and texture coordinates at the first hit.
fn hit(loaded: &Loaded, origin: [f32; 3], dir: [f32; 3]) -> (Vec3, Vec2) {
    let ray = Ray::new(Vec3::from(origin), Vec3::from(dir).normalize());
    let geometry = loaded.scene.geometry();
    let surface = geometry.surface(&ray, &geometry.intersect(&ray).expect("a hit"));
    (surface.ns, surface.uv)
}
fn check_hit(what: &str, loaded: &Loaded, ray: ([f32; 3], [f32; 3]), normal: [f32; 3], uv: [f32; 2]) {
    let (n, t) = hit(loaded, ray.0, ray.1);
    close(&n.to_array(), &normal, 2e-4, &format!("{what}: normal"));
    close(&t.to_array(), &uv, 2e-4, &format!("{what}: uv"));
}

const DOWN: ([f32; 3], [f32; 3]) = ([0.5, -0.2, 3.0], [0.0, 0.0, -1.0]);

#[test]
fn rectangles_are_mitsubas() {
    let rectangle = |inner: &str| scene(&format!("<shape type=\"rectangle\">{inner}</shape>"));
    check_hit("plain", &rectangle(""), DOWN, [0., 0., 1.], [0.75, 0.4]);
    check_hit(
        "flipped",
        &rectangle("<boolean name=\"flip_normals\" value=\"true\"/>"),
        DOWN,
        [0., 0., -1.],
        [0.75, 0.4],
    );
    let mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    check_hit("mirrored", &rectangle(mirror), DOWN, [0., 0., 1.], [0.25, 0.4]);
}

#[test]
fn cubes_are_mitsubas() {
    let cube = scene("<shape type=\"cube\"/>");
    for (axis, sign, uv) in [
        (0, 1.0, [0.4, 0.35]),
        (0, -1.0, [0.4, 0.65]),
        (1, 1.0, [0.25, 0.35]),
        (1, -1.0, [0.65, 0.75]),
        (2, 1.0, [0.4, 0.75]),
        (2, -1.0, [0.6, 0.75]),
    ] {
        let (mut origin, mut dir) = ([0.5, -0.2, 0.3], [0.0; 3]);
        (origin[axis], dir[axis]) = (3.0 * sign, -sign);
        check_hit("cube", &cube, (origin, dir), dir.map(|d| -d), uv);
    }
    let mirrored = scene("<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></shape>");
    check_hit("mirrored", &mirrored, DOWN, [0., 0., 1.], [0.4, 0.25]);
}

#[test]
fn spheres_are_mitsubas() {
    let sphere = |inner: &str| scene(&format!("<shape type=\"sphere\">{inner}</shape>"));
    let mirror = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
    for (d, uv, mirrored_uv) in [
        ([0.50507627, 0.30304576, 0.80812204], [0.086, 0.2005], [0.414, 0.2005]),
        ([-0.81110711, 0.48666426, 0.32444284], [0.414, 0.3948], [0.086, 0.3948]),
        ([0.21566555, -0.97049496, -0.10783277], [0.7848, 0.5344], [0.7152, 0.5344f32]),
    ] {
        let ray = (d.map(|x: f32| 3.0 * x), d.map(|x| -x));
        check_hit("plain", &sphere(""), ray, d, uv);
        check_hit("mirrored", &sphere(mirror), ray, d.map(|x| -x), mirrored_uv);
        check_hit("flipped", &sphere("<boolean name=\"flip_normals\" value=\"true\"/>"), ray, d.map(|x| -x), uv);
    }
    let moved = "<point name=\"center\" value=\"1 2 3\"/><float name=\"radius\" value=\"2\"/>\
                 <transform name=\"to_world\"><scale value=\"2\"/><translate x=\"10\"/></transform>";
    let bounds = sphere(moved).scene.bounds();
    close(&bounds.centre().to_array(), &[12.0, 4.0, 6.0], 1e-4, "centre");
    close(&(bounds.hi - bounds.lo).to_array(), &[8.0; 3], 1e-4, "extent");
}

#[test]
fn disks_are_mitsubas() {
    let disk = |inner: &str| scene(&format!("<shape type=\"disk\">{inner}</shape>"));
    let scale = |s: &str| disk(&format!("<transform name=\"to_world\"><scale {s}/></transform>"));
    let down = ([0.3, 0.4, 3.0], [0.0, 0.0, -1.0]);
    check_hit("plain", &disk(""), down, [0., 0., 1.], [0.5, 0.1476]);
    check_hit("flipped", &disk("<boolean name=\"flip_normals\" value=\"true\"/>"), down, [0., 0., -1.], [0.5, 0.1476]);
    check_hit("mirrored x", &scale("x=\"-1\""), down, [0., 0., 1.], [0.5, 0.3524]);
    check_hit("mirrored z", &scale("z=\"-1\""), down, [0., 0., -1.], [0.5, 0.1476]);
    check_hit("scaled", &scale("value=\"2\""), down, [0., 0., 1.], [0.25, 0.1476]);
}

#[test]
fn meshes_are_mitsubas() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("t.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    write(
        "n.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0.6 0.8\nvn 0 0.6 0.8\nvn 0 0.6 0.8\nvt 0 0\nf 1/1/1 2/1/2 3/1/3\n",
    );
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\n\
               property float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2\n";
    write("t.ply", ply);
    let set = |name: &str, value: bool| format!("<boolean name=\"{name}\" value=\"{value}\"/>");
    let scale = |s: &str| format!("<transform name=\"to_world\"><scale {s}/></transform>");
    let down = ([0.7, 0.2, 3.0], [0.0, 0.0, -1.0]);
    for (file, inner, normal, uv) in [
        ("t.obj", String::new(), [0.1151, -0.1151, 0.9867], [0.7, 0.8]),
        ("t.obj", set("face_normals", true), [0., 0., 1.], [0.7, 0.8]),
        ("t.obj", set("flip_normals", true), [-0.1151, 0.1151, -0.9867], [0.7, 0.8]),
        ("t.obj", set("flip_tex_coords", false), [0.1151, -0.1151, 0.9867], [0.7, 0.2]),
        ("t.obj", scale("z=\"-1\""), [-0.1151, 0.1151, 0.9867], [0.7, 0.8]),
        ("t.obj", scale("y=\"3\""), [0.0546, -0.0182, 0.9983], [0.7, 0.9333]),
        ("n.obj", String::new(), [0., 0.6, 0.8], [0., 1.]),
        ("n.obj", set("face_normals", true), [0., 0., 1.], [0., 1.]),
        ("n.obj", set("flip_normals", true), [0., -0.6, -0.8], [0., 1.]),
        ("n.obj", scale("z=\"-1\""), [0., 0.6, -0.8], [0., 1.]),
        ("n.obj", scale("y=\"3\""), [0., 0.2425, 0.9701], [0., 1.]),
        ("t.ply", String::new(), [0., 0., 1.], [0.7, 0.2]),
        ("t.ply", set("flip_tex_coords", true), [0., 0., 1.], [0.7, 0.8]),
    ] {
        let plugin = &file[2..];
        let body = format!("<shape type=\"{plugin}\"><string name=\"filename\" value=\"{file}\"/>{inner}</shape>");
        check_hit(&format!("{file} {inner}"), &scene_in(folder.path(), &body), down, normal, uv);
    }
}

/// The radiance of a textured rectangle where it has texture coordinates `uv`.
fn texel(folder: &Path, texture: &str, uv: [f32; 2]) -> [f32; 3] {
    let body = format!("<shape type=\"rectangle\"><emitter type=\"area\">{texture}</emitter></shape>");
    let origin = Vec3::new(2.0 * uv[0] - 1.0, 2.0 * uv[1] - 1.0, 1.0);
    let vertex =
        scene_in(folder, &body).scene.intersect(&Ray::new(origin, Vec3::NEG_Z), Mode::Radiance).expect("a hit");
    vertex.emitted().to_array()
}

#[test]
fn bitmaps_are_mitsubas() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [[255, 0, 0], [0, 255, 0], [128, 128, 128], [0, 0, 255], [255, 255, 0], [255, 255, 255u8]];
    let image = image::RgbImage::from_raw(3, 2, rows.concat()).unwrap();
    image.save(folder.path().join("q.png")).unwrap();
    let texture = |inner: &str, uv| {
        let file = "<string name=\"filename\" value=\"q.png\"/>";
        texel(folder.path(), &format!("<texture type=\"bitmap\" name=\"radiance\">{file}{inner}</texture>"), uv)
    };
    let nearest = "<string name=\"filter_type\" value=\"nearest\"/>";
    for (uv, want) in [
        ([0.1, 0.1], [1., 0., 0.]),
        ([0.5, 0.1], [0., 1., 0.]),
        ([0.9, 0.1], [0.2159, 0.2159, 0.2159]),
        ([0.1, 0.9], [0., 0., 1.]),
        ([0.5, 0.9], [1., 1., 0.]),
    ] {
        close(&texture(nearest, uv), &want, 2e-4, "nearest");
    }
    close(&texture("", [0.25, 0.4]), &[0.6, 0.25, 0.225], 2e-4, "bilinear");
    close(&texture("", [0.02, 0.02]), &[0.5561, 0.2537, 0.5113], 2e-4, "repeat");
    let wrap = |mode: &str| format!("<string name=\"wrap_mode\" value=\"{mode}\"/>");
    close(&texture(&wrap("mirror"), [0.02, 0.02]), &[1., 0., 0.], 2e-4, "mirror");
    close(&texture(&wrap("clamp"), [0.02, 0.02]), &[1., 0., 0.], 2e-4, "clamp");
    close(&texture("<boolean name=\"raw\" value=\"true\"/>", [0.9, 0.1]), &[0.6611, 0.5211, 0.5811], 2e-4, "raw");
    let moved = format!(
        "{nearest}<transform name=\"to_uv\"><scale x=\"2\" y=\"1\"/><translate x=\"0.25\" y=\"0.5\"/></transform>"
    );
    for (uv, want) in
        [([0.1, 0.1], [1., 1., 0.]), ([0.3, 0.1], [1., 1., 1.]), ([0.4, 0.1], [0., 0., 1.]), ([0.1, 0.9], [0., 1., 0.])]
    {
        close(&texture(&moved, uv), &want, 2e-4, "to_uv");
    }
}

#[test]
fn checkerboards_are_mitsubas() {
    let board = |inner: &str, uv| {
        texel(Path::new("."), &format!("<texture type=\"checkerboard\" name=\"radiance\">{inner}</texture>"), uv)[0]
    };
    for (uv, want) in [([0.1, 0.1], 0.4), ([0.6, 0.1], 0.2), ([0.1, 0.6], 0.2), ([0.6, 0.6], 0.4f32)] {
        close(&[board("", uv)], &[want], 1e-6, "plain");
    }
    let moved = "<transform name=\"to_uv\"><scale x=\"2\" y=\"1\"/><translate x=\"0.25\" y=\"0\"/></transform>";
    for (uv, want) in
        [([0.1, 0.1], 0.4), ([0.3, 0.1], 0.2), ([0.13, 0.1], 0.2), ([0.6, 0.6], 0.2), ([0.38, 0.1], 0.4f32)]
    {
        close(&[board(moved, uv)], &[want], 1e-6, "to_uv");
    }
}

#[test]
fn cameras_are_mitsubas() {
    let directions = |inner: &str| {
        let loaded = scene(&format!("<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>{inner}</sensor>"));
        [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
            .map(|[x, y]: [f32; 2]| loaded.scene.camera().ray(Vec2::new(x * 768.0, y * 576.0)).dir.to_array())
    };
    let check = |what: &str, inner: &str, want: [[f32; 3]; 4]| {
        close(directions(inner).as_flattened(), want.as_flattened(), 2e-4, what);
    };
    check(
        "plain",
        "",
        [[0.0, 0.0, 1.0], [0.3313, 0.2485, 0.9102], [-0.3313, 0.2485, 0.9102], [0.3313, -0.2485, 0.9102]],
    );
    check(
        "principal point",
        "<float name=\"principal_point_offset_x\" value=\"0.1\"/><float name=\"principal_point_offset_y\" value=\"0.2\"/>",
        [[-0.0722, -0.1083, 0.9915], [0.2762, 0.1553, 0.9485], [-0.3958, 0.1484, 0.9063], [0.2625, -0.3445, 0.9014]],
    );
    check(
        "lookat",
        "<transform name=\"to_world\"><lookat origin=\"1,2,3\" target=\"4,2,-1\" up=\"0,1,0\"/></transform>",
        [[0.6, 0.0, -0.8], [0.2811, 0.2485, -0.927], [0.8112, 0.2485, -0.5294], [0.2811, -0.2485, -0.927]],
    );
    check(
        "mirrored",
        "<transform name=\"to_world\"><scale x=\"-1\"/></transform>",
        [[0.0, 0.0, 1.0], [-0.3313, 0.2485, 0.9102], [0.3313, 0.2485, 0.9102], [-0.3313, -0.2485, 0.9102]],
    );
    // x_fov of a 4:3 film without `fov`: 50 mm, and 35 mm.
    for (inner, fov) in [("", 38.184_84), ("<string name=\"focal_length\" value=\"35mm\"/>", 52.622_54f32)] {
        let loaded = scene(&format!("<sensor type=\"perspective\">{inner}</sensor>"));
        let left = loaded.scene.camera().ray(Vec2::new(0.0, 288.0)).dir;
        close(&[2.0 * left.x.atan2(left.z).to_degrees()], &[fov], 1e-3, "focal length");
    }
}

#[test]
fn films_and_integrators_have_mitsubas_defaults() {
    let filter = |rfilter: &str| {
        scene(&format!("<sensor type=\"perspective\"><film type=\"hdrfilm\">{rfilter}</film></sensor>")).scene.filter()
    };
    assert_eq!(filter(""), Filter::Gaussian { stddev: 0.5 });
    assert_eq!(filter("<rfilter type=\"tent\"/>"), Filter::Tent { radius: 1.0 });
    assert_eq!(filter("<rfilter type=\"lanczos\"/>"), Filter::Lanczos { lobes: 3.0 });
    assert_eq!(filter("<rfilter type=\"mitchell\"/>"), Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 });
    assert_eq!(scene("").scene.camera().size, (768, 576));
    assert_eq!(scene("").scene.max_depth(), None);
    let path = |inner: &str| scene(&format!("<integrator type=\"volpath\">{inner}</integrator>"));
    assert_eq!(path("<integer name=\"max_depth\" value=\"-1\"/>").scene.max_depth(), None);
    let deep = path(
        "<integer name=\"max_depth\" value=\"7\"/><integer name=\"rr_depth\" value=\"3\"/><boolean name=\"hide_emitters\" value=\"true\"/>",
    );
    assert_eq!((deep.scene.max_depth(), deep.scene.rr_depth()), (Some(7), Some(3)));
}

#[test]
fn size_and_filter_from_outside_win_over_the_file() {
    let text = "<scene version=\"3.0.0\"><shape type=\"sphere\"/><sensor type=\"perspective\"><film type=\"hdrfilm\">\
                <integer name=\"width\" value=\"64\"/><rfilter type=\"tent\"/></film></sensor></scene>";
    let options = LoadOptions { size: Some((20, 10)), filter: Some(Filter::Box), ..LoadOptions::default() };
    let loaded = parse(text, Path::new("t.xml"), Path::new("."), &options).unwrap();
    assert_eq!((loaded.scene.camera().size, loaded.scene.filter()), ((20, 10), Filter::Box));
}

#[test]
fn environments_are_mitsubas() {
    let folder = tempfile::tempdir().unwrap();
    // Pixel (x, y) is (y, x, 1).
    exr::prelude::write_rgb_file(folder.path().join("e.exr"), 8, 4, |x, y| (y as f32, x as f32, 1.0f32)).unwrap();
    let environment = |inner: &str| {
        let file = "<string name=\"filename\" value=\"e.exr\"/><float name=\"scale\" value=\"2\"/>";
        scene_in(folder.path(), &format!("<emitter type=\"envmap\">{file}{inner}</emitter>")).scene
    };
    let rotated = "<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/><scale value=\"3\"/></transform>";
    for (inner, d, want) in [
        ("", [1., 0., 0.], [3., 3., 2.]),
        ("", [-1., 0., 0.], [3., 11., 2.]),
        ("", [0., 0., 1.], [3., 7., 2.]),
        (rotated, [1., 0., 0.], [3., 7., 2.]),
        (rotated, [0., 0., 1.], [3., 11., 2.]),
        (rotated, [0., 0., -1.], [3., 3., 2.]),
    ] {
        close(&environment(inner).environment(Vec3::from(d)).to_array(), &want, 2e-3, &format!("{inner} {d:?}"));
    }
    let constant = |inner: &str| {
        scene(&format!("<emitter type=\"constant\">{inner}</emitter>")).scene.environment(Vec3::Y).to_array()
    };
    close(&constant(""), &[1., 1., 1.], 1e-6, "default");
    close(&constant("<float name=\"radiance\" value=\"2\"/>"), &[2., 2., 2.], 1e-6, "float");
    close(&constant("<spectrum name=\"radiance\" value=\"2\"/>"), &[2.4096, 1.8966, 1.8178], 1e-4, "equal energy");
}

#[test]
fn a_shape_without_bsdf_is_grey_and_a_light_without_bsdf_is_black() {
    let albedo = |inner: &str| {
        let loaded = scene(&format!("<shape type=\"rectangle\">{inner}</shape>"));
        let vertex = loaded.scene.intersect(&Ray::new(Vec3::Z, Vec3::NEG_Z), Mode::Radiance).expect("a hit");
        vertex.lobe_at(Vec3::Z)
    };
    assert_eq!(albedo(""), Spectrum::gray(0.5) * std::f32::consts::FRAC_1_PI);
    assert!(albedo("<emitter type=\"area\"/>").is_black());
}

#[test]
fn a_directional_emitter_shines_along_z_of_its_transform() {
    // Irradiance 3 on a surface that faces it gives a grey diffuse surface 3 * 0.5 / pi; here only the direction is of interest.
    let loaded = scene(
        "<emitter type=\"directional\"><transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform></emitter>",
    );
    let mut stream = manylight_sampling::Stream::new(1, [0; 3], manylight_sampling::Purpose::CAMERA);
    let emission = loaded.scene.sample_emission(&mut stream).expect("light");
    assert!((emission.ray.dir.as_dvec3() - DVec3::X).length() < 1e-6, "{:?}", emission.ray.dir);
}

#[test]
fn cylinders_are_mitsubas() {
    let cylinder = |inner: &str| scene(&format!("<shape type=\"cylinder\">{inner}</shape>"));
    let ray = ([3., 0.2, 0.3], [-1., 0.1, 0.05]);
    check_hit("plain", &cylinder(""), ray, [0.912653, 0.408735, 0.], [0.0670149, 0.404367]);
    let flipped = cylinder("<boolean name=\"flip_normals\" value=\"true\"/>");
    check_hit("flipped", &flipped, ray, [-0.912653, -0.408735, 0.], [0.0670149, 0.404367]);
    let between = "<point name=\"p0\" value=\"0.5,-1,0\"/><point name=\"p1\" value=\"0.1,1,0.3\"/><float name=\"radius\" value=\"0.4\"/>";
    let (from_right, from_left) = (([3., 0.2, 0.3], [-1., -0.05, -0.05]), ([-3., 0.2, 0.3], [1., -0.05, -0.05]));
    check_hit("between", &cylinder(between), from_right, [0.979569, 0.183604, 0.0820629], [0.0182, 0.50552]);
    check_hit("behind", &cylinder(between), from_left, [-0.980978, -0.19098, -0.0347682], [0.525822, 0.566168]);
    let moved = "<transform name=\"to_world\"><rotate z=\"1\" angle=\"30\"/><scale value=\"2\"/><translate x=\"0.2\"/></transform>";
    let ray = ([6., 0.2, 0.3], [-1., -0.05, -0.02]);
    check_hit("moved", &cylinder(&[between, moved].concat()), ray, [0.75702, 0.645635, 0.10038], [0.0152408, 0.234194]);
}

#[test]
fn instances_are_mitsubas() {
    let group = "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><transform name=\"to_world\"><scale value=\"0.5\"/></transform></shape>\
                 <shape type=\"rectangle\"><transform name=\"to_world\"><translate z=\"1\"/></transform></shape></shape>\
                 <shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><rotate y=\"1\" angle=\"40\"/><scale x=\"2\"/>\
                 <translate x=\"0.3\"/></transform></shape>";
    let loaded = scene(group);
    check_hit("rectangle", &loaded, ([0.5, 0.2, 5.], [0.02, 0.01, -1.]), [0.38688, 0., 0.92213], [0.170592, 0.619052]);
    check_hit("cube", &loaded, ([0.4, -5., 0.1], [0., 1., 0.]), [0., -1., 0.], [0.608744, 0.474023]);
    // The group itself shows nowhere.
    assert_eq!(loaded.scene.geometry().shapes().len(), 2);
}

#[test]
fn old_files_are_read_as_mitsuba_upgrades_them() {
    let text = "<scene version=\"0.6.0\"><sensor type=\"perspective\"><string name=\"fovAxis\" value=\"x\"/><float name=\"fov\" value=\"30\"/>\
                <transform name=\"toWorld\"><lookAt origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>\
                <shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture name=\"diffuseReflectance\" type=\"bitmap\">\
                <string name=\"filename\" value=\"colours.png\"/><string name=\"filterType\" value=\"nearest\"/>\
                <float name=\"uscale\" value=\"2\"/><float name=\"vscale\" value=\"3\"/><float name=\"uoffset\" value=\"0.1\"/>\
                </texture></bsdf></shape></scene>";
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle");
    let options = LoadOptions::default();
    let old = parse(text, Path::new("t.xml"), &folder, &options).unwrap_or_else(|e| panic!("{e}"));
    assert!(old.warnings.iter().any(|w| w.contains("older than Mitsuba 2")), "{:?}", old.warnings);
    // mitsuba 3.9.1: `to_uv` is [[2, 0, 0.2], [0, 3, 0]], here written out.
    let new = text
        .replace("0.6.0", "3.0.0")
        .replace("fovAxis", "fov_axis")
        .replace("toWorld", "to_world")
        .replace("lookAt", "lookat")
        .replace("diffuseReflectance", "reflectance")
        .replace("filterType", "filter_type");
    let (start, end) = (new.find("<float name=\"uscale").unwrap(), new.find("</texture>").unwrap());
    let matrix = "<transform name=\"to_uv\"><matrix value=\"2 0 0 0.2 0 3 0 0 0 0 1 0 0 0 0 1\"/></transform>";
    let new = [&new[..start], matrix, &new[end..]].concat();
    let new = parse(&new, Path::new("t.xml"), &folder, &options).unwrap_or_else(|e| panic!("{e}"));
    let at = |loaded: &Loaded, x: f32| {
        let ray = Ray::new(Vec3::new(x, 0.3, 3.0), Vec3::NEG_Z);
        loaded.scene.intersect(&ray, Mode::Radiance).unwrap().eval(Vec3::Z)
    };
    for i in 0..20 {
        let x = -0.95 + 0.1 * i as f32;
        assert_eq!(at(&old, x), at(&new, x));
    }
}

#[test]
fn included_files_and_further_folders_are_read_as_if_they_stood_there() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let oracle = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle/colours.png");
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    std::fs::copy(oracle, folder.path().join("textures/colours.png")).unwrap();
    write(
        "parts/wood.xml",
        "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"wood\"><texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"colours.png\"/></texture></bsdf>",
    );
    write(
        "parts/lamp.xml",
        "<scene version=\"3.0.0\"><default name=\"power\" value=\"2\"/><emitter type=\"point\"><rgb name=\"intensity\" value=\"$power\"/></emitter></scene>",
    );
    let main = |more: &str| {
        let body = "<path value=\"textures\"/><include filename=\"parts/wood.xml\"/><alias id=\"wood\" as=\"oak\"/><default name=\"part\" value=\"lamp\"/><include filename=\"parts/$part.xml\"/>";
        let text = format!(
            "<scene version=\"3.0.0\">{body}<sensor type=\"perspective\"/><shape type=\"sphere\"><float name=\"radius\" value=\"$power\"/><ref id=\"oak\"/></shape>{more}</scene>"
        );
        write("main.xml", &text);
        manylight_scene_io::load(&folder.path().join("main.xml"), &LoadOptions::default())
    };
    let loaded = main("").unwrap_or_else(|e| panic!("{e}"));
    let names: Vec<_> = loaded.files.iter().map(|f| f.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["main.xml", "wood.xml", "lamp.xml", "colours.png"]);
    assert!((loaded.scene.bounds().hi.x - 2.0).abs() < 1e-6 && loaded.scene.emitters().len() == 1);
    // Mistakes are at their place in their file, and files that include each other are one.
    write(
        "parts/lamp.xml",
        "<scene version=\"3.0.0\"><default name=\"power\" value=\"2\"/>\n<emitter type=\"pont\"/></scene>",
    );
    let message = main("").unwrap_err().to_string();
    assert!(message.contains("lamp.xml:2:16: there is no emitter `pont`"), "{message}");
    write(
        "parts/lamp.xml",
        "<scene version=\"3.0.0\"><default name=\"power\" value=\"2\"/><include filename=\"main.xml\"/></scene>",
    );
    let message = main("").unwrap_err().to_string();
    assert!(message.contains("`main.xml` includes itself"), "{message}");
}

const LOOKING: &str = "<lookat origin=\"1,2,3\" target=\"2,2.5,1\" up=\"0,1,0\"/>";

#[test]
fn lenses_and_parallel_rays_are_mitsubas() {
    let film =
        "<film type=\"hdrfilm\"><integer name=\"width\" value=\"40\"/><integer name=\"height\" value=\"20\"/></film>";
    let camera = |plugin: &str, more: &str| {
        let sensor = format!("<sensor type=\"{plugin}\">{more}{film}</sensor>");
        *scene(&sensor).scene.camera()
    };
    // `sensor.sample_ray` at these places of the film.
    let places = [Vec2::new(0.1 * 40.0, 0.2 * 20.0), Vec2::new(0.9 * 40.0, 0.6 * 20.0)];
    let lens = camera(
        "thinlens",
        &format!(
            "<float name=\"fov\" value=\"50\"/><float name=\"aperture_radius\" value=\"0.2\"/>\
             <float name=\"focus_distance\" value=\"3\"/><transform name=\"to_world\">{LOOKING}</transform>"
        ),
    );
    let theirs = [
        ([1.044_269_9f32, 2.104_627_8, 3.036_835_4], [0.069_111_05f32, 0.297_266_48, -0.952_289_88]),
        ([1.023_308_9, 1.846_103_5, 2.961_723_8], [0.720_900_83, 0.210_579_18, -0.660_271_4]),
    ];
    for (at, (origin, dir)) in places.into_iter().zip(theirs) {
        let (origin, dir) = (Vec3::from(origin), Vec3::from(dir));
        // Theirs starts at the near plane: back to the lens.
        let p = origin - dir * (lens.forward.dot(origin - lens.origin) / lens.forward.dot(dir));
        assert!((p - lens.origin).length() < 0.2);
        close(&lens.at_lens_point(p).ray(at).dir.to_array(), &dir.to_array(), 1e-5, "lens");
    }
    let parallel =
        camera("orthographic", &format!("<transform name=\"to_world\"><scale x=\"3\" y=\"2\"/>{LOOKING}</transform>"));
    let origins = [[-1.200_814_7f32, 2.587_722_3, 2.035_066_8], [3.170_506_5, 1.807_002_2, 4.025_548]];
    for (at, origin) in places.into_iter().zip(origins) {
        let ray = parallel.ray(at);
        close(&ray.dir.to_array(), &[0.436_435_87, 0.218_217_9, -0.872_871_64], 1e-6, "direction");
        let along = (Vec3::from(origin) - ray.origin).dot(ray.dir);
        close(&ray.at(along).to_array(), &origin, 1e-5, "parallel");
    }
}

#[test]
fn spots_are_mitsubas() {
    let loaded = scene(&format!(
        "<emitter type=\"spot\"><rgb name=\"intensity\" value=\"3,2,1\"/><float name=\"cutoff_angle\" value=\"35\"/>\
         <float name=\"beam_width\" value=\"15\"/><transform name=\"to_world\">{LOOKING}</transform></emitter>"
    ));
    let mut s = manylight_sampling::Stream::new(1, [0; 3], manylight_sampling::Purpose::TEST);
    let sample = loaded.scene.sample_emitter(&mut s).unwrap();
    // `emitter.sample_direction`: the middle, the beam, where it fades, and outside.
    for (p, red) in SPOT {
        let d = Vec3::from(p) - sample.vertex.p;
        let got = sample.flux * sample.vertex.lobe_at(d.normalize()) * (1.0 / d.length_squared());
        let want = [red, red * 2.0 / 3.0, red / 3.0];
        assert!(
            got.to_array().iter().zip(want).all(|(a, b)| (a - b).abs() <= 2e-5 * red + 1e-7),
            "{p:?}: {got:?} {red}"
        );
    }
}

const SPOT: [([f32; 3], f32); 16] = [
    ([2.0, 2.5, 1.0], 0.5714285),
    ([2.2, 2.6, 1.4], 0.6880733),
    ([0.5, 3.9, 2.3], 0.0),
    ([1.0, 2.5, 1.3], 0.4310768),
    ([2.6, 3.7, 0.3], 0.2202905),
    ([0.1, 3.8, 1.3], 0.0),
    ([3.0, 0.5, 1.3], 0.0),
    ([2.9, 1.4, 2.8], 0.0),
    ([3.6, 0.6, 0.1], 0.0),
    ([2.2, 4.3, 1.1], 0.02300145),
    ([0.9, 2.2, 0.1], 0.09737881),
    ([0.9, 2.3, 1.5], 0.3360955),
    ([0.9, 1.4, 0.7], 0.0),
    ([1.8, 1.7, 0.1], 0.2233675),
    ([3.4, 2.7, 1.9], 0.0),
    ([0.7, 4.5, 2.6], 0.0),
];

#[test]
fn serialized_meshes_are_mitsubas() {
    // Written by `oracle/make_serialized.py`.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle");
    let shape = |file: &str, index: u32, more: &str| {
        let text = format!(
            "<shape type=\"serialized\"><string name=\"filename\" value=\"{file}.serialized\"/>\
             <integer name=\"shape_index\" value=\"{index}\"/>{more}</shape>"
        );
        scene_in(&folder, &text)
    };
    let down = ([0.5, -0.2, 9.0], [0.0, 0.0, -1.0]);
    for (file, index, normal, uv) in [
        ("quads4", 0, [-0.080281, -0.165456, 0.982944], [0.35, 0.4]),
        ("quads4", 1, [0.034782, 0.131045, 0.990766], [0.625, 0.45]),
        // Face normals by its flag alone: Mitsuba passes over it.
        ("quads4", 2, [-0.108897, -0.137236, 0.984534], [0.116667, 0.466667]),
        ("quads4", 3, [0.01737, 0.138163, 0.990257], [0.5625, 0.475]),
        ("quads3", 0, [0.069653, 0.116634, 0.99073], [0.35, 0.4]),
        ("quads3", 1, [-0.101768, -0.144303, 0.984286], [0.625, 0.45]),
    ] {
        check_hit(&format!("{file} {index}"), &shape(file, index, ""), down, normal, uv);
    }
    let faces = shape("quads4", 1, "<boolean name=\"face_normals\" value=\"true\"/>");
    check_hit("faces", &faces, down, [0.0, -0.242536, 0.970143], [0.625, 0.45]);
    let flipped = shape("quads4", 1, "<boolean name=\"flip_normals\" value=\"true\"/>");
    check_hit("flipped", &flipped, down, [-0.034782, -0.131045, -0.990766], [0.625, 0.45]);
}

#[test]
fn spectra_are_colours_and_merged_shapes_stand_beside_each_other() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("red.spd"), "# red\n400 0.1\n500 0.7\n600 0.3\n700 0.9\n").unwrap();
    let listed = "<spectrum name=\"reflectance\" value=\"400:0.1, 500:0.7, 600:0.3, 700:0.9\"/>";
    let from_file = "<spectrum name=\"reflectance\" filename=\"red.spd\"/>";
    for colour in [listed, from_file] {
        let shape =
            "<shape type=\"merge\"><shape type=\"rectangle\"><ref id=\"a\"/></shape><shape type=\"cube\"/></shape>";
        let loaded = scene_in(folder.path(), &format!("<bsdf type=\"diffuse\" id=\"a\">{colour}</bsdf>{shape}"));
        assert_eq!(loaded.scene.geometry().shapes().len(), 2);
        let bsdf = loaded.scene.bsdf(manylight_scene::MaterialId(0), Vec2::ZERO);
        close(&bsdf.albedo(Vec3::Z).to_array(), &[0.311_179_43, 0.550_708_95, 0.413_552_76], 2e-5, "reflectance");
    }
    // Too bright for a reflectance, which is said.
    let loaded = scene("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:2, 700:3\"/></bsdf>");
    assert!(loaded.warnings.iter().any(|w| w.contains("no colour of Rec. 709")), "{:?}", loaded.warnings);
}
