//! Shapes that are hardly there.

use super::*;

#[test]
fn walls_of_slivers_and_triangles_without_area_make_a_furnace_that_does_not_leak() {
    // Each wall's triangles are cut at points ever nearer to one of their edges: slivers of a millionth of their length.
    let mut walls = TriangleMesh::cube(&DAffine3::IDENTITY);
    (walls.normals, walls.uvs) = (vec![], vec![]);
    walls.flip_normals();
    let mut cut = Vec::new();
    for [a, b, c] in walls.triangles.clone() {
        let mut c = c;
        for width in [1e-1f32, 1e-2, 1e-2, 1e-1] {
            let [p, q, r] = [a, b, c].map(|i| walls.positions[i as usize]);
            walls.positions.push(p.lerp(q, 0.4) * (1.0 - width) + r * width);
            let new = walls.positions.len() as u32 - 1;
            cut.extend([[b, c, new], [c, a, new]]);
            c = new;
        }
        cut.extend([[a, b, c], [a, a, b], [c, c, c], [a, b, a]]);
    }
    walls.triangles = cut;
    let nothing = TriangleMesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]; 5], ..Default::default() };
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, ShapeGeometry::Mesh(walls), m, Some(Spectrum::ONE));
    place(&mut b, ShapeGeometry::Mesh(nothing), m, Some(Spectrum::ONE));
    b.camera(camera(DVec3::new(0.1, -0.9, 0.3), DVec3::ZERO, 70.0, (24, 24)));
    let scene = built(b);
    assert!((scene.area() - 24.0).abs() < 1e-4);
    // Without next-event estimation or roulette each sample is the truth.
    let exact = render(&scene, ("path", &["nee=off", "rr-depth=1000", "max-depth=40", "spp=16"]), 1);
    for p in &exact.pixels {
        assert!((p.0 - 2.0).abs().max_element() < 1e-3, "{p:?}");
    }
    mean_is("path", &runs(&scene, "path", &["spp=4"], 48), Spectrum::gray(2.0));
    for what in ALL {
        render(&scene, *what, 2);
    }
}

#[test]
fn needles_thinner_than_rounding_darken_a_sample_in_ten_thousand_at_most() {
    // Closed needles a metre long and down to a ten-millionth wide that shine and reflect as the walls do. Where front and back
    // are nearer to each other than rounding, a ray may meet the back, which is black; never is anything too bright.
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, hollow_cube(1.0), m, Some(Spectrum::ONE));
    for (i, width) in [1e-1f32, 1e-3, 1e-5, 1e-7].into_iter().enumerate() {
        let base = Vec3::new(-0.5, 0.2 * i as f32 - 0.3, 0.3 - 0.1 * i as f32);
        let tip = base + Vec3::new(1.0, 0.3, -0.2);
        let needle = TriangleMesh {
            positions: vec![base, base + Vec3::Y * width, base + Vec3::Z * width, tip],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            ..TriangleMesh::default()
        };
        place(&mut b, ShapeGeometry::Mesh(needle), m, Some(Spectrum::ONE));
    }
    b.camera(camera(DVec3::new(0.1, -0.9, 0.3), DVec3::ZERO, 70.0, (24, 24)));
    let scene = built(b);
    let image = render(&scene, ("path", &["nee=off", "rr-depth=1000", "max-depth=40", "spp=16"]), 1);
    assert!(image.pixels.iter().all(|p| p.largest() < 2.001));
    let dark = image.pixels.iter().filter(|p| p.0.min_element() < 1.999).count();
    println!("{dark} pixels of 16 samples are darker");
    assert!(dark <= 1, "{dark}");
    for what in ALL {
        render(&scene, *what, 2);
    }
}

#[test]
fn a_lamp_whose_triangles_are_given_twice_shines_once() {
    let lamp = |copies: usize, turned: bool| {
        plane_under(
            |b| {
                let m = diffuse(b, Spectrum::BLACK);
                let ShapeGeometry::Mesh(mut mesh) = ceiling(1.0, 1.0) else { unreachable!() };
                let once = mesh.triangles.clone();
                for _ in 1..copies {
                    mesh.triangles.extend(once.iter().map(|t| if turned { [t[0], t[2], t[1]] } else { *t }));
                }
                place(b, ShapeGeometry::Mesh(mesh), m, Some(Spectrum::ONE));
            },
            (2, 2),
        )
    };
    let once = lamp(1, false);
    for (copies, turned) in [(2, false), (5, false), (2, true)] {
        let scene = lamp(copies, turned);
        assert!((scene.area() - once.area()).abs() < 1e-9, "{copies} copies have {} m^2", scene.area());
        for (method, params) in
            [("path", &["spp=256", "max-depth=2"][..]), ("path", &["spp=256", "nee=off", "max-depth=2"])]
        {
            agree(
                &format!("{copies} times, {params:?}"),
                &runs(&scene, method, params, 32),
                &runs(&once, "path", &["spp=256", "max-depth=2"], 33),
            );
        }
    }
}

#[test]
fn a_lamp_much_smaller_than_a_pixel_brings_what_its_area_does() {
    // A square of (2e-4 m)^2 at height 1, of 1 W/m^2/sr per (1e-4 m)^2: irradiance L A / h^2 = 4.
    let scene = plane_under(
        |b| {
            let m = diffuse(b, Spectrum::BLACK);
            place(b, ceiling(1.0, 1e-4), m, Some(Spectrum::rgb(1e8, 5e7, 0.0)));
        },
        (4, 4),
    );
    let truth = Spectrum::rgb(4.0, 2.0, 0.0) * (0.8 * std::f32::consts::FRAC_1_PI);
    for (method, params) in [
        ("path", &["max-depth=2"][..]),
        (IR, &["direct=only"]),
        (IR, &["direct=virtual", "max-depth=2", "bound=none", "paths=64"]),
    ] {
        mean_is(method, &runs(&scene, method, params, 64), truth);
    }
}
