//! What is known of many virtual point lights together.

use crate::{Points, Vpl};
use manylight_framework::{Bounds, Clustered, Reach, Reaches, Receiver};
use manylight_math::{Aabb, INV_PI, Vec3};
use manylight_scene::{EmitterPoint, Scatter};
use std::f32::consts::PI;

/// A box around lights, a cone around the axes about which they shine, and their intensities. 48 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Of positions; of directions, where the light comes from infinity; empty if there are both. \[m\]
    pub bounds: Aabb,
    /// Unit, of the cone; zero for light from infinity. What is emitted at an angle a from it is at most `peak` cos(max(0, a - half
    /// angle)): a spot light's own cone is one of axes.
    pub axis: Vec3,
    /// Cosine of the cone's half angle, rounded down; -1 where a light shines to all sides.
    pub cos_half: f32,
    /// What they emit along their axes, by the mean of their lobes: luminance of flux x albedo / pi, summed. [W/sr]
    pub intensity: f32,
    /// Luminance of flux x largest channel of the lobe in any direction, summed: never below what they emit to anywhere. For
    /// light from infinity both are irradiances [W/m^2]. [W/sr]
    pub peak: f32,
}

/// Rounding of the cosines here, which are products of rounded unit vectors.
const SLACK: f32 = 4e-6;
/// Rounding of what is bounded.
const ROUNDING: f32 = 1.0 + 2e-5;

/// What a cluster is a bound of: how it is told apart is the only use of `axis` and `bounds` together.
#[derive(PartialEq)]
enum Extent {
    Near,
    Distant,
    Both,
}

impl Cluster {
    fn extent(&self) -> Extent {
        match (self.axis == Vec3::ZERO, self.bounds.is_empty()) {
            (false, _) => Extent::Near,
            (true, false) => Extent::Distant,
            (true, true) => Extent::Both,
        }
    }
    /// Does it hold another: its box, its cone, and at least its intensities?
    pub fn holds(&self, o: &Cluster) -> bool {
        let cone = self.cos_half <= -1.0 || angle(self.axis, o.axis) + half(o) <= half(self) + 2e-3;
        let boxed = self.bounds.join(&o.bounds) == self.bounds;
        let extent = if self.extent() == Extent::Both { true } else { boxed && cone && self.extent() == o.extent() };
        extent && self.intensity >= o.intensity && self.peak >= o.peak
    }
    /// Largest cosine of a light's axis to its direction towards a receiver. `lights_to`: from the lights to the receiver, whose
    /// least and largest squared length are `near2` and `far2`.
    #[inline]
    fn largest_cosine(&self, lights_to: &Aabb, near2: f32, far2: f32) -> f32 {
        if self.cos_half <= -1.0 {
            return 1.0;
        }
        // Of the cone's own axis: the greatest height over the length that belongs to it, bounded apart, which is cheap.
        let z = (self.axis * lights_to.lo).max(self.axis * lights_to.hi).element_sum();
        if z < 0.0 && self.cos_half >= 1.0 && z * z > SLACK * SLACK * far2 {
            return 0.0;
        }
        let cos = z / if z > 0.0 { near2 } else { far2 }.sqrt();
        // Also where the receiver is among the lights.
        if !(cos < self.cos_half) {
            return 1.0;
        }
        // cos(max(0, acos(cos) - half)), Walter et al. 2005, section 4.1.
        let sines = (1.0 - cos * cos).max(0.0) * (1.0 - self.cos_half * self.cos_half).max(0.0);
        (cos * self.cos_half + sines.sqrt() + SLACK).clamp(0.0, 1.0)
    }
}

fn half(c: &Cluster) -> f32 {
    c.cos_half.clamp(-1.0, 1.0).acos()
}
/// Between unit vectors, exact for small angles too. [rad]
fn angle(a: Vec3, b: Vec3) -> f32 {
    2.0 * (a - b).length().atan2((a + b).length())
}

/// The smallest cone, up to rounding, that holds two.
fn join(a: &Cluster, b: &Cluster) -> (Vec3, f32) {
    // Of light from infinity only directions are known, and those are in its box.
    if a.axis == Vec3::ZERO || b.axis == Vec3::ZERO {
        return (Vec3::ZERO, -1.0);
    }
    if a.cos_half <= -1.0 || b.cos_half <= -1.0 {
        return (a.axis, -1.0);
    }
    if a.axis == b.axis {
        return (a.axis, a.cos_half.min(b.cos_half));
    }
    let (a, b) = if a.cos_half <= b.cos_half { (a, b) } else { (b, a) };
    let (between, wide, narrow) = (angle(a.axis, b.axis), half(a), half(b));
    if between + narrow <= wide {
        return (a.axis, a.cos_half);
    }
    let joined = 0.5 * (between + wide + narrow) + 1e-6;
    // Turned from the wider one's axis towards the other's; of opposite ones nobody knows which way.
    let aside = b.axis - a.axis * a.axis.dot(b.axis);
    if joined >= PI || (a.axis + b.axis).length_squared() < 1e-4 {
        return (a.axis, -1.0);
    }
    let (sin, cos) = (joined - wide).sin_cos();
    let axis = (a.axis * cos + aside.normalize_or_zero() * sin).normalize();
    (axis, (joined.cos() - SLACK).max(-1.0))
}

impl Vpl {
    /// The side to which it shines, unless it is both.
    fn side(&self) -> Vec3 {
        match &self.vertex.scatter {
            Scatter::Surface(x) => x.ng * x.ng.dot(x.wi).signum(),
            Scatter::Emitter(EmitterPoint::Lambert { n, .. }) => *n,
            Scatter::Emitter(EmitterPoint::Spot(spot)) => spot.axis(),
            Scatter::Emitter(EmitterPoint::Distant { .. }) => Vec3::ZERO,
            // To all sides, about any axis.
            Scatter::Medium(_) | Scatter::Emitter(EmitterPoint::Isotropic) => Vec3::Z,
        }
    }
    fn shines_to_all_sides(&self) -> bool {
        match &self.vertex.scatter {
            Scatter::Surface(x) => !x.bsdf.is_one_sided(),
            Scatter::Medium(_) | Scatter::Emitter(EmitterPoint::Isotropic) => true,
            Scatter::Emitter(EmitterPoint::Spot(spot)) => spot.cutoff() >= 0.5 * PI,
            Scatter::Emitter(_) => false,
        }
    }
    /// Luminance of what it emits along its axis, were its lobe its mean; never nothing where it shines at all. [W/sr]
    fn mean_intensity(&self, peak: f32) -> f32 {
        match &self.vertex.scatter {
            Scatter::Surface(x) => {
                let mean = (self.flux * x.bsdf.albedo(x.frame.to_local(x.wi))).luminance() * INV_PI;
                mean.clamp(1e-4 * peak, peak)
            }
            _ => peak,
        }
    }
}

impl Clustered for Vpl {
    type Cluster = Cluster;

    fn position(&self) -> Vec3 {
        match self.vertex.scatter {
            Scatter::Emitter(EmitterPoint::Distant { towards, .. }) => towards,
            _ => self.vertex.p,
        }
    }
    fn axis(&self) -> Vec3 {
        if self.shines_to_all_sides() { Vec3::ZERO } else { self.side() }
    }
    /// Oriented, glossy, to all sides, from infinity.
    fn kind(&self) -> u32 {
        match &self.vertex.scatter {
            Scatter::Surface(x) if !x.bsdf.is_one_sided() => 2,
            Scatter::Surface(x) => !matches!(x.bsdf, manylight_bsdf::Bsdf::Diffuse(_)) as u32,
            Scatter::Emitter(EmitterPoint::Lambert { .. }) => 0,
            Scatter::Emitter(EmitterPoint::Spot(_)) => 2 * self.shines_to_all_sides() as u32,
            Scatter::Emitter(EmitterPoint::Distant { .. }) => 3,
            Scatter::Medium(_) | Scatter::Emitter(EmitterPoint::Isotropic) => 2,
        }
    }
    fn cluster(&self) -> Cluster {
        // A box at the vertex itself: in any direction.
        let peak = self.flux.luminance() * self.vertex.bound(&Aabb::point(self.vertex.p)).without_cosine;
        Cluster {
            bounds: Aabb::point(self.position()),
            axis: self.side(),
            cos_half: match self.vertex.scatter {
                _ if self.shines_to_all_sides() => -1.0,
                Scatter::Emitter(EmitterPoint::Spot(spot)) => spot.cutoff().cos() - SLACK,
                _ => 1.0,
            },
            intensity: self.mean_intensity(peak),
            peak,
        }
    }
    fn merge(a: &Cluster, b: &Cluster) -> Cluster {
        let (axis, cos_half) = join(a, b);
        let same = a.extent() == b.extent();
        let bounds = if same { a.bounds.join(&b.bounds) } else { Aabb::EMPTY };
        Cluster { bounds, axis, cos_half, intensity: a.intensity + b.intensity, peak: a.peak + b.peak }
    }
    fn weight(c: &Cluster) -> f32 {
        c.peak
    }
    fn cost(c: &Cluster, scale: f32) -> f32 {
        let diagonal = 2.0 * c.bounds.radius();
        let turned = if c.cos_half <= -1.0 { 0.0 } else { scale * (1.0 - c.cos_half) };
        c.peak * (diagonal * diagonal + turned * turned)
    }
}

impl<R: Receiver> Bounds<R, Cluster> for Points {
    fn upper_bound(&self, r: &R, c: &Cluster, cap: f32) -> f32 {
        let extent = r.extent();
        match c.extent() {
            Extent::Both => return f32::INFINITY,
            Extent::Distant => return c.peak * r.lobe_to_infinity(&c.bounds).with_cosine * ROUNDING,
            Extent::Near => {}
        }
        let (near2, far2) = extent.distances2(&c.bounds);
        let cosine = c.largest_cosine(&extent.minus(&c.bounds), near2, far2);
        if cosine == 0.0 {
            return 0.0;
        }
        let lobe = r.lobe(&c.bounds);
        // A receiver in the box: the quotient is infinite, and never 0 / 0.
        let full = if lobe.with_cosine > 0.0 { lobe.with_cosine * cosine / near2 } else { 0.0 };
        let capped = if lobe.without_cosine > 0.0 { lobe.without_cosine * cap } else { 0.0 };
        c.peak * full.min(capped) * ROUNDING
    }
}
impl<R: Receiver> Reaches<R, Cluster> for Points {
    fn reach(&self, r: &R, c: &Cluster, cap: f32) -> Reach {
        let (extent, least) = (r.extent(), 1.0 / cap);
        let facing = |facing: f32| (facing, facing);
        let ((near2, far2), centre2, radius2, (facing_max, facing_guess)) = match c.extent() {
            Extent::Near => {
                let (near2, far2) = extent.distances2(&c.bounds);
                let cosine = c.largest_cosine(&extent.minus(&c.bounds), near2, far2);
                let lobe = if cosine > 0.0 { r.lobe(&c.bounds).with_cosine } else { 0.0 };
                let centre2 = (c.bounds.centre() - extent.centre()).length_squared();
                (
                    (near2.max(least), far2.max(least)),
                    centre2.max(least),
                    0.25 * (c.bounds.hi - c.bounds.lo).length_squared(),
                    facing(cosine * lobe),
                )
            }
            Extent::Distant => ((1.0, 1.0), 1.0, 0.0, facing(r.lobe_to_infinity(&c.bounds).with_cosine)),
            // Only at the top of a tree: nothing is known.
            Extent::Both => ((0.0, f32::MAX), 1.0, 0.0, facing(1.0)),
        };
        Reach { intensity: c.intensity, facing_max, facing_guess, near2, far2, centre2, radius2 }
    }
}

const _: () = assert!(size_of::<Cluster>() == 48);
