//! Multiple importance sampling over all ways to make a path.

use crate::subpath::{Node, emission_density, per_area, scattering_density};
use manylight_scene::Vertex;

/// How the strategies are put together. (s, t): s vertices from the light, t from the eye, the pinhole included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// By the balance heuristic: p_s / sum p_i (Veach and Guibas 1995).
    Balance,
    /// By the power heuristic: p_s^2 / sum p_i^2.
    Power,
    /// One strategy alone, unweighted: all paths that it can make.
    Alone(u32, u32),
    /// t = 1 for all paths of two edges and more, unweighted; emission is seen directly.
    LightTracing,
}

/// The densities of one whole path z_0 .. z_n, light to eye, z_n being the pinhole.
pub(crate) struct Ways {
    /// Of z_i, made from z_{i-1}.
    pub forward: Vec<f64>,
    /// Of z_i, made from z_{i+1}.
    pub backward: Vec<f64>,
    /// The path passes z_i by a delta lobe.
    pub delta: Vec<bool>,
    /// Can eye paths hit the light?
    pub hit: bool,
}

impl Ways {
    /// Of the path that joins a light subpath (its nodes that are used) with an eye subpath. `light` and `eye` are the densities
    /// of z_0 as an emitter's point, and of the first vertex that the camera sees.
    pub fn new(y: &[Node], x: &[Node], first: f64, hit: bool, camera: impl Fn(&Vertex) -> f64) -> Self {
        let (s, t) = (y.len(), x.len());
        let vertex = |i: usize| if i < s { &y[i].vertex } else { &x[s + t - 1 - i].vertex };
        let n = s + t - 1;
        let mut ways = Ways { forward: vec![1.0; n + 1], backward: vec![1.0; n + 1], delta: vec![false; n + 1], hit };
        for i in 0..=n {
            // Whatever is within one subpath is known; the joint's neighbours are not, since their neighbours are new.
            ways.forward[i] = match i {
                0 => first,
                _ if i < s => y[i].ahead,
                1 => {
                    emission_density(vertex(0), crate::subpath::direction(vertex(0), vertex(1)))
                        * per_area(vertex(0), vertex(1))
                }
                _ if i == n => 1.0,
                _ if i <= s + 1 => scattering_density(vertex(i - 2), vertex(i - 1), vertex(i)),
                _ => x[n - i].back,
            };
            ways.backward[i] = match i {
                _ if i == n => 1.0,
                _ if i >= s => x[n - i].ahead,
                _ if i + 1 == n => camera(vertex(i)),
                _ if i + 2 >= s => scattering_density(vertex(i + 2), vertex(i + 1), vertex(i)),
                _ => y[i].back,
            };
            ways.delta[i] = if i < s { y[i].delta && i + 1 < s } else { x[n - i].delta && i > s };
        }
        ways
    }
    /// Can the strategy with s light vertices make it?
    fn possible(&self, s: usize) -> bool {
        let n = self.forward.len() - 1;
        match s {
            0 => self.hit,
            // The emission that the camera sees directly is left to s = 0.
            1 if n == 1 => false,
            _ => s <= n && !self.delta[s - 1] && !self.delta[s],
        }
    }
    /// Weight of the strategy with s light vertices, with exponent `beta`.
    pub fn weight(&self, s: usize, beta: i32) -> f64 {
        let n = self.forward.len() - 1;
        let (mut sum, mut ratio) = (1.0, 1.0f64);
        for i in (0..s).rev() {
            // From i + 1 light vertices to i: z_i is made from the eye.
            ratio = known(ratio * (self.backward[i] / self.forward[i]));
            if self.possible(i) {
                sum += ratio.powi(beta);
            }
        }
        ratio = 1.0;
        for i in s + 1..=n {
            // From i - 1 to i: z_{i-1} is made from the light.
            ratio = known(ratio * (self.forward[i - 1] / self.backward[i - 1]));
            if self.possible(i) {
                sum += ratio.powi(beta);
            }
        }
        1.0 / sum
    }
}

/// A ratio of densities, or zero where it has no value: two vertices at one place (a light in the surface that it shines on) are made
/// by a walk from the one to the other alone.
fn known(ratio: f64) -> f64 {
    if ratio.is_nan() { 0.0 } else { ratio }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subpath::{direction, walk};
    use manylight_framework::Probe;
    use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
    use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
    use manylight_sampling::{Purpose, Stream};
    use manylight_scene::{Camera, EmitterPoint, Material, Mode, Model, Scatter, Scene, Shape, Source};

    /// A diffuse ball in a glossy room with an emitting wall.
    fn scene() -> Scene {
        let mut b = Scene::builder();
        let grey = b.material(Material::two_sided(
            "grey",
            Model::Diffuse { reflectance: Source::Constant(Spectrum::gray(0.9)) },
        ));
        let metal = b.material(Material::two_sided(
            "metal",
            Model::RoughConductor {
                distribution: manylight_bsdf::Distribution::Ggx,
                alpha_u: 0.4,
                alpha_v: 0.4,
                eta: Spectrum::gray(0.2),
                k: Spectrum::gray(3.9),
                reflectance: Source::Constant(Spectrum::ONE),
            },
        ));
        let mut add = |geometry, material, radiance: Option<Spectrum>| {
            b.shape(Shape { name: "s".into(), geometry, material, radiance: radiance.map(Source::Constant) });
        };
        let mut room = TriangleMesh::cube(&DAffine3::from_scale(DVec3::splat(2.0)));
        room.flip_normals();
        add(ShapeGeometry::Mesh(room), metal, None);
        add(ShapeGeometry::Sphere(Sphere::new(Vec3::new(0.3, 0.1, 0.2), 0.7)), grey, None);
        let lamp = TriangleMesh::rectangle(&DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.6),
            Default::default(),
            DVec3::new(0.0, 0.0, -1.9),
        ));
        add(ShapeGeometry::Mesh(lamp), grey, Some(Spectrum::ONE));
        b.camera(Camera::perspective(DAffine3::from_translation(DVec3::new(0.2, 0.0, -1.5)), 60.0, (8, 8)).unwrap());
        b.build().unwrap()
    }

    #[test]
    fn densities_are_those_of_an_oracle_and_weights_of_all_strategies_sum_to_one() {
        let scene = scene();
        let lens = crate::splat::Lens::new(*scene.camera(), scene.filter());
        let mut joined = 0;
        for i in 0..400 {
            let mut s = Stream::new(1, [0, i, 0], Purpose::TEST);
            let mut probe = Probe::default();
            let ray = scene.camera().ray(s.next_2d() * 8.0);
            let pinhole = Vertex { p: ray.origin, scatter: Scatter::Emitter(EmitterPoint::Isotropic) };
            let mut x = vec![Node::new(pinhole, Spectrum::ONE, 1.0)];
            walk(
                &scene,
                &mut x,
                ray,
                Spectrum::ONE,
                |_, v| lens.density(v),
                (4, 99),
                Mode::Radiance,
                &mut probe,
                &mut s,
            );
            let emission = scene.sample_emission(&mut s).unwrap();
            let mut y =
                vec![Node::new(emission.start.vertex, emission.start.flux, emission.start.density.unwrap() as f64)];
            let first =
                |a: &Node, b: &Vertex| emission_density(&a.vertex, direction(&a.vertex, b)) * per_area(&a.vertex, b);
            walk(&scene, &mut y, emission.ray, emission.flux, first, (4, 99), Mode::Importance, &mut probe, &mut s);
            if x.len() < 4 || y.len() < 4 {
                continue;
            }
            joined += 1;
            for (light, eye) in [(1, 4), (2, 3), (3, 2), (4, 1), (4, 4), (2, 2)] {
                let ways = Ways::new(&y[..light], &x[..eye], y[0].ahead, true, |v| lens.density(v));
                let path: Vec<Vertex> =
                    y[..light].iter().map(|n| n.vertex).chain(x[..eye].iter().rev().map(|n| n.vertex)).collect();
                let n = path.len() - 1;
                for i in 2..n {
                    let fresh = scattering_density(&path[i - 2], &path[i - 1], &path[i]);
                    assert!(
                        (ways.forward[i] - fresh).abs() <= 2e-3 * fresh.max(1e-6),
                        "forward {i}: {} {fresh}",
                        ways.forward[i]
                    );
                }
                for i in 0..n - 1 {
                    let fresh = scattering_density(&path[i + 2], &path[i + 1], &path[i]);
                    assert!(
                        (ways.backward[i] - fresh).abs() <= 2e-3 * fresh.max(1e-6),
                        "backward {i}: {} {fresh}",
                        ways.backward[i]
                    );
                }
                // Not all ways may be open (a connection may lie behind a surface): count those of positive density.
                for beta in [1, 2] {
                    let sum: f64 = (0..=n)
                        .filter(|&s| ways.possible(s))
                        .map(|s| ways.weight(s, beta))
                        .filter(|w| w.is_finite())
                        .sum();
                    let dead = ways.forward[..n].iter().chain(&ways.backward[..n]).any(|p| !(*p > 0.0));
                    assert!(dead || (sum - 1.0).abs() < 1e-9, "({light}, {eye}): {sum}");
                }
            }
        }
        assert!(joined > 100, "{joined}");
    }
}
