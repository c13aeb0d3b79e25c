//! Lights made of grids, their averages, and transport from them.

use manylight_framework::{Blend, Bounds, Clustered, Kernel, Reaches, VirtualLight};
use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DMat3, DVec3, Frame, MediumId, Spectrum, Vec3};
use manylight_media::{Glow, Grid, HenyeyGreenstein, Heterogeneous, Homogeneous, Interpolation, Volume};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Boundary, Camera, Edge, MediumPoint, Scatter, Scene, Sides, Vertex};
use manylight_volume_lights::{Balls, VolumeError, VolumeLight, VolumeLights, mean_inverse_square};

const ISO: HenyeyGreenstein = HenyeyGreenstein::ISOTROPIC;
const N: usize = 12;

fn placed() -> DAffine3 {
    DAffine3::from_rotation_y(0.3) * DAffine3::from_scale(DVec3::new(2.0, 3.0, 2.5))
}
/// A cloud in a turned box, or in a ball that is too small for its grid.
fn scene(values: &[Spectrum], interpolation: Interpolation, ball: bool) -> Scene {
    let grid = |v: Vec<Spectrum>| Grid::new([N, N, N], v, &placed(), interpolation).unwrap();
    let medium =
        Heterogeneous::new(grid(vec![Spectrum::ONE; N * N * N]), 1.0, Volume::Constant(Spectrum::ONE), ISO).unwrap();
    let mut b = Scene::builder();
    let inside = b.medium(medium.emitting(Glow::new(grid(values.to_vec()), 0.5).unwrap()).into());
    let middle = placed().transform_point3(DVec3::splat(0.5));
    let geometry = if ball {
        ShapeGeometry::Sphere(Sphere {
            centre: middle.as_vec3(),
            radius: 0.8,
            frame: Frame::around(Vec3::Z),
            flipped: false,
        })
    } else {
        let cube = placed() * DAffine3::from_translation(DVec3::splat(0.5)) * DAffine3::from_scale(DVec3::splat(0.5));
        ShapeGeometry::Mesh(TriangleMesh::cube(&cube))
    };
    b.boundary(Boundary { name: "boundary".into(), geometry, sides: Sides { outside: MediumId::VACUUM, inside } });
    let looks = DAffine3 { matrix3: DMat3::IDENTITY, translation: DVec3::new(0.0, 0.0, -20.0) };
    b.camera(Camera::perspective(looks, 30.0, (4, 4)).unwrap());
    b.build().unwrap()
}
fn values() -> Vec<Spectrum> {
    let mut s = Stream::new(5, [0; 3], Purpose::TEST);
    let mut value =
        || if s.next_f32() < 0.4 { Spectrum::BLACK } else { Spectrum::rgb(s.next_f32(), s.next_f32(), 0.1) };
    (0..N * N * N).map(|_| value()).collect()
}
fn sum(lights: &[VolumeLight]) -> DVec3 {
    lights.iter().map(|l| l.intensity.0.as_dvec3()).sum()
}

#[test]
fn lights_hold_all_that_the_grid_emits_whatever_the_blocks() {
    for interpolation in [Interpolation::Nearest, Interpolation::Trilinear] {
        let scene = scene(&values(), interpolation, false);
        let total = match scene.media().next().unwrap().1 {
            manylight_scene::Medium::Heterogeneous(m) => m.emission().unwrap().total().0.as_dvec3(),
            _ => unreachable!(),
        };
        let mut before = usize::MAX;
        for block in [1, 2, 5, 12, 100] {
            let made = VolumeLights::new(&scene, block).unwrap();
            assert!(
                (sum(made.lights()) - total).length() < 1e-5 * total.length(),
                "{block}: {} {total}",
                sum(made.lights())
            );
            assert!(made.lights().len() < before.max(2), "{block}");
            before = made.lights().len();
            // Spread over the grid, each axis by the same rule at any block: sum I (p^2 + spread^2) is conserved.
            assert!(made.lights().iter().all(|l| made.bounds().contains(l.p) && l.radius > 0.0 && l.edges == 0));
            assert!((made.spacing() - (2.0 / N as f64) * block as f64).abs() < 1e-6);
        }
        assert_eq!(before, 1);
        let second = |block: usize| -> DVec3 {
            let made = VolumeLights::new(&scene, block).unwrap();
            let of = |l: &VolumeLight| (l.p * l.p + l.spread * l.spread).as_dvec3() * l.intensity.luminance() as f64;
            made.lights().iter().map(of).sum()
        };
        assert!((second(1) - second(5)).length() < 1e-5 * second(1).length());
    }
}

#[test]
fn the_grid_emits_as_much_as_its_lights_say() {
    // int j dV by points, against the lights.
    for interpolation in [Interpolation::Nearest, Interpolation::Trilinear] {
        let scene = scene(&values(), interpolation, false);
        let manylight_scene::Medium::Heterogeneous(m) = scene.media().next().unwrap().1 else { unreachable!() };
        let n = 60;
        let mut truth = DVec3::ZERO;
        for i in 0..n * n * n {
            let at = DVec3::new((i % n) as f64 + 0.5, (i / n % n) as f64 + 0.5, (i / n / n) as f64 + 0.5) / n as f64;
            truth += m.emission().unwrap().at(placed().transform_point3(at).as_vec3()).0.as_dvec3()
                * (15.0 / (n * n * n) as f64);
        }
        let made = sum(VolumeLights::new(&scene, 1).unwrap().lights());
        assert!((made - truth).length() < 2e-3 * truth.length(), "{interpolation:?}: {made} {truth}");
    }
}

#[test]
fn what_lies_beyond_the_mediums_boundary_is_no_light() {
    let all = VolumeLights::new(&scene(&vec![Spectrum::ONE; N * N * N], Interpolation::Nearest, false), 1).unwrap();
    let cut = VolumeLights::new(&scene(&vec![Spectrum::ONE; N * N * N], Interpolation::Nearest, true), 1).unwrap();
    // A ball of radius 0.8 in a box of 15 m^3, to voxels.
    let share = 4.0 / 3.0 * std::f64::consts::PI * 0.8f64.powi(3) / 15.0;
    let got = sum(cut.lights()).x / sum(all.lights()).x;
    assert!((got / share - 1.0).abs() < 0.05, "{got} {share}");
}

#[test]
fn media_without_grids_are_refused_and_those_that_do_not_emit_make_nothing() {
    let none = scene(&vec![Spectrum::BLACK; N * N * N], Interpolation::Nearest, false);
    let made = VolumeLights::new(&none, 1).unwrap();
    assert!(made.lights().is_empty() && made.bounds().is_empty() && made.spacing() == f64::INFINITY);
    let mut b = Scene::builder();
    let even = Homogeneous::new(Spectrum::BLACK, Spectrum::ONE, ISO).unwrap().emitting(Spectrum::ONE).unwrap();
    b.medium(even.into());
    b.camera(Camera::perspective(DAffine3::IDENTITY, 30.0, (4, 4)).unwrap());
    assert_eq!(VolumeLights::new(&b.build().unwrap(), 1).err(), Some(VolumeError::Homogeneous));
}

#[test]
fn the_field_of_a_ball_is_the_mean_over_its_points() {
    let mut s = Stream::new(2, [0; 3], Purpose::TEST);
    for d in [0.0f64, 0.005, 0.02, 0.5, 0.97, 1.0, 1.03, 2.0, 5.0, 7.99, 8.01, 30.0] {
        // Shell by shell: int r^2 / (2 r d) ln((d + r) / |d - r|) dr x 3.
        let n = 400_000;
        let shell = |i: usize| {
            let r = (i as f64 + 0.5) / n as f64;
            let mean = if d < 1e-9 { 1.0 / (r * r) } else { ((d + r) / (d - r).abs()).ln() / (2.0 * r * d) };
            3.0 * r * r * mean / n as f64
        };
        let truth: f64 = (0..n).map(shell).sum();
        for a in [1.0f64, 0.01, 300.0] {
            let got = mean_inverse_square((d * d * a * a) as f32, a as f32) as f64 * a * a;
            assert!((got / truth - 1.0).abs() < 2e-4, "{d} x {a}: {got} {truth}");
        }
    }
    // And by random points, once.
    let x = Vec3::X * 1.5;
    let points = (0..400_000).map(|_| warp::sphere(s.next_2d()) * s.next_f32().cbrt());
    let mean = points.map(|p| 1.0 / (p - x).length_squared() as f64).sum::<f64>() / 4e5;
    assert!((mean / mean_inverse_square(2.25, 1.0) as f64 - 1.0).abs() < 0.005);
    assert!((mean_inverse_square(2.25, 1.0) / 0.494_101_3 - 1.0).abs() < 1e-5, "the notes' ball at 1.5");
}

fn receiver(p: Vec3, g: f32) -> Vertex {
    let phase = HenyeyGreenstein::new(g).unwrap();
    let point = MediumPoint { wi: Vec3::Z, scattering: Spectrum::rgb(1.0, 0.5, 0.2), phase, medium: MediumId::new(0) };
    Vertex { p, scatter: Scatter::Medium(point) }
}

#[test]
fn shadows_are_asked_of_points_of_a_lights_own_spread() {
    let scene = scene(&values(), Interpolation::Nearest, false);
    let l = VolumeLight {
        p: Vec3::new(1.0, 2.0, 3.0),
        intensity: Spectrum::ONE,
        spread: Vec3::new(0.1, 0.0, 0.3),
        radius: 0.2,
        edges: 0,
    };
    let r = receiver(Vec3::ZERO, 0.0);
    let mut s = Stream::new(4, [0; 3], Purpose::TEST);
    let (n, mut first, mut second) = (20_000, DVec3::ZERO, DVec3::ZERO);
    for _ in 0..n {
        let c = Balls.connect(&scene, &r, &l, &mut s).unwrap();
        let Edge::Between(_, end) = c.edge else { panic!("{:?}", c.edge) };
        let d = (end.p - l.p).as_dvec3();
        (first, second) = (first + d / n as f64, second + d * d / n as f64);
        assert!((c.value.0.x / (0.25 / std::f32::consts::PI * mean_inverse_square(14.0, 0.2)) - 1.0).abs() < 1e-5);
    }
    assert!(
        first.abs().max_element() < 0.01 && (second - DVec3::new(0.01, 0.0, 0.09)).abs().max_element() < 2e-3,
        "{first} {second}"
    );
    // A receiver in the very middle is lit, and finitely.
    let c = Balls.connect(&scene, &receiver(l.p, 0.0), &l, &mut s).unwrap();
    assert!((c.value.0.x / (0.25 / std::f32::consts::PI * 75.0) - 1.0).abs() < 1e-4);
}

#[test]
fn averages_hold_intensity_middle_and_spread() {
    let mut s = Stream::new(6, [0; 3], Purpose::TEST);
    let mut v = || Vec3::new(s.next_f32(), s.next_f32(), s.next_f32());
    // Far from the origin, where squares cancel.
    let lights: Vec<VolumeLight> = (0..40)
        .map(|_| VolumeLight { p: v() + 1000.0, intensity: Spectrum(v()), spread: v() * 0.01, radius: 0.1, edges: 2 })
        .collect();
    let mut all = <VolumeLight as Blend>::Sum::default();
    lights.iter().for_each(|l| l.add(0.5, &mut all));
    let (p, made) = VolumeLight::made(&all).unwrap();
    assert_eq!((p, made.edges), (made.p, 2));
    assert!((made.intensity.0.as_dvec3() * 2.0 - sum(&lights)).length() < 1e-5);
    let weight: f64 = lights.iter().map(|l| l.intensity.luminance() as f64).sum();
    let mean = lights.iter().map(|l| l.p.as_dvec3() * l.intensity.luminance() as f64).sum::<DVec3>() / weight;
    assert!((made.p.as_dvec3() - mean).length() < 1e-3);
    assert!(made.spread.min_element() > 0.2 && made.spread.max_element() < 0.4, "{}", made.spread);
    // One light is itself; no light is none.
    let mut one = <VolumeLight as Blend>::Sum::default();
    assert!(VolumeLight::made(&one).is_none());
    lights[0].add(1.0, &mut one);
    let same = VolumeLight::made(&one).unwrap().1;
    assert!((same.p - lights[0].p).length() < 1e-3 && (same.spread - lights[0].spread).length() < 1e-3);
    assert!((same.intensity() / lights[0].intensity() - 1.0).abs() < 1e-6);
}

#[test]
fn bounds_hold_and_reaches_are_of_the_right_size() {
    let scene = scene(&values(), Interpolation::Nearest, false);
    let mut s = Stream::new(8, [0; 3], Purpose::TEST);
    for i in 0..4000 {
        let mut v = || Vec3::new(s.next_f32(), s.next_f32(), s.next_f32());
        let corner = v() * 2.0;
        let light = |p: Vec3, i: Vec3, r: f32| VolumeLight {
            p,
            intensity: Spectrum(i),
            spread: Vec3::ZERO,
            radius: r,
            edges: 0,
        };
        let lights: Vec<VolumeLight> = (0..5).map(|_| light(corner + v() * 0.3, v(), 0.02 + 0.3 * v().x)).collect();
        let x = if i % 2 == 0 { v() * 2.0 } else { corner + v() * 0.3 };
        let r = receiver(x, 0.7);
        let cluster = lights.iter().map(|l| l.cluster()).reduce(|a, b| VolumeLight::merge(&a, &b)).unwrap();
        let value: f32 =
            lights.iter().filter_map(|l| Balls.connect(&scene, &r, l, &mut s)).map(|c| c.value.luminance()).sum();
        let bound = Balls.upper_bound(&r, &cluster, f32::INFINITY);
        assert!(value <= bound, "{value} above {bound}");
        let reach = Balls.reach(&r, &cluster, f32::INFINITY);
        assert!(reach.near2 > 0.0 && reach.near2 <= reach.far2 && reach.facing_max > 0.0 && reach.intensity > 0.0);
    }
}
