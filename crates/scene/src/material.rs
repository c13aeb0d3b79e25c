//! What surfaces are made of, before texture coordinates are known.

use crate::relief::{Relief, Seen};
use crate::{Source, Texture, TextureId};
use manylight_bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, Distribution, Plastic, Principled, PrincipledParameters, RoughConductor,
    RoughDielectric, RoughPlastic, RoughTransmittance, ThinDielectric,
};
use manylight_geometry::Surface;
use manylight_math::{Frame, Spectrum, Vec2, Vec3};

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
    /// A sheet of glass without thickness.
    ThinDielectric {
        /// Refractive index of the sheet.
        int_ior: f32,
        /// Refractive index outside.
        ext_ior: f32,
        /// Multiplies the reflection.
        reflectance: Source,
        /// Multiplies the transmission.
        transmittance: Source,
    },
    /// Rough glass.
    RoughDielectric {
        /// Of the microfacets' normals.
        distribution: Distribution,
        /// Roughness along the tangent and the bitangent.
        alpha: (f32, f32),
        /// Refractive index on the side away from the normal; not that of the other side.
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
    /// Metal, glass, cloth and lacquer by a dozen numbers.
    Principled(Box<PrincipledSources>),
    /// A model under a relief.
    Relief {
        /// What turns its shading frame.
        relief: Relief,
        /// Factor that darkens light from below the horizon of the relief's slopes (Conty Estevez et al. 2019)?
        shadowed: bool,
        /// The back of the surface has the mirror image of the relief, not its mould.
        mirrored: bool,
        /// What scatters.
        model: Box<Model>,
    },
    /// A rough conductor or dielectric whose roughness is looked up.
    Roughened {
        /// Roughness along the tangent; the luminance counts.
        alpha_u: Source,
        /// Roughness along the bitangent.
        alpha_v: Source,
        /// What is made rough; its own roughness means nothing.
        model: Box<Model>,
    },
    /// One of two models at each point: the second with the probability `weight`.
    Blend {
        /// The luminance counts, between 0 and 1.
        weight: Source,
        /// The two.
        models: Box<[Model; 2]>,
    },
}

/// What a [`Principled`] is made of ([`PrincipledParameters`]), before texture coordinates are known. Of all but the colour the
/// luminance counts.
#[derive(Clone, Debug)]
#[allow(missing_docs)] // by the names of `PrincipledParameters`
pub struct PrincipledSources {
    pub base_color: Source,
    pub roughness: Source,
    pub anisotropic: Source,
    pub metallic: Source,
    pub spec_trans: Source,
    pub eta: f32,
    pub spec_tint: Source,
    pub sheen: Source,
    pub sheen_tint: Source,
    pub flatness: Source,
    pub clearcoat: Source,
    pub clearcoat_gloss: Source,
}

impl PrincipledSources {
    fn all(&self) -> [&Source; 11] {
        [
            &self.base_color,
            &self.roughness,
            &self.anisotropic,
            &self.metallic,
            &self.spec_trans,
            &self.spec_tint,
            &self.sheen,
            &self.sheen_tint,
            &self.flatness,
            &self.clearcoat,
            &self.clearcoat_gloss,
        ]
    }
    fn at(&self, textures: &[Texture], uv: Vec2) -> Principled {
        let number = |s: &Source| match s {
            // Exactly, where the luminance of a gray is not.
            Source::Constant(c) => c.mean(),
            texture => texture.at(textures, uv).luminance(),
        };
        Principled::new(&PrincipledParameters {
            base_color: self.base_color.at(textures, uv),
            roughness: number(&self.roughness),
            anisotropic: number(&self.anisotropic),
            metallic: number(&self.metallic),
            spec_trans: number(&self.spec_trans),
            eta: self.eta,
            spec_tint: number(&self.spec_tint),
            sheen: number(&self.sheen),
            sheen_tint: number(&self.sheen_tint),
            flatness: number(&self.flatness),
            clearcoat: number(&self.clearcoat),
            clearcoat_gloss: number(&self.clearcoat_gloss),
        })
    }
    /// Can any of it be glass?
    pub fn transmits(&self) -> bool {
        self.spec_trans != Source::Constant(Spectrum::BLACK)
    }
    /// Does a texture say how sharp its lobes are?
    fn is_roughened(&self) -> bool {
        let sharpness = [&self.roughness, &self.anisotropic, &self.clearcoat, &self.clearcoat_gloss];
        sharpness.into_iter().any(|s| matches!(s, Source::Texture(_)))
    }
}

/// A model at a point: what scatters there, in which frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolved {
    pub bsdf: Bsdf,
    pub frame: Frame,
    /// Of the relief, if it casts shadows: the shading normal without it, and the squared roughness that it stands for.
    pub shadows: Option<(Vec3, f32)>,
}

impl Model {
    /// The model at a surface. `frame`: the shading frame of the side that is seen. `coin` in [0, 1) chooses between models.
    pub(crate) fn at(
        &self,
        textures: &[Texture],
        x: &Surface,
        derivatives: impl Fn() -> (Vec3, Vec3),
        (frame, seen): (Frame, Seen),
        mut coin: f32,
    ) -> Resolved {
        let (mut model, mut out) = (self, Resolved { bsdf: Bsdf::Black, frame, shadows: None });
        loop {
            match model {
                Model::Relief { relief, shadowed, mirrored, model: inner } => {
                    let turned = relief.turn(textures, x, derivatives(), out.frame, seen, *mirrored);
                    if *shadowed {
                        let cos2 = turned.n.dot(out.frame.n).powi(2);
                        let alpha2 = (0.125 * (1.0 - cos2).max(0.0) / cos2).min(1.0);
                        out.shadows = (alpha2 > 0.0).then_some((out.frame.n, alpha2));
                    }
                    (out.frame, model) = (turned, inner);
                }
                Model::Blend { weight, models } => {
                    let weight = weight.at(textures, x.uv).luminance().clamp(0.0, 1.0);
                    let second = coin < weight;
                    // What is left of the coin is uniform again.
                    coin = if second { coin / weight } else { (coin - weight) / (1.0 - weight) };
                    model = &models[usize::from(second)];
                }
                leaf => return Resolved { bsdf: leaf.resolve(textures, x.uv), ..out },
            }
        }
    }
    /// How many models it may become.
    pub fn choices(&self) -> usize {
        self.leaves().len()
    }
    /// Does light pass through?
    pub fn transmits(&self) -> bool {
        let glass = |m: &&Model| match m {
            Model::Dielectric { .. } | Model::ThinDielectric { .. } | Model::RoughDielectric { .. } => true,
            Model::Principled(p) => p.transmits(),
            _ => false,
        };
        self.leaves().iter().any(glass)
    }
    /// Is a roughness in it a texture?
    pub(crate) fn is_roughened(&self) -> bool {
        match self {
            Model::Relief { model, .. } => model.is_roughened(),
            Model::Roughened { .. } => true,
            Model::Principled(p) => p.is_roughened(),
            Model::Blend { models, .. } => models.iter().any(Model::is_roughened),
            _ => false,
        }
    }
    /// All models without relief that it may become.
    pub(crate) fn leaves(&self) -> Vec<&Model> {
        match self {
            Model::Relief { model, .. } | Model::Roughened { model, .. } => model.leaves(),
            Model::Blend { models, .. } => models.iter().flat_map(Model::leaves).collect(),
            leaf => vec![leaf],
        }
    }
    /// The BSDF at texture coordinates; of a blend the first, of a relief the model below.
    pub fn resolve(&self, textures: &[Texture], uv: Vec2) -> Bsdf {
        let at = |s: &Source| s.at(textures, uv);
        match self {
            Model::Relief { model, .. } => model.resolve(textures, uv),
            Model::Blend { models, .. } => models[0].resolve(textures, uv),
            Model::Roughened { alpha_u, alpha_v, model } => {
                let rough = [at(alpha_u), at(alpha_v)].map(|alpha| alpha.luminance().max(0.0));
                model.with_alpha(rough).resolve(textures, uv)
            }
            Model::Diffuse { reflectance } => Diffuse::new(at(reflectance)).into(),
            Model::Conductor { eta, k, reflectance } => Conductor::new(*eta, *k, at(reflectance)).into(),
            Model::RoughConductor { distribution, alpha_u, alpha_v, eta, k, reflectance } => {
                RoughConductor::new(*distribution, *alpha_u, *alpha_v, *eta, *k, at(reflectance)).into()
            }
            Model::Dielectric { int_ior, ext_ior, reflectance, transmittance } => {
                Dielectric::new(*int_ior, *ext_ior, at(reflectance), at(transmittance)).into()
            }
            Model::ThinDielectric { int_ior, ext_ior, reflectance, transmittance } => {
                ThinDielectric::new(*int_ior, *ext_ior, at(reflectance), at(transmittance)).into()
            }
            Model::RoughDielectric { distribution, alpha, int_ior, ext_ior, reflectance, transmittance } => {
                let indices = (*int_ior, *ext_ior);
                RoughDielectric::new(*distribution, *alpha, indices, at(reflectance), at(transmittance)).into()
            }
            Model::Plastic { int_ior, ext_ior, diffuse, specular, nonlinear } => {
                Plastic::new(*int_ior, *ext_ior, at(diffuse), at(specular), *nonlinear).into()
            }
            Model::RoughPlastic { coat, diffuse, specular, nonlinear } => {
                RoughPlastic::new(coat, at(diffuse), at(specular), *nonlinear).into()
            }
            Model::Principled(p) => p.at(textures, uv).into(),
        }
    }
    /// With another roughness, if it has one.
    fn with_alpha(&self, [u, v]: [f32; 2]) -> Model {
        let mut model = self.clone();
        match &mut model {
            Model::RoughConductor { alpha_u, alpha_v, .. } => (*alpha_u, *alpha_v) = (u, v),
            Model::RoughDielectric { alpha, .. } => *alpha = (u, v),
            _ => {}
        }
        model
    }
    /// The textures that it names.
    pub(crate) fn textures(&self) -> Vec<TextureId> {
        let of = |sources: &[&Source]| {
            let id = |s: &&Source| if let Source::Texture(id) = s { Some(*id) } else { None };
            sources.iter().filter_map(id).collect()
        };
        match self {
            Model::Diffuse { reflectance }
            | Model::Conductor { reflectance, .. }
            | Model::RoughConductor { reflectance, .. } => of(&[reflectance]),
            Model::Dielectric { reflectance, transmittance, .. }
            | Model::ThinDielectric { reflectance, transmittance, .. }
            | Model::RoughDielectric { reflectance, transmittance, .. } => of(&[reflectance, transmittance]),
            Model::Plastic { diffuse, specular, .. } | Model::RoughPlastic { diffuse, specular, .. } => {
                of(&[diffuse, specular])
            }
            Model::Principled(p) => of(&p.all()),
            Model::Relief { relief, model, .. } => [vec![relief.texture()], model.textures()].concat(),
            Model::Roughened { alpha_u, alpha_v, model } => [of(&[alpha_u, alpha_v]), model.textures()].concat(),
            Model::Blend { weight, models } => [of(&[weight]), models[0].textures(), models[1].textures()].concat(),
        }
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
    /// The fraction of the surface that is there (its luminance counts, between 0 and 1); light passes through the rest.
    pub opacity: Option<Source>,
}

impl Material {
    /// Black from behind, unless it is a dielectric.
    pub fn one_sided(name: impl Into<String>, front: Model) -> Self {
        Material { name: name.into(), front, back: None, opacity: None }
    }
    /// The same from both sides.
    pub fn two_sided(name: impl Into<String>, model: Model) -> Self {
        Material { name: name.into(), front: model.clone(), back: Some(model), opacity: None }
    }
}
