//! Materials as nested BSDFs.

use super::elements::{Xml, rgb, texture};
use super::{WriteError, source, unsayable};
use manylight_bsdf::Distribution;
use manylight_math::Spectrum;
use manylight_scene::{Material, Model, Relief, Scene, Source};

/// One material under an id.
pub(super) fn write(scene: &Scene, material: &Material, id: &str, xml: &mut Xml) -> Result<(), WriteError> {
    xml.remark(&material.name);
    let mut writer = Writer { scene, xml, name: &material.name, id: Some(id) };
    match &material.opacity {
        None => writer.sides(&material.front, material.back.as_ref()),
        Some(opacity) => {
            writer.open("mask");
            source(scene, "opacity", opacity, writer.xml);
            writer.sides(&material.front, material.back.as_ref())?;
            writer.xml.close();
            Ok(())
        }
    }
}

/// Of a gray the number that it was made of, which its luminance is to rounding only.
fn number(c: Spectrum) -> f32 {
    if c == Spectrum::gray(c.0.x) { c.0.x } else { c.luminance() }
}

struct Writer<'a> {
    scene: &'a Scene,
    xml: &'a mut Xml,
    name: &'a str,
    /// The outermost takes it.
    id: Option<&'a str>,
}

impl Writer<'_> {
    fn open(&mut self, plugin: &str) {
        let mut attributes = vec![("type", plugin)];
        attributes.extend(self.id.take().map(|id| ("id", id)));
        self.xml.open("bsdf", &attributes);
    }
    fn sides(&mut self, front: &Model, back: Option<&Model>) -> Result<(), WriteError> {
        match (front, back) {
            (_, None) => self.model(front, false),
            // A relief around both sides, of which one sees the mould of the other.
            (
                Model::Relief { relief, shadowed, mirrored: false, model },
                Some(Model::Relief { relief: other, mirrored: false, model: behind, shadowed: too }),
            ) if relief == other && shadowed == too => {
                self.relief(relief, *shadowed);
                self.sides(model, Some(behind))?;
                self.xml.close();
                Ok(())
            }
            (front, Some(back)) => {
                self.open("twosided");
                self.model(front, true)?;
                self.model(back, true)?;
                self.xml.close();
                Ok(())
            }
        }
    }
    fn relief(&mut self, relief: &Relief, shadowed: bool) {
        self.open(if let Relief::Bump { .. } = relief { "bumpmap" } else { "normalmap" });
        if let Relief::Bump { scale, .. } = relief {
            self.xml.property("float", "scale", scale);
        }
        self.xml.property("boolean", "use_shadowing_function", shadowed);
        texture(self.scene, "normalmap", relief.texture(), self.xml);
    }
    fn source(&mut self, name: &str, s: &Source) {
        source(self.scene, name, s, self.xml);
    }
    fn microfacets(&mut self, distribution: Distribution) {
        let name = match distribution {
            Distribution::Beckmann => "beckmann",
            Distribution::Ggx => "ggx",
        };
        self.xml.property("string", "distribution", name);
    }
    fn indices(&mut self, int_ior: f32, ext_ior: f32) {
        self.xml.property("float", "int_ior", int_ior);
        self.xml.property("float", "ext_ior", ext_ior);
    }
    fn alphas(&mut self, rough: Option<[&Source; 2]>, (u, v): (f32, f32)) {
        let names = ["alpha_u", "alpha_v"];
        match rough {
            None => names.into_iter().zip([u, v]).for_each(|(name, x)| self.xml.property("float", name, x)),
            Some(sources) => names.into_iter().zip(sources).for_each(|(name, s)| match s {
                Source::Constant(c) => self.xml.property("float", name, number(*c)),
                textured => self.source(name, textured),
            }),
        }
    }
    fn model(&mut self, model: &Model, inside: bool) -> Result<(), WriteError> {
        match model {
            Model::Relief { relief, shadowed, mirrored, model } => {
                if *mirrored != inside {
                    let why = "a relief of one side alone is mirrored inside of a two-sided material, and nowhere else";
                    return Err(unsayable(format!("the material `{}`", self.name), why));
                }
                self.relief(relief, *shadowed);
                self.model(model, inside)?;
            }
            Model::Blend { weight, models } => {
                self.open("blendbsdf");
                match weight {
                    Source::Constant(c) => self.xml.property("float", "weight", number(*c)),
                    textured => self.source("weight", textured),
                }
                models.iter().try_for_each(|m| self.model(m, inside))?;
            }
            Model::Roughened { alpha_u, alpha_v, model } => self.leaf(model, Some([alpha_u, alpha_v]))?,
            leaf => self.leaf(leaf, None)?,
        }
        self.xml.close();
        Ok(())
    }
    /// Opens a model without nested ones.
    fn leaf(&mut self, model: &Model, rough: Option<[&Source; 2]>) -> Result<(), WriteError> {
        match model {
            Model::Diffuse { reflectance } => {
                self.open("diffuse");
                self.source("reflectance", reflectance);
            }
            Model::Conductor { eta, k, reflectance } => {
                self.open("conductor");
                rgb(self.xml, "eta", *eta);
                rgb(self.xml, "k", *k);
                self.source("specular_reflectance", reflectance);
            }
            Model::RoughConductor { distribution, alpha_u, alpha_v, eta, k, reflectance } => {
                self.open("roughconductor");
                self.microfacets(*distribution);
                self.alphas(rough, (*alpha_u, *alpha_v));
                rgb(self.xml, "eta", *eta);
                rgb(self.xml, "k", *k);
                self.source("specular_reflectance", reflectance);
            }
            Model::Dielectric { int_ior, ext_ior, reflectance, transmittance }
            | Model::ThinDielectric { int_ior, ext_ior, reflectance, transmittance } => {
                self.open(if let Model::Dielectric { .. } = model { "dielectric" } else { "thindielectric" });
                self.indices(*int_ior, *ext_ior);
                self.source("specular_reflectance", reflectance);
                self.source("specular_transmittance", transmittance);
            }
            Model::RoughDielectric { distribution, alpha, int_ior, ext_ior, reflectance, transmittance } => {
                self.open("roughdielectric");
                self.microfacets(*distribution);
                self.alphas(rough, *alpha);
                self.indices(*int_ior, *ext_ior);
                self.source("specular_reflectance", reflectance);
                self.source("specular_transmittance", transmittance);
            }
            Model::Plastic { int_ior, ext_ior, diffuse, specular, nonlinear } => {
                self.open("plastic");
                self.indices(*int_ior, *ext_ior);
                self.source("diffuse_reflectance", diffuse);
                self.source("specular_reflectance", specular);
                self.xml.property("boolean", "nonlinear", nonlinear);
            }
            Model::RoughPlastic { coat, diffuse, specular, nonlinear } => {
                self.open("roughplastic");
                self.microfacets(coat.distribution());
                self.xml.property("float", "alpha", coat.alpha());
                self.indices(coat.eta(), 1.0);
                self.source("diffuse_reflectance", diffuse);
                self.source("specular_reflectance", specular);
                self.xml.property("boolean", "nonlinear", nonlinear);
            }
            Model::Principled(p) => {
                self.open("principled");
                self.source("base_color", &p.base_color);
                self.xml.property("float", "eta", p.eta);
                for (name, part) in [
                    ("roughness", &p.roughness),
                    ("anisotropic", &p.anisotropic),
                    ("metallic", &p.metallic),
                    ("spec_trans", &p.spec_trans),
                    ("spec_tint", &p.spec_tint),
                    ("sheen", &p.sheen),
                    ("sheen_tint", &p.sheen_tint),
                    ("flatness", &p.flatness),
                    ("clearcoat", &p.clearcoat),
                    ("clearcoat_gloss", &p.clearcoat_gloss),
                ] {
                    match part {
                        Source::Constant(c) => self.xml.property("float", name, number(*c)),
                        textured => self.source(name, textured),
                    }
                }
            }
            Model::Relief { .. } | Model::Roughened { .. } | Model::Blend { .. } => {
                return Err(unsayable(
                    format!("the material `{}`", self.name),
                    "only rough conductors and dielectrics have a textured roughness",
                ));
            }
        }
        Ok(())
    }
}
