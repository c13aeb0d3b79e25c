//! Light that is not there.

use super::*;

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
            assert!(scene.transmittance(&c.edge, &mut s).is_black(), "{c:?}");
        }
    }
}
