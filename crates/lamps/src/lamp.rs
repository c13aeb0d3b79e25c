//! The light.

use manylight_framework::{Clustered, VirtualLight};
use manylight_math::{Aabb, Vec3};
use manylight_scene::{EmitterPart, Part, PartAxis};

/// A piece of an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Which piece.
    pub part: Part,
    cluster: LampCluster,
}

/// What is known of several pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampCluster {
    /// Of positions; of directions, for light from infinity; empty if there are both. \[m\]
    pub bounds: Aabb,
    /// Unit, of a cone about all normals; zero for light from infinity.
    pub axis: Vec3,
    /// Half angle of the cone; pi where one shines to all sides. What is emitted at an angle a from the axis is at most the intensity
    /// times cos(max(0, a - half)). \[rad\]
    pub half: f32,
    /// Luminance of the radiant intensity along the axes, summed [W/sr]; from infinity, of the irradiance [W/m^2].
    pub intensity: f32,
}

impl Lamp {
    /// Of a piece.
    pub fn new(p: &EmitterPart) -> Lamp {
        let (axis, half) = match p.axis {
            PartAxis::About(n) => (n, 0.0),
            PartAxis::Within(axis, half) => (axis, half),
            PartAxis::AllAround => (Vec3::Z, std::f32::consts::PI),
            PartAxis::FromInfinity => (Vec3::ZERO, std::f32::consts::PI),
        };
        Lamp { part: p.part, cluster: LampCluster { bounds: p.bounds, axis, half, intensity: p.strength } }
    }
}

/// Between unit vectors, exact for small angles too. [rad]
fn angle(a: Vec3, b: Vec3) -> f32 {
    2.0 * (a - b).length().atan2((a + b).length())
}

impl LampCluster {
    /// Of light from infinity alone?
    pub fn is_distant(&self) -> bool {
        self.axis == Vec3::ZERO && !self.bounds.is_empty()
    }
    /// Of light from infinity and from here?
    pub fn is_mixed(&self) -> bool {
        self.bounds.is_empty()
    }
    fn join(&self, o: &LampCluster) -> (Vec3, f32) {
        const ALL: f32 = std::f32::consts::PI;
        if self.axis == Vec3::ZERO || o.axis == Vec3::ZERO {
            return (Vec3::ZERO, ALL);
        }
        let (a, b) = if self.half >= o.half { (self, o) } else { (o, self) };
        let between = angle(a.axis, b.axis);
        if a.half >= ALL || between + b.half <= a.half {
            return (a.axis, a.half);
        }
        // The rounding of the angles is on the safe side.
        let half = 0.5 * (between + a.half + b.half) + 1e-6;
        // Of opposite axes nobody knows which way to turn.
        if half >= ALL || (a.axis + b.axis).length_squared() < 1e-4 {
            return (a.axis, ALL);
        }
        let aside = (b.axis - a.axis * a.axis.dot(b.axis)).normalize_or_zero();
        let (sin, cos) = (half - a.half).sin_cos();
        ((a.axis * cos + aside * sin).normalize(), half)
    }
}

impl VirtualLight for Lamp {
    /// pi x the intensity along the axis. \[W\]
    fn intensity(&self) -> f32 {
        self.cluster.intensity * std::f32::consts::PI
    }
    fn edges(&self) -> u32 {
        0
    }
}
impl Clustered for Lamp {
    type Cluster = LampCluster;
    fn position(&self) -> Vec3 {
        self.cluster.bounds.centre()
    }
    fn axis(&self) -> Vec3 {
        if self.cluster.half >= std::f32::consts::FRAC_PI_2 { Vec3::ZERO } else { self.cluster.axis }
    }
    /// To one side, to all sides, from infinity.
    fn kind(&self) -> u32 {
        if self.cluster.is_distant() { 2 } else { (self.cluster.half >= std::f32::consts::FRAC_PI_2) as u32 }
    }
    fn cluster(&self) -> LampCluster {
        self.cluster
    }
    fn merge(a: &LampCluster, b: &LampCluster) -> LampCluster {
        let (axis, half) = a.join(b);
        let same = a.is_distant() == b.is_distant() && !a.is_mixed() && !b.is_mixed();
        let bounds = if same { a.bounds.join(&b.bounds) } else { Aabb::EMPTY };
        LampCluster { bounds, axis, half, intensity: a.intensity + b.intensity }
    }
    fn weight(c: &LampCluster) -> f32 {
        c.intensity
    }
    fn cost(c: &LampCluster, scale: f32) -> f32 {
        let (diagonal, turned) = (2.0 * c.bounds.radius(), scale * (1.0 - c.half.cos()));
        c.intensity * (diagonal * diagonal + turned * turned)
    }
}
