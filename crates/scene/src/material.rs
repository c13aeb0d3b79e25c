//! What surfaces are made of, before texture coordinates are known.

use crate::{Source, Texture, TextureId};
use manylight_bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, Distribution, Plastic, RoughConductor, RoughPlastic, RoughTransmittance,
};
use manylight_math::{Spectrum, Vec2};

/// Index of a material in its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// A scattering model whose colours may be textures. Parameters as in Mitsuba 3's plugins of the same names.
#[derive(Clone, Debug)]
pub enum Model {
    /// Lambert's.
    Diffuse {
        /// Albedo.
        reflectance: Source,
    },
    /// A smooth mirror of metal.
    Conductor {
        /// Real part of the refractive index.
        eta: Spectrum,
        /// Imaginary part.
        k: Spectrum,
        /// Multiplies the reflection.
        reflectance: Source,
    },
    /// A rough metal.
    RoughConductor {
        /// Of the microfacets' normals.
        distribution: Distribution,
        /// Roughness along the tangent.
        alpha_u: f32,
        /// Roughness along the bitangent.
        alpha_v: f32,
        /// Real part of the refractive index.
        eta: Spectrum,
        /// Imaginary part.
        k: Spectrum,
        /// Multiplies the reflection.
        reflectance: Source,
    },
    /// Smooth glass.
    Dielectric {
        /// Refractive index on the side away from the normal.
        int_ior: f32,
        /// Refractive index on the side of the normal.
        ext_ior: f32,
        /// Multiplies the reflection.
        reflectance: Source,
        /// Multiplies the transmission.
        transmittance: Source,
    },
    /// A smooth coat over a diffuse base.
    Plastic {
        /// Refractive index of the coat.
        int_ior: f32,
        /// Refractive index outside.
        ext_ior: f32,
        /// Albedo of the base.
        diffuse: Source,
        /// Multiplies the reflection of the coat.
        specular: Source,
        /// Does light scattered inside change colour?
        nonlinear: bool,
    },
    /// A rough coat over a diffuse base.
    RoughPlastic {
        /// Distribution, roughness and refractive index of the coat.
        coat: &'static RoughTransmittance,
        /// Albedo of the base.
        diffuse: Source,
        /// Multiplies the reflection of the coat.
        specular: Source,
        /// Does light scattered inside change colour?
        nonlinear: bool,
    },
}

impl Model {
    /// The BSDF at texture coordinates.
    pub fn resolve(&self, textures: &[Texture], uv: Vec2) -> Bsdf {
        let at = |s: &Source| s.at(textures, uv);
        match self {
            Model::Diffuse { reflectance } => Diffuse::new(at(reflectance)).into(),
            Model::Conductor { eta, k, reflectance } => Conductor::new(*eta, *k, at(reflectance)).into(),
            Model::RoughConductor { distribution, alpha_u, alpha_v, eta, k, reflectance } => {
                RoughConductor::new(*distribution, *alpha_u, *alpha_v, *eta, *k, at(reflectance)).into()
            }
            Model::Dielectric { int_ior, ext_ior, reflectance, transmittance } => {
                Dielectric::new(*int_ior, *ext_ior, at(reflectance), at(transmittance)).into()
            }
            Model::Plastic { int_ior, ext_ior, diffuse, specular, nonlinear } => {
                Plastic::new(*int_ior, *ext_ior, at(diffuse), at(specular), *nonlinear).into()
            }
            Model::RoughPlastic { coat, diffuse, specular, nonlinear } => {
                RoughPlastic::new(coat, at(diffuse), at(specular), *nonlinear).into()
            }
        }
    }
    /// The textures that it names.
    pub(crate) fn textures(&self) -> impl Iterator<Item = TextureId> {
        let sources = match self {
            Model::Diffuse { reflectance }
            | Model::Conductor { reflectance, .. }
            | Model::RoughConductor { reflectance, .. } => [Some(reflectance), None],
            Model::Dielectric { reflectance, transmittance, .. } => [Some(reflectance), Some(transmittance)],
            Model::Plastic { diffuse, specular, .. } | Model::RoughPlastic { diffuse, specular, .. } => {
                [Some(diffuse), Some(specular)]
            }
        };
        sources.into_iter().flatten().filter_map(|s| if let Source::Texture(id) = s { Some(*id) } else { None })
    }
}

/// A material: one model a side.
#[derive(Clone, Debug)]
pub struct Material {
    /// For messages.
    pub name: String,
    /// On the side of the shading normal.
    pub front: Model,
    /// On the other side, as if the normal were turned round; `None`: one-sided (black behind), or a dielectric.
    pub back: Option<Model>,
}

impl Material {
    /// Black from behind, unless it is a dielectric.
    pub fn one_sided(name: impl Into<String>, front: Model) -> Self {
        Material { name: name.into(), front, back: None }
    }
    /// The same from both sides.
    pub fn two_sided(name: impl Into<String>, model: Model) -> Self {
        Material { name: name.into(), front: model.clone(), back: Some(model) }
    }
}
