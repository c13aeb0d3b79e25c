//! Materials, depths and shading normals.

use super::*;

#[test]
fn a_light_on_rough_metal_is_kept_where_its_path_ends() {
    // Microfacets of roughness 1 send almost half of the paths into the surface: the vertex is a light all the same.
    let mut b = Scene::builder();
    let m = b.material(Material::one_sided("metal", metal(1.0)));
    place(&mut b, hollow_cube(1.0), m, None);
    b.emitter(Emitter::Point { position: Vec3::new(0.3, 0.2, 0.1), intensity: Spectrum::ONE });
    b.camera(camera(DVec3::ZERO, DVec3::X, 90.0, (4, 4)));
    let scene = built(b);
    let n = 20_000;
    let keller = Keller { paths: n, max_edges: None, certain_edges: 1000, emission: Emission::Full };
    let batch = Keller { max_edges: Some(4), ..keller }.generate(&scene, 0, 1, &mut Probe::default()).unwrap();
    let at = |edges| batch.lights.iter().filter(move |l| l.edges == edges);
    // All of the lantern's 4 pi W arrive at first vertices.
    assert_eq!(at(1).count() as u64, n);
    let flux: f64 = at(1).map(|l| l.flux.luminance() as f64).sum();
    assert!((flux / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-5, "{flux}");
    // A good part of them goes no farther: to drop those would be to lose their light.
    let on = at(2).count() as f64 / n as f64;
    println!("{on} of the paths go on");
    assert!((0.4..0.7).contains(&on), "{on}");
    // And what they bring is what a path tracer finds: the indirect light of one bounce more.
    let scene = {
        let mut b = Scene::builder();
        let rough = b.material(Material::one_sided("metal", metal(0.8)));
        place(&mut b, hollow_cube(1.0), rough, None);
        let lamp = diffuse(&mut b, Spectrum::BLACK);
        place(&mut b, ceiling(0.9, 0.4), lamp, Some(Spectrum::gray(3.0)));
        b.camera(camera(DVec3::new(-0.6, -0.5, 0.1), DVec3::new(1.0, 0.8, -0.6), 60.0, (8, 8)));
        built(b)
    };
    let path = BoundedPath { bounding: Bound::Geometry(1.0), max_edges: 4 };
    let truth = block_runs(&scene, &path, 256, 3, 64, 2).with_mean();
    agree("rough metal", &runs(&scene, IR, &["bound=1", "paths=512", "min-depth=3", "max-depth=4"], 96), &truth);
}

#[test]
fn polished_metal_of_roughness_1e_4_makes_nothing_that_is_not_finite_and_looks_like_a_mirror() {
    let room = |floor: Model| {
        let mut b = Scene::builder();
        let m = diffuse(&mut b, Spectrum::gray(0.5));
        place(&mut b, hollow_cube(1.0), m, None);
        let floor = b.material(Material::two_sided("floor", floor));
        place(&mut b, rectangle(DAffine3::from_translation(DVec3::Z * -0.8)), floor, None);
        place(&mut b, ceiling(0.9, 0.5), m, Some(Spectrum::gray(4.0)));
        b.camera(camera(DVec3::new(0.0, -0.9, -0.3), DVec3::new(0.0, 0.2, -0.8), 60.0, (8, 8)));
        b.max_depth(Some(4));
        built(b)
    };
    let polished = room(metal(1e-4));
    for what in ALL {
        for seed in 0..3 {
            render(&polished, *what, seed);
        }
    }
    let Model::RoughConductor { eta, k, reflectance, .. } = metal(1e-4) else { unreachable!() };
    let mirror = room(Model::Conductor { eta, k, reflectance });
    // The mirror's paths find what the polished metal's do: all but reflections of reflections alike.
    let params = ["spp=64", "nee=off"];
    agree("path", &runs(&polished, "path", &params, 64), &runs(&mirror, "path", &params, 65));
}

#[test]
fn connections_along_the_surface_are_finite() {
    let mut s = Stream::new(4, [0; 3], Purpose::TEST);
    let materials = [white(), metal(0.1), metal(1e-4)].map(|m| m.resolve(&[], Vec2::ZERO));
    for e in 0..40 {
        let lift = 10f32.powi(-e);
        for _ in 0..200 {
            let along = |s: &mut Stream| {
                let (sin, cos) = (s.next_f32() * std::f32::consts::TAU).sin_cos();
                Vec3::new(cos, sin, lift).normalize()
            };
            let (wx, wy) = (along(&mut s), along(&mut s));
            let x = vertex(Vec3::ZERO, Vec3::Z, wx, materials[s.next_below(3)], Mode::Radiance);
            let y = along(&mut s) * (0.1 + s.next_f32());
            let up = if s.next_below(2) == 0 { Vec3::Z } else { -along(&mut s) };
            let y = vertex(y, up, if up == Vec3::Z { wy } else { up }, materials[s.next_below(3)], Mode::Importance);
            if let Some(c) = connect_vertices(&x, &y, Spectrum::ONE) {
                assert!(c.value.is_valid() && c.pair.g >= 0.0 && c.pair.g.is_finite(), "{c:?}");
            }
        }
    }
    // A lamp that grazes the floor that the camera grazes.
    let mut b = Scene::builder();
    let m = b.material(Material::two_sided("floor", metal(0.05)));
    place(&mut b, rectangle(DAffine3::from_scale(DVec3::splat(100.0))), m, None);
    let upright = DAffine3::from_translation(DVec3::X * 50.0) * DAffine3::from_rotation_y(-std::f64::consts::FRAC_PI_2);
    let lamp = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, rectangle(upright), lamp, Some(Spectrum::ONE));
    b.camera(camera(DVec3::new(-50.0, 0.0, 1e-3), DVec3::new(50.0, 0.0, 0.0), 1.0, (8, 8)));
    let scene = built(b);
    for what in ALL {
        render(&scene, *what, 1);
    }
}

#[test]
fn at_depth_1_there_are_lamps_and_at_depth_2_direct_light_and_no_virtual_light() {
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, hollow_cube(1.0), m, None);
    place(&mut b, ceiling(0.9, 0.5), m, Some(Spectrum::rgb(4.0, 2.0, 1.0)));
    b.camera(camera(DVec3::new(0.0, -0.9, 0.0), DVec3::new(0.0, 0.5, 0.4), 80.0, (16, 16)));
    let scene = built(b);
    let mut seen = None;
    for (method, params) in ALL {
        let with = |depth: &'static str| [params, &[depth][..]].concat();
        let emission = render(&scene, (method, &with("max-depth=1")), 1);
        assert!(emission.pixels.iter().any(|p| !p.is_black()) && emission.pixels.iter().any(|p| p.is_black()));
        // The same camera rays, so the same image.
        assert!(*seen.get_or_insert_with(|| emission.clone()) == emission, "{method} {params:?}");
        let r = recipe(method, &with("max-depth=2"), &scene);
        let (image, probe) = pass(&scene, &*r.method, 1, 1, 0);
        assert!(!black(&image));
        if !params.contains(&"direct=virtual") {
            assert_eq!((probe.lights, probe.evaluations), (0, 0), "{method} {params:?}");
        }
    }
    let path = runs(&scene, "path", &["spp=16", "max-depth=2"], 64);
    agree("depth 2", &runs(&scene, IR, &["spp=16", "max-depth=2"], 65), &path);
}

/// A ball of eight triangles under the normals of a round one.
fn octahedron(centre: Vec3, radius: f32) -> ShapeGeometry {
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let mut mesh = TriangleMesh {
        positions: axes.iter().map(|a| centre + *a * radius).collect(),
        triangles: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
        ..TriangleMesh::default()
    };
    mesh.compute_smooth_normals();
    ShapeGeometry::Mesh(mesh)
}

#[test]
fn on_a_coarse_mesh_with_smooth_normals_paths_and_lights_agree() {
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.7));
    place(&mut b, hollow_cube(1.0), m, None);
    place(&mut b, octahedron(Vec3::new(0.1, 0.3, -0.4), 0.5), m, None);
    place(&mut b, ceiling(0.99, 0.4), m, Some(Spectrum::gray(5.0)));
    b.camera(camera(DVec3::new(0.0, -0.95, 0.2), DVec3::new(0.1, 0.3, -0.4), 60.0, (12, 12)));
    let scene = built(b);
    let path = BoundedPath { bounding: Bound::Geometry(2.0), max_edges: 5 };
    let truth = block_runs(&scene, &path, 64, 3, 96, 2).with_mean();
    let lights = runs(&scene, IR, &["bound=2", "paths=256", "min-depth=3", "max-depth=5"], 128);
    agree("smooth normals", &lights, &truth);
}

#[test]
fn a_lamp_with_smooth_normals_shines_the_same_by_chance_by_sampling_and_by_virtual_lights() {
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, rectangle(DAffine3::from_scale(DVec3::splat(3.0))), m, None);
    place(&mut b, octahedron(Vec3::Z * 1.5, 1.0), m, Some(Spectrum::ONE));
    b.camera(camera(DVec3::new(0.0, -6.0, 3.0), DVec3::Z * 0.7, 50.0, (12, 12)));
    let scene = built(b);
    let truth = runs(&scene, "path", &["nee=off", "spp=64", "max-depth=2"], 64);
    agree("sampled", &runs(&scene, "path", &["spp=16", "max-depth=2"], 65), &truth);
    agree("direct", &runs(&scene, IR, &["spp=16", "direct=only", "max-depth=2"], 66), &truth);
    let lights = ["direct=virtual", "bound=none", "paths=512", "spp=4", "max-depth=2"];
    agree("virtual", &runs(&scene, IR, &lights, 67), &truth);
}
