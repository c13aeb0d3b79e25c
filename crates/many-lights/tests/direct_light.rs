//! Direct light at a point, against quadrature, and by either of its two strategies alone.
//!
//! Significance is family-wise 0.01 by Holm within each test; seeds are fixed.

use manylight_bsdf::Distribution;
use manylight_framework::Probe;
use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_many_lights::direct_light;
use manylight_math::{DAffine3, DVec3, Ray, Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Camera, Emitter, Material, Mode, Model, Scene, SceneBuilder, Shape, Source, Vertex};
use manylight_stats::{BlockTest, Reference, Runs};

fn diffuse(rho: f32) -> Model {
    Model::Diffuse { reflectance: Source::Constant(Spectrum::rgb(rho, 0.5 * rho, 0.0)) }
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
fn add(b: &mut SceneBuilder, to_world: DAffine3, model: Model, radiance: Option<Spectrum>) {
    let material = b.material(Material::one_sided("material", model));
    let geometry = ShapeGeometry::Mesh(TriangleMesh::rectangle(&to_world));
    b.shape(Shape { name: "shape".into(), geometry, material, radiance: radiance.map(Source::Constant) });
}
const RADIANCE: Spectrum = Spectrum::rgb(2.0, 1.0, 3.0);
/// A square lamp above a floor, a little tilted.
fn lamp() -> DAffine3 {
    DAffine3::from_translation(DVec3::new(0.3, -0.2, 1.0)) * DAffine3::from_rotation_x(std::f64::consts::PI * 0.9)
}
fn scene(floor: Model, add_light: impl FnOnce(&mut SceneBuilder)) -> (Scene, Vertex) {
    let mut b = Scene::builder();
    add(&mut b, DAffine3::from_scale(DVec3::splat(4.0)), floor, None);
    add_light(&mut b);
    b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (2, 2)).unwrap());
    let scene = b.build().unwrap();
    // The floor's middle, seen at an angle from below the lamp.
    let eye = Vec3::new(-0.5, 0.4, 0.3);
    let x = scene.intersect(&Ray::new(eye, -eye.normalize()), Mode::Radiance).unwrap();
    (scene, x)
}
/// Means of 100 samples each, so that they are near Gaussian.
fn runs(n: u64, sample: impl Fn(&mut Stream) -> Spectrum) -> Runs {
    let row = |i| {
        let mut sum = [0.0f64; 3];
        for j in 0..100 {
            let c = sample(&mut Stream::new(3, [i, j, 0], Purpose::TEST)).to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 / 100.0);
        }
        sum.to_vec()
    };
    Runs::new((0..n).map(row).collect()).unwrap()
}
fn is(what: &str, runs: &Runs, truth: &[f64; 3]) {
    let verdict = BlockTest { rounding: 1e-5, ..BlockTest::default() }.run(runs, Reference::Exact(truth)).unwrap();
    println!("{what}: {verdict}");
    assert!(verdict.passes(), "{what}: {verdict}");
}

#[test]
fn it_is_what_quadrature_says_and_so_is_either_strategy_alone() {
    for (name, floor) in [("diffuse", diffuse(0.8)), ("rough", metal(0.4)), ("glossy", metal(0.1))] {
        let (scene, x) = scene(floor, |b| add(b, lamp(), diffuse(0.0), Some(RADIANCE)));
        let n = 1000;
        let mut truth = [0.0f64; 3];
        let normal = lamp().transform_vector3(DVec3::Z).as_vec3();
        for i in 0..n * n {
            let at = |k: usize| (k as f64 + 0.5) / n as f64 * 2.0 - 1.0;
            let y = lamp().transform_point3(DVec3::new(at(i / n), at(i % n), 0.0)).as_vec3();
            let w = (y - x.p).normalize();
            let g = normal.dot(-w).max(0.0) / (y - x.p).length_squared();
            let c = x.eval(w) * RADIANCE * g;
            (0..3).for_each(|k| truth[k] += c.to_array()[k] as f64 * 4.0 / (n * n) as f64);
        }
        let both = runs(400, |s| direct_light(&scene, &x, &mut Probe::default(), s));
        is(&format!("{name}, both"), &both, &truth);
        // Each strategy alone, without a weight, written down here once more.
        let by_lamp = runs(400, |s| {
            let y = scene.sample_emitter(s).unwrap();
            let w = (y.vertex.p - x.p).normalize();
            let emitted = RADIANCE * (y.vertex.cosine(-w) / (y.vertex.p - x.p).length_squared());
            x.eval(w) * emitted * (1.0 / y.density.unwrap())
        });
        is(&format!("{name}, lamp"), &by_lamp, &truth);
        let by_chance = runs(400, |s| {
            let Some(next) = x.sample(s.next_f32(), s.next_2d()) else { return Spectrum::BLACK };
            let hit = scene.intersect(&x.leave(next.dir), Mode::Radiance);
            hit.map_or(Spectrum::BLACK, |y| next.weight * y.emitted())
        });
        is(&format!("{name}, chance"), &by_chance, &truth);
        // Together they are never much noisier than the better one, and for a polished floor far better than the lamp's.
        let noise = |r: &Runs| r.moments(0).std_error();
        let better = noise(&by_lamp).min(noise(&by_chance));
        println!("{name}: {} by the lamp, {} by chance, {} together", noise(&by_lamp), noise(&by_chance), noise(&both));
        assert!(noise(&both) < 1.2 * better);
    }
}

#[test]
fn under_the_sky_it_is_the_albedo() {
    // A constant environment: the directional albedo times the radiance, by quadrature over the hemisphere.
    for (name, floor) in [("diffuse", diffuse(0.8)), ("rough", metal(0.4))] {
        let (scene, x) = scene(floor, |b| b.emitter(Emitter::Constant { radiance: RADIANCE }));
        let n = 1000;
        let mut truth = [0.0f64; 3];
        for i in 0..n * n {
            let u = Vec2::new((i / n) as f32 + 0.5, (i % n) as f32 + 0.5) / n as f32;
            let w = warp::cosine_hemisphere(u);
            let c = x.lobe_at(w) * RADIANCE * (std::f32::consts::PI / (n * n) as f32);
            (0..3).for_each(|k| truth[k] += c.to_array()[k] as f64);
        }
        is(name, &runs(400, |s| direct_light(&scene, &x, &mut Probe::default(), s)), &truth);
    }
}

#[test]
fn points_and_parallel_light_come_whole_and_without_noise() {
    let (scene, x) = scene(diffuse(1.0), |b| {
        b.emitter(Emitter::Point { position: Vec3::Z * 2.0, intensity: Spectrum::gray(4.0) });
    });
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    for _ in 0..100 {
        let mut probe = Probe::default();
        let c = direct_light(&scene, &x, &mut probe, &mut s).0 * std::f32::consts::PI;
        assert!((c - Vec3::new(1.0, 0.5, 0.0)).abs().max_element() < 1e-5, "{c}");
        assert_eq!(probe.shadow_rays, 1);
    }
    let (scene, x) = self::scene(diffuse(1.0), |b| {
        let direction = Vec3::new(0.6, 0.0, -0.8);
        b.emitter(Emitter::Directional { direction, irradiance: Spectrum::ONE });
    });
    for _ in 0..100 {
        let c = direct_light(&scene, &x, &mut Probe::default(), &mut s).0 * std::f32::consts::PI;
        assert!((c - Vec3::new(0.8, 0.4, 0.0)).abs().max_element() < 1e-5, "{c}");
    }
}

#[test]
fn what_stands_between_takes_it() {
    let (scene, x) = scene(diffuse(0.8), |b| {
        add(b, lamp(), diffuse(0.0), Some(RADIANCE));
        add(
            b,
            DAffine3::from_translation(DVec3::Z * 0.6) * DAffine3::from_scale(DVec3::splat(2.0)),
            diffuse(0.0),
            None,
        );
        // From behind, and from below the floor.
        b.emitter(Emitter::Point { position: Vec3::NEG_Z, intensity: Spectrum::ONE });
    });
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    for _ in 0..2000 {
        assert!(direct_light(&scene, &x, &mut Probe::default(), &mut s).is_black());
    }
}
