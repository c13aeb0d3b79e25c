//! Where formulas divide by zero, sums lose digits, and light is somewhere between none and all: named, one by one.
//!
//! What is exact is asked of every pixel; what is a mean, of blocks over passes at a family-wise significance of 0.01 by Holm
//! within each test. Seeds are fixed. `pass` itself fails where a sample is not finite or a light path's flux is not.

mod absent;
mod everywhere;
mod near;
mod shapes;
mod sums;
mod surfaces;

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
