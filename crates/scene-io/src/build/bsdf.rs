//! Materials.

use super::Builder;
use super::texture::Range;
use crate::document::{Class, ObjectId, Value, refuse_plugin};
use crate::ior;
use crate::query::Query;
use manylight_bsdf::{Distribution, RoughTransmittance};
use manylight_math::Spectrum;
use manylight_scene::{Material, MaterialId, Model};

const BSDFS: [&str; 8] =
    ["diffuse", "conductor", "roughconductor", "dielectric", "plastic", "roughplastic", "twosided", "null"];
const MITSUBA: [&str; 17] = [
    "thindielectric",
    "roughdielectric",
    "mask",
    "bumpmap",
    "normalmap",
    "blendbsdf",
    "principled",
    "principledthin",
    "measured",
    "measured_polarized",
    "hair",
    "pplastic",
    "circular",
    "linear",
    "polarizer",
    "retarder",
    "volumegrid",
];

impl<'a> Builder<'a> {
    /// A material; one that is named twice is made once. `None`: it is wrong, which is in the report.
    pub(super) fn material(&mut self, id: ObjectId) -> Option<MaterialId> {
        if let Some(known) = self.materials.get(&id) {
            return *known;
        }
        let made = self.make_material(id).map(|m| self.scene.material(m));
        self.materials.insert(id, made);
        made
    }

    /// Is it the BSDF of a surface that does nothing, but may part media?
    pub(super) fn is_null(&self, id: ObjectId) -> bool {
        let q = self.query(id);
        let null = q.object.plugin == "null";
        if null {
            q.finish();
        }
        null
    }

    /// What a shape without a BSDF is made of: grey, or black if it is a light.
    pub(super) fn default_material(&mut self, emits: bool) -> MaterialId {
        let made = self.default_materials[usize::from(emits)].unwrap_or_else(|| {
            let reflectance = Self::gray(if emits { 0.0 } else { 0.5 });
            self.scene.material(Material::one_sided("default", Model::Diffuse { reflectance }))
        });
        self.default_materials[usize::from(emits)] = Some(made);
        made
    }

    fn make_material(&mut self, id: ObjectId) -> Option<Material> {
        let q = self.query(id);
        let name = q.object.id.clone().unwrap_or_else(|| q.object.plugin.clone());
        if q.object.plugin != "twosided" {
            return self.model(id).map(|model| Material::one_sided(name, model));
        }
        let sides = q.children(Class::Bsdf);
        if sides.is_empty() && !q.object.broken {
            q.error("`twosided` needs a nested <bsdf> (or two: front and back)");
        }
        if let Some((_, third)) = sides.get(2) {
            self.report.error(third.at, "`twosided` has a front and a back already: it takes only two <bsdf>");
        }
        q.finish();
        let mut models = Vec::new();
        for (side, p) in sides.iter().take(2) {
            match self.document.object(*side).plugin.as_str() {
                transmits @ ("dielectric" | "twosided" | "null") => {
                    let why = if transmits == "twosided" { "it has two sides itself" } else { "it lets light through" };
                    self.report.error(p.at, format!("`twosided` cannot hold `{transmits}`: {why}"));
                }
                _ => models.extend(self.model(*side)),
            }
        }
        let mut models = models.into_iter();
        match (models.next(), models.next()) {
            (Some(front), None) => Some(Material::two_sided(name, front)),
            (Some(front), Some(back)) => Some(Material { name, front, back: Some(back) }),
            _ => None,
        }
    }

    fn model(&mut self, id: ObjectId) -> Option<Model> {
        let q = self.query(id);
        let white = Range::Reflectance;
        let model = match q.object.plugin.as_str() {
            "diffuse" => Model::Diffuse { reflectance: self.source(&q, "reflectance", 0.5, white) },
            "conductor" => {
                let (eta, k) = self.conductor_index(&q);
                Model::Conductor { eta, k, reflectance: self.source(&q, "specular_reflectance", 1.0, white) }
            }
            "roughconductor" => {
                let (eta, k) = self.conductor_index(&q);
                let (alpha_u, alpha_v) = self.anisotropic_alpha(&q);
                let distribution = distribution(&q);
                let reflectance = self.source(&q, "specular_reflectance", 1.0, white);
                Model::RoughConductor { distribution, alpha_u, alpha_v, eta, k, reflectance }
            }
            "dielectric" => {
                let (int_ior, ext_ior) = self.dielectric_index(&q, "bk7");
                let reflectance = self.source(&q, "specular_reflectance", 1.0, white);
                let transmittance = self.source(&q, "specular_transmittance", 1.0, white);
                Model::Dielectric { int_ior, ext_ior, reflectance, transmittance }
            }
            "plastic" => {
                let (int_ior, ext_ior) = self.dielectric_index(&q, "polypropylene");
                let diffuse = self.source(&q, "diffuse_reflectance", 0.5, white);
                let specular = self.source(&q, "specular_reflectance", 1.0, white);
                Model::Plastic { int_ior, ext_ior, diffuse, specular, nonlinear: q.boolean("nonlinear", false) }
            }
            "roughplastic" => {
                let (int_ior, ext_ior) = self.dielectric_index(&q, "polypropylene");
                let diffuse = self.source(&q, "diffuse_reflectance", 0.5, white);
                let specular = self.source(&q, "specular_reflectance", 1.0, white);
                let (distribution, alpha) = (distribution(&q), self.alpha(&q, "alpha"));
                let eta = int_ior / ext_ior;
                // Tables are made for a coat that refracts, and not for one out of this world.
                if !((eta - 1.0).abs() > 1e-4 && (0.1..=10.0).contains(&eta)) {
                    q.error(format!("`int_ior` / `ext_ior` of {} must lie between 0.1 and 10 and not be 1", q.name()));
                    return None;
                }
                let coat = RoughTransmittance::of(distribution, alpha, eta);
                Model::RoughPlastic { coat, diffuse, specular, nonlinear: q.boolean("nonlinear", false) }
            }
            _ => {
                refuse_plugin(q.object, &BSDFS, &MITSUBA, self.report);
                return None;
            }
        };
        q.finish();
        Some(model)
    }

    /// Roughness; as in Mitsuba at least 1e-4.
    fn alpha(&self, q: &Query, name: &'static str) -> f32 {
        if let Some(Value::Object(id)) = q.object.value(name)
            && self.document.object(*id).class == Class::Texture
        {
            q.ignore(&[name]);
            self.report.error(
                self.document.object(*id).at,
                format!("`{name}` as a texture is not supported yet: write a <float>"),
            );
            return 0.1;
        }
        match q.float_at(name) {
            Some((x, at)) if x < 0.0 => {
                self.report.error(at, format!("`{name}` must not be negative"));
                0.1
            }
            Some((x, _)) => (x as f32).max(1e-4),
            None => 0.1,
        }
    }

    fn anisotropic_alpha(&self, q: &Query) -> (f32, f32) {
        match (q.has("alpha_u"), q.has("alpha_v")) {
            (false, false) => {
                let alpha = self.alpha(q, "alpha");
                q.ignore(&["alpha_u", "alpha_v"]);
                (alpha, alpha)
            }
            (true, true) if !q.has("alpha") => (self.alpha(q, "alpha_u"), self.alpha(q, "alpha_v")),
            _ => {
                q.ignore(&["alpha", "alpha_u", "alpha_v"]);
                q.error("give `alpha`, or both `alpha_u` and `alpha_v`");
                (0.1, 0.1)
            }
        }
    }

    /// `material`, or `eta` and `k`.
    fn conductor_index(&mut self, q: &Query<'a>) -> (Spectrum, Spectrum) {
        let preset = q.text("material");
        if let Some((name, at)) = preset
            && name != "none"
        {
            if q.has("eta") || q.has("k") {
                self.report.error(at, "give either `material` or `eta` and `k`, not both");
            }
            q.ignore(&["eta", "k"]);
            return match ior::conductor(name) {
                Ok((eta, k)) => (Spectrum::from(eta), Spectrum::from(k)),
                Err(help) => {
                    self.report.error_help(at, format!("there is no conductor `{name}`"), help);
                    (Spectrum::BLACK, Spectrum::ONE)
                }
            };
        }
        (self.colour(q, "eta", 0.0, Range::Any), self.colour(q, "k", 1.0, Range::Any))
    }

    fn dielectric_index(&self, q: &Query, interior: &'static str) -> (f32, f32) {
        (self.index(q, "int_ior", interior), self.index(q, "ext_ior", "air"))
    }

    /// A refractive index: a number, or a material's name.
    fn index(&self, q: &Query, name: &'static str, default: &str) -> f32 {
        let default = ior::dielectric(default).unwrap_or(1.0);
        let index = match q.get(name).map(|p| (&p.value, p.value_at)) {
            Some((Value::Text(material), at)) => match ior::dielectric(material) {
                Ok(index) => index,
                Err(help) => {
                    self.report.error_help(at, format!("there is no dielectric `{material}`"), help);
                    default
                }
            },
            _ => q.positive(name, default),
        };
        index as f32
    }
}

fn distribution(q: &Query) -> Distribution {
    q.ignore(&["sample_visible"]);
    q.choice(
        "distribution",
        &[("beckmann", Distribution::Beckmann), ("ggx", Distribution::Ggx)],
        Distribution::Beckmann,
    )
}
