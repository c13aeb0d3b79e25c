//! What emitters draw, and with what density they say they do.

use glam::DQuat;
use manylight_geometry::{Disk, ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DVec3, Frame, INV_4PI, Ray, Spectrum, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{
    Bitmap, Camera, Emitter, EmitterPoint, Environment, Material, Mode, Model, Scatter, Scene, SceneBuilder, Shape,
    Source, Spot,
};
use manylight_stats::{Alternative, MeanTest, Moments, chi2_goodness_of_fit};
use std::f32::consts::PI;
use std::sync::Arc;

fn lamp(b: &mut SceneBuilder, geometry: ShapeGeometry, radiance: Spectrum) {
    let black = Model::Diffuse { reflectance: Source::Constant(Spectrum::BLACK) };
    let material = b.material(Material::one_sided("black", black));
    b.shape(Shape { name: "lamp".into(), geometry, material, radiance: Some(Source::Constant(radiance)) });
}
fn built(add: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut b = Scene::builder();
    add(&mut b);
    b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (2, 2)).unwrap());
    b.build().unwrap()
}
fn stream(seed: u64) -> Stream {
    Stream::new(seed, [0; 3], Purpose::TEST)
}
fn turned() -> DAffine3 {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.0, 2.0);
    DAffine3::from_scale_rotation_translation(DVec3::new(1.0, 3.0, 0.5), turn, DVec3::new(4.0, 5.0, 6.0))
}
fn sky(radiance: impl Fn(usize) -> f32) -> Emitter {
    let pixels = (0..40).map(|i| Spectrum::rgb(radiance(i), 0.5 * radiance(i), 0.0)).collect();
    let image = Arc::new(Bitmap { width: 8, height: 5, pixels });
    Emitter::Environment(Box::new(Environment::new(image, 1.5, &DAffine3::from_rotation_x(0.7)).unwrap()))
}
/// One emitter of each kind, and the power of each. [W]
fn one_of_each() -> (Scene, Vec<f64>) {
    let mesh = TriangleMesh::cube(&turned());
    let area: f64 = (0..12).map(|i| mesh.triangle_area(i)).sum();
    let scene = built(|b| {
        lamp(b, ShapeGeometry::Mesh(mesh), Spectrum::gray(0.01));
        lamp(b, ShapeGeometry::Sphere(Sphere::new(Vec3::new(-3.0, 1.0, 2.0), 0.5)), Spectrum::gray(0.5));
        let frame = Frame::around(Vec3::new(0.6, 0.0, 0.8));
        lamp(b, ShapeGeometry::Disk(Disk { centre: Vec3::ONE, radius: 0.7, frame }), Spectrum::gray(0.7));
        b.emitter(Emitter::Point { position: Vec3::X, intensity: Spectrum::gray(0.3) });
        b.emitter(Emitter::Directional { direction: Vec3::NEG_Y, irradiance: Spectrum::gray(0.02) });
        b.emitter(Emitter::Constant { radiance: Spectrum::gray(0.003) });
        let spot = Spot::new(Vec3::Z, 0.8, 0.8).unwrap();
        b.emitter(Emitter::Spot { position: Vec3::Y, intensity: Spectrum::gray(5.0), spot });
    });
    let pi = std::f64::consts::PI;
    let disc = pi * (scene.bounds().radius() as f64 * 1.0001).powi(2);
    let powers =
        [0.01 * pi * area, 0.5 * pi * pi, 0.7 * pi * pi * 0.49, 0.3 * 4.0 * pi, 0.02 * disc, 0.003 * 4.0 * pi * disc];
    let powers = [&powers[..], &[5.0 * 2.0 * pi * (1.0 - 0.8f64.cos())]].concat();
    (scene, powers)
}

#[test]
fn emitters_are_drawn_by_their_power_and_say_so() {
    let (scene, powers) = one_of_each();
    let emitters = scene.emitters();
    let total: f64 = powers.iter().sum();
    assert_eq!(emitters.len(), 7);
    assert!((emitters.power() / total - 1.0).abs() < 1e-5, "{} {total}", emitters.power());
    for (i, power) in powers.iter().enumerate() {
        assert!((emitters.pmf(i as u32) as f64 / (power / total) - 1.0).abs() < 1e-5, "emitter {i}");
    }
    let (mut s, n) = (stream(1), 100_000);
    let mut seen = vec![0u64; 7];
    let mut flux = [0.0f64; 7];
    for _ in 0..n {
        let e = scene.sample_emission(&mut s).unwrap();
        seen[e.start.emitter as usize] += 1;
        flux[e.start.emitter as usize] += e.flux.luminance() as f64 / n as f64;
        assert!((e.ray.dir.length() - 1.0).abs() < 1e-5 && e.ray.origin.is_finite());
    }
    let expected: Vec<f64> = powers.iter().map(|p| p / total * n as f64).collect();
    assert!(chi2_goodness_of_fit(&seen, &expected, 0).p_value > 0.001, "{seen:?} {expected:?}");
    // Rays carry the power of their emitter: all with the same flux, so that only the count of them is random.
    for i in 0..7 {
        let of_one = flux[i] * n as f64 / seen[i] as f64 * emitters.pmf(i as u32) as f64;
        assert!((of_one / powers[i] - 1.0).abs() < 1e-4, "emitter {i}: {of_one} W, not {}", powers[i]);
    }
}

#[test]
fn the_density_of_a_sample_is_the_one_that_is_asked_for_afterwards() {
    let (scene, _) = one_of_each();
    let with_map = built(|b| b.emitter(sky(|i| (i % 3) as f32)));
    let mut s = stream(2);
    for scene in [&scene, &with_map] {
        let emitters = scene.emitters();
        for _ in 0..20_000 {
            let e = scene.sample_emitter(&mut s).unwrap();
            let Scatter::Emitter(point) = e.vertex.scatter else { panic!("no point of an emitter") };
            let (asked, radiance) = match point {
                EmitterPoint::Lambert { n, .. } => {
                    // Seen from in front, it is the emitter that it says it is, with the radiance that the flux is made of.
                    let ray = Ray::new(e.vertex.p + n * 0.01, -n);
                    let hit = scene.intersect(&ray, Mode::Radiance).unwrap();
                    assert_eq!(hit.emitter(), Some(e.emitter));
                    assert!((hit.p - e.vertex.p).length() < 1e-4);
                    (emitters.pdf_area(e.emitter), hit.emitted() * PI)
                }
                EmitterPoint::Distant { towards, .. } if e.density.is_some() => {
                    (emitters.environment_pdf_sa(towards), scene.environment(towards))
                }
                _ => {
                    assert!(e.density.is_none());
                    continue;
                }
            };
            let density = e.density.unwrap();
            // A direction that rounds across a texel's border has the neighbour's density.
            let near_border = (density / asked - 1.0).abs() > 1e-3 && s.next_below(1000) > 0;
            assert!(!near_border || matches!(point, EmitterPoint::Distant { .. }), "{density} {asked}");
            let flux = radiance * (1.0 / density);
            assert!((flux.0 - e.flux.0).abs().max_element() <= 1e-3 * flux.largest(), "{flux:?} {:?}", e.flux);
        }
    }
}

#[test]
fn densities_integrate_to_the_probability_of_their_emitter() {
    let (scene, powers) = one_of_each();
    let total: f64 = powers.iter().sum();
    for i in 0..3u32 {
        let area = scene.geometry().shapes()[i as usize].area();
        assert!((scene.emitters().pdf_area(i) as f64 * area * total / powers[i as usize] - 1.0).abs() < 1e-5);
    }
    for i in 3..6 {
        assert_eq!(scene.emitters().pdf_area(i), 0.0);
    }
    let skies = [scene, built(|b| b.emitter(sky(|i| 0.1 + (i % 4) as f32)))];
    for (scene, share) in skies.iter().zip([powers[5] / total, 1.0]) {
        // Stratified over the sphere.
        let (mut s, n) = (stream(3), 500);
        let mut sum = 0.0f64;
        for i in 0..n * n {
            let u = glam::Vec2::new((i / n) as f32 + s.next_f32(), (i % n) as f32 + s.next_f32()) / n as f32;
            sum += (scene.emitters().environment_pdf_sa(warp::sphere(u)) / INV_4PI) as f64;
        }
        let mass = sum / (n * n) as f64;
        assert!((mass / share - 1.0).abs() < 5e-3, "{mass} {share}");
    }
}

#[test]
fn points_of_a_mesh_are_uniform_over_its_triangles_and_within_them() {
    // Triangles of very different areas; each is cut in four at the middles of its edges.
    let mut mesh = TriangleMesh { positions: vec![Vec3::ZERO], ..TriangleMesh::default() };
    for i in 0..6u32 {
        let size = 0.1 * 1.7f32.powi(i as i32);
        let at = Vec3::X * (4.0 * i as f32);
        mesh.positions.extend([at, at + Vec3::new(size, 0.1, 0.0), at + Vec3::new(0.0, size, 0.3)]);
        mesh.triangles.push([3 * i + 1, 3 * i + 2, 3 * i + 3]);
    }
    mesh.triangles.push([0, 0, 1]);
    let corners: Vec<[Vec3; 3]> = (0..6).map(|i| mesh.corners(i)).collect();
    let areas: Vec<f64> = (0..6).map(|i| mesh.triangle_area(i)).collect();
    let scene = built(|b| lamp(b, ShapeGeometry::Mesh(mesh), Spectrum::ONE));
    let (mut s, n) = (stream(4), 100_000);
    let mut seen = vec![0u64; 24];
    for _ in 0..n {
        let p = scene.sample_emitter(&mut s).unwrap().vertex.p;
        let i = ((p.x + 0.5) / 4.0) as usize;
        let [a, b, c] = corners[i];
        // Barycentrics by areas.
        let all = (b - a).cross(c - a);
        let part = |u: Vec3, v: Vec3| (u - p).cross(v - p).dot(all) / all.length_squared();
        let (u, v, w) = (part(b, c), part(c, a), part(a, b));
        assert!(u.min(v).min(w) > -1e-4);
        seen[4 * i
            + if u > 0.5 {
                0
            } else if v > 0.5 {
                1
            } else if w > 0.5 {
                2
            } else {
                3
            }] += 1;
    }
    let total: f64 = areas.iter().sum();
    let expected: Vec<f64> = areas.iter().flat_map(|a| [a / total / 4.0 * n as f64; 4]).collect();
    let test = chi2_goodness_of_fit(&seen, &expected, 0);
    assert!(test.p_value > 0.001, "{test:?}");
}

#[test]
fn rays_of_a_lamp_leave_by_the_cosine_and_those_of_the_sky_fill_the_disc() {
    let scene = built(|b| lamp(b, ShapeGeometry::Mesh(TriangleMesh::rectangle(&DAffine3::IDENTITY)), Spectrum::ONE));
    let mut s = stream(5);
    let n = 100_000;
    // cos^2 is uniform.
    let mut seen = vec![0u64; 20];
    for _ in 0..n {
        let ray = scene.sample_emission(&mut s).unwrap().ray;
        assert!(ray.origin.z > 0.0);
        seen[((ray.dir.z * ray.dir.z * 20.0) as usize).min(19)] += 1;
    }
    assert!(chi2_goodness_of_fit(&seen, &[n as f64 / 20.0; 20], 0).p_value > 0.001);
    // A ball of radius r in a world of radius R: a share of (r / R)^2 of the sky's rays meets it, from wherever it is.
    let scene = built(|b| {
        lamp(b, ShapeGeometry::Sphere(Sphere::new(Vec3::new(2.0, 1.0, 0.0), 0.5)), Spectrum::BLACK);
        lamp(b, ShapeGeometry::Sphere(Sphere::new(Vec3::new(-3.0, 0.0, 1.0), 1e-3)), Spectrum::BLACK);
        b.emitter(Emitter::Constant { radiance: Spectrum::ONE });
    });
    let share = (0.5 / (scene.bounds().radius() as f64 * 1.0001)).powi(2);
    let hits: Moments = (0..n)
        .map(|_| {
            let ray = scene.sample_emission(&mut s).unwrap().ray;
            f64::from(scene.intersect(&ray, Mode::Importance).is_some_and(|x| x.p.x > 0.0))
        })
        .collect();
    let test = MeanTest::one_sample(&hits, share, Alternative::Different);
    assert!(test.p_value > 0.001, "{test:?}");
}

#[test]
fn a_shape_without_area_or_light_is_never_drawn_and_has_no_density() {
    let scene = built(|b| {
        let nothing = TriangleMesh { positions: vec![Vec3::X; 3], triangles: vec![[0, 1, 2]], ..Default::default() };
        lamp(b, ShapeGeometry::Mesh(nothing), Spectrum::ONE);
        lamp(b, ShapeGeometry::Sphere(Sphere::new(Vec3::ZERO, 1.0)), Spectrum::BLACK);
    });
    assert_eq!((scene.emitters().shine(), scene.emitters().power()), (false, 0.0));
    assert_eq!((scene.emitters().pdf_area(0), scene.emitters().pdf_area(1)), (0.0, 0.0));
    assert!(scene.sample_emitter(&mut stream(1)).is_none() && scene.sample_emission(&mut stream(1)).is_none());
}

#[test]
fn triangles_given_twice_shine_once() {
    let mut mesh = TriangleMesh::rectangle(&DAffine3::IDENTITY);
    mesh.triangles.extend(mesh.triangles.clone());
    mesh.triangles.push([1, 0, 2]); // and once more, from behind
    let scene = built(|b| lamp(b, ShapeGeometry::Mesh(mesh), Spectrum::ONE));
    assert!((scene.area() - 4.0).abs() < 1e-6, "{} m^2", scene.area());
    assert!((scene.emitters().pdf_area(0) - 0.25).abs() < 1e-6);
    assert!((scene.emitters().power() / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-6);
}

#[test]
fn a_lamp_shines_where_its_surface_faces_whatever_its_shading_normals_say() {
    // Shading normals tilted by 60 degrees: from low on one side the surface is in front, and they are turned away.
    let mut mesh = TriangleMesh::rectangle(&DAffine3::IDENTITY);
    mesh.normals = vec![Vec3::new(0.866_025_4, 0.0, 0.5); 4];
    let scene = built(|b| lamp(b, ShapeGeometry::Mesh(mesh), Spectrum::ONE));
    for (x, z, shines) in
        [(-0.9f32, 0.2, true), (0.9, 0.2, true), (0.0, 1.0, true), (0.9, -0.2, false), (-0.9, -0.2, false)]
    {
        let to_eye = Vec3::new(x, 0.1, z).normalize();
        let seen = scene.intersect(&Ray::new(to_eye, -to_eye), Mode::Radiance).unwrap().emitted();
        let Scatter::Emitter(EmitterPoint::Lambert { n, .. }) =
            scene.sample_emitter(&mut stream(1)).unwrap().vertex.scatter
        else {
            panic!("no lamp")
        };
        assert_eq!((!seen.is_black(), n.dot(to_eye) > 0.0), (shines, shines), "towards {to_eye}");
    }
}

#[test]
fn points_of_a_ball_are_where_they_should_be_whatever_its_size_and_place() {
    // The same numbers on a ball of radius 1 at the origin, and on a large one far off, are the same directions.
    let of = |centre: Vec3, radius: f32| {
        let scene = built(|b| lamp(b, ShapeGeometry::Sphere(Sphere::new(centre, radius)), Spectrum::ONE));
        let mut s = stream(8);
        let points = (0..1000).map(|_| {
            let vertex = scene.sample_emitter(&mut s).unwrap().vertex;
            let Scatter::Emitter(EmitterPoint::Lambert { n, .. }) = vertex.scatter else { panic!("no lamp") };
            (vertex.p, n)
        });
        points.collect::<Vec<_>>()
    };
    let unit = of(Vec3::ZERO, 1.0);
    for (centre, radius) in [(Vec3::splat(3e4), 2e4f32), (Vec3::splat(1e6), 1e6), (Vec3::splat(10.0), 1e-3)] {
        for ((_, out), (p, n)) in unit.iter().zip(of(centre, radius)) {
            assert!((n - *out).length() < 1e-5, "{n} is not {out}");
            assert!((p - (centre + *out * radius)).abs().max_element() < 2e-7 * (centre.x + radius));
        }
    }
}

#[test]
fn the_hash_of_a_scene_sees_every_light_move() {
    let hash = |emitter: Emitter| {
        let mut b = Scene::builder();
        b.emitter(emitter);
        b.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, (4, 4)).unwrap());
        b.build().unwrap().hash()
    };
    let sky = |red: f32, turn: f64| {
        let mut image = Bitmap { width: 4, height: 3, pixels: vec![Spectrum::ONE; 12] };
        image.pixels[5].0.x = red;
        let rotation = DAffine3::from_rotation_y(turn);
        Emitter::Environment(Box::new(Environment::new(Arc::new(image), 1.0, &rotation).unwrap()))
    };
    let point = |x: f32| Emitter::Point { position: Vec3::X * x, intensity: Spectrum::ONE };
    let sun = |direction: Vec3| Emitter::Directional { direction, irradiance: Spectrum::ONE };
    let all =
        [point(0.0), point(1.0), sun(Vec3::X), sun(Vec3::Y), sky(1.0, 0.0), sky(1.0, 0.5), sky(2.0, 0.0)].map(hash);
    for (i, a) in all.iter().enumerate() {
        assert!(!all[..i].contains(a), "scene {i} has the hash of another");
    }
    assert_eq!(hash(point(1.0)), all[1]);
}
