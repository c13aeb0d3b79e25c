//! Distances along segments, with the 1/w^2 of a connection cancelled: towards a point (equiangular), and between two segments.
//!
//! All in f64 from f32 positions: the differences of angles and logarithms keep their digits however far, near or parallel.

use manylight_math::{DVec3, Ray};

/// What is kept apart from zero in densities: distances below this part of the geometry's size.
const LEAST: f64 = 1e-7;

/// Draws distances u along a segment with a density in 1/w^2, w the distance from a point y (Kulla and Fajardo 2012).
///
/// With the foot of y on the line at u_0 and the distance D between them, u = u_0 + D tan(phi), du / w^2 = dphi / D: uniform in
/// the angle phi, 1 / (w^2 pdf) = Delta phi / D for every u. A table over phi takes further factors in.
#[derive(Clone, Copy, Debug)]
pub struct Angular {
    foot: f64,
    distance: f64,
    /// D in the density: kept from zero.
    width: f64,
    from: f64,
    angle: f64,
    length: f64,
    table: Option<Table>,
    /// Unit vectors: from y to the foot, and along the segment.
    axes: (DVec3, DVec3),
}

/// A point of the segment, as seen from the point beside it.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Unit, from the point to the segment.
    pub direction: DVec3,
    /// Distance along the segment. \[m\]
    pub t: f64,
    /// From the point. \[m\]
    pub distance: f64,
}

/// Vertices of a table.
const VERTICES: usize = 10;
/// Part of the samples that do not follow the table, which lies below its target between vertices.
const UNIFORM: f64 = 0.1;

/// A density that is linear between vertices.
#[derive(Clone, Copy, Debug)]
struct Table {
    at: [f64; VERTICES],
    value: [f64; VERTICES],
    total: f64,
}

/// A distance that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// \[m\]
    pub t: f64,
    /// 1 / (w^2 pdf), w from the point of the segment to the point towards which it was drawn. [1/m]
    pub inverse: f64,
}

impl Angular {
    /// Along a ray up to `t_max` (which may be infinite), towards a point. `None` if the segment has no length or nothing is
    /// finite.
    pub fn new(ray: &Ray, point: DVec3) -> Option<Self> {
        let (origin, dir, length) = (ray.origin.as_dvec3(), ray.dir.as_dvec3().normalize(), ray.t_max as f64);
        let to = point - origin;
        let foot = to.dot(dir);
        let off = dir * foot - to; // from the point to the foot
        let distance = off.length();
        let scale = to.length() + if length.is_finite() { length } else { 0.0 };
        let width = distance.max(LEAST * scale);
        if !(length > 0.0 && width > 0.0 && width.is_finite()) {
            return None;
        }
        let from = (-foot / width).atan();
        let angle = if length.is_finite() {
            (width * length).atan2(width * width - foot * (length - foot))
        } else {
            std::f64::consts::FRAC_PI_2 - from
        };
        let axes = (off.try_normalize().unwrap_or_else(|| dir.any_orthonormal_vector()), dir);
        (angle > 0.0).then_some(Angular { foot, distance, width, from, angle, length, table: None, axes })
    }
    /// Distance from the point to the line. \[m\]
    pub fn distance(&self) -> f64 {
        self.distance
    }
    /// The range of phi.
    pub fn angles(&self) -> (f64, f64) {
        (self.from, self.from + self.angle)
    }
    /// What lies at an angle.
    pub fn seen(&self, phi: f64) -> Seen {
        let (sin, cos) = phi.sin_cos();
        let t = (self.foot + self.width * (sin / cos)).clamp(0.0, self.length);
        Seen { direction: self.axes.0 * cos + self.axes.1 * sin, t, distance: self.width / cos }
    }
    /// phi at which a direction is nearest to parallel to `axis`, which need not lie in the plane of point and line: where
    /// axis . direction is largest.
    pub fn nearest(&self, axis: DVec3) -> f64 {
        axis.dot(self.axes.1).atan2(axis.dot(self.axes.0))
    }
    /// The same draws, with a density that follows `target` as well (not negative, in any unit): piecewise linear in phi, between
    /// vertices at the ends and around `peak`.
    pub fn following(self, target: impl Fn(&Seen) -> f64, peak: f64) -> Self {
        let (a, b) = self.angles();
        let inside = peak > a + 1e-3 * self.angle && peak < b - 1e-3 * self.angle;
        let n = VERTICES - 1;
        // Crowded at the ends of each part, and so at the peak.
        let spaced = |a: f64, b: f64, k: usize, n: usize| {
            let x = k as f64 / n as f64;
            a + (b - a) * x * x * (3.0 - 2.0 * x)
        };
        let split = if inside { (((peak - a) / self.angle * n as f64).round() as usize).clamp(2, n - 2) } else { n };
        let at: [f64; VERTICES] = std::array::from_fn(|k| match inside {
            true if k <= split => spaced(a, peak, k, split),
            true => spaced(peak, b, k - split, n - split),
            false => spaced(a, b, k, n),
        });
        let value = at.map(|phi| target(&self.seen(phi)).max(0.0));
        let total = (0..n).map(|k| 0.5 * (value[k] + value[k + 1]) * (at[k + 1] - at[k])).sum::<f64>();
        let table = (total > 0.0 && total.is_finite()).then_some(Table { at, value, total });
        Angular { table, ..self }
    }
    /// Draws a distance.
    pub fn sample(&self, u: f64) -> Drawn {
        let phi = match &self.table {
            Some(table) if u >= UNIFORM => table.sample((u - UNIFORM) / (1.0 - UNIFORM)),
            Some(_) => self.from + self.angle * (u / UNIFORM),
            None => self.from + self.angle * u,
        };
        let t = (self.foot + self.width * phi.tan()).clamp(0.0, self.length);
        Drawn { t, inverse: self.inverse_at(t, phi) }
    }
    /// 1 / (w^2 pdf) at a distance that something else has drawn.
    pub fn inverse(&self, t: f64) -> f64 {
        self.inverse_at(t, ((t - self.foot) / self.width).atan())
    }
    fn inverse_at(&self, t: f64, phi: f64) -> f64 {
        let density = match &self.table {
            Some(table) => (1.0 - UNIFORM) * table.density(phi) + UNIFORM / self.angle,
            None => 1.0 / self.angle,
        };
        let inverse = 1.0 / (density * self.width);
        if self.width == self.distance {
            return inverse;
        }
        // The density kept its distance, the connection does not.
        let x = t - self.foot;
        inverse * (self.width * self.width + x * x) / (self.distance * self.distance + x * x)
    }
    /// Density of a distance. [1/m]
    pub fn pdf(&self, t: f64) -> f64 {
        let x = t - self.foot;
        1.0 / (self.inverse(t) * (self.distance * self.distance + x * x))
    }
}

impl Table {
    fn sample(&self, u: f64) -> f64 {
        let mut rest = u * self.total;
        for k in 0..VERTICES - 1 {
            let (f0, f1, width) = (self.value[k], self.value[k + 1], self.at[k + 1] - self.at[k]);
            let mass = 0.5 * (f0 + f1) * width;
            if rest < mass || k == VERTICES - 2 {
                let slope = (f1 - f0) / width;
                let root = (f0 * f0 + 2.0 * slope * rest.min(mass)).max(0.0).sqrt();
                let y = if f0 + root > 0.0 { 2.0 * rest / (f0 + root) } else { 0.0 };
                return self.at[k] + y.clamp(0.0, width);
            }
            rest -= mass;
        }
        self.at[VERTICES - 1]
    }
    fn density(&self, phi: f64) -> f64 {
        let k = self.at.partition_point(|x| *x <= phi).clamp(1, VERTICES - 1);
        let part = ((phi - self.at[k - 1]) / (self.at[k] - self.at[k - 1])).clamp(0.0, 1.0);
        (self.value[k - 1] * (1.0 - part) + self.value[k] * part) / self.total
    }
}

/// Draws distances v along a segment with a density in 1/D(v), D the distance from its point at v to a line: the marginal of
/// 1/w^2 between the segment and that line (Novak et al. 2012, with the line infinite).
///
/// D^2 = h^2 + g^2, with h the distance between the lines and g = g_0 + v s, s the sine between them; with A = asinh(g / h),
/// pdf(v) = s / (Delta A D). Together with [`Angular`]: 1 / (w^2 pdf(v) pdf(u|v)) = Delta A Delta phi / s.
#[derive(Clone, Copy, Debug)]
pub struct Across {
    sine: f64,
    h: f64,
    /// h in the density: kept from zero.
    width: f64,
    g0: f64,
    length: f64,
    /// Delta A; `None`: parallel, and v is uniform.
    delta: Option<f64>,
}

impl Across {
    /// Along `ray` up to its finite `t_max`, across the line of `line`. `None` if the segment has no length or nothing is finite.
    pub fn new(ray: &Ray, line: &Ray) -> Option<Self> {
        let (o, d, length) = (ray.origin.as_dvec3(), ray.dir.as_dvec3().normalize(), ray.t_max as f64);
        let (from, dir) = (line.origin.as_dvec3(), line.dir.as_dvec3().normalize());
        let to = o - from;
        let q0 = to - dir * dir.dot(to);
        let e = d - dir * dir.dot(d);
        // |e| cancels where the two are almost parallel; the cross product does not.
        let sine = dir.cross(d).length();
        let scale = to.length() + length;
        if !(length > 0.0 && scale.is_finite()) {
            return None;
        }
        let (g0, h) = match e.try_normalize() {
            Some(axis) => {
                let g0 = q0.dot(axis);
                (g0, (q0 - axis * g0).length())
            }
            None => (0.0, q0.length()),
        };
        let width = h.max(LEAST * scale);
        let g1 = g0 + length * sine;
        let (d0, d1) = (width.hypot(g0), width.hypot(g1));
        let parallel = sine * length < 1e-6 * d0.min(d1);
        let delta = (!parallel).then(|| delta(width, g0, g1));
        Some(Across { sine, h, width, g0, length, delta })
    }
    fn distance(&self, v: f64) -> f64 {
        self.h.hypot(self.g0 + v * self.sine)
    }
    /// Draws a distance, with 1 / pdf times the 1/D of [`Angular`]'s 1 / (w^2 pdf): a number that is bounded by Delta A / s.
    pub fn sample(&self, u: f64) -> f64 {
        let Some(delta) = self.delta else { return u * self.length };
        let (h, g0) = (self.width, self.g0);
        let g1 = g0 + self.length * self.sine;
        let half = |x: f64| 0.5 * (x - h * h / x);
        let g = if g0 >= 0.0 {
            half((g0 + h.hypot(g0)) * (u * delta).exp())
        } else if g1 <= 0.0 {
            -half((h.hypot(g1) - g1) * ((1.0 - u) * delta).exp())
        } else {
            let x = h * h / (h.hypot(g0) - g0) * (u * delta).exp();
            if x >= h { half(x) } else { -half(h * h / x) }
        };
        ((g - g0) / self.sine).clamp(0.0, self.length)
    }
    /// Density of a distance. [1/m]
    pub fn pdf(&self, v: f64) -> f64 {
        match self.delta {
            Some(delta) => self.sine / (delta * self.width.hypot(self.g0 + v * self.sine)),
            None => 1.0 / self.length,
        }
    }
    /// Distance between the segment's point at `v` and the line. \[m\]
    pub fn to_line(&self, v: f64) -> f64 {
        self.distance(v)
    }
}

/// A distance with density sigma exp(-sigma t) / (1 - exp(-sigma length)); uniform for sigma = 0.
#[derive(Clone, Copy, Debug)]
pub struct Exponential {
    sigma: f64,
    length: f64,
    /// 1 - exp(-sigma length)
    reached: f64,
}

impl Exponential {
    /// In [0, length], with sigma >= 0 [1/m]; one of the two must be finite and positive, and an infinite length needs a sigma.
    pub fn new(sigma: f64, length: f64) -> Self {
        Exponential { sigma, length, reached: -(-sigma * length).exp_m1() }
    }
    /// The part that does not get to the end.
    pub fn reached(&self) -> f64 {
        self.reached
    }
    /// Draws a distance.
    pub fn sample(&self, u: f64) -> f64 {
        if !(self.reached > 1e-9) {
            return u * self.length;
        }
        (-(-u * self.reached).ln_1p() / self.sigma).clamp(0.0, self.length)
    }
    /// Density of a distance. [1/m]
    pub fn pdf(&self, t: f64) -> f64 {
        if !(self.reached > 1e-9) {
            return 1.0 / self.length;
        }
        self.sigma * (-self.sigma * t).exp() / self.reached
    }
}

/// asinh(g1 / h) - asinh(g0 / h) without cancellation, for g0 <= g1 and h > 0.
pub fn delta(h: f64, g0: f64, g1: f64) -> f64 {
    let (d0, d1) = (h.hypot(g0), h.hypot(g1));
    let rise = (g1 - g0) * ((g1 + g0) / (d1 + d0)); // d1 - d0
    if g0 >= 0.0 {
        (((g1 - g0) + rise) / (g0 + d0)).ln_1p()
    } else if g1 <= 0.0 {
        (((g1 - g0) - rise) / (d1 - g1)).ln_1p()
    } else {
        ((g1 + d1) / h).ln() + ((d0 - g0) / h).ln()
    }
}
