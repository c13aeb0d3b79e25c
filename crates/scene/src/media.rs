//! Where media are: which one a ray runs through, and where it changes.

use crate::Camera;
use crate::vertex::Sides;
use manylight_geometry::{Geometry, GeometryError, ShapeGeometry, Simd, Surface};
use manylight_math::{MediumId, Ray, Spectrum, Vec3};
use manylight_media::{Flight, Medium};
use manylight_sampling::Stream;

/// A surface that parts two media and does nothing else (Mitsuba's BSDF `null`): light passes as if it were not there, no
/// path counts it, and no ray stops at it.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// For messages.
    pub name: String,
    /// Where it is.
    pub geometry: ShapeGeometry,
    /// What lies on its two sides.
    pub sides: Sides,
}

/// A piece of a ray that lies in one medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Where it begins. \[m\]
    pub from: f32,
    /// Where it ends. \[m\]
    pub to: f32,
    /// What it lies in.
    pub medium: MediumId,
}

/// All media of a scene. A scene without media has none of this.
pub(crate) struct Media {
    pub(crate) list: Vec<Medium>,
    pub(crate) boundaries: Option<Boundaries>,
    /// Of each shape that parts media.
    pub(crate) of_shape: Vec<Option<Sides>>,
    /// What each emitter's light starts in.
    pub(crate) of_emitter: Vec<MediumId>,
}

/// The boundaries have a tree of their own: rays that ask whether something stands between never meet them.
pub(crate) struct Boundaries {
    geometry: Geometry,
    sides: Vec<Sides>,
}

/// A ray passes from one medium to another.
#[derive(Clone, Copy)]
struct Crossing {
    t: f32,
    before: MediumId,
    after: MediumId,
}

/// Crossings nearer than this part of their distance are at the same place: faces of neighbours that touch.
const SAME: f32 = 4e-6;

impl Boundaries {
    pub(crate) fn new(boundaries: Vec<Boundary>) -> Result<Option<Self>, (String, GeometryError)> {
        if boundaries.is_empty() {
            return Ok(None);
        }
        let (names, shapes): (Vec<_>, Vec<_>) = boundaries.into_iter().map(|b| ((b.name, b.sides), b.geometry)).unzip();
        let (names, sides): (Vec<_>, Vec<_>) = names.into_iter().unzip();
        match Geometry::build(shapes) {
            Ok(geometry) => Ok(Some(Boundaries { geometry, sides })),
            Err(error) => {
                let name = match error {
                    GeometryError::Mesh { shape, .. } | GeometryError::Round { shape } => names[shape].clone(),
                    GeometryError::TooMany { .. } => "all boundaries together".into(),
                };
                Err((name, error))
            }
        }
    }
    /// In the order of the ray, up to its `t_max`.
    fn crossings(&self, ray: &Ray) -> Vec<Crossing> {
        let mut found = Vec::new();
        self.geometry.every(ray, |hit| {
            let Surface { ng, .. } = self.geometry.surface(ray, &hit);
            let sides = self.sides[hit.shape as usize];
            let (before, after) = (sides.towards(Some(ng), -ray.dir), sides.towards(Some(ng), ray.dir));
            found.push(Crossing { t: hit.t, before, after });
        });
        found.sort_by(|a, b| a.t.total_cmp(&b.t));
        found
    }
    pub(crate) fn set_simd(&mut self, simd: Simd) {
        self.geometry.set_simd(simd);
    }
    pub(crate) fn geometry(&self) -> (&Geometry, &[Sides]) {
        (&self.geometry, &self.sides)
    }
}

impl Media {
    /// The medium of an index; `None` for vacuum.
    pub(crate) fn get(&self, id: MediumId) -> Option<&Medium> {
        id.index().map(|i| &self.list[i])
    }
    /// The medium at the start of a ray, by the nearest surface along it that parts media; `None` if there is none.
    pub(crate) fn at_start(&self, shapes: &Geometry, ray: &Ray) -> Option<MediumId> {
        let mut nearest: Option<(f32, MediumId)> = None;
        let mut look = |geometry: &Geometry, sides: &dyn Fn(usize) -> Option<Sides>| {
            geometry.every(ray, |hit| {
                let Some(sides) = sides(hit.shape as usize) else { return };
                if nearest.is_none_or(|(t, _)| hit.t < t) {
                    nearest = Some((hit.t, sides.towards(Some(geometry.surface(ray, &hit).ng), -ray.dir)));
                }
            });
        };
        look(shapes, &|i| self.of_shape[i]);
        if let Some(b) = &self.boundaries {
            look(&b.geometry, &|i| Some(b.sides[i]));
        }
        nearest.map(|n| n.1)
    }
    /// The medium at a point that light leaves along `dir`: as the nearest surface in front says; else as the nearest on the way
    /// back to the camera does, in sight or not; else the camera's.
    pub(crate) fn around(&self, shapes: &Geometry, camera: &Camera, p: Vec3, dir: Vec3) -> MediumId {
        let back = camera.origin - p;
        let to_camera = || {
            let ray = Ray { t_max: back.length(), ..Ray::new(p, back.try_normalize()?) };
            self.at_start(shapes, &ray)
        };
        self.at_start(shapes, &Ray::new(p, dir)).or_else(to_camera).unwrap_or(camera.medium)
    }
    /// Shows each piece of (0, t_max) of a ray in its order until `visit` says false; the medium at the end.
    pub(crate) fn walk(&self, ray: &Ray, mut visit: impl FnMut(Run) -> bool) -> MediumId {
        let (mut medium, mut from) = (ray.medium, 0.0);
        let mut crossings = self.boundaries.as_ref().map(|b| b.crossings(ray)).unwrap_or_default();
        for i in 0..crossings.len() {
            // Of faces at the same place the one that fits comes first: out of one medium, then into its neighbour.
            let here = crossings[i].t;
            let near = |c: &Crossing| c.t <= here + here * SAME;
            let fits = crossings[i..].iter().take_while(|c| near(c)).position(|c| c.before == medium);
            crossings[i..].swap(0, fits.unwrap_or(0));
            let next = crossings[i];
            if next.after == medium {
                continue;
            }
            // Both triangles at an edge report it: the second changes nothing, and faces of zero thickness neither.
            let to = next.t.max(from);
            if to > from && !visit(Run { from, to, medium }) {
                return medium;
            }
            (medium, from) = (next.after, to);
        }
        if ray.t_max > from {
            visit(Run { from, to: ray.t_max, medium });
        }
        medium
    }
    /// An estimate of the transmittance of (0, t_max) of a ray.
    pub(crate) fn transmittance(&self, ray: &Ray, s: &mut Stream) -> Spectrum {
        let mut through = Spectrum::ONE;
        self.walk(ray, |run| {
            if let Some(m) = self.get(run.medium) {
                through *= m.transmittance(ray, run.from, run.to, s);
            }
            !through.is_black()
        });
        through
    }
    /// Does any of them emit?
    pub(crate) fn emit(&self) -> bool {
        self.list.iter().any(Medium::emits)
    }
    /// An estimate of what their emission along (0, t_max) of a ray brings to its origin.
    pub(crate) fn emitted(&self, ray: &Ray, s: &mut Stream) -> Spectrum {
        let (mut sum, mut through) = (Spectrum::BLACK, Spectrum::ONE);
        self.walk(ray, |run| {
            if let Some(m) = self.get(run.medium) {
                if m.emits() {
                    sum += through * m.emitted(ray, run.from, run.to, s);
                }
                through *= m.transmittance(ray, run.from, run.to, s);
            }
            !through.is_black()
        });
        sum
    }
    /// Flies along (0, t_max) of a ray, which carries `throughput`: where it collides with what (if it does), what has become
    /// of one unit, and the medium at the end.
    pub(crate) fn fly(&self, ray: &Ray, throughput: Spectrum, s: &mut Stream) -> (Option<f32>, Spectrum, MediumId) {
        let (mut collision, mut total) = (None, Spectrum::ONE);
        let medium = self.walk(ray, |run| {
            let Some(m) = self.get(run.medium) else { return true };
            match m.fly(ray, run.from, run.to, Medium::channels(throughput * total), s) {
                Flight::Collision { t, weight } => {
                    collision = Some(t);
                    total *= weight;
                    false
                }
                Flight::Passed { weight } => {
                    total *= weight;
                    true
                }
            }
        });
        (collision, total, medium)
    }
}
