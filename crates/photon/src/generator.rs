//! Photons and beams of light paths.

use crate::{Beam, Photon, Radii};
use manylight_framework::{Batch, Claim, GenerateError, Generator, PathClasses, Probe, Promise};
use manylight_math::Spectrum;
use manylight_scene::{Scatter, Scene, Span};
use manylight_vpl::Vpl;

/// Dimensions of the blur on surfaces, and of beams.
const ON_SURFACES: f64 = 2.0;
const OF_BEAMS: f64 = 1.0;
/// Pieces of a beam are no longer than the radius of the scene over the first, but longer than R times the second: their boxes are
/// narrow, whatever the beam's direction.
const PIECES: (f32, f32) = (32.0, 8.0);

/// The vertices of light paths as photons, those of the first edge excepted: indirect light only.
pub struct Photons {
    /// Walks the paths, up to one edge more than virtual lights take: a photon needs no connection.
    pub points: Box<dyn Generator<Lights = Vec<Vpl>>>,
    /// How far photons reach.
    pub radii: Radii,
    /// Dimensions of the blur in media: 3 where receivers are points, 2 where they are rays.
    pub dimensions: f64,
}

/// An edge of a light path in a medium.
#[derive(Clone, Copy, Debug)]
pub struct BeamSource {
    /// Where it runs, along the light.
    pub span: Span,
    /// Phi / N. \[W\]
    pub flux: Spectrum,
    /// Edges from the emitter to a point on it.
    pub edges: u32,
    /// See [`Beam::channels`].
    pub channels: Option<[f32; 3]>,
}

/// The edges of light paths in media as beams, and their vertices on surfaces as photons; those of the first edge excepted.
pub struct PhotonBeams<V> {
    /// Walks the paths, up to one edge more than virtual lights take.
    pub rays: Box<dyn Generator<Lights = (Vec<Vpl>, Vec<V>)>>,
    /// What an edge is, as whoever walks calls it.
    pub edge: fn(V) -> BeamSource,
    /// How far photons and beams reach.
    pub radii: Radii,
}

/// What a walk promises, if its vertices are photons: caustics are found, and blurred.
fn blurred(walk: Claim, radii: &Radii) -> Claim {
    Claim { misses: walk.misses.without(PathClasses::CAUSTICS), ..walk }.and(radii.claim())
}

impl Promise for Photons {
    fn claim(&self) -> Claim {
        blurred(self.points.claim(), &self.radii)
    }
}
impl<V> Promise for PhotonBeams<V> {
    fn claim(&self) -> Claim {
        blurred(self.rays.claim(), &self.radii)
    }
}

/// Light that was scattered before it came here, as a photon.
fn photon(l: Vpl, radius: f32) -> Option<Photon> {
    (l.edges > 1).then(|| Photon { vertex: l.vertex, flux: l.flux, edges: l.edges - 1, radius })
}

impl Generator for Photons {
    type Lights = Vec<Photon>;
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Vec<Photon>>, GenerateError> {
        let Batch { lights, paths, .. } = self.points.generate(scene, pass, seed, probe)?;
        let (on, within) = (self.radii.at(pass, ON_SURFACES), self.radii.at(pass, self.dimensions));
        let radius = |l: &Vpl| if matches!(l.vertex.scatter, Scatter::Medium(_)) { within } else { on };
        let lights = lights.into_iter().filter_map(|l| photon(l, radius(&l))).collect();
        Ok(Batch { lights, paths, covers_direct: false })
    }
}

impl<V> Generator for PhotonBeams<V> {
    type Lights = (Vec<Photon>, Vec<Beam>);
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Self::Lights>, GenerateError> {
        let Batch { lights: (points, edges), paths, .. } = self.rays.generate(scene, pass, seed, probe)?;
        let radius = self.radii.at(pass, ON_SURFACES);
        let points = points.into_iter().filter_map(|l| photon(l, radius)).collect();
        let radius = self.radii.at(pass, OF_BEAMS);
        let extent = (scene.emitters().disc() / std::f32::consts::PI).sqrt();
        let longest = (extent / PIECES.0).max(PIECES.1 * radius);
        let mut beams = Vec::new();
        for edge in edges {
            let BeamSource { span, flux, edges, channels } = (self.edge)(edge);
            if edges < 2 {
                continue;
            }
            let length = span.ray.t_max;
            let n = (length / longest).ceil().clamp(1.0, 256.0);
            beams.extend((0..n as u32).map(|i| {
                let piece = (length * (i as f32 / n), length * ((i + 1) as f32 / n));
                Beam { span, piece, flux, edges: edges - 1, channels, radius }
            }));
        }
        Ok(Batch { lights: (points, beams), paths, covers_direct: false })
    }
}
