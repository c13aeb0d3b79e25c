//! Transport from a sphere to a receiver.

use crate::Vsl;
use manylight_bsdf::Bsdf;
use manylight_framework::{Claim, Connection, Kernel, Pair, Promise};
use manylight_math::{Aabb, Frame, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::{Edge, Scatter, Scene, Vertex};
use manylight_vpl::connect_vertices;
use std::f32::consts::TAU;

/// Directions of the cone, and how they are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Uniformly in the cone.
    Cone,
    /// By the receiver's BSDF; what falls outside the cone gives nothing.
    Receiver,
    /// By the light's BSDF, likewise.
    Light,
    /// All three, combined by the balance heuristic. A lobe that is wide against the cone is left out.
    Mis,
}

/// Connects vertices to virtual spherical lights: an estimate whose mean is the integral over the cone, times the visibility of the
/// sphere's middle. A bound does not touch it (`Pair::g` is zero), so that a compensation of one would bring what is not missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereKernel {
    /// How directions are drawn.
    pub sampling: Sampling,
    /// Directions of each kind where the cone is the hemisphere; fewer in narrower cones, in proportion to their solid angle, but
    /// at least one, and at most sixteen.
    pub samples: f32,
    /// Are there lights without radius among them, on emitters? They are point lights, whose variance is infinite.
    pub points_too: bool,
}

/// Directions of a kind at most.
const MOST: f32 = 16.0;

impl Default for SphereKernel {
    fn default() -> Self {
        SphereKernel { sampling: Sampling::Mis, samples: 4.0, points_too: false }
    }
}

/// 2 (1 - cos A) / r^2 of the cone's half angle A, which a constant integrand is multiplied by: the sphere's 1 / d^2. Written
/// without the cancellation of 1 - cos A. [1/m^2]
pub fn cone_kernel(d: f32, r: f32) -> f32 {
    if !(d > r) {
        return 2.0 / (r * r);
    }
    let s = r / d;
    2.0 / (d * d * (1.0 + (1.0 - s * s).sqrt()))
}

/// 1 - cos A.
fn versine(d: f32, r: f32) -> f32 {
    if !(d > r) {
        return 1.0;
    }
    let s2 = (r / d) * (r / d);
    s2 / (1.0 + (1.0 - s2).sqrt())
}

/// A cone of directions about an axis.
struct Cone {
    axis: Vec3,
    versine: f32,
}

impl Cone {
    fn solid_angle(&self) -> f32 {
        TAU * self.versine
    }
    fn holds(&self, w: Vec3) -> bool {
        // |w - axis|^2 = 2 (1 - cos), exact for the narrowest cones.
        (w - self.axis).length_squared() <= 2.0 * self.versine
    }
    fn sample(&self, frame: &Frame, s: &mut Stream) -> Vec3 {
        let u = s.next_2d();
        let down = u.x * self.versine;
        let sin = (down * (2.0 - down)).max(0.0).sqrt();
        let (y, x) = (TAU * u.y).sin_cos();
        frame.to_world(Vec3::new(sin * x, sin * y, 1.0 - down)).normalize()
    }
}

/// Does `w` leave to the other side of the surface than the path came from?
fn behind(v: &Vertex, w: Vec3) -> bool {
    match &v.scatter {
        Scatter::Surface(p) => p.bsdf.is_one_sided() && p.ng.dot(w) * p.ng.dot(p.wi) < 0.0,
        _ => false,
    }
}

/// How many directions of each kind.
#[derive(Clone, Copy)]
struct Counts {
    cone: u32,
    receiver: u32,
    light: u32,
}

impl SphereKernel {
    fn counts(&self, x: &Vertex, light: &Vsl, cone: &Cone) -> Counts {
        let n = (self.samples * cone.versine).ceil().clamp(1.0, MOST) as u32;
        let counts = Counts { cone: 0, receiver: 0, light: 0 };
        match self.sampling {
            Sampling::Cone => Counts { cone: n, ..counts },
            Sampling::Receiver => Counts { receiver: n, ..counts },
            Sampling::Light => Counts { light: n, ..counts },
            Sampling::Mis => {
                let with = |narrow: bool| if narrow { n } else { 0 };
                Counts { cone: n, receiver: with(is_narrow(x, cone)), light: with(is_narrow(&light.vpl.vertex, cone)) }
            }
        }
    }
}

/// Can the lobe of a vertex be as narrow as the cone? Decided by the two ends alone, never by a sample.
fn is_narrow(v: &Vertex, cone: &Cone) -> bool {
    match &v.scatter {
        Scatter::Surface(p) if matches!(p.bsdf, Bsdf::Diffuse(_)) => false,
        Scatter::Surface(_) => {
            // A box at the vertex itself: any direction. The highest that the lobe gets, against the cone's density.
            v.bound(&Aabb::point(v.p)).with_cosine * cone.solid_angle() > 0.25
        }
        _ => false,
    }
}

impl Promise for SphereKernel {
    fn claim(&self) -> Claim {
        let bias = match self.sampling {
            Sampling::Cone | Sampling::Mis => 0.0,
            // A lobe need not reach all of the cone: what it does not reach is lost.
            Sampling::Receiver | Sampling::Light => f32::INFINITY,
        };
        Claim { bias, finite_variance: !self.points_too, ..Claim::UNBIASED }
    }
}

impl Kernel<Vertex, Vsl> for SphereKernel {
    fn connect(&self, _: &Scene, x: &Vertex, light: &Vsl, s: &mut Stream) -> Option<Connection> {
        let (y, r) = (&light.vpl.vertex, light.radius);
        if !(r > 0.0) {
            return connect_vertices(x, y, light.vpl.flux);
        }
        let v = y.p - x.p;
        let d = v.length();
        let apart = d > 1e-6 * r;
        let axis = if apart { v / d } else { x.normal().unwrap_or(Vec3::Z) };
        // A middle behind either surface is hidden by it, or seen through a sheet without thickness, which must not leak.
        if apart && (behind(x, axis) || behind(y, -axis)) {
            return None;
        }
        let cone = Cone { axis, versine: versine(d, r) };
        let omega = cone.solid_angle();
        let n = self.counts(x, light, &cone);
        let mut sum = Spectrum::BLACK;
        let mut add = |w: Vec3| {
            // In units of the cone's density, so that nothing overflows as the cone closes.
            let mut density = n.cone as f32;
            if n.receiver > 0 {
                density += n.receiver as f32 * x.pdf_sa(w) * omega;
            }
            if n.light > 0 {
                density += n.light as f32 * y.pdf_sa(-w) * omega;
            }
            let f = x.eval(w) * y.eval(-w);
            if density > 0.0 && !f.is_black() {
                sum += f * (1.0 / density);
            }
        };
        let frame = Frame::around(axis);
        // These are in the cone, even where rounding would put them outside of a narrow one.
        (0..n.cone).for_each(|_| add(cone.sample(&frame, s)));
        for _ in 0..n.receiver {
            if let Some(drawn) = x.sample(s.next_f32(), s.next_2d()).filter(|d| !d.delta && cone.holds(d.dir)) {
                add(drawn.dir);
            }
        }
        for _ in 0..n.light {
            if let Some(drawn) = y.sample(s.next_f32(), s.next_2d()).filter(|d| !d.delta && cone.holds(-d.dir)) {
                add(-drawn.dir);
            }
        }
        // Omega / (pi r^2) is the kernel, without 1 - cos A.
        let value = sum * light.vpl.flux * cone_kernel(d, r);
        let pair = Pair { g: 0.0, lobes: None };
        (!value.is_black()).then(|| Connection { value, edge: Edge::Between(x.end(), y.end()), pair })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_kernel_has_the_factors_of_the_document_over_one_over_d2() {
        for (s, factor) in
            [(0.01f32, 1.000_025_0), (0.1, 1.002_513), (0.3, 1.023_574), (0.5, 1.071_797), (0.9, 1.392_864)]
        {
            let (d, k) = (3.0f32, cone_kernel(3.0, 3.0 * s));
            assert!((k * d * d / factor - 1.0f32).abs() < 2e-6, "r / d = {s}: {}", k * d * d);
            assert!((k - 2.0 * versine(d, 3.0 * s) / (9.0 * s * s)).abs() < 1e-5 * k);
        }
        assert_eq!(cone_kernel(1.0, 1.0), 2.0);
    }
    proptest! {
        #[test]
        fn what_is_drawn_in_the_cone_lies_in_it(d in 1e-3f32..1e3, r in 1e-6f32..1e3, seed in 0u64..1000) {
            let axis = Vec3::new(0.3, -0.5, 0.8).normalize();
            let cone = Cone { axis, versine: versine(d, r) };
            let mut s = Stream::new(seed, [0; 3], manylight_sampling::Purpose::TEST);
            let w = cone.sample(&Frame::around(axis), &mut s);
            // Up to the rounding of unit vectors, which the narrowest cones are narrower than.
            prop_assert!((w - axis).length_squared() <= 2.0 * cone.versine * 1.0001 + 1e-12);
            prop_assert!(cone_kernel(d, r) <= 2.0 / (d * d) * 1.00001 && cone_kernel(d, r) <= 2.0 / (r * r) * 1.00001);
        }
    }
}
