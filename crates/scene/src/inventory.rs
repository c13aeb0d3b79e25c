//! What a scene is made of, counted.

use crate::{Material, MaterialId, Medium, Model, Scene, Texture};
use manylight_geometry::{Geometry, ShapeGeometry};
use manylight_math::{Spectrum, Vec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Counts by kind, and memory. Names are those of Mitsuba's plugins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inventory {
    /// Shapes: `mesh`, `sphere`, `disk`; surfaces that only part media are `boundary`.
    pub shapes: BTreeMap<&'static str, usize>,
    /// Triangles of all meshes.
    pub triangles: usize,
    /// Shapes by what they are made of; one may be counted by several.
    pub bsdfs: BTreeMap<&'static str, usize>,
    /// Emitters.
    pub lights: BTreeMap<&'static str, usize>,
    /// Triangles that shine.
    pub shining_triangles: usize,
    /// Media.
    pub media: BTreeMap<&'static str, usize>,
    /// Textures.
    pub textures: BTreeMap<&'static str, usize>,
    /// Vertices and triangles of meshes. \[byte\]
    pub mesh_bytes: usize,
    /// The tree over all shapes, and the one over boundaries. \[byte\]
    pub tree_bytes: usize,
    /// Images, each counted once. \[byte\]
    pub image_bytes: usize,
}

impl Scene {
    /// What the scene is made of.
    pub fn inventory(&self) -> Inventory {
        let mut all = Inventory::default();
        let add = |counts: &mut BTreeMap<_, _>, kind| *counts.entry(kind).or_insert(0) += 1;
        all.count_geometry(self.geometry());
        for (i, shape) in self.shapes.iter().enumerate() {
            let MaterialId(material) = shape.material;
            for kind in self.materials[material as usize].kinds() {
                add(&mut all.bsdfs, kind);
            }
            if let (true, ShapeGeometry::Mesh(m)) = (shape.emitter != u32::MAX, &self.geometry.shapes()[i]) {
                all.shining_triangles += m.triangles.len();
            }
        }
        self.emitters().kinds().for_each(|kind| add(&mut all.lights, kind));
        let mut images = BTreeSet::new();
        for texture in &self.textures {
            add(&mut all.textures, if let Texture::Bitmap { .. } = texture { "bitmap" } else { "checkerboard" });
            if let Texture::Bitmap { image, .. } = texture
                && images.insert(Arc::as_ptr(image))
            {
                all.image_bytes += image.pixels.len() * size_of::<Spectrum>();
            }
        }
        all.image_bytes += self.emitters().image_bytes();
        for (_, medium) in self.media() {
            add(&mut all.media, if let Medium::Homogeneous(_) = medium { "homogeneous" } else { "heterogeneous" });
        }
        if let Some(boundaries) = self.boundaries() {
            let own = std::mem::take(&mut all.shapes);
            all.count_geometry(boundaries);
            let boundary = std::mem::replace(&mut all.shapes, own).into_values().sum();
            all.shapes.insert("boundary", boundary);
        }
        all
    }
}

impl Inventory {
    fn count_geometry(&mut self, geometry: &Geometry) {
        for shape in geometry.shapes() {
            let kind = match shape {
                ShapeGeometry::Mesh(m) => {
                    self.triangles += m.triangles.len();
                    self.mesh_bytes += (m.positions.len() + m.normals.len()) * size_of::<Vec3>()
                        + m.uvs.len() * size_of::<Vec2>()
                        + m.triangles.len() * size_of::<[u32; 3]>();
                    "mesh"
                }
                ShapeGeometry::Sphere(_) => "sphere",
                ShapeGeometry::Disk(_) => "disk",
            };
            *self.shapes.entry(kind).or_insert(0) += 1;
        }
        self.tree_bytes += geometry.bytes();
    }
}

impl Material {
    /// The names of everything in it.
    fn kinds(&self) -> BTreeSet<&'static str> {
        let mut kinds = BTreeSet::new();
        kinds.extend(self.opacity.map(|_| "mask"));
        kinds.extend(self.back.is_some().then_some("twosided"));
        self.front.add_kinds(&mut kinds);
        self.back.iter().for_each(|m| m.add_kinds(&mut kinds));
        kinds
    }
}

impl Model {
    fn add_kinds(&self, kinds: &mut BTreeSet<&'static str>) {
        let kind = match self {
            Model::Diffuse { .. } => "diffuse",
            Model::Conductor { .. } => "conductor",
            Model::RoughConductor { .. } => "roughconductor",
            Model::Dielectric { .. } => "dielectric",
            Model::ThinDielectric { .. } => "thindielectric",
            Model::RoughDielectric { .. } => "roughdielectric",
            Model::Plastic { .. } => "plastic",
            Model::RoughPlastic { .. } => "roughplastic",
            Model::Principled(_) => "principled",
            Model::Roughened { model, .. } => return model.add_kinds(kinds),
            Model::Relief { relief, model, .. } => {
                model.add_kinds(kinds);
                if let crate::Relief::Bump { .. } = relief { "bumpmap" } else { "normalmap" }
            }
            Model::Blend { models, .. } => {
                models.iter().for_each(|m| m.add_kinds(kinds));
                "blendbsdf"
            }
        };
        kinds.insert(kind);
    }
}
