//! What must not change an image, and what must change it by a known factor: units, places, threads, the order of passes.
//!
//! Where the statement is exact it is asked of every bit; where it is one about means, of blocks over passes at a family-wise
//! significance of 0.01 by Holm. Seeds are fixed.

use manylight_bsdf::Distribution;
use manylight_framework::{Film, Image, Probe, Sequential};
use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
use manylight_integration::rooms::{built, diffuse, place};
use manylight_integration::{block_runs, pass, recipe};
use manylight_math::{DAffine3, DVec3, Spectrum};
use manylight_recipes::methods;
use manylight_render::{Budget, Progress, Settings, render};
use manylight_scene::{Camera, Emitter, FilterSampler, Material, Model, Scene, Source};
use manylight_stats::{BlockTest, Reference};
use std::sync::Arc;

const SIZE: (u32, u32) = (24, 20);

/// A closed room with a lamp of triangles, a lamp that is a ball, a lantern, and a metal ball; moved, and scaled about the origin.
/// Radiances stay what they are, times `bright`; the lantern keeps up with them (its intensity grows with the surface).
fn room(to_world: DAffine3, bright: f32) -> Scene {
    let scale = to_world.matrix3.determinant().cbrt();
    let mut b = Scene::builder();
    let white = diffuse(&mut b, Spectrum::gray(0.7));
    let red = diffuse(&mut b, Spectrum::rgb(0.6, 0.1, 0.0));
    let metal = b.material(Material::one_sided(
        "metal",
        Model::RoughConductor {
            distribution: Distribution::Ggx,
            alpha_u: 0.3,
            alpha_v: 0.3,
            eta: Spectrum::rgb(0.2, 0.9, 1.1),
            k: Spectrum::rgb(3.9, 2.4, 2.2),
            reflectance: Source::Constant(Spectrum::ONE),
        },
    ));
    let mut walls = TriangleMesh::cube(&to_world);
    walls.flip_normals();
    place(&mut b, ShapeGeometry::Mesh(walls), white, None);
    let at = |x, y, z, s: f64| {
        to_world * DAffine3::from_translation(DVec3::new(x, y, z)) * DAffine3::from_scale(DVec3::splat(s))
    };
    place(&mut b, ShapeGeometry::Mesh(TriangleMesh::cube(&at(0.4, -0.7, 0.2, 0.3))), red, None);
    let down = DAffine3::from_rotation_x(std::f64::consts::PI);
    let lamp = TriangleMesh::rectangle(&(at(0.0, 0.2, 0.95, 0.3) * down));
    place(&mut b, ShapeGeometry::Mesh(lamp), white, Some(Spectrum::rgb(8.0, 6.0, 3.0) * bright));
    let ball = |x, y, z, r: f64| {
        ShapeGeometry::Sphere(Sphere::new(to_world.transform_point3(DVec3::new(x, y, z)).as_vec3(), (r * scale) as f32))
    };
    place(&mut b, ball(-0.4, 0.3, -0.6, 0.3), metal, None);
    place(&mut b, ball(0.6, 0.6, -0.2, 0.15), white, Some(Spectrum::rgb(1.0, 2.0, 4.0) * bright));
    b.emitter(Emitter::Point {
        position: to_world.transform_point3(DVec3::new(-0.5, -0.5, 0.5)).as_vec3(),
        intensity: Spectrum::rgb(0.5, 0.3, 0.2) * (bright as f64 * scale * scale) as f32,
    });
    // Looks along +y, a little down.
    let view = DAffine3::from_translation(DVec3::new(0.0, -0.95, 0.1)) * DAffine3::from_rotation_x(-1.7);
    b.camera(Camera::perspective(to_world * view, 75.0, SIZE).unwrap());
    b.max_depth(Some(5));
    built(b)
}
fn scaled(scale: f64) -> Scene {
    room(DAffine3::from_scale(DVec3::splat(scale)), 1.0)
}
/// Every method with few lights; also without a bound and with lights on the emitters.
const COMPOSED: &[(&str, &[&str])] = &[
    ("path", &["spp=2"]),
    ("instant-radiosity", &["paths=16"]),
    ("instant-radiosity", &["paths=16", "bound=none", "direct=virtual", "glossy-vpls=off"]),
    ("power-sampling", &["paths=64", "samples=8"]),
];
fn one(scene: &Scene, (method, params): (&str, &[&str])) -> Image {
    let r = recipe(method, params, scene);
    pass(scene, &*r.method, r.spp, 3, 1).0
}
fn lit(image: &Image) {
    let lit = image.pixels.iter().filter(|p| p.luminance() > 0.0).count();
    assert!(lit * 4 > image.pixels.len() * 3, "only {lit} pixels are lit: the comparison says nothing");
}

fn same(a: &Image, b: &[Spectrum], what: &str) {
    let off = a.pixels.iter().zip(b).filter(|(a, b)| a != b).count();
    assert_eq!(off, 0, "{what}: pixels that differ");
}

#[test]
fn a_scene_scaled_by_a_power_of_two_has_the_same_image_to_the_last_bit() {
    // Nothing knows how long a metre is: no epsilon, no bound. 2^-13 is 1.2e-4, 2^13 is 8192.
    for what in COMPOSED {
        let image = one(&scaled(1.0), *what);
        lit(&image);
        for power in [-13, -4, 5, 13] {
            same(&one(&scaled(2f64.powi(power)), *what), &image.pixels, &format!("2^{power}, {what:?}"));
        }
    }
}

#[test]
fn a_scene_scaled_by_ten_thousand_or_a_ten_thousandth_has_the_same_image_but_for_rounding() {
    // Rounding moves a sample across an edge, or a roulette past its number, now and then; everything else stays within 1e-3.
    for what in COMPOSED {
        let image = one(&scaled(1.0), *what);
        for scale in [1e-4, 1e4] {
            let other = one(&scaled(scale), *what);
            let off = |(a, b): (&Spectrum, &Spectrum)| (a.0 - b.0).abs().max_element() > 1e-3 * a.largest();
            let moved = image.pixels.iter().zip(&other.pixels).filter(|p| off(*p)).count();
            println!("{what:?} x {scale}: {moved} of {} pixels differ by more than 1e-3", image.pixels.len());
            assert!(moved * 50 <= image.pixels.len(), "{what:?} x {scale}: {moved} pixels");
        }
    }
}

#[test]
fn twice_the_light_is_twice_the_image() {
    for what in COMPOSED {
        let image = one(&room(DAffine3::IDENTITY, 1.0), *what);
        lit(&image);
        for power in [-20, 1, 20] {
            let c = 2f32.powi(power);
            let brighter = one(&room(DAffine3::IDENTITY, c), *what);
            let expected: Vec<Spectrum> = image.pixels.iter().map(|p| *p * c).collect();
            same(&brighter, &expected, &format!("2^{power}, {what:?}"));
        }
        // By a number that rounds.
        let brighter = one(&room(DAffine3::IDENTITY, 3.7), *what);
        for (a, b) in image.pixels.iter().zip(&brighter.pixels) {
            assert!((a.0 * 3.7 - b.0).abs().max_element() <= 2e-5 * b.largest(), "{what:?}: {a:?} {b:?}");
        }
    }
}

#[test]
fn a_scene_that_is_turned_and_moved_with_its_camera_has_the_same_block_means() {
    let turn = DAffine3::from_axis_angle(DVec3::new(0.6, -0.48, 0.64), 2.2);
    let moved = DAffine3::from_translation(DVec3::new(7.0, -30.0, 12.0)) * turn;
    let (here, there) = (room(DAffine3::IDENTITY, 1.0), room(moved, 1.0));
    for (method, params) in [("path", &["spp=4"][..]), ("instant-radiosity", &["paths=32", "bound=2"])] {
        let runs = |scene: &Scene, seed| {
            let r = recipe(method, params, scene);
            block_runs(scene, &*r.method, r.spp, seed, 96, 2).with_mean()
        };
        let there = runs(&there, 2);
        let verdict = BlockTest::default().run(&runs(&here, 1), Reference::Runs(&there)).unwrap();
        println!("{method}: {verdict}");
        assert!(verdict.passes(), "{method}: {verdict}");
    }
}

/// FNV-1a over the bits of an image.
fn hash(image: &Image) -> u64 {
    let bits = image.pixels.iter().flat_map(|p| p.to_array()).flat_map(|x| x.to_bits().to_le_bytes());
    bits.fold(0xcbf2_9ce4_8422_2325, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn one_hash_for_1_2_and_7_threads_by_every_method() {
    // More paths than a thread walks at a time, and more tiles than threads.
    let scene = room(DAffine3::IDENTITY, 1.0);
    let same = |name: &str, params: &[&str]| {
        let r = recipe(name, params, &scene);
        let with = |threads| {
            let settings = Settings { budget: Budget::Passes(2), seed: 9, spp: 1, threads: Some(threads) };
            let done = render(&scene, &*r.method, &settings, &mut |_: &Progress| (), &Arc::default()).unwrap();
            (hash(&done.image), done.probe.rays(), done.probe.lights, done.probe.evaluations)
        };
        let [one, two, seven] = [1, 2, 7].map(with);
        assert_eq!((one, one), (two, seven), "{name} {params:?}");
    };
    for m in methods() {
        // What of these a method has.
        let has = |pair: &&str| {
            let (name, value) = pair.split_once('=').unwrap();
            m.params().any(|p| p.name == name && p.kind.accepts(value))
        };
        for wanted in
            [&["paths=700", "lights=power"][..], &["paths=300", "lights=all", "direct=virtual", "nee=off", "mis=off"]]
        {
            same(m.name, &wanted.iter().copied().filter(has).collect::<Vec<_>>());
        }
    }
    for part in [
        "compensation=kollig-keller",
        "compensation=local",
        "compensation=screen-space",
        "lights=light-bvh",
        "lights=lightcuts",
        "lights=stochastic-lightcuts",
        "generator=rejection",
        "generator=metropolis",
        "generator=bidirectional",
        "kernel=sphere",
    ] {
        same("many-lights", &["paths=300", "bound=2", part]);
    }
}

#[test]
fn a_pass_alone_is_the_same_as_in_the_sequence() {
    let scene = room(DAffine3::IDENTITY, 1.0);
    for m in methods() {
        let r = recipe(m.name, &[], &scene);
        let sequence: Vec<Image> = (0..4).map(|p| pass(&scene, &*r.method, 1, 5, p).0).collect();
        // Made anew, out of order, on a film of its own.
        let r = recipe(m.name, &[], &scene);
        for p in [3usize, 0, 2] {
            let filter = FilterSampler::new(scene.filter());
            let mut film = Film::new(*scene.camera(), &filter, 5, p as u64, 1, &Sequential);
            r.method.pass(&scene, &mut film, &mut Probe::default()).unwrap();
            same(&film.image, &sequence[p].pixels, &format!("{}: pass {p}", m.name));
        }
        assert!((1..4).all(|p| sequence[p] != sequence[0]), "{}: passes repeat", m.name);
    }
}
