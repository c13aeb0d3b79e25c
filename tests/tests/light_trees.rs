//! Light sets over a tree: every set, kind of light and BSDF at one receiver against the sum over all lights, and whole images
//! against the path tracer. Family-wise significance 0.01 by Holm; what is printed says what would have been seen.

use manylight_bsdf::*;
use manylight_compensation::Bound;
use manylight_framework::{Contribute, Gather, LightSet, Occlusion, Picks, Plan, Probe};
use manylight_geometry::{ShapeGeometry, Sphere, Surface};
use manylight_integration::{block_runs, effort, load_scene, recipe, rooms};
use manylight_light_list::All;
use manylight_light_tree::{Build, CutBy, Growth, LightBvh, Lightcuts, Standing, StochasticLightcuts};
use manylight_math::{Aabb, DVec3, Frame, MediumId, Spectrum, Vec2, Vec3};
use manylight_media::HenyeyGreenstein;
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Edge, EmitterPoint, MediumPoint, Mode, Scatter, Scene, SurfacePoint, Vertex};
use manylight_stats::{BlockTest, Reference, Runs, chi2_goodness_of_fit};
use manylight_vpl::{Points, Vpl};

fn stream(seed: u64) -> Stream {
    Stream::new(seed, [0; 3], Purpose::TEST)
}
fn at(bsdf: Bsdf, p: Vec3, n: Vec3, wi: Vec3, mode: Mode) -> Vertex {
    let x = Surface { p, error: 1e-6, ng: n, ns: n, uv: Vec2::ZERO, dpdu: Frame::around(n).s };
    Vertex { p, scatter: Scatter::Surface(SurfacePoint::new(&x, Frame::around(n), wi, bsdf, mode)) }
}
fn bsdfs() -> Vec<(&'static str, Bsdf)> {
    let red = Spectrum::rgb(0.9, 0.3, 0.1);
    let coat = RoughTransmittance::of(Distribution::Ggx, 0.3, 1.5);
    let metal = |alpha| RoughConductor::new(Distribution::Ggx, alpha, alpha, red, Spectrum::gray(3.0), Spectrum::ONE);
    vec![
        ("diffuse", Diffuse::new(red).into()),
        ("plastic", Plastic::new(1.5, 1.0, red, Spectrum::ONE, false).into()),
        ("rough plastic", RoughPlastic::new(coat, red, Spectrum::ONE, false).into()),
        ("rough metal", metal(0.3).into()),
        ("smoother metal", metal(0.12).into()),
    ]
}
const KINDS: [&str; 7] = ["diffuse", "glossy", "medium", "lambert", "isotropic", "distant", "all"];
/// Sixty lights in the upper half of a room, most of which face the middle.
fn lights(kind: &str) -> Vec<Vpl> {
    let mut s = stream(21);
    (0..60)
        .map(|i| {
            let p = Vec3::new(2.0 * s.next_f32() - 1.0, 2.0 * s.next_f32() - 1.0, 0.2 + s.next_f32());
            let n = (-p + warp::sphere(s.next_2d()) * 1.2).normalize();
            let wi = Frame::around(n).to_world(warp::cosine_hemisphere(s.next_2d())).normalize();
            let glossy = bsdfs()[2 + i % 3].1;
            let diffuse = Diffuse::new(Spectrum::rgb(0.2, 0.5, 0.8)).into();
            let emitter = |point| Vertex { p, scatter: Scatter::Emitter(point) };
            let kind = if kind == "all" { KINDS[i % 6] } else { kind };
            let vertex = match kind {
                "diffuse" => at(diffuse, p, n, wi, Mode::Importance),
                "glossy" => at(glossy, p, n, wi, Mode::Importance),
                "medium" => {
                    let phase = HenyeyGreenstein::new(0.4).unwrap();
                    let point = MediumPoint { wi, scattering: Spectrum::ONE, phase, medium: MediumId::new(0) };
                    Vertex { p, scatter: Scatter::Medium(point) }
                }
                "lambert" => emitter(EmitterPoint::Lambert { n, error: 1e-6 }),
                "isotropic" => emitter(EmitterPoint::Isotropic),
                _ => emitter(EmitterPoint::Distant { towards: -n, disc: 3.0 }),
            };
            let strength = 10f32.powf(2.0 * s.next_f32() - 1.0);
            Vpl { vertex, flux: Spectrum::rgb(1.0, s.next_f32(), 0.3) * strength, edges: (i % 3) as u32 }
        })
        .collect()
}
/// A ball that hides some of the lights.
fn scene() -> Scene {
    let mut b = Scene::builder();
    let material = rooms::diffuse(&mut b, Spectrum::gray(0.5));
    rooms::place(&mut b, ShapeGeometry::Sphere(Sphere::new(Vec3::new(0.3, 0.1, 0.25), 0.12)), material, None);
    b.camera(rooms::camera(DVec3::X, DVec3::ZERO, 40.0, (4, 4)));
    rooms::built(b)
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
fn receiver(bsdf: Bsdf) -> Vertex {
    at(bsdf, Vec3::ZERO, Vec3::Z, Vec3::new(0.48, 0.0, 0.877).normalize(), Mode::Radiance)
}
fn gather<'a>(
    scene: &'a Scene,
    x: &'a Vertex,
    bounding: &'a Bound,
    probe: &'a mut Probe,
) -> Gather<'a, Vertex, Points, Bound> {
    Gather { scene, receiver: x, kernel: &Points, bounding, edges_left: u32::MAX, edges_least: 0, probe }
}
/// A set's estimates at a receiver, in three channels: each run builds the set anew, and is the mean of so many estimates.
fn runs<P: Plan<Vec<Vpl>>>(
    plan: &P,
    lights: &[Vpl],
    x: &Vertex,
    bound: Bound,
    (count, each): (u64, u32),
) -> Vec<Vec<f64>>
where
    P::Set: for<'g> LightSet<Gather<'g, Vertex, Points, Bound>>,
{
    let scene = scene();
    let run = |i| {
        let mut s = Stream::new(3, [i, 0, 0], Purpose::TEST);
        let set = plan.build(lights.to_vec(), &Clear, &mut s).unwrap();
        let mut probe = Probe::default();
        let mut sum = [0.0f64; 3];
        for _ in 0..each {
            let c = set.radiance(&mut gather(&scene, x, &bound, &mut probe), &mut s).to_array();
            (0..3).for_each(|k| sum[k] += c[k] as f64 / each as f64);
        }
        sum.to_vec()
    };
    (0..count).map(run).collect()
}

#[test]
fn every_set_agrees_with_all_lights_for_every_kind_of_light_and_bsdf() {
    let slc = |size| StochasticLightcuts { size, ..StochasticLightcuts::default() };
    let greedy = Growth { build: Build::Greedy, ..Growth::default() };
    for kind in KINDS {
        let lights = lights(kind);
        for (name, bsdf) in bsdfs() {
            for bound in [Bound::None, Bound::Geometry(1.0)] {
                let x = receiver(bsdf);
                let truth = runs(&All, &lights, &x, bound, (1, 1)).remove(0);
                let exact = |what: &str, estimates: Vec<Vec<f64>>| {
                    for (e, t) in estimates.iter().flatten().zip(truth.iter().cycle()) {
                        assert!((e - t).abs() <= 2e-6 * t, "{kind} {name}, {what}: {e}, expected {t}");
                    }
                };
                let mean = |what: &str, estimates: Vec<Vec<f64>>| {
                    let verdict =
                        BlockTest::default().run(&Runs::new(estimates).unwrap(), Reference::Exact(&truth)).unwrap();
                    assert!(verdict.passes(), "{kind} {name}, {what}: {verdict}");
                };
                // A narrow lobe makes few draws large: their mean has to be taken over more.
                let count = (effort(64), if name == "smoother metal" { 600 } else { 40 });
                let every = Lightcuts { error: 0.0, most: u32::MAX, ..Lightcuts::default() };
                exact("lightcuts down to the leaves", runs(&every, &lights, &x, bound, (2, 1)));
                exact("a cut of all leaves", runs(&slc(60), &lights, &x, bound, (2, 1)));
                mean("a cut of 8", runs(&slc(8), &lights, &x, bound, count));
                if bound == Bound::None {
                    mean("one light", runs(&slc(1), &lights, &x, bound, count));
                    mean(
                        "a light BVH",
                        runs(&LightBvh { samples: 3, ..LightBvh::default() }, &lights, &x, bound, count),
                    );
                    mean(
                        "a greedy tree",
                        runs(&StochasticLightcuts { growth: greedy, ..slc(4) }, &lights, &x, bound, count),
                    );
                }
            }
        }
    }
}

#[test]
fn lightcuts_are_off_by_less_than_their_certificate() {
    // Without noise in the kernel, and with shadows that are all or nothing: |cut - sum| <= bound, in luminance, always.
    let scene = scene();
    let (mut worst, mut loose, mut cases) = (0.0f64, 0.0f64, 0);
    for kind in KINDS {
        let lights = lights(kind);
        for (_, bsdf) in bsdfs() {
            for standing in [Standing::Pass(1), Standing::Pass(4), Standing::Receiver, Standing::Brightest] {
                for (k, error) in [0.5, 0.1, 0.02].into_iter().enumerate() {
                    let bound = [Bound::None, Bound::Geometry(0.5)][k % 2];
                    let plan = Lightcuts { error, standing, ..Lightcuts::default() };
                    for i in 0..10 {
                        let mut s = Stream::new(5, [i, k as u64, 0], Purpose::TEST);
                        let set = plan.build(lights.clone(), &Clear, &mut s).unwrap();
                        let turned = Vec3::new(0.3 * s.next_f32(), 0.2, 0.0);
                        let x = Vertex { p: turned, ..receiver(bsdf) };
                        let mut probe = Probe::default();
                        let estimate = set.radiance(&mut gather(&scene, &x, &bound, &mut probe), &mut s).luminance();
                        let size = probe.mean("cut size").unwrap();
                        assert_eq!(probe.evaluations as f64, size, "one light is asked for each node of the cut");
                        let certificate = probe.mean("error bound").unwrap();
                        let truth: f64 = {
                            let mut ask = gather(&scene, &x, &bound, &mut probe);
                            lights.iter().map(|l| ask.contribution(l, &mut s).luminance() as f64).sum()
                        };
                        let off = (estimate as f64 - truth).abs();
                        assert!(off <= certificate + 1e-5 * truth, "{kind}: off by {off}, certificate {certificate}");
                        cases += 1;
                        if certificate > 0.0 {
                            worst = worst.max(off / certificate);
                            loose += off / certificate;
                        }
                    }
                }
            }
        }
    }
    println!("{cases} cuts: off by {} of the certificate on average, by {worst} at most", loose / cases as f64);
    assert!(worst > 0.1, "the certificate says nothing");
}

#[test]
fn picks_follow_their_probabilities_and_what_cannot_be_picked_gives_nothing() {
    let scene = scene();
    for kind in KINDS {
        let lights = lights(kind);
        for (name, bsdf) in bsdfs() {
            let x = receiver(bsdf);
            let mut probe = Probe::default();
            let mut ask = gather(&scene, &x, &Bound::None, &mut probe);
            let mut s = stream(8);
            let slc = StochasticLightcuts::default().build(lights.clone(), &Clear, &mut s).unwrap();
            let bvh = LightBvh::default().build(lights.clone(), &Clear, &mut s).unwrap();
            type Pick<'a> = &'a dyn for<'g> Picks<Gather<'g, Vertex, Points, Bound>>;
            for (what, set) in [("stochastic lightcuts", &slc as Pick), ("light BVH", &bvh as Pick)] {
                let pmf: Vec<f64> = (0..lights.len()).map(|i| set.pmf(&mut ask, i)).collect();
                let dead = 1.0 - pmf.iter().sum::<f64>();
                assert!(dead > -1e-12, "{what}: {dead}");
                for (l, p) in lights.iter().zip(&pmf) {
                    let gives = !ask.contribution(l, &mut s).is_black();
                    assert!(*p > 0.0 || !gives, "{kind} {name}, {what}: {l:?} gives, and cannot be picked");
                }
                let (mut seen, n) = (vec![0u64; lights.len() + 1], 20_000);
                for _ in 0..n {
                    match set.pick(&mut ask, &mut s) {
                        Some((i, p)) => {
                            assert!((p / pmf[i] - 1.0).abs() < 1e-9, "{what}: {p} {}", pmf[i]);
                            seen[i] += 1;
                        }
                        None => seen[lights.len()] += 1,
                    }
                }
                let all = pmf.iter().copied().chain([dead.max(0.0)]);
                let expected: Vec<f64> = all.map(|p| p * n as f64).collect();
                // Those that cannot be picked are not.
                assert!(seen.iter().zip(&expected).all(|(s, e)| *s == 0 || *e > 1e-9));
                let possible: Vec<(u64, f64)> = seen.iter().copied().zip(expected).filter(|c| c.1 > 0.0).collect();
                let (seen, expected): (Vec<u64>, Vec<f64>) = possible.into_iter().unzip();
                if seen.len() > 1 {
                    let test = chi2_goodness_of_fit(&seen, &expected, 0);
                    assert!(test.p_value > 1e-4, "{kind} {name}, {what}: {test:?}");
                }
            }
        }
    }
}

#[test]
fn the_bias_of_cuts_by_error_is_small() {
    // Its samples are in the estimate that ends refinement: a bias, which the claim states.
    let lights = lights("all");
    let x = receiver(bsdfs()[0].1);
    let truth = runs(&All, &lights, &x, Bound::None, (1, 1)).remove(0);
    for error in [0.3, 0.02] {
        let plan = StochasticLightcuts { size: 40, by: CutBy::Error(error), ..StochasticLightcuts::default() };
        let estimates = Runs::new(runs(&plan, &lights, &x, Bound::None, (200, 100))).unwrap();
        let mean: Vec<f64> = (0..3).map(|k| estimates.rows().iter().map(|r| r[k]).sum::<f64>() / 200.0).collect();
        let bias: Vec<f64> = mean.iter().zip(&truth).map(|(m, t)| m / t - 1.0).collect();
        println!("cut by an error of {error}: bias {bias:?}");
        assert!(bias.iter().all(|b| b.abs() < 0.02), "{bias:?}");
    }
}

#[test]
fn many_lamps_by_every_set_are_those_of_the_path_tracer() {
    let dir = std::env::temp_dir().join(format!("manylight-lamps-{}", std::process::id()));
    manylight_scene_io::parametric::write("many-lamps", &[("lamps".into(), "300".into())], &dir).unwrap();
    let scene = load_scene(&dir.join("scene.xml"), (12, 8));
    std::fs::remove_dir_all(&dir).unwrap();
    let only = ["min-depth=2", "max-depth=2"];
    let path = recipe("path", &[&only[..], &["spp=128"]].concat(), &scene);
    let truth = block_runs(&scene, &*path.method, path.spp, 31, effort(64), 2);
    for (method, more) in [
        ("stochastic-lightcuts", &["cut=1"][..]),
        ("stochastic-lightcuts", &["cut=12"]),
        ("light-bvh", &["samples=4"]),
        ("light-bvh", &["samples=4", "tree=greedy"]),
        ("lightcuts", &["error=none", "max-cut=100000", "spp=2"]),
    ] {
        let base = ["generator=emitters", "bound=none", "paths=1024", "direct=virtual", "spp=32"];
        let given = more.iter().map(|p| p.split('=').next());
        let base = base.iter().copied().filter(|p| !given.clone().any(|n| n == p.split('=').next()));
        let params: Vec<&str> = base.chain(only).chain(more.iter().copied()).collect();
        let r = recipe(method, &params, &scene);
        let runs = block_runs(&scene, &*r.method, r.spp, 32, effort(64), 2);
        let verdict = BlockTest::default().run(&runs, Reference::Runs(&truth)).unwrap();
        println!("{method} {more:?}: {verdict}");
        assert!(verdict.passes(), "{method} {more:?}: {verdict}");
    }
}
