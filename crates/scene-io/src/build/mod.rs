//! From the document to the scene: one file a kind of object.

mod bsdf;
mod emission;
mod emitter;
mod medium;
mod principled;
mod sensor;
mod shape;
mod texture;

use crate::assets::{Assets, Failure};
use crate::diagnostic::{At, Report};
use crate::document::{Class, Document, ObjectId, refuse_plugin};
use crate::query::Query;
use crate::{LoadOptions, Loaded};
use manylight_math::MediumId;
use manylight_scene::{Material, MaterialId, Scene, SceneBuilder, Source, TextureId};
use std::collections::HashMap;

/// Integrators of Mitsuba 3: their depths count, the rest of them does not.
const INTEGRATORS: [&str; 14] = [
    "path",
    "volpath",
    "volpathmis",
    "direct",
    "ptracer",
    "aov",
    "depth",
    "moment",
    "stokes",
    "prb",
    "prbvolpath",
    "prb_basic",
    "direct_projective",
    "prb_projective",
];

/// What is being built, and what it is built from.
pub(crate) struct Builder<'a> {
    document: &'a Document,
    report: &'a Report,
    assets: &'a Assets<'a>,
    options: &'a LoadOptions,
    scene: SceneBuilder,
    materials: HashMap<ObjectId, Option<MaterialId>>,
    /// By object, and whether it stands inside a `twosided`.
    drafts: HashMap<(ObjectId, bool), Option<Material>>,
    textures: HashMap<ObjectId, Option<TextureId>>,
    media: HashMap<ObjectId, Option<MediumId>>,
    /// For shapes without a BSDF: without and with an emitter.
    default_materials: [Option<MaterialId>; 2],
}

/// Builds everything; what is wrong goes into the report, `None` is returned then.
pub(crate) fn build(
    document: &Document,
    report: &Report,
    assets: &Assets<'_>,
    options: &LoadOptions,
) -> Option<Loaded> {
    let mut b = Builder {
        document,
        report,
        assets,
        options,
        scene: Scene::builder(),
        materials: HashMap::new(),
        drafts: HashMap::new(),
        textures: HashMap::new(),
        media: HashMap::new(),
        default_materials: [None; 2],
    };
    let scene = b.query(document.scene());
    b.integrator(&scene);
    // Also those that no shape refers to: their mistakes count.
    for (id, _) in scene.children(Class::Texture) {
        b.texture(id, texture::Range::Any);
    }
    for (id, _) in scene.children(Class::Bsdf) {
        if !b.is_null(id) {
            b.material(id);
        }
    }
    for (id, _) in scene.children(Class::Medium) {
        b.medium(id);
    }
    b.sensors(&scene);
    b.shapes(&scene);
    b.emitters(&scene);
    scene.finish();
    if report.has_errors() {
        return None;
    }
    match b.scene.build() {
        Ok(scene) => Some(Loaded { scene, warnings: Vec::new(), files: Vec::new() }),
        Err(e) => {
            report.error_nowhere(e.to_string(), None);
            None
        }
    }
}

impl<'a> Builder<'a> {
    fn query(&self, id: ObjectId) -> Query<'a> {
        Query::new(self.document, id, self.report)
    }

    /// `max_depth` and `rr_depth`: Mitsuba's plugins stay loadable in Mitsuba, the method is chosen elsewhere.
    fn integrator(&mut self, scene: &Query<'a>) {
        let Some(id) = scene.child(Class::Integrator) else { return };
        let mut q = self.query(id);
        // `aov` and `moment` wrap another one.
        if let Some((inner, _)) = q.children(Class::Integrator).first() {
            q.ignore_rest();
            q = self.query(*inner);
        }
        if !INTEGRATORS.contains(&q.object.plugin.as_str()) {
            refuse_plugin(q.object, &INTEGRATORS, &[], self.report);
        }
        match q.integer("max_depth", -1..=1 << 30, -1) {
            -1 => self.scene.max_depth(None),
            depth => self.scene.max_depth(Some(depth as u32)),
        }
        if q.get("rr_depth").is_some() {
            let depth = q.integer("rr_depth", 1..=1 << 30, 5);
            self.scene.rr_depth(depth as u32);
        }
        q.ignore_rest();
    }

    /// The colour of an absent property.
    fn gray(x: f32) -> Source {
        Source::Constant(manylight_math::Spectrum::gray(x))
    }

    fn fail(&self, at: At, (message, help): Failure) {
        match help {
            Some(help) => self.report.error_help(at, message, help),
            None => self.report.error(at, message),
        }
    }
}

/// The filename of an object that cannot do without.
fn filename<'a>(q: &Query<'a>) -> Option<(&'a str, At)> {
    let found = q.text("filename");
    if found.is_none() && !q.has("filename") && !q.object.broken {
        q.error(format!("{} needs a `filename` (<string>)", q.name()));
    }
    found
}
