//! Colours: constants and textures.

use super::{Builder, filename};
use crate::diagnostic::At;
use crate::document::{ObjectId, Property, Value, refuse_plugin};
use crate::query::Query;
use crate::spectrum;
use glam::{Affine2, DMat2};
use manylight_math::{DAffine3, Spectrum};
use manylight_scene::{Source, Texture, TextureFilter, TextureId, Wrap};

const TEXTURES: [&str; 2] = ["bitmap", "checkerboard"];
const MITSUBA: [&str; 3] = ["mesh_attribute", "volume", "uniform"];

/// The colour of `<spectrum value="1"/>` in an emitter: equal energy at all wavelengths is not white (mitsuba 3.9.1, scalar_rgb).
const EQUAL_ENERGY: [f64; 3] = [1.2047939, 0.948291, 0.90891606];

/// What a colour may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    /// In [0, 1].
    Reflectance,
    /// Not negative.
    Emission,
    /// Not negative; not a light.
    Any,
}

impl<'a> Builder<'a> {
    /// A colour that may be a texture.
    pub(super) fn source(&mut self, q: &Query<'a>, name: &'static str, default: f32, range: Range) -> Source {
        let Some(p) = q.get(name) else { return Self::gray(default) };
        if let Value::Object(id) = p.value
            && self.document.object(id).class == crate::document::Class::Texture
        {
            return self.texture(id, range).map_or(Self::gray(default), Source::Texture);
        }
        self.constant(q, name, p, range).map_or(Self::gray(default), Source::Constant)
    }

    /// A colour that may not be a texture.
    pub(super) fn colour(&mut self, q: &Query<'a>, name: &'static str, default: f32, range: Range) -> Spectrum {
        let found = q.get(name).and_then(|p| self.constant(q, name, p, range));
        found.unwrap_or(Spectrum::gray(default))
    }

    fn constant(&self, q: &Query, name: &str, p: &Property, range: Range) -> Option<Spectrum> {
        let rgb = match p.value {
            Value::Rgb(c) => c,
            Value::Float(x) => [x; 3],
            Value::Integer(i) => [i as f64; 3],
            Value::Spectrum(x) if range == Range::Emission => EQUAL_ENERGY.map(|e| e * x),
            Value::Spectrum(x) => [x; 3],
            Value::Table(ref table) => self.in_gamut(spectrum::to_rgb(table, range == Range::Emission), range, p),
            Value::Reference(_) => return None,
            ref other => {
                let tag = q.tag_of(other);
                let message = match tag {
                    "texture" => {
                        format!("`{name}` of {} cannot be a texture here: expected a colour (<rgb>)", q.name())
                    }
                    _ => format!("`{name}` must be a colour (<rgb>, <float>), not <{tag}>"),
                };
                self.report.error(p.at, message);
                return None;
            }
        };
        let (ok, expected) = match range {
            Range::Reflectance => (rgb.iter().all(|c| (0.0..=1.0).contains(c)), "lie between 0 and 1"),
            Range::Emission | Range::Any => (rgb.iter().all(|c| *c >= 0.0), "not be negative"),
        };
        if !ok {
            self.report.error(p.value_at, format!("`{name}` must {expected}"));
            return None;
        }
        Some(Spectrum::from(rgb.map(|c| c as f32)))
    }

    /// A spectrum may be outside of what three colours can say: as in Mitsuba it is clamped, and said.
    fn in_gamut(&self, rgb: [f64; 3], range: Range, p: &Property) -> [f64; 3] {
        let most = if range == Range::Reflectance { 1.0 } else { f64::INFINITY };
        let inside = rgb.map(|c| c.clamp(0.0, most));
        // A white one is off by the steps of its integral.
        if rgb.iter().zip(inside).any(|(a, b)| (a - b).abs() > 2e-3) {
            let shown = rgb.map(|c| format!("{c:.3}")).join(" ");
            self.report.warn(p.value_at, format!("this spectrum is no colour of Rec. 709 ({shown}): it is clamped"));
        }
        inside
    }

    /// A texture; one that is named twice is made once.
    pub(super) fn texture(&mut self, id: ObjectId, range: Range) -> Option<TextureId> {
        if let Some(known) = self.textures.get(&id) {
            return *known;
        }
        let made = self.make_texture(id, range);
        let made = made.map(|t| self.scene.texture(t));
        self.textures.insert(id, made);
        made
    }

    fn make_texture(&mut self, id: ObjectId, range: Range) -> Option<Texture> {
        let q = self.query(id);
        let texture = match q.object.plugin.as_str() {
            "checkerboard" => {
                let color0 = self.colour(&q, "color0", 0.4, Range::Reflectance);
                let color1 = self.colour(&q, "color1", 0.2, Range::Reflectance);
                Some(Texture::Checkerboard { color0, color1, to_uv: self.to_uv(&q) })
            }
            "bitmap" => self.bitmap(&q, range),
            _ => {
                refuse_plugin(q.object, &TEXTURES, &MITSUBA, self.report);
                return None;
            }
        };
        q.finish();
        texture
    }

    fn bitmap(&mut self, q: &Query<'a>, range: Range) -> Option<Texture> {
        let raw = q.boolean("raw", false);
        let filters = [("bilinear", TextureFilter::Bilinear), ("nearest", TextureFilter::Nearest)];
        let filter = q.choice("filter_type", &filters, TextureFilter::Bilinear);
        let wraps = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];
        let wrap = q.choice("wrap_mode", &wraps, Wrap::Repeat);
        let to_uv = self.to_uv(q);
        q.ignore(&["accel", "format"]);
        let (name, at) = filename(q)?;
        match self.assets.image(name, raw) {
            Ok((image, [least, largest])) => {
                if least < 0.0 {
                    self.report.error(at, format!("`{name}` has negative pixels"));
                    return None;
                }
                if range == Range::Reflectance && largest > 1.0 {
                    self.report.warn(at, format!("`{name}` has pixels above 1: as a reflectance they create light"));
                }
                Some(Texture::Bitmap { image, filter, wrap, to_uv })
            }
            Err(failure) => {
                self.fail(at, failure);
                None
            }
        }
    }

    /// What happens to texture coordinates: the x and y of a transform.
    fn to_uv(&self, q: &Query) -> Affine2 {
        let Some((t, at)) = q.transform_at("to_uv") else { return Affine2::IDENTITY };
        planar(&t).unwrap_or_else(|| self.refuse_flat(at))
    }
    fn refuse_flat(&self, at: At) -> Affine2 {
        self.report.error(at, "`to_uv` is singular: it flattens the texture (is a scale 0?)");
        Affine2::IDENTITY
    }
}

fn planar(t: &DAffine3) -> Option<Affine2> {
    let m = DMat2::from_cols(t.matrix3.x_axis.truncate(), t.matrix3.y_axis.truncate());
    let lengths = m.x_axis.length() * m.y_axis.length();
    let regular = m.determinant().abs() > 1e-9 * lengths && lengths > 0.0;
    let translation = t.translation.truncate().as_vec2();
    regular.then(|| Affine2 { matrix2: m.as_mat2(), translation })
}
