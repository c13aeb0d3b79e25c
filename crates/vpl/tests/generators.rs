//! Light walks, the two generators and their sum: lengths, fluxes, and what their lights bring.
//!
//! Significance is family-wise 0.01 by Holm where means are compared; seeds are fixed.

use manylight_bsdf::Distribution;
use manylight_framework::{Batch, Claim, GenerateError, Generator, Probe, Promise};
use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DVec3, Ray, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Camera, Emitter, Material, Mode, Model, Scatter, Scene, SceneBuilder, Shape, Source};
use manylight_stats::{BlockTest, Reference, Runs};
use manylight_vpl::{Emission, Emitters, Keller, Length, NoLights, Rejection, Sum, Vpl, connect_vertices, walk};

fn diffuse(rho: Spectrum) -> Model {
    Model::Diffuse { reflectance: Source::Constant(rho) }
}
fn metal(alpha: f32) -> Model {
    Model::RoughConductor {
        distribution: Distribution::Ggx,
        alpha_u: alpha,
        alpha_v: alpha,
        eta: Spectrum::rgb(0.2, 0.9, 1.1),
        k: Spectrum::rgb(3.9, 2.4, 2.2),
        reflectance: Source::Constant(Spectrum::ONE),
    }
}
fn add(b: &mut SceneBuilder, geometry: ShapeGeometry, model: Model, radiance: Option<Spectrum>) {
    let material = b.material(Material::one_sided("material", model));
    b.shape(Shape { name: "shape".into(), geometry, material, radiance: radiance.map(Source::Constant) });
}
fn built(mut b: SceneBuilder) -> Scene {
    b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (2, 2)).unwrap());
    b.build().unwrap()
}
/// A lantern of 1 W/sr in the inside of a ball.
fn room(model: Model) -> Scene {
    let mut b = Scene::builder();
    let inside = Sphere { flipped: true, ..Sphere::new(Vec3::ZERO, 1.0) };
    add(&mut b, ShapeGeometry::Sphere(inside), model, None);
    b.emitter(Emitter::Point { position: Vec3::X * 0.2, intensity: Spectrum::ONE });
    built(b)
}
fn keller(paths: u64) -> Keller {
    Keller { paths, max_edges: None, certain_edges: 1, emission: Emission::Full }
}
fn lights(g: &dyn Generator<Lights = Vec<Vpl>>, scene: &Scene, pass: u64) -> (Batch<Vec<Vpl>>, Probe) {
    let mut probe = Probe::default();
    (g.generate(scene, pass, 3, &mut probe).unwrap(), probe)
}

#[test]
fn a_walk_has_as_many_edges_as_allowed_and_no_more() {
    // White walls, no roulette: each path is as long as it may be.
    let scene = room(diffuse(Spectrum::ONE));
    for max_edges in 0..=12u32 {
        let (mut probe, mut seen) = (Probe::default(), vec![]);
        for path in 0..100 {
            let length = Length { max_edges, certain_edges: u32::MAX };
            walk(&scene, 1, 0, path, length, &mut probe, |step| seen.push(step.edges));
        }
        let expected: Vec<u32> = (0..100).flat_map(|_| 1..=max_edges).collect();
        assert_eq!(seen, expected);
        assert_eq!((probe.light_paths, probe.path_rays), (100, 100 * max_edges as u64));
    }
}

#[test]
fn a_path_to_the_eye_takes_two_edges_more_than_its_light_has() {
    let scene = room(diffuse(Spectrum::ONE));
    for (max_edges, longest) in [(1, 0), (2, 0), (3, 1), (4, 2), (9, 7)] {
        let g = Keller { max_edges: Some(max_edges), certain_edges: 99, ..keller(50) };
        let (batch, probe) = lights(&g, &scene, 0);
        assert_eq!(batch.lights.len() as u32, 50 * longest, "max_edges = {max_edges}");
        assert_eq!(batch.lights.iter().map(|l| l.edges).max().unwrap_or(0), longest);
        assert_eq!((batch.paths, batch.covers_direct, probe.light_paths), (50, false, 50));
        assert_eq!(probe.lights, batch.lights.len() as u64);
    }
}

#[test]
fn every_flux_is_valid_and_roulette_keeps_the_lights_of_a_path_equally_strong() {
    for model in [diffuse(Spectrum::rgb(0.9, 0.2, 0.0)), diffuse(Spectrum::gray(1.0)), metal(0.4), metal(1e-4)] {
        let scene = room(model);
        let (batch, probe) = lights(&keller(2000), &scene, 0);
        assert_eq!((batch.paths, probe.broken_paths), (2000, 0));
        // Each path leaves a light where it first meets the wall, whether or not it can go on from there.
        assert_eq!(batch.lights.iter().filter(|l| l.edges == 1).count(), 2000);
        let start = 4.0 * std::f32::consts::PI / 2000.0;
        for l in &batch.lights {
            assert!(l.flux.is_valid() && l.flux.luminance() > 0.0);
            // Up to the sixteenth edge no flux exceeds the first, and with roulette at every edge none falls below.
            let off = (l.flux.luminance() / start - 1.0).abs();
            assert!(l.edges > 16 || off < 1e-4, "{} after {} edges", l.flux.luminance() / start, l.edges);
        }
    }
}

#[test]
fn roulette_and_certainty_have_the_same_flux_at_each_edge() {
    let scene = room(diffuse(Spectrum::rgb(0.8, 0.4, 0.1)));
    let runs = |certain_edges: u32| {
        let g = Keller { certain_edges, max_edges: Some(7), ..keller(200) };
        let row = |pass| {
            let (batch, _) = lights(&g, &scene, pass + 1000 * certain_edges as u64);
            let mut flux = vec![0.0; 15];
            for l in &batch.lights {
                for (k, c) in l.flux.to_array().into_iter().enumerate() {
                    flux[3 * (l.edges as usize - 1) + k] += c as f64;
                }
            }
            flux
        };
        Runs::new((0..200).map(row).collect()).unwrap()
    };
    // Phi rho^(j - 1).
    let truth: Vec<f64> =
        (0..15).map(|i| 4.0 * std::f64::consts::PI * [0.8f64, 0.4, 0.1][i % 3].powi(i as i32 / 3)).collect();
    for certain_edges in [1, 2, 4, 99] {
        let test = BlockTest { rounding: 1e-5, ..BlockTest::default() };
        let verdict = test.run(&runs(certain_edges), Reference::Exact(&truth)).unwrap();
        println!("{certain_edges}: {verdict}");
        assert!(verdict.passes(), "{certain_edges}: {verdict}");
    }
}

#[test]
fn a_sum_has_the_lights_of_its_parts_in_their_order() {
    let scene = room(diffuse(Spectrum::gray(0.5)));
    let (a, b) = (lights(&keller(40), &scene, 2), lights(&Emitters { paths: 25 }, &scene, 2));
    let sum = Sum(vec![Box::new(keller(40)), Box::new(Emitters { paths: 25 }), Box::new(NoLights)]);
    let (batch, probe) = lights(&Sum(vec![Box::new(keller(40)), Box::new(Emitters { paths: 25 })]), &scene, 2);
    let places = |l: &[Vpl]| l.iter().map(|l| (l.vertex.p, l.flux, l.edges)).collect::<Vec<_>>();
    assert_eq!(places(&batch.lights), [places(&a.0.lights), places(&b.0.lights)].concat());
    assert_eq!((batch.paths, batch.covers_direct), (25, true), "a bound goes by the coarsest part");
    assert_eq!(probe.lights, a.1.lights + b.1.lights);
    assert_eq!((probe.light_paths, probe.path_rays), (65, a.1.path_rays));
    assert!(!lights(&Sum(vec![Box::new(keller(4))]), &scene, 0).0.covers_direct);
    assert!(sum.claim().is_unbiased());
    // What one part cannot make, nor can the sum.
    struct Fails;
    impl Promise for Fails {
        fn claim(&self) -> Claim {
            Claim::DARKENS
        }
    }
    impl Generator for Fails {
        type Lights = Vec<Vpl>;
        fn generate(&self, _: &Scene, _: u64, _: u64, _: &mut Probe) -> Result<Batch<Vec<Vpl>>, GenerateError> {
            Err(GenerateError::NoEmitters)
        }
    }
    let sum = Sum(vec![Box::new(keller(4)), Box::new(Fails)]);
    assert!(sum.generate(&scene, 0, 0, &mut Probe::default()).is_err() && !sum.claim().is_unbiased());
}

#[test]
fn a_light_emits_what_its_albedo_says_whether_it_keeps_its_lobe_or_not() {
    // The flux that leaves a light is its flux times the albedo of its surface. Over the hemisphere, by 40,000 directions.
    for model in [metal(0.3), metal(0.8), diffuse(Spectrum::rgb(0.7, 0.3, 0.0))] {
        let scene = room(model);
        let full = lights(&Keller { max_edges: Some(4), certain_edges: 9, ..keller(12) }, &scene, 0).0.lights;
        let g = Keller { max_edges: Some(4), certain_edges: 9, emission: Emission::Diffuse, ..keller(12) };
        let flat = lights(&g, &scene, 0).0.lights;
        assert_eq!(full.len(), flat.len());
        for (a, b) in full.iter().zip(&flat) {
            assert_eq!((a.vertex.p, a.flux, a.edges), (b.vertex.p, b.flux, b.edges));
            let Scatter::Surface(x) = a.vertex.scatter else { panic!("no surface") };
            let albedo = x.bsdf.albedo(x.frame.to_local(x.wi));
            let mut s = Stream::new(1, [0; 3], Purpose::TEST);
            let n = 200;
            let mut sums = [Spectrum::BLACK; 2];
            for i in 0..n * n {
                let at = manylight_math::Vec2::new((i / n) as f32 + s.next_f32(), (i % n) as f32 + s.next_f32());
                let w = x.frame.to_world(warp::cosine_hemisphere(at / n as f32));
                let pdf = x.frame.n.dot(w) / std::f32::consts::PI;
                for (sum, l) in sums.iter_mut().zip([a, b]) {
                    *sum += l.vertex.eval(w) * (1.0 / (pdf * (n * n) as f32));
                }
            }
            for sum in sums {
                let off = (sum.0 - albedo.0).abs().max_element();
                assert!(off < 0.03, "{sum:?} leaves, the albedo is {albedo:?}");
            }
        }
    }
}

#[test]
fn lights_on_the_emitters_bring_the_direct_light() {
    // E[sum of contributions] at a point, against quadrature over the square; a glossy and a diffuse receiver.
    let lamp =
        DAffine3::from_translation(DVec3::new(0.3, -0.2, 1.0)) * DAffine3::from_rotation_x(std::f64::consts::PI * 0.9);
    for model in [diffuse(Spectrum::rgb(0.8, 0.5, 0.0)), metal(0.3)] {
        let mut b = Scene::builder();
        add(
            &mut b,
            ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(4.0)))),
            model,
            None,
        );
        let radiance = Spectrum::rgb(2.0, 1.0, 3.0);
        add(&mut b, ShapeGeometry::Mesh(TriangleMesh::rectangle(&lamp)), diffuse(Spectrum::BLACK), Some(radiance));
        let scene = built(b);
        // Seen from below the lamp, at an angle.
        let eye = Vec3::new(-0.5, 0.4, 0.3);
        let x = scene.intersect(&Ray::new(eye, -eye.normalize()), Mode::Radiance).unwrap();
        let n = 400;
        let normal = lamp.transform_vector3(DVec3::Z).as_vec3();
        let mut truth = [0.0f64; 3];
        for i in 0..n * n {
            let at = |k: usize| (k as f64 + 0.5) / n as f64 * 2.0 - 1.0;
            let y = lamp.transform_point3(DVec3::new(at(i / n), at(i % n), 0.0)).as_vec3();
            let (d, w) = (y - x.p, (y - x.p).normalize());
            let cosine = normal.dot(-w).max(0.0);
            let c = x.eval(w) * radiance * (cosine / d.length_squared() * 4.0 / (n * n) as f32);
            truth.iter_mut().zip(c.to_array()).for_each(|(t, c)| *t += c as f64);
        }
        let row = |pass| {
            let batch = lights(&Emitters { paths: 32 }, &scene, pass).0;
            assert!(batch.covers_direct && batch.lights.len() == 32 && batch.lights.iter().all(|l| l.edges == 0));
            let all = batch.lights.iter().filter_map(|l| connect_vertices(&x, &l.vertex, l.flux));
            let mut s = Stream::new(0, [pass, 0, 0], Purpose::TEST);
            let sum = all.fold(Spectrum::BLACK, |sum, c| sum + c.value * scene.transmittance(&c.edge, &mut s));
            sum.to_array().map(f64::from).to_vec()
        };
        let verdict = BlockTest::default()
            .run(&Runs::new((0..2000).map(row).collect()).unwrap(), Reference::Exact(&truth))
            .unwrap();
        println!("{verdict}");
        assert!(verdict.passes(), "{verdict}");
    }
}

#[test]
fn paths_draw_from_places_of_their_own_whatever_the_threads_and_how_many_there_are() {
    // The first of 600 paths are the paths of a run of 300, but for the flux, which is shared by all.
    let scene = room(diffuse(Spectrum::gray(0.5)));
    let (few, many) = (lights(&keller(300), &scene, 0).0.lights, lights(&keller(600), &scene, 0).0.lights);
    for (a, b) in few.iter().zip(&many) {
        assert_eq!((a.vertex.p, a.edges), (b.vertex.p, b.edges));
        assert!((a.flux.luminance() / b.flux.luminance() - 2.0).abs() < 1e-5);
    }
    let other = lights(&keller(300), &scene, 1).0.lights;
    assert_ne!(few[0].vertex.p, other[0].vertex.p);
}

#[test]
fn points_too_near_for_their_distance_squared_are_not_connected() {
    let scene = room(diffuse(Spectrum::gray(0.5)));
    let x = scene.intersect(&Ray::new(Vec3::ZERO, Vec3::Z), Mode::Radiance).unwrap();
    let at = |p: Vec3| manylight_scene::Vertex { p, ..x };
    // A whole watt times a million, over distances whose square is a denormal, tiny, or fits.
    for (distance, connects) in [(0.0f32, false), (1e-22, false), (1e-18, false), (1e-12, true), (1e-6, true)] {
        let x = at(Vec3::ZERO);
        let y = at(Vec3::new(0.6, 0.0, -0.8) * distance);
        let from_above =
            manylight_scene::Vertex { p: y.p, scatter: Scatter::Emitter(manylight_scene::EmitterPoint::Isotropic) };
        let c = connect_vertices(&x, &from_above, Spectrum::gray(1e6));
        assert_eq!(c.is_some(), connects, "at {distance} m: {c:?}");
        assert!(c.is_none_or(|c| c.value.is_valid()));
    }
}

#[test]
fn rejection_keeps_candidates_as_they_are_but_for_their_flux() {
    let scene = room(diffuse(Spectrum::gray(0.5)));
    let (all, _) = lights(&keller(400), &scene, 0);
    let with = |floor| Rejection { walks: keller(400), points: 16, rays: 4, selectivity: 4.0, floor, sharp: 0.0 };
    // A floor of one keeps everything: bit for bit what Keller's generator makes.
    let (kept, _) = lights(&with(1.0), &scene, 0);
    assert_eq!(format!("{:?}", kept.lights), format!("{:?}", all.lights));
    let (kept, probe) = lights(&with(0.1), &scene, 0);
    let rate = kept.lights.len() as f64 / all.lights.len() as f64;
    assert!(rate < 0.7 && (probe.mean("acceptance").unwrap() - rate).abs() < 1e-6, "{rate}");
    assert_eq!((kept.paths, probe.light_paths, probe.lights), (400, 400, kept.lights.len() as u64));
    for light in &kept.lights {
        // Divided by a probability between the floor and one.
        let was = all.lights.iter().find(|l| l.vertex.p == light.vertex.p && l.edges == light.edges).unwrap();
        let p = was.flux.luminance() / light.flux.luminance();
        assert!((0.0999..=1.0001).contains(&p), "{p}");
    }
    // Without a floor it says that it is biased.
    assert!(with(0.1).claim().is_unbiased() && !with(0.0).claim().is_unbiased());
}
