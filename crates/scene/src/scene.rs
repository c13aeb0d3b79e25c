//! Everything that is rendered, and the questions that light transport asks of it.

use crate::vertex::{Edge, Scatter, SurfacePoint, Vertex};
use crate::{
    Camera, Emission, Emitter, EmitterSample, Emitters, Filter, Material, MaterialId, Source, Texture, TextureId,
};
use manylight_bsdf::{Bsdf, Mode};
use manylight_geometry::{Geometry, GeometryError, Hit, ShapeGeometry, offset_from, shadow_segment};
use manylight_math::{Aabb, Frame, Ray, Spectrum, Vec3};
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
    /// An emission is negative or not finite.
    #[error("{0}")]
    Emission(String),
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
}

impl SceneBuilder {
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
            for id in m.front.textures().chain(m.back.iter().flat_map(|b| b.textures())) {
                missing(format!("material `{}`", m.name), "texture", id.0, self.textures.len())?;
            }
        }
        for s in &self.shapes {
            missing(format!("shape `{}`", s.name), "material", s.material.0, self.materials.len())?;
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
        let mut environments = 0;
        for e in &self.emitters {
            let (valid, surrounds) = match e {
                Emitter::Point { position, intensity } => (position.is_finite() && intensity.is_valid(), false),
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
        let (emitters, of_shape) = Emitters::new(&radiances, self.emitters, &geometry, &self.textures);
        for (shape, emitter) in shapes.iter_mut().zip(of_shape) {
            shape.emitter = emitter;
        }
        Ok(Scene {
            geometry,
            shapes,
            materials: self.materials,
            textures: self.textures,
            emitters,
            camera,
            filter: self.filter.unwrap_or(Filter::Box),
            max_depth: self.max_depth,
            rr_depth: self.rr_depth,
        })
    }
}

/// A shape without its geometry, which lives in `Geometry`.
struct Placed {
    name: String,
    material: MaterialId,
    radiance: Option<Source>,
    emitter: u32,
}

/// Everything that is rendered. Read-only while rendering.
pub struct Scene {
    geometry: Geometry,
    shapes: Vec<Placed>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    emitters: Emitters,
    camera: Camera,
    filter: Filter,
    max_depth: Option<u32>,
    rr_depth: Option<u32>,
}

impl Scene {
    /// Collects a scene piece by piece.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
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

    /// The first surface along a ray, as a vertex of an eye path or a light path.
    pub fn intersect(&self, ray: &Ray, mode: Mode) -> Option<Vertex> {
        let hit = self.geometry.intersect(ray)?;
        Some(self.vertex_at(ray, &hit, mode))
    }
    fn vertex_at(&self, ray: &Ray, hit: &Hit, mode: Mode) -> Vertex {
        let x = self.geometry.surface(ray, hit);
        let shape = &self.shapes[hit.shape as usize];
        let material = &self.materials[shape.material.0 as usize];
        let wi = -ray.dir;
        let frame = Frame::with_tangent(x.ns, x.dpdu);
        let in_front = wi.dot(x.ns) > 0.0;
        let (model, frame) = match &material.back {
            Some(back) if !in_front => (back, frame.flipped()),
            _ => (&material.front, frame),
        };
        let bsdf = model.resolve(&self.textures, x.uv);
        // What scatters on one side alone is black from behind: nobody need ask it for anything.
        let dark = !in_front && material.back.is_none() && bsdf.has_smooth();
        let bsdf = if dark { Bsdf::Black } else { bsdf };
        let mut point = SurfacePoint::new(&x, frame, wi, bsdf, mode);
        point.emitter = shape.emitter;
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
    /// What gets through along an edge: one if it is clear, black if it is blocked.
    pub fn transmittance(&self, edge: &Edge) -> Spectrum {
        let ray = match edge {
            Edge::Between(a, b) => match shadow_segment((a.p, a.surface), (b.p, b.surface)) {
                Some(ray) => ray,
                None => return Spectrum::ONE, // nothing fits between coincident points
            },
            Edge::ToInfinity(a, w) => Ray::new(a.surface.map_or(a.p, |(n, error)| offset_from(a.p, n, error, *w)), *w),
        };
        if self.geometry.occluded(&ray) { Spectrum::BLACK } else { Spectrum::ONE }
    }
    /// Draws a point of an emitter, or a direction to infinity. `None` if nothing shines.
    pub fn sample_emitter(&self, s: &mut Stream) -> Option<EmitterSample> {
        self.emitters.sample(&self.geometry, &self.textures, s)
    }
    /// Draws a ray of light. `None` if nothing shines.
    pub fn sample_emission(&self, s: &mut Stream) -> Option<Emission> {
        self.emitters.sample_ray(&self.geometry, &self.textures, s)
    }
    /// Does any shape's material need a delta lobe (a smooth mirror, glass)?
    pub fn has_delta_lobes(&self) -> bool {
        let delta = |m: &crate::Model| m.resolve(&self.textures, Default::default()).has_delta();
        let of_shape = |s: &Placed| &self.materials[s.material.0 as usize];
        self.shapes.iter().map(of_shape).any(|m| delta(&m.front) || m.back.as_ref().is_some_and(delta))
    }
    /// The BSDF of a material's front at texture coordinates.
    pub fn bsdf(&self, material: MaterialId, uv: manylight_math::Vec2) -> Bsdf {
        self.materials[material.0 as usize].front.resolve(&self.textures, uv)
    }
    /// A number that differs where scenes differ: FNV-1a over geometry, materials, textures, emitters and camera.
    pub fn hash(&self) -> u64 {
        let mut h = Fnv(0xcbf2_9ce4_8422_2325);
        for (shape, placed) in self.geometry.shapes().iter().zip(&self.shapes) {
            match shape {
                ShapeGeometry::Mesh(m) => {
                    m.positions.iter().chain(&m.normals).for_each(|p| h.floats(&p.to_array()));
                    m.uvs.iter().for_each(|p| h.floats(&p.to_array()));
                    m.triangles.iter().flatten().for_each(|i| h.add(&i.to_le_bytes()));
                }
                round => h.add(format!("{round:?}").as_bytes()),
            }
            h.add(format!("{:?} {:?}", placed.material, placed.radiance).as_bytes());
        }
        for t in &self.textures {
            match t {
                Texture::Bitmap { image, filter, wrap, to_uv } => {
                    image.pixels.iter().for_each(|p| h.floats(&p.to_array()));
                    h.add(format!("{} {} {filter:?} {wrap:?} {to_uv:?}", image.width, image.height).as_bytes());
                }
                other => h.add(format!("{other:?}").as_bytes()),
            }
        }
        let rest = format!("{:?} {:?} {:?} {:?}", self.materials, self.camera, self.filter, self.max_depth);
        h.add(rest.as_bytes());
        h.floats(&self.emitters.numbers());
        h.0
    }
}

struct Fnv(u64);
impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.0 = (self.0 ^ *b as u64).wrapping_mul(0x100_0000_01b3);
        }
    }
    fn floats(&mut self, values: &[f32]) {
        values.iter().for_each(|x| self.add(&x.to_bits().to_le_bytes()));
    }
}
