//! Media, and where they are.

use super::Builder;
use super::texture::Range;
use crate::document::{Class, ObjectId, Value, refuse_plugin};
use crate::query::Query;
use manylight_math::MediumId;
use manylight_scene::{Grid, HenyeyGreenstein, Heterogeneous, Homogeneous, Interpolation, Medium, Sides, Volume};

const MEDIA: [&str; 2] = ["homogeneous", "heterogeneous"];
const PHASES: [&str; 2] = ["isotropic", "hg"];
const MITSUBA_PHASES: [&str; 5] = ["rayleigh", "sggx", "blendphase", "tabphase", "tabphase_irregular"];
const VOLUMES: [&str; 2] = ["constvolume", "gridvolume"];

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
            refuse_plugin(q.object, &MEDIA, &[], self.report);
            return None;
        }
        // Which strategy samples, and how, is the method's affair.
        q.ignore(&["sample_emitters", "has_spectral_extinction", "majorant_resolution_factor"]);
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
        let fire = self.fire(&q);
        let name = q.name();
        let at = q.object.plugin_at;
        q.finish();
        let (extinction, albedo, phase) = (extinction?, albedo?, phase?);
        let made = match (extinction, albedo) {
            (Volume::Constant(sigma), Volume::Constant(albedo)) => {
                Homogeneous::new(sigma * scale * albedo, sigma * scale, phase).map(Medium::from)
            }
            (Volume::Grid(sigma), albedo) => Heterogeneous::new(sigma, scale, albedo, phase).map(Medium::from),
            (Volume::Constant(_), Volume::Grid(_)) => {
                self.report.error(at, "an `albedo` that is a grid needs a `sigma_t` that is one, too");
                return None;
            }
        };
        match made {
            Ok(m) => self.lit(m, fire?),
            Err(e) => {
                self.report.error(at, format!("{name}: {e}"));
                None
            }
        }
    }

    /// A colour, or a volume.
    pub(super) fn coefficient(
        &mut self,
        q: &Query<'a>,
        name: &'static str,
        default: f32,
        range: Range,
    ) -> Option<Volume> {
        let Some(Value::Object(id)) = q.object.value(name).cloned() else {
            return Some(Volume::Constant(self.colour(q, name, default, range)));
        };
        if self.document.object(id).class != Class::Volume {
            return Some(Volume::Constant(self.colour(q, name, default, range))); // reports what it is
        }
        q.ignore(&[name]);
        let volume = self.query(id);
        match volume.object.plugin.as_str() {
            "constvolume" => {
                volume.ignore(&["to_world"]);
                let value = self.colour(&volume, "value", 1.0, range);
                volume.finish();
                Some(Volume::Constant(value))
            }
            "gridvolume" if q.object.plugin == "heterogeneous" => self.grid(volume, range).map(Volume::Grid),
            "gridvolume" => {
                q.error("a `homogeneous` medium is the same everywhere: write type=\"heterogeneous\" for a grid");
                None
            }
            _ => {
                refuse_plugin(volume.object, &VOLUMES, &[], self.report);
                None
            }
        }
    }

    fn grid(&mut self, q: Query<'a>, range: Range) -> Option<Grid> {
        let interpolation = q.choice(
            "filter_type",
            &[("trilinear", Interpolation::Trilinear), ("nearest", Interpolation::Nearest)],
            Interpolation::Trilinear,
        );
        // Clamped is what a medium's grid can only be: outside there is nothing.
        q.choice("wrap_mode", &[("clamp", ())], ());
        q.ignore(&["raw", "accel"]);
        let use_grid_bbox = q.boolean("use_grid_bbox", false);
        let (to_world, at) = q.to_world();
        let (name, file_at) = super::filename(&q)?;
        q.finish();
        if name.to_ascii_lowercase().ends_with(".vdb") {
            self.report.error_help(
                file_at,
                format!("`{name}` is an OpenVDB grid, which is not read"),
                "save it as Mitsuba's .vol, for instance with pyopenvdb and mitsuba.VolumeGrid(array).write(..)",
            );
            return None;
        }
        let raw = match self.assets.grid(name) {
            Ok(raw) => raw,
            Err(failure) => {
                self.fail(file_at, failure);
                return None;
            }
        };
        if range == Range::Reflectance && raw.values.iter().any(|v| v.largest() > 1.0) {
            self.report.error(file_at, format!("`{name}` has values above 1, which an albedo cannot have"));
            return None;
        }
        let to_world = if use_grid_bbox { to_world * raw.to_box } else { to_world };
        match Grid::new(raw.size, raw.values.clone(), &to_world, interpolation) {
            Ok(grid) => Some(grid),
            Err(e) => {
                self.report.error(at, format!("`{name}`: {e}"));
                None
            }
        }
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
