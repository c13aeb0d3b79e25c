//! Scenes in code, at any length of the metre and any brightness of the watt.

use manylight_geometry::{ShapeGeometry, Sphere, TriangleMesh};
use manylight_math::{DAffine3, DMat3, DVec3, MediumId, Spectrum};
use manylight_scene::{
    Boundary, Camera, Emitter, HenyeyGreenstein, Homogeneous, Material, MaterialId, Medium, Model, Scene, SceneBuilder,
    Shape, ShapeId, Sides, Source,
};

/// Pixels a side: few, since the pass is the unit of every statistic.
pub(super) const SIZE: u32 = 8;

/// What a scene is written in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Everything is so many times as long; densities keep optical depths.
    pub length: f64,
    /// Everything is so many times as bright.
    pub light: f64,
}

impl Units {
    /// As it is written.
    pub const PLAIN: Units = Units { length: 1.0, light: 1.0 };
}

/// A scene under construction.
pub(super) struct Site {
    pub b: SceneBuilder,
    units: Units,
}

/// What a case may stumble over while it is built; it is a fault of the case, and said.
pub(super) type Made = Result<Scene, String>;

pub(super) fn rgb(c: [f64; 3]) -> Spectrum {
    Spectrum::from(c.map(|x| x as f32))
}

impl Site {
    pub fn new(units: Units) -> Site {
        Site { b: SceneBuilder::default(), units }
    }
    pub fn diffuse(&mut self, albedo: [f64; 3]) -> MaterialId {
        self.model(Model::Diffuse { reflectance: Source::Constant(rgb(albedo)) })
    }
    /// On both sides.
    pub fn sheet(&mut self, albedo: [f64; 3]) -> MaterialId {
        let model = Model::Diffuse { reflectance: Source::Constant(rgb(albedo)) };
        self.b.material(Material::two_sided("sheet", model))
    }
    pub fn model(&mut self, model: Model) -> MaterialId {
        self.b.material(Material::one_sided("material", model))
    }
    fn add(&mut self, geometry: ShapeGeometry, material: MaterialId, radiance: Option<[f64; 3]>) -> ShapeId {
        let radiance = radiance.map(|r| Source::Constant(rgb(r.map(|x| x * self.units.light))));
        self.b.shape(Shape { name: "shape".into(), geometry, material, radiance })
    }
    fn sphere(&self, centre: DVec3, radius: f64, flipped: bool) -> ShapeGeometry {
        let u = self.units.length;
        ShapeGeometry::Sphere(Sphere { flipped, ..Sphere::new((centre * u).as_vec3(), (radius * u) as f32) })
    }
    pub fn ball(&mut self, centre: DVec3, radius: f64, material: MaterialId, radiance: Option<[f64; 3]>) -> ShapeId {
        let ball = self.sphere(centre, radius, false);
        self.add(ball, material, radiance)
    }
    /// Its inside.
    pub fn hollow(&mut self, radius: f64, material: MaterialId, radiance: Option<[f64; 3]>) -> ShapeId {
        let ball = self.sphere(DVec3::ZERO, radius, true);
        self.add(ball, material, radiance)
    }
    fn scaled(&self, mut mesh: TriangleMesh) -> ShapeGeometry {
        mesh.transform(&DAffine3::from_scale(DVec3::splat(self.units.length)));
        ShapeGeometry::Mesh(mesh)
    }
    pub fn mesh(&mut self, mesh: TriangleMesh, material: MaterialId, radiance: Option<[f64; 3]>) -> ShapeId {
        let mesh = self.scaled(mesh);
        self.add(mesh, material, radiance)
    }
    pub fn point(&mut self, at: DVec3, intensity: [f64; 3]) {
        let (u, q) = (self.units.length, self.units.light);
        let intensity = rgb(intensity.map(|x| x * u * u * q));
        self.b.emitter(Emitter::Point { position: (at * u).as_vec3(), intensity });
    }
    pub fn sky(&mut self, radiance: [f64; 3]) {
        self.b.emitter(Emitter::Constant { radiance: rgb(radiance.map(|x| x * self.units.light)) });
    }
    pub fn sun(&mut self, direction: DVec3, irradiance: [f64; 3]) {
        let irradiance = rgb(irradiance.map(|x| x * self.units.light));
        self.b.emitter(Emitter::Directional { direction: direction.normalize().as_vec3(), irradiance });
    }
    /// By sigma_s and sigma_t [1/m].
    pub fn fog(&mut self, scattering: [f64; 3], extinction: [f64; 3], g: f64) -> Result<MediumId, String> {
        let phase = HenyeyGreenstein::new(g as f32).ok_or("g is no mean cosine")?;
        let per = 1.0 / self.units.length;
        let fog = Homogeneous::new(rgb(scattering.map(|x| x * per)), rgb(extinction.map(|x| x * per)), phase);
        Ok(self.b.medium(Medium::from(fog.map_err(|e| e.to_string())?)))
    }
    /// A mesh that parts media.
    pub fn skin(&mut self, mesh: TriangleMesh, inside: MediumId, outside: MediumId) {
        let geometry = self.scaled(mesh);
        self.b.boundary(Boundary { name: "skin".into(), geometry, sides: Sides { inside, outside } });
    }
    /// Length of a metre.
    pub fn metre(&self) -> f64 {
        self.units.length
    }
    /// A watt.
    pub fn watt(&self) -> f64 {
        self.units.light
    }
    /// Looks from a point to another, and builds.
    pub fn seen(mut self, from: DVec3, to: DVec3, fov: f64, medium: MediumId) -> Made {
        let to_world = view(from * self.units.length, (to - from).normalize());
        let camera = Camera::perspective(to_world, fov, (SIZE, SIZE)).map_err(|e| e.to_string())?;
        self.b.camera(camera.within(medium));
        self.b.build().map_err(|e| e.to_string())
    }
}

/// The frame of a camera that looks along `dir`.
fn view(from: DVec3, dir: DVec3) -> DAffine3 {
    let left = dir.any_orthonormal_vector();
    DAffine3 { matrix3: DMat3::from_cols(left, dir.cross(left), dir), translation: from }
}

/// Mean over the film of a function of the direction, for the camera of [`Site::seen`] (the midpoint rule; for smooth functions).
pub(super) fn film_mean(from: DVec3, to: DVec3, fov: f64, radiance: impl Fn(DVec3) -> f64) -> f64 {
    const POINTS: usize = 256;
    let frame = view(from, (to - from).normalize());
    let half = (0.5 * fov.to_radians()).tan();
    let at = |i: usize| half * (2.0 * (i as f64 + 0.5) / POINTS as f64 - 1.0);
    let sum: f64 = (0..POINTS * POINTS)
        .map(|k| radiance((frame.matrix3 * DVec3::new(at(k % POINTS), at(k / POINTS), 1.0)).normalize()))
        .sum();
    sum / (POINTS * POINTS) as f64
}

/// A box.
pub(super) fn cuboid(low: DVec3, high: DVec3) -> TriangleMesh {
    let half = DAffine3::from_scale(0.5 * (high - low));
    TriangleMesh::cube(&(DAffine3::from_translation(0.5 * (low + high)) * half))
}

/// The inside of a box.
pub(super) fn room(low: DVec3, high: DVec3) -> TriangleMesh {
    let mut mesh = cuboid(low, high);
    mesh.flip_normals();
    mesh
}

/// A square of half width `size` around `at`, facing up.
pub(super) fn square(at: DVec3, size: f64) -> TriangleMesh {
    TriangleMesh::rectangle(&(DAffine3::from_translation(at) * DAffine3::from_scale(DVec3::new(size, size, 1.0))))
}
