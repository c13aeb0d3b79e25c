//! Materials.

use super::Builder;
use super::texture::Range;
use crate::document::{Class, Object, ObjectId, Value, refuse_plugin};
use crate::ior;
use crate::query::Query;
use manylight_bsdf::{Distribution, RoughTransmittance};
use manylight_math::Spectrum;
use manylight_scene::{Material, MaterialId, Model, Relief, Source};

/// More BSDFs than any blend has.
const MOST_CHOICES: usize = 64;

const BSDFS: [&str; 15] = [
    "diffuse",
    "conductor",
    "roughconductor",
    "dielectric",
    "thindielectric",
    "roughdielectric",
    "plastic",
    "roughplastic",
    "principled",
    "twosided",
    "mask",
    "bumpmap",
    "normalmap",
    "blendbsdf",
    "null",
];
const MITSUBA: [&str; 10] = [
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
        let name = |o: &Object| o.id.clone().unwrap_or_else(|| o.plugin.clone());
        let made = self.draft(id, false)?;
        Some(Material { name: name(self.document.object(id)), ..made })
    }

    /// A material without its name. `inside` a `twosided`, which takes neither what transmits nor what has two sides. Each is
    /// made once: a chain of blends of two references to the next would double at each step.
    fn draft(&mut self, id: ObjectId, inside: bool) -> Option<Material> {
        if let Some(known) = self.drafts.get(&(id, inside)) {
            return known.clone();
        }
        let made = self.make_draft(id, inside);
        self.drafts.insert((id, inside), made.clone());
        made
    }

    fn make_draft(&mut self, id: ObjectId, inside: bool) -> Option<Material> {
        let q = self.query(id);
        let plugin = q.object.plugin.as_str();
        let refused = match plugin {
            "twosided" => Some("it has two sides itself"),
            "dielectric" | "thindielectric" | "roughdielectric" | "null" | "mask" => Some("it lets light through"),
            _ => None,
        };
        if let Some(why) = refused.filter(|_| inside) {
            let help = if plugin == "mask" { "write the `twosided` inside the `mask`" } else { "take it out" };
            self.report.error_help(q.object.at, format!("`twosided` cannot hold `{plugin}`: {why}"), help);
            return None;
        }
        match plugin {
            "twosided" => self.twosided(q),
            "mask" => self.mask(q),
            "bumpmap" | "normalmap" => self.relief(q, inside),
            "blendbsdf" => self.blend(q, inside),
            "null" => {
                let help = "for a surface with holes write a `mask`";
                self.report.error_help(q.object.at, "`null` cannot stand inside another BSDF here", help);
                None
            }
            _ => self.model(id, inside).map(|model| Material::one_sided("", model)),
        }
    }

    /// The nested BSDFs of one that takes `count`.
    fn nested(&self, q: &Query<'a>, least: usize, most: usize) -> Vec<ObjectId> {
        let nested = q.children(Class::Bsdf);
        let takes = match (least, most) {
            (1, 1) => "one nested <bsdf>",
            (1, _) => "a nested <bsdf> (or two: front and back)",
            _ => "two nested <bsdf>",
        };
        let plugin = &q.object.plugin;
        if nested.len() < least && !q.object.broken {
            q.error(format!("`{plugin}` needs {takes}"));
        }
        if let Some((_, excess)) = nested.get(most) {
            self.report.error(excess.at, format!("`{plugin}` takes {takes}, and no more"));
        }
        nested.into_iter().take(most).map(|(id, _)| id).collect()
    }

    fn twosided(&mut self, q: Query<'a>) -> Option<Material> {
        let sides = self.nested(&q, 1, 2);
        q.finish();
        let made: Vec<Option<Material>> = sides.into_iter().map(|side| self.draft(side, true)).collect();
        let mut models = made.into_iter().map(|m| m.map(|m| m.front));
        let (front, back) = (models.next()??, models.next());
        Some(Material {
            back: Some(if let Some(back) = back { back? } else { front.clone() }),
            ..Material::one_sided("", front)
        })
    }

    fn mask(&mut self, q: Query<'a>) -> Option<Material> {
        let opacity = self.source(&q, "opacity", 0.5, Range::Reflectance);
        let nested = self.nested(&q, 1, 1);
        let at = q.object.at;
        q.finish();
        let inner = self.draft(*nested.first()?, false)?;
        if inner.opacity.is_some() {
            self.report.error(at, "a `mask` inside a `mask` is not supported: multiply their opacities");
            return None;
        }
        Some(Material { opacity: Some(opacity), ..inner })
    }

    fn relief(&mut self, q: Query<'a>, inside: bool) -> Option<Material> {
        let shadowed = q.boolean("use_shadowing_function", true);
        if q.has("flip_invalid_normals") && q.boolean("flip_invalid_normals", true) {
            let at = q.object.at;
            self.report.warn(at, "`flip_invalid_normals` has no effect: what a relief turns from the viewer is black");
        }
        let bump = q.object.plugin == "bumpmap";
        let scale = if bump { q.float("scale", 1.0) as f32 } else { 1.0 };
        let map = if bump {
            q.child(Class::Texture)
        } else {
            match q.get("normalmap").map(|p| &p.value) {
                Some(Value::Object(id)) if self.document.object(*id).class == Class::Texture => Some(*id),
                _ => None,
            }
        };
        let nested = self.nested(&q, 1, 1);
        if map.is_none() && !q.object.broken {
            let named = if bump { "" } else { " named `normalmap`" };
            q.error(format!("`{}` needs a nested <texture>{named}", q.object.plugin));
        }
        q.finish();
        let plugin = self.document.object(map?).plugin.as_str();
        if bump && plugin != "bitmap" {
            let at = self.document.object(map?).plugin_at;
            self.report.error(at, format!("`bumpmap` needs a `bitmap`: a `{plugin}` has no slopes"));
            return None;
        }
        let texture = self.texture(map?, Range::Any);
        let inner = self.draft(*nested.first()?, inside)?;
        let texture = texture?;
        let relief = if bump { Relief::Bump { height: texture, scale } } else { Relief::Normals { map: texture } };
        let under = |model| Model::Relief { relief, shadowed, mirrored: inside, model: Box::new(model) };
        Some(Material {
            front: under(inner.front),
            back: inner.back.map(under),
            opacity: inner.opacity,
            name: String::new(),
        })
    }

    fn blend(&mut self, q: Query<'a>, inside: bool) -> Option<Material> {
        if !q.has("weight") && !q.object.broken {
            q.error("`blendbsdf` needs a `weight` (<float> or <texture>): 0 shows the first <bsdf>, 1 the second");
        }
        let weight = self.source(&q, "weight", 0.5, Range::Reflectance);
        let nested = self.nested(&q, 2, 2);
        let at = q.object.at;
        q.finish();
        let made: Vec<Option<Material>> = nested.into_iter().map(|id| self.draft(id, inside)).collect();
        let [Some(a), Some(b)] = <[Option<Material>; 2]>::try_from(made).ok()? else { return None };
        if a.opacity.is_some() || b.opacity.is_some() {
            self.report.error(at, "a `mask` inside a `blendbsdf` is not supported: write the mask around it");
            return None;
        }
        let blend = |a, b| Model::Blend { weight, models: Box::new([a, b]) };
        let back = match (a.back, b.back) {
            (None, None) => None,
            (a_back, b_back) => {
                let one_sided = [(&a.front, &a_back), (&b.front, &b_back)].into_iter().find(|(_, back)| back.is_none());
                if one_sided.is_some_and(|(front, _)| front.transmits()) {
                    self.report.error(at, "a blend of a two-sided and a transmitting BSDF is not supported");
                    return None;
                }
                Some(blend(a_back.unwrap_or(Self::black()), b_back.unwrap_or(Self::black())))
            }
        };
        let made = Material { back, ..Material::one_sided("", blend(a.front, b.front)) };
        if made.front.choices() > MOST_CHOICES {
            self.report.error(at, format!("blends of more than {MOST_CHOICES} BSDFs are not supported"));
            return None;
        }
        Some(made)
    }

    fn black() -> Model {
        Model::Diffuse { reflectance: Self::gray(0.0) }
    }

    fn model(&mut self, id: ObjectId, inside: bool) -> Option<Model> {
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
                let distribution = distribution(&q);
                let reflectance = self.source(&q, "specular_reflectance", 1.0, white);
                self.roughened(&q, |alpha_u, alpha_v| Model::RoughConductor {
                    distribution,
                    alpha_u,
                    alpha_v,
                    eta,
                    k,
                    reflectance,
                })
            }
            "dielectric" => {
                let (int_ior, ext_ior) = self.dielectric_index(&q, "bk7");
                let reflectance = self.source(&q, "specular_reflectance", 1.0, white);
                let transmittance = self.source(&q, "specular_transmittance", 1.0, white);
                Model::Dielectric { int_ior, ext_ior, reflectance, transmittance }
            }
            "thindielectric" => {
                let (int_ior, ext_ior) = self.dielectric_index(&q, "bk7");
                let reflectance = self.source(&q, "specular_reflectance", 1.0, white);
                let transmittance = self.source(&q, "specular_transmittance", 1.0, white);
                Model::ThinDielectric { int_ior, ext_ior, reflectance, transmittance }
            }
            "roughdielectric" => {
                let (int_ior, ext_ior) = self.dielectric_index(&q, "bk7");
                let distribution = distribution(&q);
                let reflectance = self.source(&q, "specular_reflectance", 1.0, white);
                let transmittance = self.source(&q, "specular_transmittance", 1.0, white);
                if !((int_ior / ext_ior - 1.0).abs() > 1e-4) {
                    q.error(format!("`int_ior` and `ext_ior` of {} must differ", q.name()));
                    return None;
                }
                self.roughened(&q, |u, v| {
                    let alpha = (u, v);
                    Model::RoughDielectric { distribution, alpha, int_ior, ext_ior, reflectance, transmittance }
                })
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
            "principled" => self.principled(&q),
            _ => {
                refuse_plugin(q.object, &BSDFS, &MITSUBA, self.report);
                return None;
            }
        };
        q.finish();
        if inside && model.transmits() {
            let at = self.document.object(id).at;
            self.report.error(at, "`twosided` cannot hold a `principled` with `spec_trans`: it lets light through");
            return None;
        }
        Some(model)
    }

    /// Roughness; as in Mitsuba at least 1e-4.
    fn alpha(&self, q: &Query, name: &'static str) -> f32 {
        if self.texture_of(q, name).is_some() {
            let at = q.get(name).map_or(q.object.at, |p| p.at);
            self.report.error(at, format!("`{name}` of {} cannot be a texture: write a <float>", q.name()));
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
    /// The texture that a property is.
    fn texture_of(&self, q: &Query, name: &'static str) -> Option<ObjectId> {
        match q.object.value(name) {
            Some(Value::Object(id)) if self.document.object(*id).class == Class::Texture => Some(*id),
            _ => None,
        }
    }
    /// Roughness that may be a texture; the number is that of a constant.
    fn alpha_source(&mut self, q: &Query<'a>, name: &'static str) -> (f32, Source) {
        match self.texture_of(q, name) {
            Some(_) => (0.1, self.source(q, name, 0.1, Range::Any)),
            None => {
                let alpha = self.alpha(q, name);
                (alpha, Self::gray(alpha))
            }
        }
    }

    /// A model made of both roughnesses.
    fn roughened(&mut self, q: &Query<'a>, model: impl FnOnce(f32, f32) -> Model) -> Model {
        let ((u, source_u), (v, source_v)) = match (q.has("alpha_u"), q.has("alpha_v")) {
            (false, false) => {
                let alpha = self.alpha_source(q, "alpha");
                q.ignore(&["alpha_u", "alpha_v"]);
                (alpha, alpha)
            }
            (true, true) if !q.has("alpha") => (self.alpha_source(q, "alpha_u"), self.alpha_source(q, "alpha_v")),
            _ => {
                q.ignore(&["alpha", "alpha_u", "alpha_v"]);
                q.error("give `alpha`, or both `alpha_u` and `alpha_v`");
                ((0.1, Self::gray(0.1)), (0.1, Self::gray(0.1)))
            }
        };
        match (source_u, source_v) {
            (Source::Constant(_), Source::Constant(_)) => model(u, v),
            (alpha_u, alpha_v) => Model::Roughened { alpha_u, alpha_v, model: Box::new(model(u, v)) },
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
