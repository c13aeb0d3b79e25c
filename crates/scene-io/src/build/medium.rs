//! Media, and where they are.

use super::Builder;
use super::texture::Range;
use crate::document::{Class, ObjectId, Value, refuse_plugin};
use crate::query::Query;
use manylight_math::{MediumId, Spectrum};
use manylight_scene::{HenyeyGreenstein, Homogeneous, Medium, Sides};

const MEDIA: [&str; 1] = ["homogeneous"];
const MITSUBA: [&str; 1] = ["heterogeneous"];
const PHASES: [&str; 2] = ["isotropic", "hg"];
const MITSUBA_PHASES: [&str; 5] = ["rayleigh", "sggx", "blendphase", "tabphase", "tabphase_irregular"];
const VOLUMES: [&str; 1] = ["constvolume"];

impl<'a> Builder<'a> {
    /// A medium; one that is named twice is made once. `None`: it is wrong, which is in the report.
    pub(super) fn medium(&mut self, id: ObjectId) -> Option<MediumId> {
        if let Some(known) = self.media.get(&id) {
            return *known;
        }
        let made = self.make_medium(id).map(|m| self.scene.medium(m));
        self.media.insert(id, made);
        made
    }

    fn make_medium(&mut self, id: ObjectId) -> Option<Medium> {
        let q = self.query(id);
        if !MEDIA.contains(&q.object.plugin.as_str()) {
            refuse_plugin(q.object, &MEDIA, &MITSUBA, self.report);
            return None;
        }
        // Which strategy samples, and how, is the method's affair.
        q.ignore(&["sample_emitters", "has_spectral_extinction"]);
        let phase = match q.child(Class::Phase) {
            Some(id) => self.phase(id),
            None => Some(HenyeyGreenstein::ISOTROPIC),
        };
        let extinction = self.coefficient(&q, "sigma_t", 1.0, Range::Any);
        let albedo = self.coefficient(&q, "albedo", 0.75, Range::Reflectance);
        let scale = match q.float_at("scale") {
            Some((x, at)) if x < 0.0 => {
                self.report.error(at, "`scale` must not be negative");
                1.0
            }
            found => found.map_or(1.0, |(x, _)| x as f32),
        };
        let name = q.name();
        let at = q.object.plugin_at;
        q.finish();
        let extinction = extinction? * scale;
        match Homogeneous::new(extinction * albedo?, extinction, phase?) {
            Ok(m) => Some(m.into()),
            Err(e) => {
                self.report.error(at, format!("{name}: {e}"));
                None
            }
        }
    }

    /// A colour, or a volume that is the same everywhere.
    fn coefficient(&mut self, q: &Query<'a>, name: &'static str, default: f32, range: Range) -> Option<Spectrum> {
        let Some(Value::Object(id)) = q.object.value(name).cloned() else {
            return Some(self.colour(q, name, default, range));
        };
        if self.document.object(id).class != Class::Volume {
            return Some(self.colour(q, name, default, range)); // reports what it is
        }
        q.ignore(&[name]);
        let volume = self.query(id);
        if volume.object.plugin != "constvolume" {
            refuse_plugin(volume.object, &VOLUMES, &["gridvolume"], self.report);
            return None;
        }
        volume.ignore(&["to_world"]);
        let value = self.colour(&volume, "value", 1.0, range);
        volume.finish();
        Some(value)
    }

    fn phase(&mut self, id: ObjectId) -> Option<HenyeyGreenstein> {
        let q = self.query(id);
        let g = match q.object.plugin.as_str() {
            "isotropic" => Some((0.0, q.object.at)),
            "hg" => Some(q.float_at("g").unwrap_or((0.8, q.object.at))),
            _ => {
                refuse_plugin(q.object, &PHASES, &MITSUBA_PHASES, self.report);
                return None;
            }
        };
        q.finish();
        let (g, at) = g?;
        let phase = HenyeyGreenstein::new(g as f32);
        if phase.is_none() {
            self.report.error(at, format!("`g` must lie between -1 and 1, and be neither, not {g}"));
        }
        phase
    }

    /// What lies on the sides of a shape, if it says so of any: `interior` is the side away from its normals.
    pub(super) fn sides(&mut self, shape: &Query<'a>) -> Option<Sides> {
        let mut sides = None;
        let mut given: Vec<&str> = Vec::new();
        for (id, p) in shape.children(Class::Medium) {
            let medium = self.medium(id);
            let sides: &mut Sides = sides.get_or_insert(Sides::VACUUM);
            let side = match p.name.as_str() {
                "interior" => &mut sides.inside,
                "exterior" => &mut sides.outside,
                _ => {
                    self.report.error(p.at, "a <medium> of a shape needs the name `interior` or `exterior`");
                    continue;
                }
            };
            if given.contains(&p.name.as_str()) {
                self.report.error(p.at, format!("{} has an `{}` medium already", shape.name(), p.name));
            }
            given.push(&p.name);
            if let Some(medium) = medium {
                *side = medium;
            }
        }
        sides
    }
}
