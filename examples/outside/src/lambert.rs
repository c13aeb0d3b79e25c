//! A light of your own: three types, and three traits.
//!
//! [`Lambert`] is the light (`VirtualLight`), [`Sorted`] makes it (`Generator`), [`Two`] is its transport (`Kernel`). It stands
//! beside `Vpl`: lights on diffuse surfaces are kept as one, all others as the other, and a pair of light sets asks both.

use manylight_framework::{
    Batch, Claim, Connection, GenerateError, Generator, Kernel, Pair, Probe, Promise, VirtualLight,
};
use manylight_math::{Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::{Bsdf, Edge, End, Scatter, Scene, Vertex};
use manylight_vpl::{Keller, Points, Vpl};

/// A point of a diffuse surface: to a direction at an angle theta to its normal it sends `intensity` cos(theta). Half as large as a `Vpl`.
#[derive(Clone, Copy, Debug)]
pub struct Lambert {
    /// Where it is, and what a shadow ray has to know of that.
    end: End,
    /// Unit, geometric and of shading, on the side that shines.
    normals: [Vec3; 2],
    /// Flux x albedo / pi. [W/sr]
    intensity: Spectrum,
    edges: u32,
}

impl VirtualLight for Lambert {
    fn intensity(&self) -> f32 {
        self.intensity.luminance() * std::f32::consts::PI
    }
    fn edges(&self) -> u32 {
        self.edges
    }
}

impl Lambert {
    /// What a virtual point light is, if it lies on a diffuse surface.
    pub fn of(light: &Vpl) -> Option<Lambert> {
        let Scatter::Surface(x) = &light.vertex.scatter else { return None };
        if !matches!(x.bsdf, Bsdf::Diffuse(_)) {
            return None;
        }
        let lit = |n: Vec3| if n.dot(x.wi) < 0.0 { -n } else { n };
        let normals = [lit(x.ng), lit(x.frame.n)];
        // The same to all sides: the one along the normal will do.
        let intensity = light.flux * light.vertex.lobe_at((normals[0] + normals[1]).normalize());
        Some(Lambert { end: light.vertex.end(), normals, intensity, edges: light.edges })
    }
}

/// Keller's lights, the diffuse ones apart.
#[derive(Clone, Copy, Debug)]
pub struct Sorted(pub Keller);

impl Promise for Sorted {
    fn claim(&self) -> Claim {
        self.0.claim()
    }
}
impl Generator for Sorted {
    type Lights = (Vec<Lambert>, Vec<Vpl>);
    fn generate(
        &self,
        scene: &Scene,
        pass: u64,
        seed: u64,
        probe: &mut Probe,
    ) -> Result<Batch<Self::Lights>, GenerateError> {
        let Batch { lights, paths, covers_direct } = self.0.generate(scene, pass, seed, probe)?;
        let (mut diffuse, mut others) = (Vec::new(), Vec::new());
        for light in lights {
            match Lambert::of(&light) {
                Some(l) => diffuse.push(l),
                None => others.push(light),
            }
        }
        Ok(Batch { lights: (diffuse, others), paths, covers_direct })
    }
}

/// Transport from both.
#[derive(Clone, Copy, Debug)]
pub struct Two;

impl Promise for Two {
    fn claim(&self) -> Claim {
        Points.claim()
    }
}
impl Kernel<Vertex, Vpl> for Two {
    fn connect(&self, scene: &Scene, x: &Vertex, light: &Vpl, s: &mut Stream) -> Option<Connection> {
        Points.connect(scene, x, light, s)
    }
}
/// f(x) cos_x cos_y / d^2 x intensity.
impl Kernel<Vertex, Lambert> for Two {
    fn connect(&self, _: &Scene, x: &Vertex, light: &Lambert, _: &mut Stream) -> Option<Connection> {
        let d = light.end.p - x.p;
        let d2 = d.length_squared();
        // NaN fails too; nearer than a femtometre is the same point.
        if !(d2 > 1e-30) {
            return None;
        }
        let w = d / d2.sqrt();
        let [cos_y, shading] = light.normals.map(|n| n.dot(-w));
        let g = x.cosine(w) * cos_y / d2;
        if !(g > 0.0 && shading > 0.0) {
            return None;
        }
        let value = x.lobe_at(w) * light.intensity * g;
        // (What a bound may see of the light's lobe is not known any more: none is claimed.)
        let pair = Pair { g, lobes: None };
        (!value.is_black()).then_some(Connection { value, edge: Edge::Between(x.end(), light.end), pair })
    }
}
