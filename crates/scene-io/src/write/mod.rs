//! Scenes as Mitsuba 3 files: what a program built, or what was read.

mod elements;
mod files;
mod materials;

use crate::parametric::write_whole;
use elements::{Xml, rgb};
use manylight_geometry::ShapeGeometry;
use manylight_math::{DAffine3, DMat3, Frame, Vec3};
use manylight_scene::{Emitter, Filter, Scene, Source};
use std::path::{Path, PathBuf};

/// Why a scene could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A file or its folder could not be made.
    #[error("cannot write `{}`: {error}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// There is a scene already.
    #[error("`{}` is there already: name another folder, or remove it", .0.display())]
    Exists(PathBuf),
    /// The format has nothing like it, or this writer does not know how to say it.
    #[error("{what} cannot be written: {why}")]
    Unsayable {
        /// Of what.
        what: String,
        /// And why.
        why: &'static str,
    },
}

/// Writes a scene into a folder, which is made if it is not there: `scene.xml`, a PLY file for each mesh and an EXR image for each bitmap.
/// Each file appears whole or not at all, `scene.xml` last. Returns what was written, `scene.xml` first.
///
/// Read again it is the same scene, and its images are the same bit for bit (but for spheres and discs that are turned, and
/// environments that are, to rounding). Scenes with media are refused.
pub fn write(scene: &Scene, dir: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let main = dir.join("scene.xml");
    if main.exists() {
        return Err(WriteError::Exists(main));
    }
    if scene.media().next().is_some() {
        return Err(unsayable("a medium", "only surfaces are written so far"));
    }
    // All of it that can fail before anything is written.
    let mut xml = Xml::default();
    xml.open("scene", &[("version", "3.0.0")]);
    settings(scene, &mut xml);
    camera(scene, &mut xml);
    for (i, material) in scene.materials().iter().enumerate() {
        materials::write(scene, material, &format!("material-{i}"), &mut xml)?;
    }
    shapes(scene, &mut xml);
    emitters(scene, &mut xml);
    xml.close();
    std::fs::create_dir_all(dir).map_err(|error| WriteError::File { path: dir.into(), error })?;
    let mut written = vec![main.clone()];
    let mut put = |name: String, content: std::io::Result<Vec<u8>>| {
        let path = dir.join(name);
        let done = content.and_then(|content| write_whole(&path, dir, &content));
        written.push(path.clone());
        done.map_err(|error| WriteError::File { path, error })
    };
    for (i, shape) in scene.geometry().shapes().iter().enumerate() {
        if let ShapeGeometry::Mesh(mesh) = shape {
            put(format!("mesh-{i}.ply"), Ok(files::ply(mesh)))?;
        }
    }
    for (i, texture) in scene.textures().iter().enumerate() {
        if let manylight_scene::Texture::Bitmap { image, .. } = texture {
            put(format!("texture-{i}.exr"), files::exr(image))?;
        }
    }
    for emitter in scene.emitters().sources() {
        if let Emitter::Environment(map) = emitter {
            put("environment.exr".into(), files::exr(map.image()))?;
        }
    }
    put("scene.xml".into(), Ok(xml.text().into_bytes()))?;
    written.pop();
    Ok(written)
}

fn unsayable(what: impl Into<String>, why: &'static str) -> WriteError {
    WriteError::Unsayable { what: what.into(), why }
}

fn settings(scene: &Scene, xml: &mut Xml) {
    xml.open("integrator", &[("type", "path")]);
    if let Some(depth) = scene.max_depth() {
        xml.property("integer", "max_depth", depth);
    }
    if let Some(depth) = scene.rr_depth() {
        xml.property("integer", "rr_depth", depth);
    }
    xml.close();
}

fn camera(scene: &Scene, xml: &mut Xml) {
    let (camera, view) = (scene.camera(), scene.camera().view());
    let kind = match camera.lens() {
        _ if camera.is_parallel() => "orthographic",
        Some(_) => "thinlens",
        None => "perspective",
    };
    xml.open("sensor", &[("type", kind)]);
    if !camera.is_parallel() {
        xml.property("float", "fov", view.fov_x);
        xml.property("string", "fov_axis", "x");
    }
    if let Some((radius, focus)) = camera.lens() {
        xml.property("float", "aperture_radius", radius);
        xml.property("float", "focus_distance", focus);
    }
    for (name, offset) in ["principal_point_offset_x", "principal_point_offset_y"].into_iter().zip(view.offset) {
        if offset != 0.0 {
            xml.property("float", name, offset);
        }
    }
    xml.transform("to_world", &view.to_world);
    xml.open("film", &[("type", "hdrfilm")]);
    xml.property("integer", "width", camera.size.0);
    xml.property("integer", "height", camera.size.1);
    let (filter, parameters): (_, &[(&str, f32)]) = match scene.filter() {
        Filter::Box => ("box", &[]),
        Filter::Tent { radius } => ("tent", &[("radius", radius)]),
        Filter::Gaussian { stddev } => ("gaussian", &[("stddev", stddev)]),
        Filter::Mitchell { b, c } => ("mitchell", &[("B", b), ("C", c)]),
        Filter::CatmullRom => ("catmullrom", &[]),
        Filter::Lanczos { lobes } => ("lanczos", &[("lobes", lobes)]),
    };
    xml.open("rfilter", &[("type", filter)]);
    for (name, value) in parameters {
        let tag = if *name == "lobes" { "integer" } else { "float" };
        xml.property(tag, name, value);
    }
    xml.close();
    xml.close();
    xml.close();
}

fn shapes(scene: &Scene, xml: &mut Xml) {
    for (i, (shape, (name, material, radiance))) in scene.geometry().shapes().iter().zip(scene.surfaces()).enumerate() {
        xml.remark(name);
        let placed = |frame: &Frame, scale: f32, centre: Vec3| DAffine3 {
            matrix3: DMat3::from_cols(frame.s.as_dvec3(), frame.t.as_dvec3(), frame.n.as_dvec3()) * f64::from(scale),
            translation: centre.as_dvec3(),
        };
        match shape {
            ShapeGeometry::Mesh(mesh) => {
                xml.open("shape", &[("type", "ply")]);
                xml.property("string", "filename", format!("mesh-{i}.ply"));
                if mesh.normals.is_empty() {
                    xml.property("boolean", "face_normals", true);
                }
            }
            ShapeGeometry::Sphere(s) => {
                xml.open("shape", &[("type", "sphere")]);
                if s.frame == (Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z }) {
                    xml.property("point", "center", format!("{} {} {}", s.centre.x, s.centre.y, s.centre.z));
                    xml.property("float", "radius", s.radius);
                } else {
                    xml.transform("to_world", &placed(&s.frame, s.radius, s.centre));
                }
                // A mirrored frame turns the normals by itself.
                let mirrored = s.frame.s.cross(s.frame.t).dot(s.frame.n) < 0.0;
                xml.property("boolean", "flip_normals", s.flipped != mirrored);
            }
            ShapeGeometry::Disk(d) => {
                xml.open("shape", &[("type", "disk")]);
                xml.transform("to_world", &placed(&d.frame, d.radius, d.centre));
            }
        }
        xml.reference(&format!("material-{}", material.0));
        if let Some(radiance) = radiance {
            xml.open("emitter", &[("type", "area")]);
            source(scene, "radiance", &radiance, xml);
            xml.close();
        }
        xml.close();
    }
}

fn emitters(scene: &Scene, xml: &mut Xml) {
    for emitter in scene.emitters().sources() {
        let triple = |v: Vec3| format!("{} {} {}", v.x, v.y, v.z);
        match emitter {
            Emitter::Point { position, intensity } => {
                xml.open("emitter", &[("type", "point")]);
                xml.property("point", "position", triple(position));
                rgb(xml, "intensity", intensity);
            }
            Emitter::Spot { position, intensity, spot } => {
                xml.open("emitter", &[("type", "spot")]);
                rgb(xml, "intensity", intensity);
                xml.property("float", "cutoff_angle", f64::from(spot.cutoff()).to_degrees());
                xml.property("float", "beam_width", f64::from(spot.beam()).to_degrees());
                let Frame { s, t, n } = Frame::around(spot.axis());
                let matrix3 = DMat3::from_cols(s.as_dvec3(), t.as_dvec3(), n.as_dvec3());
                xml.transform("to_world", &DAffine3 { matrix3, translation: position.as_dvec3() });
            }
            Emitter::Directional { direction, irradiance } => {
                xml.open("emitter", &[("type", "directional")]);
                xml.property("vector", "direction", triple(direction));
                rgb(xml, "irradiance", irradiance);
            }
            Emitter::Constant { radiance } => {
                xml.open("emitter", &[("type", "constant")]);
                rgb(xml, "radiance", radiance);
            }
            Emitter::Environment(map) => {
                xml.open("emitter", &[("type", "envmap")]);
                xml.property("string", "filename", "environment.exr");
                xml.property("float", "scale", map.scale());
                let to_world = DAffine3 { matrix3: map.to_world(), ..DAffine3::IDENTITY };
                xml.transform("to_world", &to_world);
            }
        }
        xml.close();
    }
}

/// A colour or a texture, as a property.
fn source(scene: &Scene, name: &str, source: &Source, xml: &mut Xml) {
    match source {
        Source::Constant(c) => rgb(xml, name, *c),
        Source::Texture(id) => elements::texture(scene, name, *id, xml),
    }
}
