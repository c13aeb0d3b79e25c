//! Where formulas divide by zero, sums lose digits, and light is somewhere between none and all: named, one by one.
//!
//! What is exact is asked of every pixel; what is a mean, of blocks over passes at a family-wise significance of 0.01 by Holm
//! within each test. Seeds are fixed. `pass` itself fails where a sample is not finite or a light path's flux is not.

use manylight_bsdf::{Distribution, Mode};
use manylight_compensation::Bound;
use manylight_framework::{Bounding, Gather, Generator, Image, LightSet, Occlusion, Plan, Probe, VirtualLight};
use manylight_geometry::{ShapeGeometry, Sphere, Surface, TriangleMesh};
use manylight_integration::bounded_path::BoundedPath;
use manylight_integration::rooms::{
    built, camera, diffuse, furnace, hollow_ball, hollow_cube, lantern, place, plane_under,
};
use manylight_integration::{block_runs, pass, recipe};
use manylight_light_list::{All, Power};
use manylight_many_lights::direct_light;
use manylight_math::{Aabb, DAffine3, DVec3, Frame, Ray, Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{
    Bsdf, Edge, Emitter, EmitterPoint, Material, Model, Scatter, Scene, SceneBuilder, Source, SurfacePoint, Vertex,
};
use manylight_stats::{BlockTest, Reference, Runs};
use manylight_vpl::{Emission, Keller, Points, Vpl, connect_vertices};

const IR: &str = "instant-radiosity";
/// Every method, and the parts that its defaults leave out.
const ALL: &[(&str, &[&str])] = &[
    ("path", &[]),
    ("path", &["nee=off"]),
    (IR, &["paths=16"]),
    (IR, &["paths=16", "bound=none", "direct=virtual"]),
    (IR, &["paths=16", "glossy-vpls=off"]),
    (IR, &["direct=only"]),
    ("power-sampling", &["paths=64", "samples=4", "bound=none"]),
    ("many-lights", &["paths=16", "bound=3"]),
];
fn render(scene: &Scene, (method, params): (&str, &[&str]), seed: u64) -> Image {
    let r = recipe(method, params, scene);
    pass(scene, &*r.method, r.spp, seed, 0).0
}
/// Block means of a method over passes, with the mean of all blocks.
fn runs(scene: &Scene, method: &str, params: &[&str], passes: u64) -> Runs {
    let r = recipe(method, params, scene);
    block_runs(scene, &*r.method, r.spp, 31, passes, 2).with_mean()
}
/// The means are `truth`, up to what f32 rounds along a path.
fn mean_is(what: &str, runs: &Runs, truth: Spectrum) {
    // The mean over the blocks is over their channels too: leave it out.
    let blocks = runs.blocks() - 1;
    let rows: Vec<Vec<f64>> = runs.rows().iter().map(|r| r[..blocks].to_vec()).collect();
    let exact: Vec<f64> = (0..blocks).map(|i| truth.to_array()[i % 3] as f64).collect();
    let test = BlockTest { rounding: 5e-5, ..BlockTest::default() };
    let verdict = test.run(&Runs::new(rows).unwrap(), Reference::Exact(&exact)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}
fn agree(what: &str, a: &Runs, b: &Runs) {
    let verdict = BlockTest { rounding: 5e-5, ..BlockTest::default() }.run(a, Reference::Runs(b)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}
fn rectangle(to_world: DAffine3) -> ShapeGeometry {
    ShapeGeometry::Mesh(TriangleMesh::rectangle(&to_world))
}
/// A square of half width `size` at height `z`, facing down.
fn ceiling(z: f64, size: f64) -> ShapeGeometry {
    rectangle(
        DAffine3::from_translation(DVec3::new(0.0, 0.0, z))
            * DAffine3::from_rotation_x(std::f64::consts::PI)
            * DAffine3::from_scale(DVec3::splat(size)),
    )
}
fn metal(alpha: f32) -> Model {
    let (distribution, reflectance) = (Distribution::Ggx, Source::Constant(Spectrum::ONE));
    let (eta, k) = (Spectrum::rgb(0.2, 0.9, 1.1), Spectrum::rgb(3.9, 2.4, 2.2));
    Model::RoughConductor { distribution, alpha_u: alpha, alpha_v: alpha, eta, k, reflectance }
}
fn white() -> Model {
    Model::Diffuse { reflectance: Source::Constant(Spectrum::ONE) }
}
/// A vertex of a surface, seen along `wi`.
fn vertex(p: Vec3, n: Vec3, wi: Vec3, bsdf: Bsdf, mode: Mode) -> Vertex {
    let error = 1e-6 * p.abs().max_element().max(1.0);
    let surface = Surface { p, error, ng: n, ns: n, uv: Vec2::ZERO, dpdu: Vec3::ZERO };
    Vertex { p, scatter: Scatter::Surface(SurfacePoint::new(&surface, Frame::around(n), wi, bsdf, mode)) }
}
fn black(image: &Image) -> bool {
    image.pixels.iter().all(|p| p.is_black())
}

// ---- Points that are too near

#[test]
fn a_light_on_or_beside_the_shading_point_gives_nothing_or_what_the_bound_allows() {
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    let unit = |s: &mut Stream| manylight_sampling::warp::sphere(s.next_2d());
    let glossy = |alpha| metal(alpha).resolve(&[], Vec2::ZERO);
    let materials = [white().resolve(&[], Vec2::ZERO), glossy(0.3), glossy(1e-4)];
    let distances = [0.0, 1e-45, 1e-38, 1e-30].into_iter().chain((6..=25).map(|e| 10f32.powi(-e)));
    let (mut some, mut none) = (0, 0);
    for distance in distances {
        for _ in 0..400 {
            let p = if s.next_below(2) == 0 { Vec3::ZERO } else { unit(&mut s) * 3.0 };
            let (n, m) = (unit(&mut s), unit(&mut s));
            let seen = |n: Vec3, w: Vec3| if n.dot(w) < 0.0 { -w } else { w };
            let (wx, wy) = (seen(n, unit(&mut s)), seen(m, unit(&mut s)));
            let x = vertex(p, n, wx, materials[s.next_below(3)], Mode::Radiance);
            let y = vertex(p + unit(&mut s) * distance, m, wy, materials[s.next_below(3)], Mode::Importance);
            for flux in [1e-6f32, 1.0, 1e6] {
                let Some(c) = connect_vertices(&x, &y, Spectrum::gray(flux)) else {
                    none += 1;
                    continue;
                };
                some += 1;
                assert!(c.value.is_valid() && c.pair.g.is_finite(), "{distance}: {c:?}");
                let bound = Bound::Geometry(7.0);
                let w = (y.p - x.p).normalize();
                let most = (x.lobe_at(w) * y.lobe_at(-w)).largest() * flux * 7.0;
                let kept = (c.value * bound.keep(&c.pair)).largest();
                assert!(kept <= most * 1.0001, "{distance}: {kept} is more than {most}");
            }
        }
    }
    println!("{some} connections, {none} without");
    assert!(some > 1000 && none > 1000);
}

#[test]
fn a_vertex_does_not_light_itself() {
    // The lights of a pass as receivers: each meets itself among them, and its neighbours.
    let scene = furnace(hollow_cube(1.0), 1.0, Spectrum::gray(0.5), Spectrum::ONE, (4, 4));
    let keller = Keller { paths: 200, max_edges: None, certain_edges: 1, emission: Emission::Full };
    let lights = keller.generate(&scene, 0, 1, &mut Probe::default()).unwrap().lights;
    let set = build(&All, lights.clone());
    for light in &lights {
        let mut probe = Probe::default();
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        let mut ask = gather(&scene, &light.vertex, &Bound::None, &mut probe);
        assert!(set.radiance(&mut ask, &mut s).is_valid());
        assert!(connect_vertices(&light.vertex, &light.vertex, light.flux).is_none());
    }
}
struct Clear;
impl Occlusion for Clear {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}
fn build<P: Plan<Vec<Vpl>>>(plan: &P, lights: Vec<Vpl>) -> P::Set {
    plan.build(lights, &Clear, &mut Stream::new(1, [0; 3], Purpose::BUILD)).unwrap()
}
fn gather<'a>(
    scene: &'a Scene,
    receiver: &'a Vertex,
    bounding: &'a Bound,
    probe: &'a mut Probe,
) -> Gather<'a, Vertex, Points, Bound> {
    Gather { scene, receiver, kernel: &Points, bounding, edges_left: u32::MAX, edges_least: 0, probe }
}

#[test]
fn a_point_light_on_a_surface_or_a_hair_above_it_makes_no_sample_that_is_not_finite() {
    for height in [0.0f32, 1e-30, 1e-20, 1e-12, 1e-6] {
        let scene =
            plane_under(|b| b.emitter(Emitter::Point { position: Vec3::Z * height, intensity: Spectrum::ONE }), (8, 8));
        for what in ALL {
            render(&scene, *what, 1);
        }
        // The point below it, exactly.
        let below = scene.intersect(&Ray::new(Vec3::Z, Vec3::NEG_Z), Mode::Radiance).unwrap();
        let direct = direct_light(&scene, &below, &mut Probe::default(), &mut Stream::new(1, [0; 3], Purpose::TEST));
        assert!(direct.is_valid(), "at {height}: {direct:?}");
    }
}

#[test]
fn a_lamp_in_the_plane_of_the_floor_lights_it_by_no_method() {
    // Coplanar and overlapping, face to face at no distance.
    for flip in [0.0, std::f64::consts::PI] {
        let scene = plane_under(
            |b| {
                let m = diffuse(b, Spectrum::gray(0.5));
                let lamp = DAffine3::from_rotation_x(flip) * DAffine3::from_scale(DVec3::splat(0.5));
                place(b, rectangle(DAffine3::from_translation(DVec3::X * 2.0) * lamp), m, Some(Spectrum::ONE));
            },
            (8, 8),
        );
        for what in ALL {
            assert!(black(&render(&scene, *what, 1)), "{what:?}");
        }
    }
}

// ---- Shapes that are hardly there

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

// ---- Sums

#[test]
fn a_million_equal_lights_give_a_million_times_one() {
    let scene = lantern(0.5, (4, 4));
    let x = scene.intersect(&scene.camera().ray(Vec2::splat(2.0)), Mode::Radiance).unwrap();
    let n = 1_000_000;
    let vertex = Vertex { p: Vec3::new(0.1, 0.2, 0.3), scatter: Scatter::Emitter(EmitterPoint::Isotropic) };
    let light = Vpl { vertex, flux: Spectrum::rgb(0.7, 0.3, 0.123_456_79), edges: 1 };
    let sum = |lights: Vec<Vpl>| {
        let mut probe = Probe::default();
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        build(&All, lights).radiance(&mut gather(&scene, &x, &Bound::None, &mut probe), &mut s)
    };
    let (one, all) = (sum(vec![light]), sum(vec![light; n]));
    assert!(one.0.min_element() > 0.0);
    for (one, all) in one.to_array().into_iter().zip(all.to_array()) {
        let expected = one as f64 * n as f64;
        assert!((all as f64 / expected - 1.0).abs() < 1e-6, "{all} is not {expected}");
    }
}

#[test]
fn of_two_lamps_a_million_to_one_the_weak_one_is_drawn_as_seldom_and_weighs_as_much() {
    let mut b = Scene::builder();
    let intensities = [1e6f32, 1.0];
    for (i, intensity) in intensities.into_iter().enumerate() {
        let position = Vec3::X * i as f32;
        b.emitter(Emitter::Point { position, intensity: Spectrum::gray(intensity) });
    }
    b.camera(camera(DVec3::Z, DVec3::ZERO, 40.0, (2, 2)));
    let scene = built(b);
    let emitters = scene.emitters();
    assert!((emitters.pmf(1) as f64 * (1e6 + 1.0) - 1.0).abs() < 1e-6);
    let mut s = Stream::new(3, [0; 3], Purpose::TEST);
    let n = 20_000_000;
    let mut weak = 0;
    for _ in 0..n {
        let e = scene.sample_emitter(&mut s).unwrap();
        // pmf x flux = 4 pi I, for both.
        let flux = e.flux.luminance() * emitters.pmf(e.emitter);
        let expected = 4.0 * std::f32::consts::PI * intensities[e.emitter as usize];
        assert!((flux / expected - 1.0).abs() < 1e-5, "{flux} {expected}");
        weak += e.emitter;
    }
    // Poisson of mean 20: within [7, 36] but for one in 1000.
    assert!((7..=36).contains(&weak), "{weak} of {n}");
    // And as lights of a set: each stratum of the power weighs what it is.
    let lights = |flux: [f32; 2]| {
        let vertex = |x| Vertex { p: Vec3::X * x, scatter: Scatter::Emitter(EmitterPoint::Isotropic) };
        vec![0, 1]
            .into_iter()
            .map(|i| Vpl { vertex: vertex(i as f32), flux: Spectrum::gray(flux[i]), edges: 1 })
            .collect()
    };
    let made: Vec<Vpl> = lights(intensities);
    assert_eq!(made[0].intensity() / made[1].intensity(), 1e6);
    let set = build(&Power { samples: 1 }, made);
    use manylight_framework::Picks;
    let pmf = |i| Picks::<()>::pmf(&set, &mut (), i);
    assert!((pmf(0) + pmf(1) - 1.0).abs() < 1e-15 && (pmf(1) * (1e6 + 1.0) - 1.0).abs() < 1e-6);
}

#[test]
fn a_weak_lamp_that_is_seldom_drawn_is_found_by_chance_at_its_full_strength() {
    // A ceiling of radiance 1 over the floor, and a lantern of a million times its power that cannot be seen from there: drawn
    // once in a million, the ceiling is still what the BSDF's samples say.
    let scene = plane_under(
        |b| {
            let m = diffuse(b, Spectrum::BLACK);
            place(b, ceiling(1.0, 1.0), m, Some(Spectrum::ONE));
            b.emitter(Emitter::Point { position: Vec3::NEG_Z, intensity: Spectrum::gray(1e6) });
        },
        (4, 4),
    );
    // Form factor of a square from a point below its middle: four times that of a corner, 2 / (pi sqrt 2) atan(1 / sqrt 2).
    let quarter = (0.5f64.sqrt() * 0.5f64.sqrt().atan()) / std::f64::consts::PI;
    let truth = Spectrum::gray((0.8 * 4.0 * quarter) as f32);
    for (method, params) in [("path", &["max-depth=2"][..]), (IR, &["direct=only"])] {
        let r = recipe(method, params, &scene);
        mean_is(method, &block_runs(&scene, &*r.method, 64, 1, 256, 2).with_mean(), truth);
    }
}

// ---- Light that is not there

#[test]
fn a_channel_without_light_stays_exactly_black_and_the_others_do_not() {
    let mut b = Scene::builder();
    // No blue in the light, no red in the walls; green in both.
    let m = diffuse(&mut b, Spectrum::rgb(0.0, 0.6, 0.9));
    place(&mut b, hollow_ball(1.0), m, None);
    let lamp = diffuse(&mut b, Spectrum::BLACK);
    place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::Z * 0.4, 0.1)), lamp, Some(Spectrum::rgb(5.0, 3.0, 0.0)));
    b.camera(camera(DVec3::new(0.2, 0.1, 0.3), DVec3::new(0.1, 0.0, -1.0), 60.0, (12, 12)));
    let scene = built(b);
    for what in ALL {
        let image = render(&scene, *what, 1);
        assert!(image.pixels.iter().all(|p| p.0.x == 0.0 && p.0.z == 0.0), "{what:?}");
        assert!(image.pixels.iter().any(|p| p.0.y > 0.0), "{what:?}");
    }
    // Blue alone has 7 % of the luminance and none of the others': it is carried all the same.
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::rgb(1.0, 0.0, 0.5));
    place(&mut b, hollow_ball(1.0), m, Some(Spectrum::rgb(0.0, 0.0, 1.0)));
    b.camera(camera(DVec3::new(0.2, 0.1, 0.3), DVec3::new(0.1, 0.0, -1.0), 60.0, (8, 8)));
    let blue = built(b);
    for (method, params) in [("path", &["spp=16"][..]), (IR, &["bound=none", "paths=64"])] {
        mean_is(method, &runs(&blue, method, params, 64), Spectrum::rgb(0.0, 0.0, 2.0));
    }
}

#[test]
fn without_shapes_there_is_the_sky_or_nothing() {
    for sky in [None, Some(Spectrum::rgb(0.5, 1.0, 0.0))] {
        let mut b = Scene::builder();
        if let Some(radiance) = sky {
            b.emitter(Emitter::Constant { radiance });
        }
        b.emitter(Emitter::Point { position: Vec3::X, intensity: Spectrum::ONE });
        b.camera(camera(DVec3::ZERO, DVec3::X, 60.0, (4, 4)));
        let scene = built(b);
        for what in ALL {
            let image = render(&scene, *what, 1);
            assert!(image.pixels.iter().all(|p| *p == sky.unwrap_or_default()), "{what:?}: {:?}", image.pixels[0]);
        }
    }
}

#[test]
fn a_camera_that_looks_away_sees_nothing_although_there_is_light() {
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, rectangle(DAffine3::IDENTITY), m, Some(Spectrum::ONE));
    b.camera(camera(DVec3::Z, DVec3::Z * 2.0, 60.0, (4, 4)));
    let scene = built(b);
    for what in ALL {
        assert!(black(&render(&scene, *what, 1)), "{what:?}");
    }
}

#[test]
fn a_camera_inside_or_behind_a_shape_sees_its_black_back() {
    // Inside a ball whose outside is lit; and behind the one-sided walls of a lit room.
    let lamp = |b: &mut SceneBuilder| {
        b.emitter(Emitter::Point { position: Vec3::new(0.0, 0.0, 3.0), intensity: Spectrum::ONE });
    };
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), m, Some(Spectrum::ONE));
    lamp(&mut b);
    b.camera(camera(DVec3::ZERO, DVec3::X, 90.0, (6, 6)));
    let inside = built(b);
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, hollow_cube(4.0), m, Some(Spectrum::ONE));
    lamp(&mut b);
    b.camera(camera(DVec3::X * 9.0, DVec3::ZERO, 20.0, (6, 6)));
    let behind = built(b);
    // On the surface itself, to a hair.
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, rectangle(DAffine3::IDENTITY), m, Some(Spectrum::ONE));
    b.camera(camera(DVec3::ZERO, DVec3::X, 90.0, (6, 6)));
    let on = built(b);
    for what in ALL {
        assert!(black(&render(&inside, *what, 1)), "inside, {what:?}");
        assert!(black(&render(&behind, *what, 1)), "behind, {what:?}");
        render(&on, *what, 1);
    }
}

#[test]
fn a_lamp_shines_on_one_side_only() {
    // The lamp faces up and hangs above the floor: from below it is black, and so is the floor.
    let scene = plane_under(
        |b| {
            let m = diffuse(b, Spectrum::gray(0.5));
            place(b, rectangle(DAffine3::from_translation(DVec3::Z)), m, Some(Spectrum::ONE));
        },
        (4, 4),
    );
    for what in ALL {
        assert!(black(&render(&scene, *what, 1)), "{what:?}");
    }
    let up = Ray::new(Vec3::new(0.1, 0.2, 0.5), Vec3::Z);
    assert!(scene.intersect(&up, Mode::Radiance).unwrap().emitted().is_black());
    let down = Ray::new(Vec3::new(0.1, 0.2, 5.0), Vec3::NEG_Z);
    assert_eq!(scene.intersect(&down, Mode::Radiance).unwrap().emitted(), Spectrum::ONE);
}

#[test]
fn a_lamp_without_power_beside_one_that_shines_changes_nothing() {
    let with = |dark: bool| {
        plane_under(
            |b| {
                let m = diffuse(b, Spectrum::BLACK);
                place(b, ceiling(1.0, 1.0), m, Some(Spectrum::ONE));
                if dark {
                    place(b, ceiling(3.0, 1.0), m, Some(Spectrum::BLACK));
                    b.emitter(Emitter::Point { position: Vec3::Z * 0.5, intensity: Spectrum::BLACK });
                    b.emitter(Emitter::Constant { radiance: Spectrum::BLACK });
                }
            },
            (4, 4),
        )
    };
    let (dark, plain) = (with(true), with(false));
    assert_eq!((1..4).map(|i| dark.emitters().pmf(i)).collect::<Vec<_>>(), [0.0; 3]);
    for what in ALL {
        let mean = |scene: &Scene| {
            let image = render(scene, (what.0, what.1), 4);
            image.pixels.iter().map(|p| p.luminance()).sum::<f32>()
        };
        let (a, b) = (mean(&dark), mean(&plain));
        assert!((a > 0.0) == (b > 0.0), "{what:?}: {a} {b}");
    }
    agree("path", &runs(&dark, "path", &["spp=64"], 32), &runs(&plain, "path", &["spp=64"], 33));
    let lights = ["paths=256", "direct=virtual", "bound=none"];
    agree("lights", &runs(&dark, IR, &lights, 64), &runs(&plain, IR, &lights, 65));
}

#[test]
fn no_light_gets_through_a_wall_without_thickness_that_scatters_on_both_sides() {
    // A room cut in two by a two-sided wall: the lamp in one half, the camera in the other, lights on both faces' neighbours.
    let mut b = Scene::builder();
    let m = diffuse(&mut b, Spectrum::gray(0.9));
    place(&mut b, hollow_cube(1.0), m, None);
    let wall = b.material(Material::two_sided("wall", white()));
    let upright = DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2);
    place(&mut b, rectangle(upright * DAffine3::from_scale(DVec3::splat(1.5))), wall, None);
    b.emitter(Emitter::Point { position: Vec3::X * 0.5, intensity: Spectrum::ONE });
    b.emitter(Emitter::Point { position: Vec3::X * 1e-3, intensity: Spectrum::ONE });
    b.camera(camera(DVec3::X * -0.9, DVec3::ZERO, 100.0, (16, 16)));
    b.max_depth(Some(20));
    let scene = built(b);
    for what in ALL {
        for seed in 0..4 {
            assert!(black(&render(&scene, *what, seed)), "{what:?}, seed {seed}");
        }
    }
    // Face to face through the wall, wherever on it.
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    for _ in 0..100_000 {
        let mut on = |side: f32| {
            let p = Vec3::new(0.0, s.next_f32() - 0.5, s.next_f32() - 0.5) * 10f32.powi(-(s.next_below(6) as i32));
            let mode = if side < 0.0 { Mode::Radiance } else { Mode::Importance };
            scene.intersect(&Ray::new(p + Vec3::X * 0.5 * side, Vec3::X * -side), mode).unwrap()
        };
        let (x, y) = (on(-1.0), on(1.0));
        if let Some(c) = connect_vertices(&x, &y, Spectrum::ONE) {
            assert!(scene.transmittance(&c.edge).is_black(), "{c:?}");
        }
    }
}

// ---- Light from everywhere, and white things

#[test]
fn a_convex_thing_under_an_even_sky_has_its_albedo() {
    for (rho, sky) in [(Spectrum::rgb(0.5, 0.8, 0.0), Spectrum::rgb(2.0, 1.0, 3.0)), (Spectrum::ONE, Spectrum::ONE)] {
        let mut b = Scene::builder();
        let m = diffuse(&mut b, rho);
        place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), m, None);
        // Far away and hardly there: most paths from the sky meet nothing.
        place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::Z * 8.0, 1e-3)), m, None);
        b.emitter(Emitter::Constant { radiance: sky });
        b.camera(camera(DVec3::new(-3.0, 0.0, 0.0), DVec3::ZERO, 25.0, (8, 8)));
        let scene = built(b);
        let truth = rho * sky;
        // By chance alone, each sample is exact.
        let image = render(&scene, ("path", &["nee=off", "spp=16"]), 1);
        for p in &image.pixels {
            assert!((p.0 - truth.0).abs().max_element() < 1e-5, "{p:?} is not {truth:?}");
        }
        mean_is("path", &runs(&scene, "path", &["spp=16"], 64), truth);
        mean_is("lights", &runs(&scene, IR, &["spp=16", "bound=none", "paths=64"], 64), truth);
        mean_is("virtual", &runs(&scene, IR, &["direct=virtual", "bound=none", "paths=1024"], 64), truth);
        // The first vertices carry what falls on the ball: irradiance pi L, on 4 pi r^2. 1 in 20 paths meets it.
        let n = 400_000;
        let keller = Keller { paths: n, max_edges: Some(3), certain_edges: 9, emission: Emission::Full };
        let mut probe = Probe::default();
        let batch = keller.generate(&scene, 0, 3, &mut probe).unwrap();
        let hits = batch.lights.len() as f64 / n as f64;
        let flux: f64 = batch.lights.iter().map(|l| l.flux.luminance() as f64).sum();
        let expected = 4.0 * std::f64::consts::PI.powi(2) * sky.luminance() as f64;
        let sigma = ((1.0 - hits) / (hits * n as f64)).sqrt();
        println!("{hits} of the paths hit; flux {flux} W, expected {expected} +- {:.2} %", 100.0 * sigma);
        assert!((0.02..0.1).contains(&hits) && (flux / expected - 1.0).abs() < 3.3 * sigma);
        assert_eq!(probe.light_paths, n);
    }
}

#[test]
fn what_absorbs_nothing_vanishes_under_an_even_sky() {
    let glass = Model::Dielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        reflectance: Source::Constant(Spectrum::ONE),
        transmittance: Source::Constant(Spectrum::ONE),
    };
    // Index 0 + 1e6 i: reflects everything.
    let mirror =
        Model::Conductor { eta: Spectrum::BLACK, k: Spectrum::gray(1e6), reflectance: Source::Constant(Spectrum::ONE) };
    for (name, model) in [("diffuse", white()), ("glass", glass), ("mirror", mirror)] {
        let mut b = Scene::builder();
        let m = b.material(Material::one_sided(name, model));
        place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), m, None);
        b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
        b.camera(camera(DVec3::new(-3.0, 0.0, 0.0), DVec3::ZERO, 40.0, (8, 8)));
        let scene = built(b);
        for (method, params) in
            [("path", &["spp=64"][..]), ("path", &["spp=64", "nee=off"]), (IR, &["spp=64", "paths=16", "bound=none"])]
        {
            mean_is(&format!("{name}, {method} {params:?}"), &runs(&scene, method, params, 32), Spectrum::ONE);
        }
    }
}

#[test]
fn roulette_ends_every_path_between_white_walls() {
    let scene = lantern(1.0, (4, 4));
    for what in ALL {
        let r = recipe(what.0, what.1, &scene);
        let (image, probe) = pass(&scene, &*r.method, 1, 1, 0);
        assert!(image.pixels.iter().all(|p| p.is_finite()));
        let walks = probe.light_paths + probe.camera_rays;
        // A chance of 0.95 an edge after the sixteenth: 36 edges in the mean.
        assert!(probe.path_rays < 60 * walks, "{what:?}: {} rays of {walks} paths", probe.path_rays);
    }
}

// ---- Materials

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

// ---- Depths

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

// ---- Shading normals

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
