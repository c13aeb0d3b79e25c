//! Surfaces and lights built to break things.

use super::case::{Case, Truth};
use super::site::{Made, Site, Units, cuboid, film_mean, room, square};
use manylight_bsdf::Distribution;
use manylight_geometry::TriangleMesh;
use manylight_math::{DAffine3, DVec3, MediumId, Spectrum, Vec3};
use manylight_scene::{Model, Source};
use std::f64::consts::PI;

const AIR: MediumId = MediumId::VACUUM;
const FROM: DVec3 = DVec3::new(0.2, 0.1, 0.3);
const TO: DVec3 = DVec3::new(0.1, 0.0, -1.0);
/// From `FROM` away from the middle.
const AWAY: DVec3 = DVec3::new(1.0, 0.5, 1.5);

pub(super) const CASES: &[Case] = &[
    Case {
        bounded_g: true,
        ..Case::new("furnace-1e-6", "a glowing ball a micrometre wide", |u| furnace(times(u, 1e-6)), half)
    },
    Case {
        bounded_g: true,
        ..Case::new("furnace-1e6", "a glowing ball a thousand kilometres wide", |u| furnace(times(u, 1e6)), half)
    },
    Case::new("far-away", "a glowing room a thousand times its size from the origin", far_away, half),
    Case::new(
        "slivers",
        "a glowing room whose walls are triangles a hundred thousand times as long as wide",
        slivers,
        half,
    ),
    Case::new(
        "parallel-walls",
        "a glowing room with a ceiling 1e-4 of its width above the floor",
        parallel_walls,
        half,
    ),
    Case {
        bounded_g: true,
        ..Case::new("white-walls", "a glowing ball that absorbs nothing, paths of fifty edges", white_walls, |edges| {
            Some([f64::from(edges.min(50)); 3])
        })
    },
    Case { bounded_g: true, ..Case::new("contrast", "channels of 1e6, 1 and 1e-6", contrast, contrast_truth) },
    Case {
        bounded_g: true,
        ..Case::new("one-place", "256 lights at one point, 1e6:1 in intensity", one_place, lantern)
    },
    Case { bounded_g: true, ..Case::new("sub-pixel", "a lamp of 1e-4 of the room's radius", sub_pixel, lantern) },
    Case {
        bounded_g: true,
        ..Case::new("at-the-wall", "a light 1e-4 of the room's radius from its wall", at_the_wall, at_the_wall_truth)
    },
    Case {
        bounded_g: true,
        ..Case::new("grazing", "a sun at a cosine of 1e-3, seen along the ground", grazing, grazing_truth)
    },
    Case::new("touching-balls", "white balls that touch under an even sky", touching_balls, one),
    Case::new(
        "twice-there",
        "a white box that is there twice, and one that stands on it, under an even sky",
        twice_there,
        one,
    ),
    Case::new("sharp-metal", "a lossless metal of roughness 1e-4 under an even sky", |u| sharp(u, metal(1e-4)), one),
    Case::new("sharp-glass", "lossless glass of roughness 1e-4 under an even sky", |u| sharp(u, glass()), one),
    Case::new(
        "all-lights",
        "a sky, a sun, a point and a lamp over a floor and rough metal: nothing they have in common has a unit",
        all_lights,
        unknown,
    ),
    Case::new("lamp-in-floor", "a lamp in the plane of the floor, and a light in it", lamp_in_floor, unknown),
];

fn times(u: Units, scale: f64) -> Units {
    Units { length: u.length * scale, ..u }
}
fn one(edges: u32) -> Truth {
    (edges == u32::MAX).then_some([1.0; 3])
}
fn unknown(_: u32) -> Truth {
    None
}
/// Albedo 1/2, radiance 1: (1 - 2^-k) / (1 - 1/2).
fn half(edges: u32) -> Truth {
    Some([2.0 * (1.0 - 0.5f64.powf(f64::from(edges))); 3])
}

fn furnace(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([0.5; 3]);
    s.hollow(1.0, m, Some([1.0; 3]));
    s.seen(FROM, TO, 70.0, AIR)
}

fn glowing(u: Units, walls: TriangleMesh, from: DVec3, to: DVec3) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([0.5; 3]);
    s.mesh(walls, m, Some([1.0; 3]));
    s.seen(from, to, 70.0, AIR)
}

fn far_away(u: Units) -> Made {
    let o = DVec3::new(1000.0, -700.0, 300.0);
    glowing(u, room(o - 1.0, o + 1.0), o + FROM, o + TO)
}

fn parallel_walls(u: Units) -> Made {
    let h = 1e-4;
    glowing(
        u,
        room(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, h)),
        DVec3::new(0.1, 0.2, 0.4 * h),
        DVec3::new(0.1, 0.3, 0.0),
    )
}

/// A room whose six walls are fans from a corner: two large triangles, and between them eight that are 1e-5 of their length wide.
fn slivers(u: Units) -> Made {
    let plain = room(DVec3::splat(-1.0), DVec3::splat(1.0));
    let mut mesh = TriangleMesh::default();
    // Corners of each wall, in the order of its edge.
    for wall in plain.positions.chunks_exact(4) {
        let (base, b, c) = (mesh.positions.len() as u32, wall[1], wall[2]);
        let middle = (0..=8).map(|k| b + (c - b) * (0.5 + k as f32 * 1e-5));
        let stops: Vec<Vec3> = [wall[0], b].into_iter().chain(middle).chain([c, wall[3]]).collect();
        mesh.triangles.extend((1..stops.len() as u32 - 1).map(|k| [base, base + k, base + k + 1]));
        mesh.positions.extend(stops);
    }
    glowing(u, mesh, FROM, TO)
}

fn white_walls(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([1.0; 3]);
    s.hollow(1.0, m, Some([1.0; 3]));
    s.b.max_depth(Some(50));
    s.seen(FROM, TO, 70.0, AIR)
}

const CONTRAST: ([f64; 3], [f64; 3]) = ([1e6, 1.0, 1e-6], [0.3, 0.5, 0.7]);

fn contrast(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse(CONTRAST.1);
    s.hollow(1.0, m, Some(CONTRAST.0));
    s.seen(FROM, TO, 70.0, AIR)
}
fn contrast_truth(edges: u32) -> Truth {
    let (e, a) = CONTRAST;
    Some([0, 1, 2].map(|c| e[c] * (1.0 - a[c].powf(f64::from(edges))) / (1.0 - a[c])))
}

/// 1 W/sr in the middle of a ball of albedo 1/2: irradiance 1, each bounce the same over its half.
fn lantern(edges: u32) -> Truth {
    Some([0.5 / PI * 2.0 * (1.0 - 0.5f64.powf(f64::from(edges) - 1.0)); 3])
}

fn one_place(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([0.5; 3]);
    s.hollow(1.0, m, None);
    let weights: Vec<f64> = (0..256).map(|i| 1e6f64.powf(f64::from(i) / 255.0)).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().for_each(|w| s.point(DVec3::ZERO, [w / sum; 3]));
    s.seen(FROM, TO, 70.0, AIR)
}

fn sub_pixel(u: Units) -> Made {
    let r = 1e-4;
    let mut s = Site::new(u);
    let (m, black) = (s.diffuse([0.5; 3]), s.diffuse([0.0; 3]));
    s.hollow(1.0, m, None);
    s.ball(DVec3::ZERO, r, black, Some([1.0 / (PI * r * r); 3]));
    // Not in sight: seen directly it would be a firefly to whoever looks by chance.
    s.seen(FROM, AWAY, 70.0, AIR)
}

const AT_THE_WALL: DVec3 = DVec3::new(0.0, 0.0, -(1.0 - 1e-4));

fn at_the_wall(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([0.5; 3]);
    s.hollow(1.0, m, None);
    s.point(AT_THE_WALL, [1.0; 3]);
    // Direct light alone: what comes from the bright spot beside the light is met by one eye path in a hundred million.
    s.b.max_depth(Some(2));
    s.seen(FROM, AWAY, 40.0, AIR)
}
/// rho / pi times I cos / d^2.
fn at_the_wall_truth(edges: u32) -> Truth {
    let direct = film_mean(FROM, AWAY, 40.0, |w| {
        let b = FROM.dot(w);
        let p = FROM + w * ((b * b + 1.0 - FROM.length_squared()).sqrt() - b);
        let d = AT_THE_WALL - p;
        0.5 / PI * d.dot(-p) / d.length().powi(3)
    });
    (edges == 2).then_some([direct; 3])
}

fn grazing(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([0.8; 3]);
    s.mesh(square(DVec3::ZERO, 5.0), m, None);
    s.sun(DVec3::new((1.0f64 - 1e-6).sqrt(), 0.0, -1e-3), [1.0; 3]);
    s.seen(DVec3::new(0.0, -3.0, 1e-3), DVec3::ZERO, 0.002, AIR)
}
fn grazing_truth(_: u32) -> Truth {
    Some([0.8 / PI * 1e-3; 3])
}

fn touching_balls(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([1.0; 3]);
    for at in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.5, 0.5, 0.5f64.sqrt())] {
        s.ball(at, 0.5, m, None);
    }
    s.sky([1.0; 3]);
    s.seen(DVec3::new(2.0, 2.5, 3.0), DVec3::new(0.4, 0.4, 0.2), 18.0, AIR)
}

fn twice_there(u: Units) -> Made {
    let mut s = Site::new(u);
    let m = s.diffuse([1.0; 3]);
    for _ in 0..2 {
        s.mesh(cuboid(DVec3::new(-1.0, -1.0, -0.5), DVec3::new(1.0, 1.0, 0.0)), m, None);
    }
    s.mesh(cuboid(DVec3::new(-0.4, -0.4, 0.0), DVec3::new(0.4, 0.4, 0.4)), m, None);
    s.sky([1.0; 3]);
    s.seen(DVec3::new(2.0, 2.5, 3.0), DVec3::ZERO, 20.0, AIR)
}

/// Index 0 + 1e6 i: reflects everything.
fn metal(alpha: f32) -> Model {
    Model::RoughConductor {
        distribution: Distribution::Ggx,
        alpha_u: alpha,
        alpha_v: alpha,
        eta: Spectrum::BLACK,
        k: Spectrum::gray(1e6),
        reflectance: Source::Constant(Spectrum::ONE),
    }
}
fn glass() -> Model {
    Model::RoughDielectric {
        distribution: Distribution::Ggx,
        alpha: (1e-4, 1e-4),
        int_ior: 1.5,
        ext_ior: 1.0,
        reflectance: Source::Constant(Spectrum::ONE),
        transmittance: Source::Constant(Spectrum::ONE),
    }
}
/// Not to its silhouette, where no microfacet model is lossless.
fn sharp(u: Units, model: Model) -> Made {
    let mut s = Site::new(u);
    let m = s.model(model);
    s.ball(DVec3::ZERO, 1.0, m, None);
    s.sky([1.0; 3]);
    s.seen(DVec3::new(-3.0, 0.0, 0.0), DVec3::ZERO, 20.0, AIR)
}

fn lamp_in_floor(u: Units) -> Made {
    let mut s = Site::new(u);
    let (m, sheet) = (s.diffuse([0.8; 3]), s.sheet([0.6; 3]));
    s.mesh(square(DVec3::ZERO, 1.0), m, None);
    s.mesh(square(DVec3::ZERO, 0.3), m, Some([5.0, 4.0, 3.0]));
    // On the floor itself, and on the edge of a sheet that stands on it.
    s.point(DVec3::new(0.5, 0.5, 0.0), [0.1; 3]);
    s.point(DVec3::new(0.6, 0.0, 0.5), [0.1; 3]);
    let upright = DAffine3::from_translation(DVec3::new(0.6, 0.0, 0.25)) * DAffine3::from_rotation_y(0.5 * PI);
    s.mesh(TriangleMesh::rectangle(&(upright * DAffine3::from_scale(DVec3::new(0.25, 0.5, 1.0)))), sheet, None);
    s.seen(DVec3::new(-1.5, -1.0, 1.2), DVec3::ZERO, 60.0, AIR)
}

fn all_lights(u: Units) -> Made {
    let mut s = Site::new(u);
    let (m, metal) = (s.diffuse([0.6, 0.5, 0.4]), s.model(metal(0.3)));
    s.mesh(square(DVec3::ZERO, 2.0), m, None);
    s.ball(DVec3::new(0.5, 0.3, 0.4), 0.4, metal, None);
    s.ball(DVec3::new(-0.5, -0.3, 0.9), 0.1, m, Some([4.0, 3.0, 2.0]));
    s.point(DVec3::new(0.2, -0.6, 0.8), [0.2, 0.3, 0.4]);
    s.sky([0.2, 0.3, 0.5]);
    s.sun(DVec3::new(0.3, 0.5, -1.0), [1.0, 0.9, 0.8]);
    s.seen(DVec3::new(-1.5, -1.0, 1.2), DVec3::new(0.0, 0.0, 0.2), 60.0, AIR)
}
