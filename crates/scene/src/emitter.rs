//! Where light comes from, and drawing from it.

use crate::media::Media;
use crate::vertex::{EmitterPoint, Scatter, Vertex};
use crate::{Camera, Environment, Source, Spot, Texture};
use manylight_geometry::{Geometry, ShapeGeometry, offset_from};
use manylight_math::{Aabb, Frame, INV_4PI, INV_PI, MediumId, Ray, Spectrum, Vec2, Vec3};
use manylight_sampling::{AliasTable, Stream, warp};
use std::f32::consts::PI;

/// A source of light that is not a shape.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A point that shines the same in all directions.
    Point {
        /// \[m\]
        position: Vec3,
        /// [W/sr]
        intensity: Spectrum,
    },
    /// A point that shines into a cone.
    Spot {
        /// \[m\]
        position: Vec3,
        /// Along the axis. [W/sr]
        intensity: Spectrum,
        /// Where it shines to.
        spot: Spot,
    },
    /// Parallel light.
    Directional {
        /// Unit, the way the light travels.
        direction: Vec3,
        /// On a surface that faces it. [W/m^2]
        irradiance: Spectrum,
    },
    /// The same radiance from everywhere far away.
    Constant {
        /// [W/(m^2 sr)]
        radiance: Spectrum,
    },
    /// Radiance from far away, by a map.
    Environment(Box<Environment>),
}

/// One source, prepared for drawing.
#[derive(Clone, Debug)]
enum Sampler {
    /// A shape; `triangles` picks one by area, for meshes.
    Area {
        shape: u32,
        radiance: Source,
        area: f64,
        triangles: Option<AliasTable>,
    },
    Point {
        position: Vec3,
        intensity: Spectrum,
    },
    Spot {
        position: Vec3,
        intensity: Spectrum,
        spot: Spot,
    },
    Directional {
        direction: Vec3,
        irradiance: Spectrum,
    },
    Constant {
        radiance: Spectrum,
    },
    Environment(Box<Environment>),
}

/// A point (or direction) drawn from an emitter.
#[derive(Clone, Copy, Debug)]
pub struct EmitterSample {
    /// The end of a path: its lobe is normalised, so that `flux` times it is what it emits.
    pub vertex: Vertex,
    /// Emitted by all of the light that the sample stands for: radiance x pi / pdf for areas, intensity x solid angle / pmf for points \[W\];
    /// irradiance / pdf for light from infinity [W/m^2].
    pub flux: Spectrum,
    /// Density of the point per area [1/m^2], or of the direction per solid angle [1/sr] for light from infinity, times the
    /// probability of the emitter. `None` for points and parallel light: only drawing the emitter finds them.
    pub density: Option<f32>,
    /// Index of the emitter.
    pub emitter: u32,
}

/// One emitter, or one triangle of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index of the emitter.
    pub emitter: u32,
    /// Of an emitting mesh.
    pub triangle: Option<u32>,
}

/// A piece of an emitter, as something that can be drawn from and told apart from afar.
#[derive(Clone, Copy, Debug)]
pub struct EmitterPart {
    /// Which piece.
    pub part: Part,
    /// Of its points; of its directions, if it is infinitely far away. \[m\]
    pub bounds: Aabb,
    /// To where it shines.
    pub axis: PartAxis,
    /// Luminance of the radiant intensity along its axis [W/sr]; of its irradiance [W/m^2], if it is infinitely far away.
    pub strength: f32,
}

/// To where a piece of an emitter shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartAxis {
    /// To one side, by the cosine to this unit normal.
    About(Vec3),
    /// Into a cone: the unit axis and the half angle, at least pi / 2 to all sides. \[rad\]
    Within(Vec3, f32),
    /// To all sides.
    AllAround,
    /// From directions.
    FromInfinity,
}

/// Area of a triangle of a mesh; `whole` of what has none. [m^2]
fn part_area(shape: &ShapeGeometry, part: Part, whole: f64) -> f64 {
    match (shape, part.triangle) {
        (ShapeGeometry::Mesh(m), Some(t)) => m.triangle_area(t as usize),
        _ => whole,
    }
}

/// A ray from an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Where the ray started; for light from infinity its position is of no meaning.
    pub start: EmitterSample,
    /// Already beyond the emitter's own surface.
    pub ray: Ray,
    /// The flux that the ray carries: emitted / density. \[W\]
    pub flux: Spectrum,
}

/// All emitters of a scene, picked by power.
pub struct Emitters {
    samplers: Vec<Sampler>,
    pick: Option<AliasTable>,
    /// Centre and radius of a sphere around the scene, for light from infinity. [m]
    world: (Vec3, f32),
    environment: Option<u32>,
    powers: Vec<f64>,
}

impl Emitters {
    /// Shapes that emit first, in their order, then the others. Also the emitter of each shape (`u32::MAX`: none). Light from infinity
    /// falls on all of `bounds`.
    pub(crate) fn new(
        radiances: &[Option<Source>],
        others: Vec<Emitter>,
        geometry: &Geometry,
        bounds: Aabb,
        textures: &[Texture],
    ) -> (Self, Vec<u32>) {
        let world = if bounds.is_empty() {
            (Vec3::ZERO, 1.0)
        } else {
            (bounds.centre(), bounds.radius().max(f32::MIN_POSITIVE) * 1.0001)
        };
        let disc = std::f64::consts::PI * (world.1 as f64).powi(2);
        let mut of_shape = vec![u32::MAX; radiances.len()];
        let mut samplers = Vec::new();
        let mut powers = Vec::new();
        for (i, radiance) in radiances.iter().enumerate() {
            let Some(radiance) = *radiance else { continue };
            let geometry = &geometry.shapes()[i];
            let area = geometry.area();
            let triangles = match geometry {
                ShapeGeometry::Mesh(m) => AliasTable::new((0..m.triangles.len()).map(|t| m.triangle_area(t))),
                _ => None,
            };
            of_shape[i] = samplers.len() as u32;
            powers.push(radiance.mean(textures).luminance() as f64 * std::f64::consts::PI * area);
            samplers.push(Sampler::Area { shape: i as u32, radiance, area, triangles });
        }
        let mut environment = None;
        for other in others {
            let at = samplers.len() as u32;
            let (sampler, power) = match other {
                Emitter::Point { position, intensity } => {
                    (Sampler::Point { position, intensity }, intensity.luminance() as f64 * 4.0 * std::f64::consts::PI)
                }
                Emitter::Spot { position, intensity, spot } => {
                    let power = intensity.luminance() as f64 * spot.solid_angle() as f64;
                    (Sampler::Spot { position, intensity, spot }, power)
                }
                Emitter::Directional { direction, irradiance } => {
                    (Sampler::Directional { direction, irradiance }, irradiance.luminance() as f64 * disc)
                }
                Emitter::Constant { radiance } => {
                    environment = Some(at);
                    let power = radiance.luminance() as f64 * 4.0 * std::f64::consts::PI * disc;
                    (Sampler::Constant { radiance }, power)
                }
                Emitter::Environment(map) => {
                    environment = Some(at);
                    let power = map.mean().luminance() as f64 * 4.0 * std::f64::consts::PI * disc;
                    (Sampler::Environment(map), power)
                }
            };
            samplers.push(sampler);
            powers.push(power);
        }
        let pick = AliasTable::new(powers.iter().copied());
        (Emitters { samplers, pick, world, environment, powers }, of_shape)
    }
    /// What each emitter's light starts in: as its shape says; else as the nearest surface says that parts media in front of it;
    /// else what the way from the camera leads to.
    pub(crate) fn media(&self, media: &Media, geometry: &Geometry, camera: &Camera) -> Vec<MediumId> {
        let parted = media.boundaries.is_some() || media.of_shape.iter().any(Option::is_some);
        // Where nothing parts media there is one, and it reaches to infinity.
        let far = if parted { MediumId::VACUUM } else { camera.medium };
        let near = |p: Vec3, n: Vec3| media.around(geometry, camera, p, n);
        let of = |sampler: &Sampler| match sampler {
            Sampler::Area { shape, triangles, .. } => media.of_shape[*shape as usize].map_or_else(
                || {
                    let x = match (&geometry.shapes()[*shape as usize], triangles) {
                        (ShapeGeometry::Mesh(_), None) => return far, // without area
                        (ShapeGeometry::Mesh(_), Some(_)) => {
                            geometry.surface_on_triangle(*shape, 0, Vec2::splat(1.0 / 3.0))
                        }
                        (ShapeGeometry::Sphere(_), _) => geometry.surface_on_sphere(*shape, Vec3::Z),
                        (ShapeGeometry::Disk(_), _) => geometry.surface_on_disk(*shape, Vec2::ZERO),
                    };
                    near(offset_from(x.p, x.ng, x.error, x.ng), x.ng)
                },
                |sides| sides.outside,
            ),
            Sampler::Point { position, .. } | Sampler::Spot { position, .. } => {
                near(*position, Vec3::new(0.48, 0.6, 0.64))
            }
            Sampler::Directional { .. } | Sampler::Constant { .. } | Sampler::Environment(_) => far,
        };
        self.samplers.iter().map(of).collect()
    }
    /// All numbers that make them what they are, for a hash of the scene.
    pub(crate) fn numbers(&self) -> Vec<f32> {
        let mut all = Vec::new();
        for sampler in &self.samplers {
            // The first number is the kind: a point and a direction may be the same three.
            match sampler {
                Sampler::Area { shape, .. } => all.extend([0.0, *shape as f32]),
                Sampler::Point { position, intensity } => {
                    all.extend([1.0].into_iter().chain(position.to_array()).chain(intensity.to_array()));
                }
                Sampler::Directional { direction, irradiance } => {
                    all.extend([2.0].into_iter().chain(direction.to_array()).chain(irradiance.to_array()));
                }
                Sampler::Constant { radiance } => all.extend([3.0].into_iter().chain(radiance.to_array())),
                Sampler::Environment(map) => all.extend([4.0].into_iter().chain(map.numbers())),
                Sampler::Spot { position, intensity, spot } => {
                    all.extend([5.0].into_iter().chain(position.to_array()).chain(intensity.to_array()));
                    all.extend(spot.axis().to_array().into_iter().chain([spot.cutoff(), spot.beam()]));
                }
            }
        }
        all
    }
    /// What they are, by the names of Mitsuba's plugins.
    pub fn kinds(&self) -> impl Iterator<Item = &'static str> {
        self.samplers.iter().map(|sampler| match sampler {
            Sampler::Area { .. } => "area",
            Sampler::Point { .. } => "point",
            Sampler::Spot { .. } => "spot",
            Sampler::Directional { .. } => "directional",
            Sampler::Constant { .. } => "constant",
            Sampler::Environment(_) => "envmap",
        })
    }
    /// Memory of environment maps. \[byte\]
    pub(crate) fn image_bytes(&self) -> usize {
        let of = |s: &Sampler| if let Sampler::Environment(map) = s { map.bytes() } else { 0 };
        self.samplers.iter().map(of).sum()
    }
    /// Those that are no shapes, in their order.
    pub fn sources(&self) -> impl Iterator<Item = Emitter> {
        self.samplers.iter().filter_map(|sampler| match sampler {
            Sampler::Area { .. } => None,
            &Sampler::Point { position, intensity } => Some(Emitter::Point { position, intensity }),
            &Sampler::Spot { position, intensity, spot } => Some(Emitter::Spot { position, intensity, spot }),
            &Sampler::Directional { direction, irradiance } => Some(Emitter::Directional { direction, irradiance }),
            &Sampler::Constant { radiance } => Some(Emitter::Constant { radiance }),
            Sampler::Environment(map) => Some(Emitter::Environment(map.clone())),
        })
    }
    /// How many there are.
    pub fn len(&self) -> usize {
        self.samplers.len()
    }
    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.samplers.is_empty()
    }
    /// Does any of them shine?
    pub fn shine(&self) -> bool {
        self.pick.is_some()
    }
    /// Luminance of what all emit together (for light from infinity: onto the sphere around the scene). \[W\]
    pub fn power(&self) -> f64 {
        self.powers.iter().sum()
    }
    /// Probability of picking an emitter: by the luminance of its power.
    pub fn pmf(&self, emitter: u32) -> f32 {
        self.pick.as_ref().map_or(0.0, |p| p.pmf(emitter as usize) as f32)
    }
    /// Density with which `sample` draws a point of an emitting shape, per area. [1/m^2]
    pub fn pdf_area(&self, emitter: u32) -> f32 {
        match &self.samplers[emitter as usize] {
            // Without area there is no point to draw.
            Sampler::Area { area, .. } if *area > 0.0 => (self.pmf(emitter) as f64 / area) as f32,
            _ => 0.0,
        }
    }
    /// Radiance from infinity. [W/(m^2 sr)]
    pub fn environment_radiance(&self, w: Vec3) -> Spectrum {
        match self.environment.map(|i| &self.samplers[i as usize]) {
            Some(Sampler::Constant { radiance }) => *radiance,
            Some(Sampler::Environment(map)) => map.radiance(w),
            _ => Spectrum::BLACK,
        }
    }
    /// Index of the light from infinity that a ray can meet.
    pub fn environment_emitter(&self) -> Option<u32> {
        self.environment
    }
    /// Is there light from infinity that a ray can meet?
    pub fn has_environment(&self) -> bool {
        self.environment.is_some()
    }
    /// Density with which `sample` draws a direction to infinity. [1/sr]
    pub fn environment_pdf_sa(&self, w: Vec3) -> f32 {
        let Some(i) = self.environment else { return 0.0 };
        let pdf = match &self.samplers[i as usize] {
            Sampler::Environment(map) => map.pdf_sa(w),
            _ => INV_4PI,
        };
        self.pmf(i) * pdf
    }

    /// Draws a point of an emitter, or a direction to infinity. `None` if nothing shines (there).
    pub fn sample(&self, geometry: &Geometry, textures: &[Texture], s: &mut Stream) -> Option<EmitterSample> {
        let i = self.pick.as_ref()?.sample(s.next_f64());
        self.draw(i, self.pmf(i as u32), None, geometry, textures, s)
    }
    /// Draws a point of one emitter, or of one triangle of it, or a direction: as `sample` does, were there no other emitter.
    /// `None` if there is nothing to draw.
    pub fn sample_part(
        &self,
        part: Part,
        geometry: &Geometry,
        textures: &[Texture],
        s: &mut Stream,
    ) -> Option<EmitterSample> {
        self.draw(part.emitter as usize, 1.0, part.triangle, geometry, textures, s)
    }
    /// Density with which `sample_part` draws a point of a shape [1/m^2], or this direction to infinity [1/sr]; `None` for points and
    /// parallel light.
    pub fn pdf_of_part(&self, part: Part, geometry: &Geometry, to_infinity: Vec3) -> Option<f32> {
        match &self.samplers[part.emitter as usize] {
            Sampler::Area { shape, area, .. } => {
                Some((1.0 / part_area(&geometry.shapes()[*shape as usize], part, *area)) as f32)
            }
            Sampler::Environment(map) => Some(map.pdf_sa(to_infinity)),
            Sampler::Constant { .. } => Some(INV_4PI),
            Sampler::Point { .. } | Sampler::Spot { .. } | Sampler::Directional { .. } => None,
        }
    }
    /// The emitters piece by piece: each triangle of a mesh, each other shape, each source that is no shape. What does not shine is
    /// left out. Where a texture makes them uneven the emitter's mean is taken for each.
    pub fn parts(&self, geometry: &Geometry, textures: &[Texture]) -> Vec<EmitterPart> {
        let mut parts = Vec::new();
        for (emitter, sampler) in self.samplers.iter().enumerate() {
            let whole = Part { emitter: emitter as u32, triangle: None };
            let mut add = |part, bounds: Aabb, axis, strength: f64| {
                if strength > 0.0 {
                    parts.push(EmitterPart { part, bounds, axis, strength: strength as f32 });
                }
            };
            let around = Aabb { lo: -Vec3::ONE, hi: Vec3::ONE };
            let luminance = |c: Spectrum| c.luminance() as f64;
            match sampler {
                Sampler::Area { shape, radiance, area, .. } => {
                    let mean = luminance(radiance.mean(textures));
                    match &geometry.shapes()[*shape as usize] {
                        ShapeGeometry::Mesh(m) => {
                            for t in 0..m.triangles.len() {
                                let part = Part { triangle: Some(t as u32), ..whole };
                                let x = geometry.surface_on_triangle(*shape, t as u32, Vec2::splat(1.0 / 3.0));
                                add(part, Aabb::around(m.corners(t)), PartAxis::About(x.ng), mean * m.triangle_area(t));
                            }
                        }
                        round @ ShapeGeometry::Disk(d) => {
                            add(whole, round.bounds(), PartAxis::About(d.frame.n), mean * area)
                        }
                        // Seen from anywhere it is a disc, a quarter of its surface.
                        round => add(whole, round.bounds(), PartAxis::AllAround, mean * 0.25 * area),
                    }
                }
                Sampler::Point { position, intensity } => {
                    add(whole, Aabb::point(*position), PartAxis::AllAround, luminance(*intensity))
                }
                Sampler::Spot { position, intensity, spot } => {
                    let axis = PartAxis::Within(spot.axis(), spot.cutoff());
                    add(whole, Aabb::point(*position), axis, luminance(*intensity))
                }
                Sampler::Directional { direction, irradiance } => {
                    add(whole, Aabb::point(-*direction), PartAxis::FromInfinity, luminance(*irradiance))
                }
                Sampler::Constant { radiance } => {
                    add(whole, around, PartAxis::FromInfinity, luminance(*radiance) * 4.0 * std::f64::consts::PI)
                }
                Sampler::Environment(map) => {
                    add(whole, around, PartAxis::FromInfinity, luminance(map.mean()) * 4.0 * std::f64::consts::PI)
                }
            }
        }
        parts
    }
    fn draw(
        &self,
        i: usize,
        pmf: f32,
        triangle: Option<u32>,
        geometry: &Geometry,
        textures: &[Texture],
        s: &mut Stream,
    ) -> Option<EmitterSample> {
        let made = |point: EmitterPoint, p: Vec3, flux: Spectrum, density: Option<f32>| {
            let vertex = Vertex { p, scatter: Scatter::Emitter(point) };
            Some(EmitterSample { vertex, flux, density, emitter: i as u32 })
        };
        match &self.samplers[i] {
            Sampler::Area { shape, radiance, area, triangles } => {
                let u = s.next_2d();
                let geometry_of = &geometry.shapes()[*shape as usize];
                let part = Part { emitter: i as u32, triangle };
                let x = match (triangles, geometry_of) {
                    (Some(table), _) => {
                        let triangle = triangle.unwrap_or_else(|| table.sample(s.next_f64()) as u32);
                        geometry.surface_on_triangle(*shape, triangle, warp::triangle(u))
                    }
                    (None, ShapeGeometry::Sphere(_)) => geometry.surface_on_sphere(*shape, warp::sphere(u)),
                    (None, ShapeGeometry::Disk(_)) => geometry.surface_on_disk(*shape, warp::disc(u)),
                    (None, ShapeGeometry::Mesh(_)) => return None, // without area
                };
                let density = pmf / part_area(geometry_of, part, *area) as f32;
                let point = EmitterPoint::Lambert { n: x.ng, error: x.error };
                made(point, x.p, radiance.at(textures, x.uv) * (PI / density), Some(density))
            }
            Sampler::Point { position, intensity } => {
                made(EmitterPoint::Isotropic, *position, *intensity * (4.0 * PI / pmf), None)
            }
            Sampler::Spot { position, intensity, spot } => {
                made(EmitterPoint::Spot(*spot), *position, *intensity * (spot.solid_angle() / pmf), None)
            }
            Sampler::Directional { direction, irradiance } => made(
                EmitterPoint::Distant { towards: -*direction, disc: self.disc() },
                self.world.0,
                *irradiance * (1.0 / pmf),
                None,
            ),
            Sampler::Constant { radiance } => {
                let towards = warp::sphere(s.next_2d());
                let density = pmf * INV_4PI;
                made(
                    EmitterPoint::Distant { towards, disc: self.disc() },
                    self.world.0,
                    *radiance * (1.0 / density),
                    Some(density),
                )
            }
            Sampler::Environment(map) => {
                let (towards, pdf) = map.sample([s.next_f64(), s.next_f64()])?;
                let density = pmf * pdf;
                made(
                    EmitterPoint::Distant { towards, disc: self.disc() },
                    self.world.0,
                    map.radiance(towards) * (1.0 / density),
                    Some(density),
                )
            }
        }
    }
    /// Area of a disc that the scene fits in. \[m^2\]
    pub fn disc(&self) -> f32 {
        PI * self.world.1 * self.world.1
    }
    /// Draws a ray of light: a point as `sample`, and a direction by its lobe (a point of the disc that the scene fits in, for
    /// light from infinity). `None` if nothing shines (there).
    pub fn sample_ray(&self, geometry: &Geometry, textures: &[Texture], s: &mut Stream) -> Option<Emission> {
        let start = self.sample(geometry, textures, s)?;
        let Scatter::Emitter(point) = start.vertex.scatter else { return None };
        let (ray, flux) = match point {
            EmitterPoint::Lambert { n, error } => {
                let dir = Frame::around(n).to_world(warp::cosine_hemisphere(s.next_2d()));
                (Ray::new(offset_from(start.vertex.p, n, error, dir), dir), start.flux)
            }
            EmitterPoint::Isotropic => (Ray::new(start.vertex.p, warp::sphere(s.next_2d())), start.flux),
            EmitterPoint::Spot(spot) => (Ray::new(start.vertex.p, spot.sample(s.next_2d())), start.flux),
            EmitterPoint::Distant { towards, disc } => {
                let (centre, radius) = self.world;
                let (frame, d) = (Frame::around(towards), warp::disc(s.next_2d()) * radius);
                let origin = centre + (towards * radius + frame.s * d.x + frame.t * d.y);
                (Ray::new(origin, -towards), start.flux * disc)
            }
        };
        Some(Emission { start, ray, flux })
    }
}

impl EmitterPoint {
    /// Largest normalised emission: 1/pi, 1/(4 pi), or 1 for light from infinity; without a cosine. [1/sr]
    pub(crate) fn peak(&self) -> f32 {
        match self {
            EmitterPoint::Lambert { .. } => INV_PI,
            EmitterPoint::Isotropic => INV_4PI,
            EmitterPoint::Spot(spot) => spot.peak(),
            EmitterPoint::Distant { .. } => 1.0,
        }
    }
}
