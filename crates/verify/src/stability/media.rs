//! Media built to break things.

use super::case::{Case, Truth};
use super::site::{Made, Site, Units, cuboid, film_mean, rgb, room, square};
use manylight_geometry::TriangleMesh;
use manylight_math::{DAffine3, DVec3, MediumId};
use manylight_scene::{Glow, Grid, HenyeyGreenstein, Heterogeneous, Interpolation, Medium, Volume};
use std::f64::consts::PI;

const AIR: MediumId = MediumId::VACUUM;
const FROM: DVec3 = DVec3::new(0.2, 0.1, 0.3);
const TO: DVec3 = DVec3::new(0.1, 0.0, -1.0);
const AWAY: DVec3 = DVec3::new(1.0, 0.5, 1.5);

pub(super) const CASES: &[Case] = &[
    Case::new("thin-fog", "fog of an optical depth of 1e-6 around a light, black walls", thin_fog, airlight),
    Case::new("deep-fog", "a pit of fog 1e4 mean free paths deep under an even light", deep_fog, deep_fog_truth),
    Case::new(
        "forward",
        "fog that absorbs nothing, g = 0.999, in an even light",
        |u| lossless(u, [2.0; 3], 0.999),
        one,
    ),
    Case::new(
        "backward",
        "fog that absorbs nothing, g = -0.999, in an even light",
        |u| lossless(u, [2.0; 3], -0.999),
        one,
    ),
    Case::new(
        "colours",
        "fog that absorbs nothing, extinctions of 0, 1 and 30 a radius",
        |u| lossless(u, [0.0, 1.0, 30.0], 0.0),
        one,
    ),
    Case::new("nested", "three boxes of fog, one in another, that share a face, in an even light", nested, one),
    Case::new("thin-fire", "a box of fire of an optical depth of 1e-6", |u| fire(u, 0.5e-6, 0.5), thin_fire),
    Case::new(
        "deep-fire",
        "a box of fire of an optical depth of 1e4",
        |u| fire(u, 0.5e4, 0.0),
        |_| Some([2e-4, 1e-4, 0.0]),
    ),
];

fn one(edges: u32) -> Truth {
    (edges == u32::MAX).then_some([1.0; 3])
}

fn thin_fog(u: Units) -> Made {
    let mut s = Site::new(u);
    let black = s.diffuse([0.0; 3]);
    let fog = s.fog([0.5e-6; 3], [0.5e-6; 3], 0.0)?;
    s.hollow(1.0, black, None);
    s.point(DVec3::ZERO, [1.0; 3]);
    s.seen(FROM, AWAY, 40.0, fog)
}
/// int sigma_s I / (4 pi r^2) dt = sigma_s I / (4 pi a) (angle under which the light sees the ray, which passes it at a distance a).
fn airlight(edges: u32) -> Truth {
    let mean = film_mean(FROM, AWAY, 40.0, |w| {
        let b = FROM.dot(w);
        let end = FROM + w * ((b * b + 1.0 - FROM.length_squared()).sqrt() - b);
        0.5e-6 / (4.0 * PI * FROM.cross(w).length()) * FROM.angle_between(end)
    });
    Some(if edges > 1 { [mean; 3] } else { [0.0; 3] })
}

/// Half width of the pit in mean free paths: light that gets to its walls from what is seen, and back, is 1e-4 of it.
const PIT: f64 = 8.0;
const PIT_FROM: DVec3 = DVec3::new(0.0, 0.0, 0.5);
const PIT_TO: DVec3 = DVec3::new(0.1, 0.05, 0.0);

fn deep_fog(u: Units) -> Made {
    let mut s = Site::new(u);
    let black = s.diffuse([0.0; 3]);
    let fog = s.fog([0.5; 3], [1.0; 3], 0.0)?;
    let corner = DVec3::new(PIT, PIT, 0.0);
    // Rooms without the walls between them.
    let open = |mesh: TriangleMesh, z: f32| {
        let keep = |t: &[u32; 3]| t.iter().any(|v| mesh.positions[*v as usize].z != z);
        TriangleMesh { triangles: mesh.triangles.iter().copied().filter(keep).collect(), ..mesh.clone() }
    };
    s.mesh(open(room(-corner, corner + DVec3::Z), 0.0), black, Some([1.0; 3]));
    s.mesh(open(room(-corner - DVec3::Z * 1e4, corner), 0.0), black, None);
    s.skin(square(DVec3::ZERO, PIT), fog, AIR);
    s.seen(PIT_FROM, PIT_TO, 50.0, AIR)
}
/// Under an even light of radiance 1 an endless depth shows 1 - sqrt(1 - a) H(mu), with Chandrasekhar's H of the albedo a; scattered
/// once, a / 2 (1 - mu ln(1 + 1 / mu)).
fn deep_fog_truth(edges: u32) -> Truth {
    const ALBEDO: f64 = 0.5;
    let value = match edges {
        1 => 0.0,
        2 => film_mean(PIT_FROM, PIT_TO, 50.0, |w| 0.5 * ALBEDO * (1.0 + w.z * (1.0 - 1.0 / w.z).ln())),
        u32::MAX => {
            let h = chandrasekhar(ALBEDO);
            film_mean(PIT_FROM, PIT_TO, 50.0, |w| 1.0 - (1.0 - ALBEDO).sqrt() * h(-w.z))
        }
        _ => return None,
    };
    Some([value; 3])
}

/// H(mu) by 1 / H(mu) = sqrt(1 - a) + a / 2 int_0^1 m H(m) / (m + mu) dm, at midpoints (Chandrasekhar 1950, Radiative transfer, ch. 5).
fn chandrasekhar(albedo: f64) -> impl Fn(f64) -> f64 {
    const POINTS: usize = 200;
    let at = |i: usize| (i as f64 + 0.5) / POINTS as f64;
    let next = move |h: &[f64], mu: f64| {
        let sum: f64 = h.iter().enumerate().map(|(i, h)| at(i) * h / (at(i) + mu)).sum();
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * sum / POINTS as f64)
    };
    let mut h = vec![1.0; POINTS];
    for _ in 0..40 {
        h = (0..POINTS).map(|i| next(&h, at(i))).collect();
    }
    move |mu| next(&h, mu)
}

/// What neither absorbs nor emits does not change an even light.
fn lossless(u: Units, density: [f64; 3], g: f64) -> Made {
    let mut s = Site::new(u);
    let black = s.diffuse([0.0; 3]);
    let fog = s.fog(density, density, g)?;
    s.hollow(1.0, black, Some([1.0; 3]));
    s.seen(FROM, TO, 70.0, fog)
}

fn nested(u: Units) -> Made {
    let mut s = Site::new(u);
    let black = s.diffuse([0.0; 3]);
    s.hollow(1.5, black, Some([1.0; 3]));
    let fogs = [(1.0, 0.8), (5.0, 0.0), (0.2, -0.5)];
    let [a, b, c] = fogs.map(|(density, g)| s.fog([density; 3], [density; 3], g));
    let (a, b, c) = (a?, b?, c?);
    // `c` lies in `a` and ends where `a` does, and `b` begins there.
    s.skin(cuboid(DVec3::splat(-0.5), DVec3::splat(0.5)), a, AIR);
    s.skin(cuboid(DVec3::new(0.5, -0.5, -0.5), DVec3::new(1.0, 0.5, 0.5)), b, AIR);
    s.skin(cuboid(DVec3::new(0.0, -0.5, -0.5), DVec3::new(0.5, 0.5, 0.5)), c, a);
    // Along the faces, not across them only.
    s.seen(DVec3::new(0.5, 0.0, 1.2), DVec3::new(0.5, 0.0, 0.0), 60.0, AIR)
}

const FIRE_FROM: DVec3 = DVec3::new(0.05, 0.1, 3.0);
const FIRE_TO: DVec3 = DVec3::ZERO;
const GLOW: [f64; 3] = [1.0, 0.5, 0.0];

/// A box [-1, 1]^3 of one density and one emission, as grids.
fn fire(u: Units, extinction: f64, albedo: f64) -> Made {
    let mut s = Site::new(u);
    let (metre, watt) = (s.metre(), s.watt());
    let place = DAffine3::from_scale(DVec3::splat(2.0 * metre)) * DAffine3::from_translation(DVec3::splat(-0.5));
    let grid = |value: [f64; 3]| {
        Grid::new([4; 3], vec![rgb(value); 64], &place, Interpolation::Trilinear).map_err(|e| e.to_string())
    };
    let density = (extinction / metre) as f32;
    let albedo = Volume::Constant(rgb([albedo; 3]));
    let smoke = Heterogeneous::new(grid([1.0; 3])?, density, albedo, HenyeyGreenstein::ISOTROPIC);
    let glow = Glow::new(grid(GLOW)?, (watt / metre) as f32);
    let smoke = smoke.map_err(|e| e.to_string())?.emitting(glow.map_err(|e| e.to_string())?);
    let fire = s.b.medium(Medium::from(smoke));
    s.skin(cuboid(DVec3::splat(-1.0), DVec3::splat(1.0)), fire, AIR);
    s.seen(FIRE_FROM, FIRE_TO, 15.0, AIR)
}
/// Emission times the length of the way, which enters and leaves by the faces across it.
fn thin_fire(_: u32) -> Truth {
    let length = film_mean(FIRE_FROM, FIRE_TO, 15.0, |w| -2.0 / w.z);
    Some(GLOW.map(|j| j * length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_h_is_what_chandrasekhar_says() {
        // (2 / a) (1 - sqrt(1 - a)), ch. 5, eq. 10 there; and H(1) for a = 1/2 from his table XI.
        for albedo in [0.2f64, 0.5, 0.9] {
            let h = chandrasekhar(albedo);
            let integral: f64 = (0..1000).map(|i| h((f64::from(i) + 0.5) / 1000.0)).sum::<f64>() / 1000.0;
            assert!((integral - 2.0 / albedo * (1.0 - (1.0 - albedo).sqrt())).abs() < 1e-4, "{albedo}: {integral}");
        }
    }
    #[test]
    fn light_in_the_air_is_what_a_fine_sum_along_the_ray_gives() {
        // Off the axis, which leads through the light.
        let w = (AWAY - FROM + DVec3::new(0.0, 0.3, -0.1)).normalize();
        let b = FROM.dot(w);
        let length = (b * b + 1.0 - FROM.length_squared()).sqrt() - b;
        let (n, mut sum) = (100_000, 0.0);
        for i in 0..n {
            let t = length * (f64::from(i) + 0.5) / f64::from(n);
            sum += 0.5e-6 / (4.0 * PI * (FROM + w * t).length_squared()) * length / f64::from(n);
        }
        let closed = 0.5e-6 / (4.0 * PI * FROM.cross(w).length()) * FROM.angle_between(FROM + w * length);
        assert!((closed / sum - 1.0).abs() < 1e-6, "{closed} {sum}");
    }
}
