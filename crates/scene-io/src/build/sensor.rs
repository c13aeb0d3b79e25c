//! The camera, its film and its filter.

use super::Builder;
use crate::document::{Class, ObjectId, refuse_plugin};
use crate::query::Query;
use manylight_math::{DAffine3, DVec3, MediumId};
use manylight_scene::{Camera, Filter, SceneError};

const SENSORS: [&str; 3] = ["perspective", "thinlens", "orthographic"];
const MITSUBA_SENSORS: [&str; 6] = ["radiancemeter", "irradiancemeter", "distant", "batch", "sphere", "measure"];
const MITSUBA_FILMS: [&str; 1] = ["specfilm"];
const FILTERS: [&str; 6] = ["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"];
/// Film of 24 x 36 mm, which `focal_length` refers to.
const FULL_FRAME_DIAGONAL: f64 = 43.266_615_305_567_87;

/// What `fov` measures.
#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

impl<'a> Builder<'a> {
    pub(super) fn sensors(&mut self, scene: &Query<'a>) {
        let sensors = scene.children(Class::Sensor);
        match sensors.first() {
            Some((id, _)) => self.sensor(*id),
            None if scene.object.broken => {}
            None => {
                self.report.error(scene.object.at, "the scene has no camera: it needs a <sensor type=\"perspective\">")
            }
        }
        if let Some((_, second)) = sensors.get(1) {
            self.report.warn(second.at, format!("of {} sensors the first is used", sensors.len()));
        }
    }

    fn sensor(&mut self, id: ObjectId) {
        let q = self.query(id);
        let plugin = q.object.plugin.as_str();
        if !SENSORS.contains(&plugin) {
            refuse_plugin(q.object, &SENSORS, &MITSUBA_SENSORS, self.report);
            return;
        }
        // What samples and how many is not the scene's affair.
        q.child(Class::Sampler);
        // The near and far planes only narrow what Mitsuba traces.
        q.ignore(&["near_clip", "far_clip", "shutter_open", "shutter_close"]);
        let size = self.film(&q);
        let size = self.options.size.unwrap_or(size);
        let (to_world, at) = q.to_world();
        let camera = if plugin == "orthographic" {
            if !has_right_angles(&to_world) {
                self.report.error(at, "the `to_world` of a camera cannot shear");
            }
            // Where the sharp plane would be says nothing here.
            q.ignore(&["focus_distance"]);
            Some(Camera::orthographic(to_world, size))
        } else {
            if !is_rigid(&to_world) {
                self.report.error(at, "the `to_world` of a camera cannot scale or shear");
            }
            self.perspective(&q, to_world, size)
        };
        let medium = q.child(Class::Medium).map_or(Some(MediumId::VACUUM), |id| self.medium(id));
        let (name, type_at) = (q.name(), q.object.plugin_at);
        q.finish();
        let Some(camera) = camera else { return };
        match camera {
            // A medium that is wrong is in the report.
            Ok(camera) => self.scene.camera(camera.within(medium.unwrap_or(MediumId::VACUUM))),
            Err(e) => self.report.error(type_at, format!("{name}: {e}")),
        }
    }

    /// Of a pinhole, or of a `thinlens`. `None` if its angle is wrong.
    fn perspective(&self, q: &Query, to_world: DAffine3, size: (u32, u32)) -> Option<Result<Camera, SceneError>> {
        let fov = self.horizontal_fov(q, f64::from(size.0) / f64::from(size.1.max(1)));
        let lens = (q.object.plugin == "thinlens").then(|| {
            if !q.has("aperture_radius") && !q.object.broken {
                q.error("`thinlens` needs an `aperture_radius` (<float>)");
            }
            (q.positive("aperture_radius", 1.0) as f32, q.positive("focus_distance", q.float("far_clip", 1e4)) as f32)
        });
        if lens.is_none() {
            q.ignore(&["focus_distance"]);
        }
        // A lens has its principal point in the middle.
        let offset = if lens.is_some() {
            [0.0; 2]
        } else {
            ["principal_point_offset_x", "principal_point_offset_y"].map(|name| q.float(name, 0.0))
        };
        let camera = Camera::perspective_shifted(to_world, fov?, size, offset);
        Some(match lens {
            Some((radius, focus)) => camera.and_then(|c| c.with_lens(radius, focus)),
            None => camera,
        })
    }

    /// In degrees. `None` if it is wrong.
    fn horizontal_fov(&self, q: &Query, aspect: f64) -> Option<f64> {
        let focal_length = q.text("focal_length");
        let Some((fov, at)) = q.float_at("fov") else {
            if q.has("fov") {
                return None;
            }
            if q.has("fov_axis") {
                q.ignore(&["fov_axis"]);
                q.error("`fov_axis` says nothing without `fov`");
            }
            let text = focal_length.map_or("50", |(text, _)| text);
            let millimetres = text.trim().trim_end_matches("mm").trim().parse::<f64>();
            let Some(f) = millimetres.ok().filter(|f| *f > 0.0 && f.is_finite()) else {
                let at = focal_length.map_or(q.object.at, |(_, at)| at);
                self.report.error(at, format!("`{text}` is not a focal length: expected something like `50mm`"));
                return None;
            };
            let diagonal = 2.0 * (0.5 * FULL_FRAME_DIAGONAL / f).atan();
            return Some(to_horizontal(diagonal, Axis::Diagonal, aspect).to_degrees());
        };
        if focal_length.is_some() {
            self.report.error(at, "give either `fov` or `focal_length`, not both");
        }
        let axes = [
            ("x", Axis::X),
            ("y", Axis::Y),
            ("diagonal", Axis::Diagonal),
            ("smaller", Axis::Smaller),
            ("larger", Axis::Larger),
        ];
        let axis = q.choice("fov_axis", &axes, Axis::X);
        if !(fov > 0.0 && fov < 180.0) {
            self.report.error(at, format!("`fov` must lie between 0 and 180 degrees, not {fov}"));
            return None;
        }
        Some(to_horizontal(fov.to_radians(), axis, aspect).to_degrees())
    }

    /// Width and height, and the filter.
    fn film(&mut self, sensor: &Query<'a>) -> (u32, u32) {
        // As Mitsuba's `hdrfilm` where there is none.
        let gaussian = Filter::Gaussian { stddev: 0.5 };
        let Some(id) = sensor.child(Class::Film) else {
            self.scene.filter(self.options.filter.unwrap_or(gaussian));
            return (768, 576);
        };
        let q = self.query(id);
        if q.object.plugin != "hdrfilm" {
            refuse_plugin(q.object, &["hdrfilm"], &MITSUBA_FILMS, self.report);
            return (768, 576);
        }
        let most = 1 << 20;
        let width = q.integer("width", 1..=most, 768) as u32;
        let height = q.integer("height", 1..=most, 576) as u32;
        for name in ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"] {
            if q.has(name)
                && let Some(p) = q.get(name)
            {
                self.report.error(p.at, format!("`{name}` is not supported: whole images are rendered"));
            }
        }
        q.ignore(&["file_format", "pixel_format", "component_format", "sample_border", "compensate", "banner"]);
        let filter = match q.child(Class::Filter) {
            Some(id) => self.filter(id),
            None => Some(gaussian),
        };
        q.finish();
        if let Some(filter) = self.options.filter.or(filter) {
            self.scene.filter(filter);
        }
        (width, height)
    }

    fn filter(&mut self, id: ObjectId) -> Option<Filter> {
        let q = self.query(id);
        let filter = match q.object.plugin.as_str() {
            "box" => Filter::Box,
            "tent" => Filter::Tent { radius: q.positive("radius", 1.0) as f32 },
            "gaussian" => Filter::Gaussian { stddev: q.positive("stddev", 0.5) as f32 },
            "mitchell" => Filter::Mitchell { b: q.float("B", 1.0 / 3.0) as f32, c: q.float("C", 1.0 / 3.0) as f32 },
            "catmullrom" => Filter::CatmullRom,
            "lanczos" => Filter::Lanczos { lobes: q.integer("lobes", 1..=64, 3) as f32 },
            _ => {
                refuse_plugin(q.object, &FILTERS, &[], self.report);
                return None;
            }
        };
        q.finish();
        Some(filter)
    }
}

/// The angle along the image's width. [rad]
fn to_horizontal(fov: f64, axis: Axis, aspect: f64) -> f64 {
    let from_tan = |tan: f64| 2.0 * tan.atan();
    let tan = (0.5 * fov).tan();
    match axis {
        Axis::X => fov,
        Axis::Y => from_tan(tan * aspect),
        Axis::Diagonal => from_tan(tan / (1.0 + 1.0 / (aspect * aspect)).sqrt()),
        Axis::Smaller => to_horizontal(fov, if aspect > 1.0 { Axis::Y } else { Axis::X }, aspect),
        Axis::Larger => to_horizontal(fov, if aspect > 1.0 { Axis::X } else { Axis::Y }, aspect),
    }
}

/// Axes of unit length, at right angles?
fn is_rigid(t: &DAffine3) -> bool {
    let m = t.matrix3;
    let unit = |v: DVec3| (v.length_squared() - 1.0).abs() < 1e-3;
    [m.x_axis, m.y_axis, m.z_axis].into_iter().all(unit) && has_right_angles(t)
}

/// Axes at right angles?
fn has_right_angles(t: &DAffine3) -> bool {
    let m = t.matrix3;
    let right = |a: DVec3, b: DVec3| a.dot(b).abs() < 1e-3 * a.length() * b.length();
    right(m.x_axis, m.y_axis) && right(m.y_axis, m.z_axis) && right(m.z_axis, m.x_axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_view_are_those_of_mitsuba() {
        // mitsuba 3.9.1: `x_fov` of `perspective` with a film of 768 x 576 and fov 40.
        for (axis, want) in [
            (Axis::X, 40.0),
            (Axis::Y, 51.774_009),
            (Axis::Diagonal, 32.468_605),
            (Axis::Smaller, 51.774_009),
            (Axis::Larger, 40.0),
        ] {
            let got = to_horizontal(40f64.to_radians(), axis, 768.0 / 576.0).to_degrees();
            assert!((got - want).abs() < 1e-4, "{got} {want}");
        }
    }
}
