//! Points that are too near.

use super::*;

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
