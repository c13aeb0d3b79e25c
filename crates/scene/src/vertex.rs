//! The two kinds of ends: a vertex (a point that scatters or emits) and a span (a straight run through a medium).

use crate::Spot;
use manylight_bsdf::{Bsdf, Lobe, Mode};
use manylight_geometry::{Surface, offset_from};

use manylight_math::{Aabb, Frame, MediumId, Ray, Spectrum, Vec2, Vec3};
use manylight_media::HenyeyGreenstein;

/// One end of an edge: a point, its surface if it lies on one, and the medium around it.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// \[m\]
    pub p: Vec3,
    /// Geometric normal and error bound \[m\] of the surface that it lies on.
    pub surface: Option<(Vec3, f32)>,
    /// What is around it.
    pub sides: Sides,
}

impl End {
    /// The medium that an edge along `w` starts in.
    pub fn towards(&self, w: Vec3) -> MediumId {
        self.sides.towards(self.surface.map(|s| s.0), w)
    }
}

/// The media around a point: of a surface, one on each side of its geometric normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// On the side that the normal points to.
    pub outside: MediumId,
    /// On the other side.
    pub inside: MediumId,
}

impl Sides {
    /// Vacuum on both sides.
    pub const VACUUM: Sides = Sides { outside: MediumId::VACUUM, inside: MediumId::VACUUM };

    /// The same on both sides.
    pub fn both(medium: MediumId) -> Self {
        Sides { outside: medium, inside: medium }
    }
    /// What lies on the side that `w` leaves to.
    pub fn towards(&self, normal: Option<Vec3>, w: Vec3) -> MediumId {
        if normal.is_some_and(|n| n.dot(w) < 0.0) { self.inside } else { self.outside }
    }
}

/// What must be clear for a connection to count.
#[derive(Clone, Copy, Debug)]
pub enum Edge {
    /// The segment between two points.
    Between(End, End),
    /// From a point to infinity, along a unit direction.
    ToInfinity(End, Vec3),
}

/// A point where light scatters or starts. Receivers and virtual point lights are both vertices.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// \[m\]
    pub p: Vec3,
    /// What it does with light.
    pub scatter: Scatter,
}

/// What a vertex does with light.
#[derive(Clone, Copy, Debug)]
pub enum Scatter {
    /// It lies on a surface.
    Surface(SurfacePoint),
    /// It lies in a medium.
    Medium(MediumPoint),
    /// Light starts there.
    Emitter(EmitterPoint),
}

/// A point of a surface, seen from where the path came from.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Geometric normal. Unit, on the side of the shading normal as the mesh has it.
    pub ng: Vec3,
    /// Shading frame of `bsdf` (turned over on the back of a two-sided material).
    pub frame: Frame,
    /// Unit, to where the path came from.
    pub wi: Vec3,
    /// With its textures resolved.
    pub bsdf: Bsdf,
    /// Is the path from the eye or from a light?
    pub mode: Mode,
    /// Bound on the rounding error of the position. \[m\]
    pub error: f32,
    /// Radiance that leaves along `wi`. [W/(m^2 sr)]
    pub emitted: Spectrum,
    /// Index of the emitter that the surface is, or `u32::MAX`.
    pub emitter: u32,
    /// The media that it parts.
    pub sides: Sides,
    /// A relief that casts shadows: the shading normal without it, and the squared roughness that it stands for.
    pub shadows: Option<(Vec3, f32)>,
}

/// A point of a medium.
#[derive(Clone, Copy, Debug)]
pub struct MediumPoint {
    /// Unit, to where the path came from.
    pub wi: Vec3,
    /// Multiplies the phase function: sigma_s [1/m] for a receiver and for a point on a virtual ray light; one for a virtual
    /// point light, whose flux is scattered power and has its sigma_s inside.
    pub scattering: Spectrum,
    /// How it scatters.
    pub phase: HenyeyGreenstein,
    /// Which medium.
    pub medium: MediumId,
}

/// A point of an emitter. Its lobe is normalised: times the flux it is what is emitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterPoint {
    /// The same radiance to all directions of a side.
    Lambert {
        /// Geometric normal. Unit, on the side that shines.
        n: Vec3,
        /// Bound on the rounding error of the position. \[m\]
        error: f32,
    },
    /// A point that shines the same to all directions.
    Isotropic,
    /// A point that shines into a cone.
    Spot(Spot),
    /// Infinitely far away; the vertex's position is of no meaning.
    Distant {
        /// Unit, to where the light comes from.
        towards: Vec3,
        /// Area of the disc, across the light, that the scene fits in: times the irradiance it is the power that arrives. \[m^2\]
        disc: f32,
    },
}

/// A direction drawn at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct VertexSample {
    /// Unit, away from the vertex.
    pub dir: Vec3,
    /// eval / pdf.
    pub weight: Spectrum,
    /// Density per solid angle [1/sr], or the probability of a delta lobe.
    pub pdf: f32,
    /// Only drawing finds this direction.
    pub delta: bool,
    /// Index of refraction of where the path goes over that of where it came from; 1 for what is not refracted. Radiance is divided by
    /// its square, which the same path out of the glass gives back: roulette goes by the throughput without it.
    pub eta: f32,
}

impl SurfacePoint {
    /// A surface with its BSDF, seen along `wi`. `frame` and `bsdf` as of the side that is seen.
    pub fn new(x: &Surface, frame: Frame, wi: Vec3, bsdf: Bsdf, mode: Mode) -> Self {
        let emitted = Spectrum::BLACK;
        let sides = Sides::VACUUM;
        let (error, emitter, shadows) = (x.error, u32::MAX, None);
        SurfacePoint { ng: x.ng, frame, wi, bsdf, mode, error, emitted, emitter, sides, shadows }
    }
    /// The part of light along `w` that the slopes of a relief do not shadow: as GGX microfacets of roughness alpha,
    /// alpha^2 = tan^2 / 8 of the angle by which the normal is turned (Conty Estevez, Lecocq and Stein 2019). Of the two directions
    /// it is the one towards the light that counts.
    #[inline]
    fn unshadowed(&self, w: Vec3) -> f32 {
        let Some((n, alpha2)) = self.shadows else { return 1.0 };
        let cos2 = n.dot(w).powi(2);
        // 2 / (1 + sqrt(1 + alpha^2 tan^2)), finite at grazing angles.
        let cos = cos2.sqrt();
        2.0 * cos / (cos + (cos2 + alpha2 * (1.0 - cos2).max(0.0)).sqrt())
    }
    /// What makes shading normals conserve what geometric normals say: |ns . wi| / |ng . wi| for light paths, one for eye
    /// paths (the part of Veach 1997, Eq. 5.19 that belongs to the arrival).
    #[inline]
    fn arrival(&self) -> f32 {
        match self.mode {
            Mode::Radiance => 1.0,
            Mode::Importance => {
                let g = self.ng.dot(self.wi).abs();
                if g > 0.0 { self.unshadowed(self.wi) * self.frame.n.dot(self.wi).abs() / g } else { 0.0 }
            }
        }
    }
    /// The part of what leaves along `w` that a relief does not shadow.
    #[inline]
    fn leaving(&self, w: Vec3) -> f32 {
        if self.mode == Mode::Radiance { self.unshadowed(w) } else { 1.0 }
    }
    /// The cosine that belongs to the departure: of the shading normal for eye paths, of the geometric one for light paths.
    #[inline]
    fn departure(&self, w: Vec3) -> f32 {
        match self.mode {
            Mode::Radiance => self.frame.n.dot(w).abs(),
            Mode::Importance => self.ng.dot(w).abs(),
        }
    }
    /// See `Vertex::bound`.
    fn bound(&self, p: Vec3, towards: &Aabb) -> Lobe {
        // What is one-sided reflects: nothing scatters to below the surface, beyond the rounding of the cosine.
        let box_from_here = towards.minus(&Aabb::point(p));
        let mut cos = box_from_here.largest_cosine(&self.frame) + COSINE_SLACK;
        if !self.bsdf.is_one_sided() {
            cos = cos.max(box_from_here.largest_cosine(&self.frame.flipped()) + COSINE_SLACK);
        } else if !(cos > 0.0 && self.frame.n.dot(self.wi) > 0.0) {
            return Lobe::NONE;
        }
        let local = |w: Vec3| self.frame.to_local(w);
        let lobe = match self.bsdf {
            // The same to all sides: no cone need be made.
            Bsdf::Diffuse(m) => {
                let f = m.value().largest();
                Lobe { with_cosine: f, without_cosine: f }
            }
            _ => {
                let (axis, cos_half) = cone_towards(p, towards);
                self.bsdf.upper_bound(local(self.wi), local(axis), cos_half)
            }
        };
        let f = lobe.without_cosine * self.arrival();
        match self.mode {
            // A box is narrower than the cone around it.
            Mode::Radiance => Lobe { with_cosine: lobe.with_cosine.min(f * cos), without_cosine: f },
            // The departure's cosine is the geometric one, of which the BSDF's bound knows nothing.
            Mode::Importance => Lobe { with_cosine: f, without_cosine: f },
        }
    }
    /// Do both normals agree on which side of the surface `w` leaves to? Else light would leak through.
    #[inline]
    fn sides_agree(&self, w: Vec3) -> bool {
        let reflected = |n: Vec3| n.dot(w) * n.dot(self.wi) > 0.0;
        reflected(self.frame.n) == reflected(self.ng)
    }
}

impl Vertex {
    /// BSDF, phase function or emission profile towards `w`, without this vertex's cosine. [1/sr] or [1/(m sr)]
    #[inline]
    pub fn lobe_at(&self, w: Vec3) -> Spectrum {
        match &self.scatter {
            Scatter::Surface(x) => {
                if !x.sides_agree(w) {
                    return Spectrum::BLACK;
                }
                let (wi, wo) = (x.frame.to_local(x.wi), x.frame.to_local(w));
                let radiance = if x.mode == Mode::Radiance { x.bsdf.radiance_factor(wi, wo) } else { 1.0 };
                x.bsdf.eval(wi, wo) * (x.arrival() * x.leaving(w) * radiance)
            }
            Scatter::Medium(x) => x.scattering * x.phase.eval(x.wi, w),
            Scatter::Emitter(EmitterPoint::Lambert { n, .. }) if !(n.dot(w) > 0.0) => Spectrum::BLACK,
            Scatter::Emitter(EmitterPoint::Spot(spot)) => Spectrum::gray(spot.lobe(w)),
            Scatter::Emitter(point) => Spectrum::gray(point.peak()),
        }
    }
    /// This vertex's part of G: a cosine on a surface, one elsewhere.
    #[inline]
    pub fn cosine(&self, w: Vec3) -> f32 {
        match &self.scatter {
            Scatter::Surface(x) => x.departure(w),
            Scatter::Emitter(EmitterPoint::Lambert { n, .. }) => n.dot(w).max(0.0),
            _ => 1.0,
        }
    }
    /// Is `eval` black along `d`, of any length? `true` is certain; it costs a product, where `eval` costs many.
    #[inline]
    pub fn turns_away(&self, d: Vec3) -> bool {
        // More than the rounding of the cosine that decides.
        let below = |n: Vec3| n.dot(d) < -16.0 * f32::EPSILON * (d.x.abs() + d.y.abs() + d.z.abs());
        match &self.scatter {
            // What is one-sided reflects.
            Scatter::Surface(x) => x.bsdf.is_one_sided() && below(x.frame.n),
            Scatter::Emitter(EmitterPoint::Lambert { n, .. }) => below(*n),
            _ => false,
        }
    }
    /// What leaves towards `w` per unit of what arrives: `lobe_at` times `cosine`.
    #[inline]
    pub fn eval(&self, w: Vec3) -> Spectrum {
        self.lobe_at(w) * self.cosine(w)
    }
    /// Draws where a path goes on. `None`: it ends. Not for emitters (see `Emitters::sample_ray`).
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<VertexSample> {
        match &self.scatter {
            Scatter::Surface(x) => {
                let s = x.bsdf.sample(x.frame.to_local(x.wi), x.mode, u_lobe, u)?;
                let dir = x.frame.to_world(s.wo).normalize();
                if !x.sides_agree(dir) {
                    return None;
                }
                let cosine = x.frame.n.dot(dir).abs();
                let scale = x.arrival() * x.leaving(dir);
                let correction = if cosine > 0.0 { scale * x.departure(dir) / cosine } else { 0.0 };
                Some(VertexSample { dir, weight: s.weight * correction, pdf: s.pdf, delta: s.delta, eta: s.eta })
            }
            Scatter::Medium(x) => {
                let dir = x.phase.sample(x.wi, u);
                Some(VertexSample { dir, weight: x.scattering, pdf: x.phase.eval(x.wi, dir), delta: false, eta: 1.0 })
            }
            Scatter::Emitter(_) => None,
        }
    }
    /// Density of `sample` among the directions that are not of a delta lobe. [1/sr]
    pub fn pdf_sa(&self, w: Vec3) -> f32 {
        match &self.scatter {
            Scatter::Surface(x) if x.sides_agree(w) => x.bsdf.pdf_sa(x.frame.to_local(x.wi), x.frame.to_local(w)),
            Scatter::Medium(x) => x.phase.eval(x.wi, w),
            _ => 0.0,
        }
    }
    /// Parts the lobes of a roughness (alpha) of at most `alpha` from the others: what is left of this vertex, the same vertex
    /// with those alone, and the probability with which drawing chooses them. `None` if there are none, delta lobes aside.
    pub fn split(&self, alpha: f32) -> Option<(Vertex, Vertex, f32)> {
        let Scatter::Surface(x) = &self.scatter else { return None };
        let split = x.bsdf.split(x.frame.to_local(x.wi), alpha)?;
        let with = |bsdf| Vertex { p: self.p, scatter: Scatter::Surface(SurfacePoint { bsdf, ..*x }) };
        Some((with(split.dull), with(split.sharp), split.chance))
    }
    /// Can anything but a delta lobe be evaluated here? If not, no light can be connected to it.
    pub fn connects(&self) -> bool {
        match &self.scatter {
            Scatter::Surface(x) => x.bsdf.has_smooth(),
            _ => true,
        }
    }
    /// Radiance that leaves back along the path. [W/(m^2 sr)]
    pub fn emitted(&self) -> Spectrum {
        match &self.scatter {
            Scatter::Surface(x) => x.emitted,
            _ => Spectrum::BLACK,
        }
    }
    /// The emitter that this surface is.
    pub fn emitter(&self) -> Option<u32> {
        match &self.scatter {
            Scatter::Surface(x) if x.emitter != u32::MAX => Some(x.emitter),
            _ => None,
        }
    }
    /// Geometric normal, on a surface.
    pub fn normal(&self) -> Option<Vec3> {
        match &self.scatter {
            Scatter::Surface(x) => Some(x.ng),
            Scatter::Emitter(EmitterPoint::Lambert { n, .. }) => Some(*n),
            _ => None,
        }
    }
    /// This vertex as the end of an edge. An emitter does not know what is around it: an edge starts at the other end.
    #[inline]
    pub fn end(&self) -> End {
        let (surface, sides) = match &self.scatter {
            Scatter::Surface(x) => (Some((x.ng, x.error)), x.sides),
            Scatter::Emitter(EmitterPoint::Lambert { n, error }) => (Some((*n, *error)), Sides::VACUUM),
            Scatter::Medium(x) => (None, Sides::both(x.medium)),
            Scatter::Emitter(_) => (None, Sides::VACUUM),
        };
        End { p: self.p, surface, sides }
    }
    /// A ray that leaves the vertex, from beyond its own surface, into the medium that is there.
    pub fn leave(&self, dir: Vec3) -> Ray {
        let end = self.end();
        let origin = end.surface.map_or(end.p, |(n, error)| offset_from(end.p, n, error, dir));
        Ray::new(origin, dir).within(end.towards(dir))
    }
    /// Largest channel of the material over every direction towards a box: never below the truth. [1/sr] or [1/(m sr)]
    #[inline]
    pub fn bound(&self, towards: &Aabb) -> Lobe {
        match &self.scatter {
            Scatter::Surface(x) => x.bound(self.p, towards),
            Scatter::Medium(x) => {
                let f = x.scattering.largest() * x.phase.largest();
                Lobe { with_cosine: f, without_cosine: f }
            }
            Scatter::Emitter(point) => Lobe { with_cosine: point.peak(), without_cosine: point.peak() },
        }
    }
}

/// Rounding of cosines of directions to boxes.
const COSINE_SLACK: f32 = 4e-6;

/// A cone (unit axis, cosine of its half angle, rounded down) of all directions from `p` to points of a box.
fn cone_towards(p: Vec3, b: &Aabb) -> (Vec3, f32) {
    let d = b.centre() - p;
    let (distance, radius) = (d.length(), b.radius());
    if !(distance > radius * 1.00001) {
        return (Vec3::Z, -1.0);
    }
    let sin = radius / distance;
    (d / distance, (1.0 - sin * sin).max(0.0).sqrt() - 1e-5)
}

/// A straight run through a medium: a camera segment, or a virtual ray light.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// With a finite `t_max`, in the medium that it runs through. \[m\]
    pub ray: Ray,
    /// Largest scattering coefficient along it. [1/m]
    pub scattering_max: Spectrum,
    /// How the medium scatters.
    pub phase: HenyeyGreenstein,
}

impl Span {
    /// The smallest box around it.
    pub fn extent(&self) -> Aabb {
        Aabb::around([self.ray.origin, self.ray.at(self.ray.t_max)])
    }
    /// The vertex at distance `t`, where the medium scatters `scattering` [1/m]; it carries that coefficient.
    pub fn at(&self, t: f32, scattering: Spectrum) -> Vertex {
        let Span { ray, phase, .. } = *self;
        let point = MediumPoint { wi: -ray.dir, scattering, phase, medium: ray.medium };
        Vertex { p: ray.at(t), scatter: Scatter::Medium(point) }
    }
    /// Largest channel of scattering coefficient x phase function, integrated over its length. [1/sr]
    pub fn bound(&self) -> Lobe {
        let f = self.scattering_max.largest() * self.phase.largest() * self.ray.t_max;
        Lobe { with_cosine: f, without_cosine: f }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_bsdf::Diffuse;
    use manylight_sampling::{Purpose, Stream, warp};

    fn tilted(mode: Mode, wi: Vec3) -> Vertex {
        let ns = Vec3::new(0.3, -0.2, 1.0).normalize();
        let surface = Surface { p: Vec3::ZERO, error: 1e-6, ng: Vec3::Z, ns, uv: Vec2::ZERO, dpdu: Vec3::X };
        let bsdf = Diffuse::new(Spectrum::rgb(0.8, 0.5, 0.1)).into();
        Vertex {
            p: Vec3::ZERO,
            scatter: Scatter::Surface(SurfacePoint::new(&surface, Frame::around(ns), wi, bsdf, mode)),
        }
    }
    #[test]
    fn a_light_path_and_an_eye_path_give_the_same_product_over_tilted_shading_normals() {
        // Through one vertex, seen from both ends: f |ns . to_light| |ng . to_eye| is the product either way.
        let (eye, light) = (Vec3::new(0.5, 0.1, 0.8).normalize(), Vec3::new(-0.3, 0.6, 0.7).normalize());
        let from_eye = tilted(Mode::Radiance, eye).eval(light) * Vec3::Z.dot(eye);
        let from_light = tilted(Mode::Importance, light).eval(eye) * Vec3::Z.dot(light);
        assert!((from_eye - from_light).0.length() < 1e-6, "{from_eye:?} {from_light:?}");
    }
    #[test]
    fn sampled_weights_are_eval_over_pdf_in_both_modes() {
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        for mode in [Mode::Radiance, Mode::Importance] {
            let v = tilted(mode, Vec3::new(0.2, 0.3, 0.9).normalize());
            for _ in 0..1000 {
                let Some(x) = v.sample(s.next_f32(), s.next_2d()) else { continue };
                let expected = v.eval(x.dir) / v.pdf_sa(x.dir);
                assert!(
                    (x.weight - expected).0.length() < 1e-3 * expected.largest(),
                    "{mode:?} {:?} {expected:?}",
                    x.weight
                );
            }
        }
    }
    #[test]
    fn nothing_leaks_where_the_two_normals_disagree() {
        let wi = Vec3::new(0.0, 0.0, 1.0);
        let v = tilted(Mode::Radiance, wi);
        let between = Vec3::new(1.0, 0.0, -0.05).normalize(); // above the shading plane, below the real one
        assert!(v.eval(between).is_black() && v.pdf_sa(between) == 0.0);
    }
    #[test]
    fn the_phase_function_is_normalised_sampled_exactly_and_stable_for_any_g() {
        let wi = Vec3::new(0.0, 0.6, 0.8);
        for g in [-0.95f32, -0.5, -1e-4, 0.0, 1e-7, 1e-4, 0.3, 0.9, 0.95] {
            let phase = HenyeyGreenstein::new(g).unwrap();
            let point = MediumPoint { wi, scattering: Spectrum::ONE, phase, medium: MediumId::new(0) };
            let v = Vertex { p: Vec3::ZERO, scatter: Scatter::Medium(point) };
            let mut s = Stream::new(9, [0; 3], Purpose::TEST);
            let n = 200_000;
            let (mut cos, mut mass) = (0.0f64, 0.0f64);
            for i in 0..n {
                let w = v.sample(0.0, s.next_2d()).unwrap().dir;
                cos += -wi.dot(w) as f64;
                // By stratified cosines: the mass of the density.
                let c = 2.0 * (i as f32 + s.next_f32()) / n as f32 - 1.0;
                mass += v.pdf_sa(Frame::around(-wi).to_world(Vec3::new((1.0 - c * c).max(0.0).sqrt(), 0.0, c))) as f64;
                assert!(v.pdf_sa(w) <= v.bound(&Aabb::point(w)).with_cosine * 1.001);
            }
            // The mean cosine is g by definition; its standard error is below 0.58 / sqrt(n) = 0.0013.
            assert!((cos / n as f64 - g as f64).abs() < 0.005, "g = {g}: mean cosine {}", cos / n as f64);
            let mass = mass / n as f64 / warp::SPHERE_PDF as f64;
            assert!((mass - 1.0).abs() < 0.01, "g = {g}: mass {mass}");
        }
    }
    #[test]
    fn the_cone_holds_every_direction_to_the_box() {
        let mut s = Stream::new(2, [0; 3], Purpose::TEST);
        for _ in 0..20_000 {
            let mut point = || Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * 2.0 - 1.0;
            let (p, b) = (point() * 3.0, Aabb::around([point(), point()]));
            let inside = b.lo + (b.hi - b.lo) * (point() * 0.5 + 0.5);
            let (axis, cos_half) = cone_towards(p, &b);
            assert!(axis.dot((inside - p).normalize_or(axis)) >= cos_half);
        }
    }
}
