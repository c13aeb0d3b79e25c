//! Everything that is rendered, and the questions that light transport asks of it.

use crate::mask::coin;
use crate::material::Resolved;
use crate::media::{Boundaries, Media};
use crate::relief::Seen;
use crate::vertex::{MediumPoint, Scatter, Sides, SurfacePoint, Vertex};
use crate::{
    Boundary, Camera, Emission, Emitter, EmitterPart, EmitterSample, Emitters, Filter, Material, MaterialId, Part, Run,
    Source, Texture, TextureId,
};
use manylight_bsdf::{Bsdf, Mode};
use manylight_geometry::{Geometry, GeometryError, Hit, ShapeGeometry, Simd};
use manylight_math::{Aabb, Frame, MediumId, Ray, Spectrum, Vec3};
use manylight_media::Medium;
use manylight_sampling::Stream;

/// Index of a shape in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeId(pub u32);

/// A shape, what it is made of, and what it emits.
#[derive(Clone, Debug)]
pub struct Shape {
    /// For messages.
    pub name: String,
    /// Where it is.
    pub geometry: ShapeGeometry,
    /// What it is made of.
    pub material: MaterialId,
    /// Radiance on the side of its normal, if it is an area light. [W/(m^2 sr)]
    pub radiance: Option<Source>,
}

/// Why a scene cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// There is no camera, or it is broken.
    #[error("the camera cannot be used: {0}")]
    Camera(String),
    /// A shape is broken.
    #[error("shape `{name}` cannot be used: {error}")]
    Geometry {
        /// Which shape.
        name: String,
        /// What is wrong.
        error: GeometryError,
    },
    /// Something names a texture or material that is not there.
    #[error("{who} names {what} {index}, but there are only {count}")]
    Missing {
        /// Who names it.
        who: String,
        /// "texture" or "material".
        what: &'static str,
        /// The index named.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A shape bounds a medium and lets a part of the light pass.
    #[error("shape `{0}` bounds a medium and has an opacity: only one is possible")]
    Boundary(String),
    /// An emission is negative or not finite.
    #[error("{0}")]
    Emission(String),
    /// More media than an index holds.
    #[error("{0} media: at most {most} are possible", most = MediumId::MOST)]
    Media(usize),
    /// More than one light surrounds the scene.
    #[error("{0} lights surround the scene (constant or envmap): at most one is possible")]
    Environments(usize),
}

/// Collects a scene piece by piece.
#[derive(Default)]
pub struct SceneBuilder {
    textures: Vec<Texture>,
    materials: Vec<Material>,
    shapes: Vec<Shape>,
    emitters: Vec<Emitter>,
    camera: Option<Camera>,
    filter: Option<Filter>,
    max_depth: Option<u32>,
    rr_depth: Option<u32>,
    media: Vec<Medium>,
    boundaries: Vec<Boundary>,
    parts: Vec<(ShapeId, Sides)>,
}

impl SceneBuilder {
    /// Adds a medium.
    pub fn medium(&mut self, medium: Medium) -> MediumId {
        self.media.push(medium);
        // Too many are refused by `build`.
        MediumId::new((self.media.len() - 1).min(MediumId::MOST - 1) as u16)
    }
    /// Adds a surface that parts two media and does nothing else. It must close, or end at shapes.
    pub fn boundary(&mut self, boundary: Boundary) {
        self.boundaries.push(boundary);
    }
    /// Says what lies on the two sides of a shape. Of all others the medium is the same on both, whatever it is.
    pub fn parts(&mut self, shape: ShapeId, sides: Sides) {
        self.parts.push((shape, sides));
    }
    /// Adds a texture.
    pub fn texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }
    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }
    /// Adds a shape.
    pub fn shape(&mut self, shape: Shape) -> ShapeId {
        self.shapes.push(shape);
        ShapeId(self.shapes.len() as u32 - 1)
    }
    /// Adds an emitter that is not a shape.
    pub fn emitter(&mut self, emitter: Emitter) {
        self.emitters.push(emitter);
    }
    /// Sets the camera.
    pub fn camera(&mut self, camera: Camera) {
        self.camera = Some(camera);
    }
    /// Sets the pixel filter (box, if not called).
    pub fn filter(&mut self, filter: Filter) {
        self.filter = Some(filter);
    }
    /// Sets the number of edges from which paths may end by Russian roulette.
    pub fn rr_depth(&mut self, edges: u32) {
        self.rr_depth = Some(edges);
    }
    /// Sets the largest number of edges of a path; `None`: no limit.
    pub fn max_depth(&mut self, edges: Option<u32>) {
        self.max_depth = edges;
    }
    /// Checks everything and builds the tree over the shapes.
    pub fn build(self) -> Result<Scene, SceneError> {
        let camera = self.camera.ok_or_else(|| SceneError::Camera("the scene has none: add one".into()))?;
        let missing = |who: String, what: &'static str, index: u32, count: usize| {
            if (index as usize) < count { Ok(()) } else { Err(SceneError::Missing { who, what, index, count }) }
        };
        for m in &self.materials {
            let opacity = m.opacity.iter().filter_map(|o| if let Source::Texture(id) = o { Some(*id) } else { None });
            for id in m.front.textures().into_iter().chain(m.back.iter().flat_map(|b| b.textures())).chain(opacity) {
                missing(format!("material `{}`", m.name), "texture", id.0, self.textures.len())?;
            }
        }
        for s in &self.shapes {
            missing(format!("shape `{}`", s.name), "material", s.material.0, self.materials.len())?;
            if s.radiance.is_some() && self.materials[s.material.0 as usize].opacity.is_some() {
                return Err(SceneError::Emission(format!(
                    "shape `{}` shines and lets light pass: only one is possible",
                    s.name
                )));
            }
            match s.radiance {
                Some(Source::Texture(id)) => {
                    missing(format!("shape `{}`", s.name), "texture", id.0, self.textures.len())?
                }
                Some(Source::Constant(c)) if !c.is_valid() => {
                    return Err(SceneError::Emission(format!(
                        "shape `{}` emits {:?}: expected finite, not negative",
                        s.name, c.0
                    )));
                }
                _ => {}
            }
        }
        let named = self.boundaries.iter().map(|b| (&b.name, b.sides));
        let shape_name = |id: &ShapeId| self.shapes.get(id.0 as usize).map(|s| &s.name);
        for (name, sides) in named.chain(self.parts.iter().filter_map(|(id, s)| Some((shape_name(id)?, *s)))) {
            for index in [sides.outside, sides.inside].into_iter().filter_map(MediumId::index) {
                missing(format!("shape `{name}`"), "medium", index as u32, self.media.len())?;
            }
        }
        for (id, _) in &self.parts {
            missing("a medium's place".into(), "shape", id.0, self.shapes.len())?;
            let shape = &self.shapes[id.0 as usize];
            if self.materials[shape.material.0 as usize].opacity.is_some() {
                return Err(SceneError::Boundary(shape.name.clone()));
            }
        }
        if let Some(index) = camera.medium.index() {
            missing("the camera".into(), "medium", index as u32, self.media.len())?;
        }
        if self.media.len() >= MediumId::MOST {
            return Err(SceneError::Media(self.media.len()));
        }
        let mut environments = 0;
        for e in &self.emitters {
            let (valid, surrounds) = match e {
                Emitter::Point { position, intensity } => (position.is_finite() && intensity.is_valid(), false),
                Emitter::Spot { position, intensity, .. } => (position.is_finite() && intensity.is_valid(), false),
                Emitter::Directional { direction, irradiance } => {
                    ((direction.length() - 1.0).abs() < 1e-3 && irradiance.is_valid(), false)
                }
                Emitter::Constant { radiance } => (radiance.is_valid(), true),
                Emitter::Environment(map) => (map.mean().is_valid(), true),
            };
            environments += surrounds as usize;
            if !valid {
                let kind = match e {
                    Emitter::Point { .. } => "a point light",
                    Emitter::Spot { .. } => "a spot light",
                    Emitter::Directional { .. } => "a directional light",
                    Emitter::Constant { .. } => "the constant light around the scene",
                    Emitter::Environment(_) => "the environment map",
                };
                return Err(SceneError::Emission(format!("{kind} is negative, not finite or without direction")));
            }
        }
        if environments > 1 {
            return Err(SceneError::Environments(environments));
        }
        let mut geometries = Vec::with_capacity(self.shapes.len());
        let mut shapes = Vec::with_capacity(self.shapes.len());
        for s in self.shapes {
            geometries.push(s.geometry);
            shapes.push(Placed { name: s.name, material: s.material, radiance: s.radiance, emitter: u32::MAX });
        }
        let geometry = Geometry::build(geometries).map_err(|error| {
            let name = match error {
                GeometryError::Mesh { shape, .. } | GeometryError::Round { shape } => shapes[shape].name.clone(),
                GeometryError::TooMany { .. } => "all together".into(),
            };
            SceneError::Geometry { name, error }
        })?;
        let radiances: Vec<_> = shapes.iter().map(|s| s.radiance).collect();
        // Media may reach further than the shapes do.
        let all = self.boundaries.iter().fold(geometry.bounds(), |all, b| all.join(&b.geometry.bounds()));
        let (emitters, of_shape) = Emitters::new(&radiances, self.emitters, &geometry, all, &self.textures);
        for (shape, emitter) in shapes.iter_mut().zip(of_shape) {
            shape.emitter = emitter;
        }
        let mut media_emit = false;
        let media = if self.media.is_empty() {
            None
        } else {
            let boundaries =
                Boundaries::new(self.boundaries).map_err(|(name, error)| SceneError::Geometry { name, error })?;
            let mut of_shape = vec![None; shapes.len()];
            self.parts.iter().for_each(|(id, sides)| of_shape[id.0 as usize] = Some(*sides));
            let mut media = Media { list: self.media, boundaries, of_shape, of_emitter: Vec::new() };
            media_emit = media.emit();
            media.of_emitter = emitters.media(&media, &geometry, &camera);
            Some(Box::new(media))
        };
        let mut scene = Scene {
            media,
            media_emit,
            geometry,
            shapes,
            materials: self.materials,
            textures: self.textures,
            emitters,
            camera,
            filter: self.filter.unwrap_or(Filter::Box),
            max_depth: self.max_depth,
            rr_depth: self.rr_depth,
            delta_lobes: false,
            masked: false,
        };
        scene.masked = scene.shapes.iter().any(|s| scene.materials[s.material.0 as usize].opacity.is_some());
        scene.delta_lobes = scene.find_delta_lobes();
        Ok(scene)
    }
}

/// A shape without its geometry, which lives in `Geometry`.
pub(crate) struct Placed {
    name: String,
    pub(crate) material: MaterialId,
    pub(crate) radiance: Option<Source>,
    pub(crate) emitter: u32,
}

/// Everything that is rendered. Read-only while rendering.
pub struct Scene {
    /// None of it, where there is no medium.
    pub(crate) media: Option<Box<Media>>,
    media_emit: bool,
    pub(crate) geometry: Geometry,
    pub(crate) shapes: Vec<Placed>,
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) emitters: Emitters,
    pub(crate) camera: Camera,
    pub(crate) filter: Filter,
    pub(crate) max_depth: Option<u32>,
    rr_depth: Option<u32>,
    delta_lobes: bool,
    /// Is any shape not all there?
    pub(crate) masked: bool,
}

impl Scene {
    /// Collects a scene piece by piece.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }
    /// Each shape's name, material and radiance, in the order of the geometry's.
    pub fn surfaces(&self) -> impl Iterator<Item = (&str, MaterialId, Option<Source>)> {
        self.shapes.iter().map(|s| (s.name.as_str(), s.material, s.radiance))
    }
    /// All materials, by their index.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }
    /// All textures, by their index.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }
    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
    /// The pixel filter.
    pub fn filter(&self) -> Filter {
        self.filter
    }
    /// The largest number of edges that the scene file allows a path; `None`: no limit.
    pub fn max_depth(&self) -> Option<u32> {
        self.max_depth
    }
    /// The number of edges from which the scene file lets a path tracer end paths by Russian roulette, if it says so.
    pub fn rr_depth(&self) -> Option<u32> {
        self.rr_depth
    }
    /// The shapes' geometry.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }
    /// Chooses what traces rays; the best that the processor has, if not called. The image does not depend on it.
    pub fn set_simd(&mut self, simd: Simd) {
        self.geometry.set_simd(simd);
        if let Some(boundaries) = self.media.as_mut().and_then(|m| m.boundaries.as_mut()) {
            boundaries.set_simd(simd);
        }
    }
    /// The emitters.
    pub fn emitters(&self) -> &Emitters {
        &self.emitters
    }
    /// Name of a shape.
    pub fn shape_name(&self, shape: ShapeId) -> &str {
        &self.shapes[shape.0 as usize].name
    }
    /// The smallest box around all shapes.
    pub fn bounds(&self) -> Aabb {
        self.geometry.bounds()
    }
    /// Area of all shapes. [m^2]
    pub fn area(&self) -> f64 {
        self.geometry.shapes().iter().map(ShapeGeometry::area).sum()
    }

    /// Is there any medium?
    pub fn has_media(&self) -> bool {
        self.media.is_some()
    }
    /// A medium; `None` for vacuum.
    pub fn medium(&self, id: MediumId) -> Option<&Medium> {
        self.media.as_ref()?.get(id)
    }
    /// The surfaces that only part media.
    pub(crate) fn boundaries(&self) -> Option<&Geometry> {
        Some(self.media.as_ref()?.boundaries.as_ref()?.geometry().0)
    }
    /// Does any medium emit light of its own?
    pub fn media_emit(&self) -> bool {
        self.media_emit
    }
    /// All media, each with its index.
    pub fn media(&self) -> impl Iterator<Item = (MediumId, &Medium)> {
        self.media.iter().flat_map(|m| m.list.iter().enumerate()).map(|(i, m)| (MediumId::new(i as u16), m))
    }
    /// What lies at a point: as the nearest surface along a fixed direction says that parts media, else as one on the way to the camera
    /// does.
    pub fn medium_at(&self, p: Vec3) -> MediumId {
        let Some(media) = &self.media else { return MediumId::VACUUM };
        media.around(&self.geometry, &self.camera, p, Vec3::new(0.48, 0.6, 0.64))
    }
    /// An estimate of what media emit along a ray up to the first surface, as it arrives at the origin. [W/(m^2 sr)]
    pub fn emitted_along(&self, ray: &Ray, s: &mut Stream) -> Spectrum {
        let Some(media) = self.media.as_ref().filter(|_| self.media_emit) else { return Spectrum::BLACK };
        match self.first(ray) {
            Some(hit) => media.emitted(&until(ray, hit.t), s),
            None => media.emitted(ray, s),
        }
    }
    /// The pieces of (0, t_max) of a ray that lie in media, in order.
    pub fn runs(&self, ray: &Ray) -> Vec<Run> {
        let mut runs = Vec::new();
        if let Some(media) = &self.media {
            media.walk(ray, |run| {
                runs.extend(Some(run).filter(|r| r.medium != MediumId::VACUUM));
                true
            });
        }
        runs
    }
    /// What media let through along (0, t_max) of a ray, whatever stands between; drawn only where there is no closed form.
    pub fn through(&self, ray: &Ray, s: &mut Stream) -> Spectrum {
        self.media.as_ref().map_or(Spectrum::ONE, |media| media.transmittance(ray, s))
    }
    /// The first surface along a ray, as a vertex of an eye path or a light path. Media on the way change nothing: what they
    /// let through is `transmittance`, and `advance` scatters in them.
    pub fn intersect(&self, ray: &Ray, mode: Mode) -> Option<Vertex> {
        let hit = self.first(ray)?;
        let medium = match &self.media {
            None => MediumId::VACUUM,
            Some(media) => media.walk(&until(ray, hit.t), |_| true),
        };
        Some(self.vertex_at(ray, &hit, mode, medium))
    }
    /// Where a path that carries `throughput` goes along a ray: to a collision with a medium, drawn, or to the first surface;
    /// `None`, and it leaves the scene. With it what one unit becomes on the way: T / pdf, times sigma_s at a collision, whose
    /// vertex has a phase function alone. Without media it is `intersect`, and draws nothing.
    pub fn advance(&self, ray: &Ray, mode: Mode, throughput: Spectrum, s: &mut Stream) -> (Option<Vertex>, Spectrum) {
        let Some(media) = &self.media else { return (self.intersect(ray, mode), Spectrum::ONE) };
        let hit = self.first(ray);
        let length = hit.map_or(ray.t_max, |h| h.t);
        let (collision, weight, medium) = media.fly(&until(ray, length), throughput, s);
        let vertex = match (collision, hit) {
            (Some(t), _) => media.get(medium).map(|m| {
                let point = MediumPoint { wi: -ray.dir, scattering: Spectrum::ONE, phase: m.phase(), medium };
                Vertex { p: ray.at(t), scatter: Scatter::Medium(point) }
            }),
            (None, Some(hit)) => Some(self.vertex_at(ray, &hit, mode, medium)),
            (None, None) => None,
        };
        (vertex, weight)
    }
    /// The surface at a hit; `medium` is what the ray arrived through.
    fn vertex_at(&self, ray: &Ray, hit: &Hit, mode: Mode, medium: MediumId) -> Vertex {
        let x = self.geometry.surface(ray, hit);
        let shape = &self.shapes[hit.shape as usize];
        let material = &self.materials[shape.material.0 as usize];
        let wi = -ray.dir;
        let frame = Frame::with_tangent(x.ns, x.dpdu);
        let in_front = wi.dot(x.ns) > 0.0;
        let (model, side) = match &material.back {
            Some(back) if !in_front => (back, (frame.flipped(), Seen::Back)),
            _ => (&material.front, (frame, Seen::Front)),
        };
        let derivatives = || self.geometry.derivatives(hit, &x);
        let Resolved { bsdf, frame, shadows } = model.at(&self.textures, &x, derivatives, side, coin(ray, hit, 1));
        // What scatters on one side alone is black from behind: nobody need ask it for anything.
        let dark = !in_front && material.back.is_none() && bsdf.is_one_sided();
        let bsdf = if dark { Bsdf::Black } else { bsdf };
        let mut point = SurfacePoint::new(&x, frame, wi, bsdf, mode);
        point.shadows = shadows;
        point.emitter = shape.emitter;
        let parts = self.media.as_ref().and_then(|m| m.of_shape[hit.shape as usize]);
        point.sides = parts.unwrap_or(Sides::both(medium));
        // By the geometric normal, as the emitters draw: a shading normal does not say where a lamp shines.
        if let Some(radiance) = shape.radiance
            && wi.dot(x.ng) > 0.0
        {
            point.emitted = radiance.at(&self.textures, x.uv);
        }
        Vertex { p: x.p, scatter: Scatter::Surface(point) }
    }
    /// Radiance that arrives along a ray which meets nothing. [W/(m^2 sr)]
    pub fn environment(&self, dir: Vec3) -> Spectrum {
        self.emitters.environment_radiance(dir)
    }
    /// Draws a point of an emitter, or a direction to infinity. `None` if nothing shines.
    pub fn sample_emitter(&self, s: &mut Stream) -> Option<EmitterSample> {
        self.emitters.sample(&self.geometry, &self.textures, s)
    }
    /// The emitters piece by piece, see `Emitters::parts`.
    pub fn emitter_parts(&self) -> Vec<EmitterPart> {
        self.emitters.parts(&self.geometry, &self.textures)
    }
    /// Draws a point of one piece of an emitter, see `Emitters::sample_part`.
    pub fn sample_part(&self, part: Part, s: &mut Stream) -> Option<EmitterSample> {
        self.emitters.sample_part(part, &self.geometry, &self.textures, s)
    }
    /// The piece of an emitter that a ray meets first: what `intersect` meets, named.
    pub fn part_along(&self, ray: &Ray) -> Option<Part> {
        let hit = self.first(ray)?;
        let emitter = self.shapes[hit.shape as usize].emitter;
        let mesh = matches!(self.geometry.shapes()[hit.shape as usize], ShapeGeometry::Mesh(_));
        (emitter != u32::MAX).then_some(Part { emitter, triangle: mesh.then_some(hit.triangle) })
    }
    /// Density of `sample_part`, see `Emitters::pdf_of_part`.
    pub fn pdf_of_part(&self, part: Part, to_infinity: Vec3) -> Option<f32> {
        self.emitters.pdf_of_part(part, &self.geometry, to_infinity)
    }
    /// Draws a ray of light. `None` if nothing shines.
    pub fn sample_emission(&self, s: &mut Stream) -> Option<Emission> {
        let mut emission = self.emitters.sample_ray(&self.geometry, &self.textures, s)?;
        if let Some(media) = &self.media {
            emission.ray.medium = media.of_emitter[emission.start.emitter as usize];
        }
        Some(emission)
    }
    /// Does any shape let a part of the light pass (a mask)?
    pub fn has_masks(&self) -> bool {
        self.masked
    }
    /// Has any shape's material a lobe that [`Vertex::split`] parts from the others, delta lobes aside?
    pub fn has_lobes_as_sharp_as(&self, alpha: f32) -> bool {
        let leaf = |m: &crate::Model| m.resolve(&self.textures, Default::default()).split(Vec3::Z, alpha).is_some();
        // Roughness by a texture may be anything.
        let sharp = |m: &crate::Model| m.is_roughened() || m.leaves().into_iter().any(leaf);
        self.shapes
            .iter()
            .map(|s| &self.materials[s.material.0 as usize])
            .any(|m| std::iter::once(&m.front).chain(&m.back).any(sharp))
    }
    /// Does any shape's material need a delta lobe (a smooth mirror, glass)?
    pub fn has_delta_lobes(&self) -> bool {
        self.delta_lobes
    }
    fn find_delta_lobes(&self) -> bool {
        let leaf = |m: &crate::Model| m.resolve(&self.textures, Default::default()).has_delta();
        let delta = |m: &crate::Model| m.leaves().into_iter().any(leaf);
        let of_shape = |s: &Placed| &self.materials[s.material.0 as usize];
        self.shapes.iter().map(of_shape).any(|m| delta(&m.front) || m.back.as_ref().is_some_and(delta))
    }
    /// The BSDF of a material's front at texture coordinates.
    pub fn bsdf(&self, material: MaterialId, uv: manylight_math::Vec2) -> Bsdf {
        self.materials[material.0 as usize].front.resolve(&self.textures, uv)
    }
}

/// A ray up to a surface, and not beyond: a boundary that coincides with the surface is not crossed.
fn until(ray: &Ray, t: f32) -> Ray {
    Ray { t_max: t * (1.0 - 4.0 * f32::EPSILON), ..*ray }
}
