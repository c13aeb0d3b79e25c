//! What was done and counted: JSON, and the header of the image.

use crate::files::Attribute;
use crate::{RenderError, Rendering, Settings, files, peak_memory};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// What was rendered, as the caller knows it.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Name of the method.
    pub method: String,
    /// All its parameters, with the values they had.
    pub parameters: Vec<(String, String)>,
    /// What it promises, in a sentence.
    pub claim: String,
    /// Hash of the scene.
    pub scene_hash: u64,
    /// Time to read the scene and build its BVH.
    pub load: Duration,
    /// Time to put the method together.
    pub build: Duration,
}

/// What was done and counted, all passes of the image together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stats {
    /// This program and its version.
    pub renderer: String,
    /// Name of the method.
    pub method: String,
    /// All its parameters, with the values they had.
    pub parameters: BTreeMap<String, String>,
    /// What it promises, in a sentence.
    pub claim: String,
    /// Hash of the scene, hexadecimal.
    pub scene_hash: String,
    /// What all random numbers follow from.
    pub seed: u64,
    /// Complete passes.
    pub passes: u64,
    /// Camera samples for each pixel of each pass.
    pub spp: u32,
    /// Whether it was cancelled before the budget was spent.
    pub interrupted: bool,
    /// Where the time went.
    pub seconds: Seconds,
    /// Rays by what they were for.
    pub rays: Rays,
    /// Light paths.
    pub light_paths: u64,
    /// Virtual lights.
    pub lights: u64,
    /// Means of what parts of the method noted by name: acceptance rates, cut sizes.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub notes: BTreeMap<String, f64>,
    /// Lights asked for their contribution, for each camera sample.
    pub evaluations_per_sample: f64,
    /// The largest memory the process has held \[bytes\], where the system says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory: Option<u64>,
    /// Samples that were NaN, infinite or negative: black in the image.
    pub non_finite: NonFinite,
    /// Light paths that were ended because their flux was NaN or infinite: their light is missing.
    pub broken_paths: u64,
    /// Estimated relative mean squared error by noise ([`crate::Accumulator::estimated_error`]), from two passes on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
}

/// Wall-clock time \[s\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Seconds {
    /// Reading the scene and building its BVH.
    pub load: f64,
    /// Putting the method together.
    pub build: f64,
    /// In each pass before the first tile of the image: light paths, trees.
    pub generate: f64,
    /// The rest of the passes.
    pub render: f64,
}

/// Rays by what they were for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Along paths, from surface to surface.
    pub path: u64,
    /// Between two points that may see each other.
    pub shadow: u64,
}

/// Samples that were NaN, infinite or negative: black in the image.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NonFinite {
    /// How many.
    pub count: u64,
    /// The first few.
    pub first: Vec<SampleAt>,
}

/// The place of a sample in the whole rendering, by which it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SampleAt {
    /// Pass.
    pub pass: u64,
    /// Column of the pixel.
    pub x: usize,
    /// Row of the pixel.
    pub y: usize,
    /// Sample of that pixel and pass.
    pub sample: u32,
}

impl fmt::Display for SampleAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "pixel {},{}, pass {}, sample {}", self.x, self.y, self.pass, self.sample)
    }
}

impl Stats {
    /// Of a rendering.
    pub fn new(subject: &Subject, settings: &Settings, rendering: &Rendering) -> Self {
        let probe = &rendering.probe;
        let Subject { method, parameters, claim, scene_hash, load, build } = subject.clone();
        Stats {
            renderer: concat!("manylight ", env!("CARGO_PKG_VERSION")).into(),
            method,
            parameters: parameters.into_iter().collect(),
            claim,
            scene_hash: format!("{scene_hash:016x}"),
            seed: settings.seed,
            passes: rendering.passes,
            spp: settings.spp,
            interrupted: rendering.interrupted,
            seconds: Seconds {
                load: load.as_secs_f64(),
                build: build.as_secs_f64(),
                generate: rendering.preparing.as_secs_f64(),
                render: rendering.elapsed.saturating_sub(rendering.preparing).as_secs_f64(),
            },
            rays: Rays { camera: probe.camera_rays, path: probe.path_rays, shadow: probe.shadow_rays },
            light_paths: probe.light_paths,
            lights: probe.lights,
            notes: probe.names().filter_map(|n| Some((n.to_string(), probe.mean(n)?))).collect(),
            evaluations_per_sample: probe.evaluations as f64 / probe.camera_rays.max(1) as f64,
            memory: peak_memory(),
            non_finite: non_finite(rendering),
            broken_paths: probe.broken_paths,
            estimated_error: rendering.estimated_error,
        }
    }
    /// What belongs into the header of the image: how to make it again, and what it cost.
    pub fn attributes(&self) -> BTreeMap<String, Attribute> {
        let parameters: Vec<String> = self.parameters.iter().map(|(key, value)| format!("{key}={value}")).collect();
        let texts = [
            ("renderer", self.renderer.clone()),
            ("method", self.method.clone()),
            ("parameters", parameters.join(" ")),
            ("claim", self.claim.clone()),
            ("scene_hash", self.scene_hash.clone()),
            ("seed", self.seed.to_string()),
        ];
        let numbers = [
            ("passes", self.passes as f64),
            ("spp", self.spp.into()),
            ("seconds", self.seconds.build + self.seconds.generate + self.seconds.render),
        ];
        let texts = texts.map(|(name, text)| (name.to_string(), Attribute::Text(text)));
        let numbers = numbers.map(|(name, number)| (name.to_string(), Attribute::Number(number)));
        texts.into_iter().chain(numbers).collect()
    }
    /// Writes them as JSON, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), RenderError> {
        let mut json = serde_json::to_vec_pretty(self).map_err(|e| RenderError::write(path, e))?;
        json.push(b'\n');
        files::write_atomically(path, &json)
    }
}

fn non_finite(rendering: &Rendering) -> NonFinite {
    let found = &rendering.probe.non_finite;
    let width = rendering.image.width;
    let place =
        |&(pass, pixel, sample): &(u64, usize, u32)| SampleAt { pass, x: pixel % width, y: pixel / width, sample };
    NonFinite { count: found.count, first: found.first.iter().map(place).collect() }
}
