//! What a photon or a beam gives to a receiver that is near enough.

use crate::{Beam, Photon};
use manylight_framework::{Claim, Connection, Kernel, Pair, Promise};
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Edge, Scatter, Scene, Span, Vertex};
use std::f32::consts::PI;

/// Density estimates with a constant kernel, as `crate` has them. Exact, given the photons: that these are spread is theirs to claim.
/// (What it has to say of shadows is meaningless: nothing stands between a photon and where it is.)
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimate;

impl Promise for Estimate {
    fn claim(&self) -> Claim {
        Claim::EXACT
    }
}

/// Normals of a surface that is taken for one with that of a photon make at most 60 degrees.
const ALIKE: f32 = 0.5;
/// Beams that make a smaller angle with the camera's ray than this have no crossing that can be told. (Sine.)
const PARALLEL: f64 = 1e-6;

fn gives(value: Spectrum, at: &Vertex) -> Option<Connection> {
    let here = Edge::Between(at.end(), at.end());
    (!value.is_black()).then_some(Connection { value, edge: here, pair: Pair { g: 0.0, lobes: None } })
}

/// Phi f / (pi R^2) on a surface, Phi f / (4/3 pi R^3) in a medium, over sigma_s there, which a receiver's point of a medium is
/// weighed by: a photon's flux has been scattered already.
impl Kernel<Vertex, Photon> for Estimate {
    fn connect(&self, scene: &Scene, x: &Vertex, l: &Photon, _: &mut Stream) -> Option<Connection> {
        let r2 = l.radius * l.radius;
        if !((l.vertex.p - x.p).length_squared() < r2) {
            return None;
        }
        match (&x.scatter, &l.vertex.scatter) {
            (Scatter::Surface(here), Scatter::Surface(there)) => {
                let cosine = here.ng.dot(there.wi).abs();
                if !(here.ng.dot(there.ng) > ALIKE && cosine > 0.0) {
                    return None;
                }
                // The flux is one per area across the geometric normal.
                gives(x.eval(there.wi) * l.flux * (1.0 / (PI * r2 * cosine)), x)
            }
            // A scene file may name one fog many times: which medium a photon is in says nothing.
            (Scatter::Medium(here), Scatter::Medium(there)) => {
                let sigma = scene.medium(here.medium)?.scattering(x.p);
                let per_scattering = sigma.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 });
                let volume = 4.0 / 3.0 * PI * r2 * l.radius;
                let f = there.phase.eval(there.wi, here.wi) / volume;
                gives(here.scattering * per_scattering * l.flux * f, x)
            }
            _ => None,
        }
    }
}

/// The beam radiance estimate: Phi f T(u) / (pi R^2), u being the foot of the photon on the ray.
impl Kernel<Span, Photon> for Estimate {
    fn connect(&self, scene: &Scene, r: &Span, l: &Photon, s: &mut Stream) -> Option<Connection> {
        let Scatter::Medium(there) = &l.vertex.scatter else { return None };
        let to = l.vertex.p - r.ray.origin;
        let u = to.dot(r.ray.dir);
        let r2 = l.radius * l.radius;
        if !(u >= 0.0 && u <= r.ray.t_max && (to - r.ray.dir * u).length_squared() < r2) {
            return None;
        }
        let through = scene.medium(r.ray.medium)?.transmittance(&r.ray, 0.0, u, s);
        gives(l.flux * through * (there.phase.eval(there.wi, -r.ray.dir) / (PI * r2)), &l.vertex)
    }
}

/// Surfaces have photons of their own.
impl Kernel<Vertex, Beam> for Estimate {
    fn connect(&self, _: &Scene, _: &Vertex, _: &Beam, _: &mut Stream) -> Option<Connection> {
        None
    }
}

/// Phi sigma_s(v) f T(v) T(u) / (2 R sin theta) where the two lines pass each other nearer than R, both within their pieces.
impl Kernel<Span, Beam> for Estimate {
    fn connect(&self, scene: &Scene, r: &Span, l: &Beam, s: &mut Stream) -> Option<Connection> {
        let (a, b) = (r.ray.dir.as_dvec3().normalize(), l.span.ray.dir.as_dvec3().normalize());
        let to = l.span.ray.origin.as_dvec3() - r.ray.origin.as_dvec3();
        let across = a.cross(b);
        let sine = across.length();
        if !(sine > PARALLEL && (to.dot(across) / sine).abs() < f64::from(l.radius)) {
            return None;
        }
        // to + v b - u a is parallel to `across`.
        let (u, v) = (to.cross(b).dot(across) / (sine * sine), to.cross(a).dot(across) / (sine * sine));
        let inside = u >= 0.0 && u <= f64::from(r.ray.t_max) && v >= f64::from(l.piece.0) && v < f64::from(l.piece.1);
        if !inside {
            return None;
        }
        let (here, there) = (scene.medium(r.ray.medium)?, scene.medium(l.span.ray.medium)?);
        let (u, v) = (u as f32, v as f32);
        let y = l.span.at(v, there.scattering(l.span.ray.at(v)));
        let through = l.arrives(there, v, s) * here.transmittance(&r.ray, 0.0, u, s);
        let width = 2.0 * f64::from(l.radius) * sine;
        gives(y.lobe_at(-r.ray.dir) * l.flux * through * (1.0 / width) as f32, &y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_bsdf::Diffuse;
    use manylight_framework::{Bounding, Gather, LightSet, Pair, Plan, Probe};
    use manylight_geometry::Surface;
    use manylight_math::{DAffine3, Frame, MediumId, Ray, Vec2, Vec3};
    use manylight_sampling::Purpose;
    use manylight_scene::{Camera, HenyeyGreenstein, Homogeneous, MediumPoint, Mode, SurfacePoint};

    /// Nothing is taken away.
    struct Whole;
    impl Promise for Whole {
        fn claim(&self) -> Claim {
            Claim::EXACT
        }
    }
    impl Bounding for Whole {
        fn keep(&self, _: &Pair) -> f32 {
            1.0
        }
    }
    const SIGMA: f32 = 1e-6;
    fn fog() -> (Scene, MediumId) {
        let mut b = Scene::builder();
        b.camera(Camera::perspective(DAffine3::IDENTITY, 45.0, (1, 1)).unwrap());
        let sigma = Spectrum::gray(SIGMA);
        let id = b.medium(Homogeneous::new(sigma, sigma, HenyeyGreenstein::ISOTROPIC).unwrap().into());
        (b.build().unwrap(), id)
    }
    /// What all lights give to a receiver.
    fn sum<R, L>(scene: &Scene, receiver: &R, lights: Vec<L>) -> f64
    where
        L: crate::Near,
        Estimate: Kernel<R, L>,
        R: manylight_framework::Stretch,
    {
        struct Nothing;
        impl manylight_framework::Occlusion for Nothing {
            fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
                panic!("photons have no shadows")
            }
            fn extent(&self) -> manylight_math::Aabb {
                manylight_math::Aabb::EMPTY
            }
        }
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        let set = crate::Nearby.build(lights, &Nothing, &mut s).unwrap();
        let mut probe = Probe::default();
        let kernel = &Estimate;
        let mut ask =
            Gather { scene, receiver, kernel, bounding: &Whole, edges_left: 9, edges_least: 0, probe: &mut probe };
        let sum = f64::from(set.radiance(&mut ask, &mut s).mean());
        assert_eq!(probe.shadow_rays, 0);
        sum
    }
    /// Lattice points of [-1, 1]^2, a cell's area apart, off the middle.
    fn lattice(n: i32) -> impl Iterator<Item = (f32, f32)> {
        let at = move |i: i32| (i as f32 + 0.37) / n as f32;
        (-n..n).flat_map(move |i| (-n..n).map(move |j| (at(i), at(j))))
    }
    const N: i32 = 40;
    const CELL: f32 = 1.0 / N as f32;
    /// e^x has mean 1 + R^2 / (2 m + 4) + .. over a ball of m dimensions: sinh(R) / R, 2 I_1(R) / R, 3 (R cosh R - sinh R) / R^3.
    fn means(r: f64) -> [f64; 3] {
        // 2 I_1(R) / R = sum_k (R / 2)^(2 k) / (k! (k + 1)!)
        let (mut term, mut disc) = (1.0, 0.0);
        for k in 1..30 {
            disc += term;
            term *= (0.5 * r).powi(2) / f64::from(k * (k + 1));
        }
        [r.sinh() / r, disc, 3.0 * (r * r.cosh() - r.sinh()) / r.powi(3)]
    }
    fn in_fog(medium: MediumId, p: Vec3, wi: Vec3) -> Vertex {
        let phase = HenyeyGreenstein::ISOTROPIC;
        Vertex { p, scatter: Scatter::Medium(MediumPoint { wi, scattering: Spectrum::ONE, phase, medium }) }
    }
    const ISOTROPIC: f64 = 0.25 / std::f64::consts::PI;

    #[test]
    fn estimates_are_means_over_balls_discs_and_widths_and_so_their_bias_is_of_second_order() {
        let (scene, medium) = fog();
        let span = |length: f32| Span {
            ray: Ray { t_max: length, ..Ray::new(Vec3::Z * -0.5 * length, Vec3::Z) }.within(medium),
            scattering_max: Spectrum::gray(SIGMA),
            phase: HenyeyGreenstein::ISOTROPIC,
        };
        for radius in [1.0f32, 0.5, 0.25] {
            let truth = means(f64::from(radius));
            let near = |got: f64, truth: f64, what: &str| {
                println!("{what}, R = {radius}: {got}, mean of e^x {truth}");
                assert!((got / truth - 1.0).abs() < 4e-3, "{what}, R = {radius}: {got} {truth}");
                // And it tells the mean from what is in the middle, or from that of another dimension.
                assert!(radius < 1.0 || means(1.0).iter().all(|m| *m == truth || (got / m - 1.0).abs() > 8e-3));
            };
            // Photons of flux density e^x.
            let layers: Vec<f32> = (-N..N).map(|k| radius * (k as f32 + 0.37) * CELL).collect();
            let volume = (radius * CELL).powi(3);
            let ball = layers.iter().flat_map(|z| lattice(N).map(move |(x, y)| Vec3::new(radius * x, radius * y, *z)));
            let photon = |p: Vec3, flux: f32| Photon {
                vertex: in_fog(medium, p, Vec3::X),
                flux: Spectrum::gray(flux * p.x.exp()),
                edges: 1,
                radius,
            };
            let points: Vec<_> = ball.map(|p| photon(p, volume)).collect();
            let x = in_fog(medium, Vec3::ZERO, Vec3::Y);
            near(sum(&scene, &x, points) * f64::from(SIGMA) / ISOTROPIC, truth[2], "a ball");
            // Along a ray through all of them, of length one.
            let flat = |z: f32| lattice(N).map(move |(x, y)| Vec3::new(radius * x, radius * y, z));
            let disc: Vec<_> = flat(0.1).map(|p| photon(p, (radius * CELL).powi(2))).collect();
            near(sum(&scene, &span(1.0), disc) / ISOTROPIC, truth[1], "a disc across the ray");
            // Beams that cross it at an angle, the density of whose lines across is e^x.
            let beams: Vec<_> = (-N..N)
                .map(|i| {
                    let x = radius * (i as f32 + 0.37) * CELL;
                    let dir = Vec3::new(0.0, 0.8, 0.6);
                    let ray = Ray { t_max: 2.0, ..Ray::new(Vec3::new(x, 0.0, 0.0) - dir, dir) }.within(medium);
                    let span = Span { ray, ..span(1.0) };
                    let flux = Spectrum::gray(radius * CELL * x.exp() * 0.8 / SIGMA);
                    let channels = Some([1.0 / 3.0; 3]);
                    // In two pieces that meet where the ray passes: one of them counts.
                    [(0.0, 1.0), (1.0, 2.0)].map(|piece| Beam { span, piece, flux, edges: 1, channels, radius })
                })
                .collect::<Vec<_>>()
                .concat();
            near(sum(&scene, &span(1.0), beams) / ISOTROPIC, truth[0], "a width");
            // On a surface.
            let white: manylight_bsdf::Bsdf = Diffuse::new(Spectrum::ONE).into();
            let on = |p: Vec3, wi: Vec3, mode: Mode| {
                let surface = Surface { p, error: 1e-6, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::ZERO, dpdu: Vec3::X };
                let point = SurfacePoint::new(&surface, Frame::around(Vec3::Z), wi, white, mode);
                Vertex { p, scatter: Scatter::Surface(point) }
            };
            let down = Vec3::new(0.6, 0.0, 0.8);
            let disc: Vec<_> = flat(0.0)
                .map(|p| Photon { vertex: on(p, down, Mode::Importance), ..photon(p, (radius * CELL).powi(2)) })
                .collect();
            let x = on(Vec3::ZERO, Vec3::Z, Mode::Radiance);
            near(sum(&scene, &x, disc) * std::f64::consts::PI, truth[1], "a disc on a surface");
        }
    }
}
