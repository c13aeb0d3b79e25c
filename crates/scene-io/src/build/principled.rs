//! The principled material.

use super::Builder;
use super::texture::Range;
use crate::query::Query;
use manylight_bsdf::PrincipledParameters;
use manylight_scene::{Model, PrincipledSources};

impl<'a> Builder<'a> {
    pub(super) fn principled(&mut self, q: &Query<'a>) -> Model {
        // How often Mitsuba draws each lobe: what is seen does not depend on it.
        q.ignore(&["main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate"]);
        let mut part = |name, default| self.source(q, name, default, Range::Reflectance);
        let mut sources = PrincipledSources {
            base_color: part("base_color", 0.5),
            roughness: part("roughness", 0.5),
            anisotropic: part("anisotropic", 0.0),
            metallic: part("metallic", 0.0),
            spec_trans: part("spec_trans", 0.0),
            eta: 1.0,
            spec_tint: part("spec_tint", 0.0),
            sheen: part("sheen", 0.0),
            sheen_tint: part("sheen_tint", 0.0),
            flatness: part("flatness", 0.0),
            clearcoat: part("clearcoat", 0.0),
            clearcoat_gloss: part("clearcoat_gloss", 0.0),
        };
        sources.eta = self.principled_index(q, sources.transmits());
        Model::Principled(Box::new(sources))
    }

    /// `eta`, or `specular`, which stands for one.
    fn principled_index(&self, q: &Query, transmits: bool) -> f32 {
        let (eta, specular) = (q.positive("eta", 1.5), q.float_at("specular"));
        let Some((specular, at)) = specular else {
            return if q.has("eta") { eta as f32 } else { PrincipledParameters::eta_of_specular(0.5) };
        };
        if q.has("eta") {
            self.report.error(at, "give either `eta` or `specular`, not both");
        }
        if !(0.0..=1.0).contains(&specular) {
            self.report.error(at, format!("`specular` must lie between 0 and 1, not {specular}"));
        }
        // Glass has to refract (Mitsuba's least).
        let least = if transmits { 1e-3 } else { 0.0 };
        PrincipledParameters::eta_of_specular(specular.clamp(least, 1.0) as f32)
    }
}
