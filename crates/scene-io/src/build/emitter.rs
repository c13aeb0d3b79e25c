//! Lights that are not shapes, and the radiance of those that are.

use super::texture::Range;
use super::{Builder, filename};
use crate::diagnostic::At;
use crate::document::{Class, ObjectId, refuse_plugin};
use crate::query::Query;
use crate::value;
use manylight_math::{DAffine3, DMat3, DVec3};
use manylight_scene::{Emitter, Environment, Source, Spot};

const EMITTERS: [&str; 6] = ["area", "point", "spot", "directional", "constant", "envmap"];
const MITSUBA: [&str; 7] = ["projector", "sunsky", "sun", "sky", "timed_sunsky", "directionalarea", "volumelight"];

impl<'a> Builder<'a> {
    /// The emitters beside the shapes.
    pub(super) fn emitters(&mut self, scene: &Query<'a>) {
        let mut surrounding: Option<At> = None;
        for (id, p) in scene.children(Class::Emitter) {
            let object = self.document.object(id);
            if matches!(object.plugin.as_str(), "constant" | "envmap") {
                if let Some(first) = surrounding {
                    let place = self.report.place(first);
                    self.report.error(p.at, format!("only one light can surround a scene (the first is at {place})"));
                }
                surrounding.get_or_insert(p.at);
            }
            if let Some(emitter) = self.emitter(id) {
                self.scene.emitter(emitter);
            }
        }
    }

    fn emitter(&mut self, id: ObjectId) -> Option<Emitter> {
        let q = self.query(id);
        q.ignore(&["sampling_weight"]);
        let emitter = match q.object.plugin.as_str() {
            "point" => {
                let position = match (q.point("position"), q.has("to_world")) {
                    (Some(_), true) => {
                        self.one_of(&q, "position");
                        None
                    }
                    (Some(position), false) => Some(position),
                    (None, _) => Some(q.to_world().0.translation),
                };
                let intensity = self.colour(&q, "intensity", 1.0, Range::Emission);
                position.map(|p| Emitter::Point { position: p.as_vec3(), intensity })
            }
            "spot" => self.spot(&q),
            "directional" => {
                let direction = self.direction(&q);
                let irradiance = self.colour(&q, "irradiance", 1.0, Range::Emission);
                direction.map(|d| Emitter::Directional { direction: d.as_vec3(), irradiance })
            }
            "constant" => Some(Emitter::Constant { radiance: self.colour(&q, "radiance", 1.0, Range::Emission) }),
            "envmap" => self.envmap(&q),
            "area" => {
                q.error("an `area` emitter is part of a shape: write it inside the <shape> that shines");
                return None;
            }
            _ => {
                refuse_plugin(q.object, &EMITTERS, &MITSUBA, self.report);
                return None;
            }
        };
        q.finish();
        emitter
    }

    fn spot(&mut self, q: &Query<'a>) -> Option<Emitter> {
        if let Some(p) = q.get("texture") {
            self.report.error(p.at, "`texture` of a `spot` is not supported: its light has one colour");
        }
        let intensity = self.colour(q, "intensity", 1.0, Range::Emission);
        let cutoff = q.float("cutoff_angle", 20.0);
        let beam = q.float("beam_width", 0.75 * cutoff);
        let at = q.get("cutoff_angle").map_or(q.object.at, |p| p.value_at);
        if !(0.1..=180.0).contains(&cutoff) {
            self.report.error(at, format!("`cutoff_angle` must lie between 0.1 and 180 degrees, not {cutoff}"));
            return None;
        }
        if !(0.0..=cutoff).contains(&beam) {
            let at = q.get("beam_width").map_or(at, |p| p.value_at);
            self.report.error(at, format!("`beam_width` must lie between 0 and `cutoff_angle`, not {beam}"));
            return None;
        }
        let (to_world, _) = q.to_world();
        let axis = value::unit(to_world.transform_vector3(DVec3::Z))?.as_vec3();
        let spot = Spot::new(axis, cutoff.to_radians() as f32, beam.to_radians() as f32)?;
        Some(Emitter::Spot { position: to_world.translation.as_vec3(), intensity, spot })
    }

    fn one_of(&self, q: &Query, name: &str) {
        q.ignore(&["to_world"]);
        q.error(format!("give either `{name}` or `to_world`, not both"));
    }

    /// The way the light travels: given, or where `to_world` takes +z.
    fn direction(&self, q: &Query) -> Option<DVec3> {
        match q.vector_at("direction") {
            Some(_) if q.has("to_world") => {
                self.one_of(q, "direction");
                None
            }
            Some((direction, at)) => {
                let unit = value::unit(direction);
                if unit.is_none() {
                    self.report.error(at, "`direction` must not be zero");
                }
                unit
            }
            None => q.to_world().0.transform_vector3(DVec3::Z).try_normalize(),
        }
    }

    fn envmap(&mut self, q: &Query<'a>) -> Option<Emitter> {
        let scale = match q.float_at("scale") {
            Some((x, at)) if x < 0.0 => {
                self.report.error(at, "`scale` must not be negative");
                1.0
            }
            found => found.map_or(1.0, |(x, _)| x),
        };
        q.ignore(&["mis_compensation"]);
        let (to_world, at) = q.to_world();
        let rotation = without_scale(&to_world);
        if rotation.is_none() {
            self.report.error(at, "`to_world` of an `envmap` can rotate and mirror, but not stretch");
        }
        let (name, at) = filename(q)?;
        let (image, [least, _]) = match self.assets.image(name, false) {
            Ok(image) => image,
            Err(failure) => {
                self.fail(at, failure);
                return None;
            }
        };
        if least < 0.0 {
            self.report.error(at, format!("`{name}` has negative pixels"));
            return None;
        }
        let map = Environment::new(image, scale as f32, &rotation?);
        if map.is_none() {
            self.report.error(at, format!("`{name}` is too small for an environment: it needs two rows"));
        }
        map.map(|map| Emitter::Environment(Box::new(map)))
    }

    /// The radiance of a shape: its nested `area` emitter.
    pub(super) fn radiance(&mut self, shape: &Query<'a>) -> Option<Source> {
        let id = shape.child(Class::Emitter)?;
        let q = self.query(id);
        match q.object.plugin.as_str() {
            "area" => {
                q.ignore(&["sampling_weight"]);
                if q.has("to_world") {
                    q.ignore(&["to_world"]);
                    q.error("an `area` emitter has no `to_world`: that of its shape counts");
                }
                let radiance = self.source(&q, "radiance", 1.0, Range::Emission);
                q.finish();
                Some(radiance)
            }
            known if EMITTERS.contains(&known) => {
                q.error(format!("a shape can only hold an `area` emitter: write `{known}` beside it, in the <scene>"));
                None
            }
            _ => {
                refuse_plugin(q.object, &["area"], &MITSUBA, self.report);
                None
            }
        }
    }
}

/// The rotation (or mirroring) in a transform whose axes are equally long and at right angles.
fn without_scale(t: &DAffine3) -> Option<DAffine3> {
    let m = t.matrix3 * t.matrix3.determinant().abs().cbrt().recip();
    let unit = m.transpose() * m;
    let off = (0..3)
        .flat_map(|c| (0..3).map(move |r| (unit.col(c)[r] - DMat3::IDENTITY.col(c)[r]).abs()))
        .fold(0.0, f64::max);
    (off < 1e-3).then_some(DAffine3 { matrix3: m, translation: DVec3::ZERO })
}
