//! XML, a line an element.

use glam::Affine2;
use manylight_math::{DAffine3, Spectrum};
use manylight_scene::{Scene, Texture, TextureFilter, TextureId, Wrap};
use std::fmt::{Display, Write};

/// A text that grows.
#[derive(Default)]
pub(super) struct Xml {
    text: String,
    open: Vec<&'static str>,
}

impl Xml {
    pub fn text(self) -> String {
        self.text
    }
    fn line(&mut self, line: &str) {
        (0..self.open.len()).for_each(|_| self.text.push_str("    "));
        self.text.push_str(line);
        self.text.push('\n');
    }
    pub fn open(&mut self, tag: &'static str, attributes: &[(&str, &str)]) {
        let mut line = format!("<{tag}");
        for (name, value) in attributes {
            let _ = write!(line, " {name}=\"{}\"", escaped(value)); // a String takes everything
        }
        self.line(&(line + ">"));
        self.open.push(tag);
    }
    pub fn close(&mut self) {
        if let Some(tag) = self.open.pop() {
            self.line(&format!("</{tag}>"));
        }
    }
    /// Numbers are written so that they come back as they are.
    pub fn property(&mut self, tag: &str, name: &str, value: impl Display) {
        self.line(&format!("<{tag} name=\"{name}\" value=\"{}\"/>", escaped(&value.to_string())));
    }
    pub fn reference(&mut self, id: &str) {
        self.line(&format!("<ref id=\"{id}\"/>"));
    }
    pub fn remark(&mut self, text: &str) {
        // Two dashes would end it.
        self.line(&format!("<!-- {} -->", text.replace('-', "\u{2010}").replace(char::is_control, " ")));
    }
    pub fn transform(&mut self, name: &str, t: &DAffine3) {
        let (m, o) = (t.matrix3.transpose(), t.translation);
        let row = |r: manylight_math::DVec3, o: f64| format!("{} {} {} {o} ", r.x, r.y, r.z);
        let rows = row(m.x_axis, o.x) + &row(m.y_axis, o.y) + &row(m.z_axis, o.z);
        self.line(&format!("<transform name=\"{name}\"><matrix value=\"{rows}0 0 0 1\"/></transform>"));
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('$', "&#36;")
}

pub(super) fn rgb(xml: &mut Xml, name: &str, c: Spectrum) {
    let [r, g, b] = c.to_array();
    xml.property("rgb", name, format!("{r} {g} {b}"));
}

pub(super) fn texture(scene: &Scene, name: &str, id: TextureId, xml: &mut Xml) {
    let to_uv = |xml: &mut Xml, t: &Affine2| {
        let (m, o) = (t.matrix2, t.translation);
        let (x, y) = (m.x_axis, m.y_axis);
        let rows = format!("{} {} 0 {} {} {} 0 {} 0 0 1 0 0 0 0 1", x.x, y.x, o.x, x.y, y.y, o.y);
        xml.line(&format!("<transform name=\"to_uv\"><matrix value=\"{rows}\"/></transform>"));
    };
    match &scene.textures()[id.0 as usize] {
        Texture::Checkerboard { color0, color1, to_uv: t } => {
            xml.open("texture", &[("type", "checkerboard"), ("name", name)]);
            rgb(xml, "color0", *color0);
            rgb(xml, "color1", *color1);
            to_uv(xml, t);
        }
        Texture::Bitmap { filter, wrap, to_uv: t, .. } => {
            xml.open("texture", &[("type", "bitmap"), ("name", name)]);
            xml.property("string", "filename", format!("texture-{}.exr", id.0));
            // As it is: also where it holds normals or roughness.
            xml.property("boolean", "raw", true);
            let filter = match filter {
                TextureFilter::Nearest => "nearest",
                TextureFilter::Bilinear => "bilinear",
            };
            xml.property("string", "filter_type", filter);
            let wrap = match wrap {
                Wrap::Repeat => "repeat",
                Wrap::Mirror => "mirror",
                Wrap::Clamp => "clamp",
            };
            xml.property("string", "wrap_mode", wrap);
            to_uv(xml, t);
        }
    }
    xml.close();
}
