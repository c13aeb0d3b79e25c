//! A number that tells scenes apart.

use crate::{Scene, Texture};
use manylight_geometry::{Geometry, ShapeGeometry};

impl Scene {
    /// A number that differs where scenes differ: FNV-1a over geometry, materials, textures, emitters and camera.
    pub fn hash(&self) -> u64 {
        let mut h = Fnv(0xcbf2_9ce4_8422_2325);
        for (shape, placed) in self.geometry.shapes().iter().zip(&self.shapes) {
            h.shape(shape);
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
        if let Some(media) = &self.media {
            media.list.iter().for_each(|m| h.add(format!("{m:?}").as_bytes()));
            h.add(format!("{:?} {:?}", media.of_shape, media.boundaries.as_ref().map(|b| b.geometry().1)).as_bytes());
            media.boundaries.iter().for_each(|b| h.geometry(b.geometry().0));
        }
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
    fn geometry(&mut self, geometry: &Geometry) {
        geometry.shapes().iter().for_each(|s| self.shape(s));
    }
    fn shape(&mut self, shape: &ShapeGeometry) {
        match shape {
            ShapeGeometry::Mesh(m) => {
                m.positions.iter().chain(&m.normals).for_each(|p| self.floats(&p.to_array()));
                m.uvs.iter().for_each(|p| self.floats(&p.to_array()));
                m.triangles.iter().flatten().for_each(|i| self.add(&i.to_le_bytes()));
            }
            round => self.add(format!("{round:?}").as_bytes()),
        }
    }
    fn floats(&mut self, values: &[f32]) {
        values.iter().for_each(|x| self.add(&x.to_bits().to_le_bytes()));
    }
}
