//! Generators that put lights where they are needed bring the light that they should: against the bounded path tracer, against
//! Keller's generator pass by pass, in a closed room whose radiance is known, and where there is nothing to be seen.
//!
//! Family-wise significance 0.01 by Holm within each verdict; seeds are fixed. What is printed says what would have been seen.

use manylight_compensation::{Bound, BoundPlan};
use manylight_framework::{Batch, Claim, Compensation, GenerateError, Generator, Method, Probe, Promise};
use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_integration::bounded_path::BoundedPath;
use manylight_integration::rooms::{
    built, camera, diffuse, disc_light, furnace, hollow_ball, hollow_cube, place, plane_under,
};
use manylight_integration::{block_runs, effort, our_scene, pass, recipe};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
use manylight_metropolis_ir::{Metropolis, Start};
use manylight_scene::{Emitter, Scene};
use manylight_stats::{BlockTest, Reference, Runs, Verdict};
use manylight_vpl::{Emission, Keller, Points, Rejection, Vpl};

/// Indirect light alone, with a bound that makes its variance finite.
fn indirect(generator: Box<dyn Generator<Lights = Vec<Vpl>>>, bound: f32, max_edges: u32) -> impl Method {
    let (bounding, compensation) = (BoundPlan::fixed(bound), Compensation::None);
    ManyLights { generator, plan: All, kernel: Points, bounding, compensation, max_edges, min_edges: 3, sharp: 0.0 }
}
fn keller(paths: u64) -> Keller {
    Keller { paths, max_edges: Some(12), certain_edges: 1, emission: Emission::Full }
}
fn rejection(paths: u64) -> Rejection {
    Rejection { walks: keller(paths), points: 64, rays: 8, selectivity: 4.0, floor: 0.05, sharp: 0.0 }
}
fn verdict(a: &Runs, reference: Reference) -> Verdict {
    BlockTest::default().run(a, reference).unwrap()
}

/// Scene, size, bound [1/m^2], light paths, passes, blocks a side.
type Case = (&'static str, (u32, u32), f32, u64, u64, usize);
const SCENES: &[Case] = &[
    ("cornell-box", (16, 16), 4.0, 512, 64, 2),
    ("corner", (16, 16), 4.0, 256, 64, 2),
    ("ajar", (16, 10), 1.0, 1024, 96, 1),
];
/// Methods with what they are given besides.
const METHODS: &[(&str, &[&str])] = &[
    ("rejection", &["importons=64", "importance-rays=8", "selectivity=4"]),
    ("bidirectional-ir", &["importons=256", "importance-rays=16", "reverse=256", "eyes=16", "resampled=256"]),
    ("metropolis-ir", &["importons=64", "importance-rays=8", "bootstrap=256", "chains=16", "tries=2"]),
];

#[test]
fn they_bring_what_the_bounded_path_tracer_brings() {
    for &(name, size, bound, paths, passes, grid) in SCENES {
        let scene = our_scene(name, size);
        let max_edges = scene.max_depth().unwrap_or(u32::MAX);
        let path = BoundedPath { bounding: Bound::Geometry(bound), max_edges };
        let truth = block_runs(&scene, &path, 128, 12, effort(64), grid).with_mean();
        for (method, own) in METHODS {
            let base = [format!("bound={bound}"), format!("paths={paths}"), "min-depth=3".into()];
            let all: Vec<&str> = base.iter().map(String::as_str).chain(own.iter().copied()).collect();
            let r = recipe(method, &all, &scene);
            let runs = block_runs(&scene, &*r.method, r.spp, 17, effort(passes), grid).with_mean();
            let v = verdict(&runs, Reference::Runs(&truth));
            println!("{name}, {method}: {v}");
            assert!(v.passes(), "{name}, {method}: {v}");
        }
    }
}

/// Block means of one method minus those of another, pass by pass: same seeds, and so the same camera rays.
fn differences(scene: &Scene, a: &dyn Method, b: &dyn Method, passes: u64) -> Runs {
    let [a, b] = [a, b].map(|m| block_runs(scene, m, 1, 23, passes, 1).rows().to_vec());
    Runs::new(a.iter().zip(&b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect()).collect()).unwrap()
}

#[test]
fn what_is_rejected_is_made_up_for_by_what_is_kept() {
    // Against the very candidates: only the noise of keeping is left.
    let scene = our_scene("ajar", (16, 10));
    let honest = rejection(512);
    let blind = Rejection { points: 4, rays: 1, floor: 0.0, ..honest };
    let against = |r: Rejection| {
        let (a, b) = (indirect(Box::new(r), 1.0, 12), indirect(Box::new(keller(512)), 1.0, 12));
        verdict(&differences(&scene, &a, &b, effort(128)), Reference::Exact(&[0.0; 3]))
    };
    let v = against(honest);
    println!("rejection minus its candidates: {v}");
    assert!(v.passes(), "{v}");
    // The liar: lights that no point saw are lost.
    let v = against(blind);
    assert!(v.rejected(), "without a floor: {v}");
}

#[test]
fn chains_need_their_starting_weight_and_their_normalisation() {
    let scene = our_scene("ajar", (16, 10));
    let truth =
        block_runs(&scene, &BoundedPath { bounding: Bound::Geometry(1.0), max_edges: 12 }, 128, 12, effort(64), 1);
    // Chains of four steps: they hardly leave where they started.
    let own =
        Metropolis { chains: 64, bootstrap: 256, points: 64, rays: 8, large: 0.2, ..Metropolis::new(keller(256)) };
    let against = |g: Box<dyn Generator<Lights = Vec<Vpl>>>| {
        verdict(&block_runs(&scene, &indirect(g, 1.0, 12), 1, 29, effort(96), 1), Reference::Runs(&truth))
    };
    let v = against(Box::new(own));
    println!("chains of four steps: {v}");
    assert!(v.passes(), "{v}");
    let v = against(Box::new(Metropolis { start: Start::Uniform, ..own }));
    assert!(v.rejected(), "chains that start anywhere: {v}");
    let v = against(Box::new(Unnormalised(own)));
    assert!(v.rejected(), "over the lights instead of the steps: {v}");
}

/// The liar that divides by the lights, of which a chain that stands still leaves one, instead of the steps.
struct Unnormalised(Metropolis);
impl Promise for Unnormalised {
    fn claim(&self) -> Claim {
        self.0.claim()
    }
}
impl Generator for Unnormalised {
    type Lights = Vec<Vpl>;
    fn generate(&self, s: &Scene, pass: u64, seed: u64, p: &mut Probe) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let mut batch = self.0.generate(s, pass, seed, p)?;
        let wrong = batch.paths as f32 / batch.lights.len() as f32;
        batch.lights.iter_mut().for_each(|l| l.flux *= wrong);
        Ok(batch)
    }
}

#[test]
fn in_a_closed_room_radiance_is_what_it_should_be() {
    let scene = furnace(hollow_ball(1.0), 1.0, Spectrum::gray(0.5), Spectrum::ONE, (8, 8));
    for (method, own) in METHODS {
        let all: Vec<&str> = ["bound=none", "paths=64"].into_iter().chain(own.iter().copied()).collect();
        let r = recipe(method, &all, &scene);
        let v = verdict(&block_runs(&scene, &*r.method, r.spp, 3, 64, 1), Reference::Exact(&[2.0; 3]));
        println!("furnace, {method}: {v}");
        assert!(v.passes(), "{method}: {v}");
    }
}

/// A floor and a ceiling; what lies above the ceiling is seen by nobody below it.
fn storeys(lamps: &[(Vec3, f32)], looks_at: DVec3) -> Scene {
    let mut b = Scene::builder();
    let white = diffuse(&mut b, Spectrum::gray(0.5));
    place(&mut b, hollow_cube(2.0), white, None);
    let ceiling = TriangleMesh::cube(&DAffine3::from_scale_rotation_translation(
        DVec3::new(1.999, 1.999, 0.05),
        Default::default(),
        DVec3::new(0.0, 0.0, 0.5),
    ));
    place(&mut b, ShapeGeometry::Mesh(ceiling), white, None);
    for &(position, intensity) in lamps {
        b.emitter(Emitter::Point { position, intensity: Spectrum::gray(intensity) });
    }
    b.camera(camera(DVec3::new(0.3, 0.2, -0.9), looks_at, 60.0, (8, 8)));
    built(b)
}

#[test]
fn hard_cases_are_black_or_right() {
    let below = DVec3::new(0.0, 0.0, -2.0);
    for (method, own) in METHODS {
        let of = |scene: &Scene, more: &[&str]| {
            let all: Vec<&str> = ["bound=1", "paths=256", "min-depth=3"]
                .into_iter()
                .chain(own.iter().copied())
                .chain(more.iter().copied())
                .collect();
            recipe(method, &all, scene)
        };
        // The lamp is on the other storey (through a crack a millimetre wide some light may come): no importon sees any light.
        let dark = storeys(&[(Vec3::new(0.0, 0.0, 1.2), 1.0)], below);
        let (image, probe) = pass(&dark, &*of(&dark, &[]).method, 1, 1, 0);
        assert!(image.pixels.iter().all(|p| p.is_valid() && p.largest() < 1e-2), "{method}");
        assert!(probe.light_paths >= 256, "{method}");
        // The camera looks into the void: nothing to weigh lights by.
        let void = plane_under(disc_light, (4, 4));
        let mut outside = Scene::builder();
        let grey = diffuse(&mut outside, Spectrum::gray(0.5));
        place(&mut outside, ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::IDENTITY)), grey, None);
        disc_light(&mut outside);
        outside.camera(camera(DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.0, 0.0, 9.0), 40.0, (4, 4)));
        let outside = built(outside);
        for scene in [&void, &outside] {
            let (image, _) = pass(scene, &*of(scene, &[]).method, 1, 1, 0);
            assert!(image.pixels.iter().all(|p| p.is_valid()), "{method}");
        }
        assert!(pass(&outside, &*of(&outside, &[]).method, 1, 1, 0).0.pixels.iter().all(|p| p.is_black()), "{method}");
        // One lamp of 17 lights what is seen; the others are fifty times as bright, and on the other storey.
        let mut lamps: Vec<_> = (0..16).map(|i| (Vec3::new(-1.5 + 0.2 * i as f32, 0.3, 1.2), 3.0)).collect();
        lamps.push((Vec3::new(0.5, -0.3, -0.4), 1.0));
        let scene = storeys(&lamps, below);
        let path = BoundedPath { bounding: Bound::Geometry(1.0), max_edges: u32::MAX };
        let truth = block_runs(&scene, &path, 64, 12, effort(32), 1);
        let r = of(&scene, &[]);
        let v = verdict(&block_runs(&scene, &*r.method, r.spp, 19, effort(64), 1), Reference::Runs(&truth));
        println!("one lamp among seventeen, {method}: {v}");
        assert!(v.passes(), "{method}: {v}");
    }
}

#[test]
fn a_pass_of_lights_does_not_depend_on_threads() {
    let scene = our_scene("ajar", (16, 9));
    for (method, own) in METHODS {
        let r = recipe(method, &own.iter().copied().chain(["paths=300"]).collect::<Vec<_>>(), &scene);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| pass(&scene, &*r.method, 1, 4, 2).0)
        };
        assert!(on(1) == on(3), "{method}");
    }
}
