//! A receiver with everything that is needed to answer about it.

use crate::{
    BoundCluster, Bounding, Bounds, Contribute, Explained, Kernel, Limited, Located, Notes, Probe, Reach, ReachCluster,
    Reaches, Stretch, Unshadowed, VirtualLight,
};
use arrayvec::ArrayVec;
use manylight_math::{Ray, Spectrum, Vec3};
use manylight_sampling::Stream;
use manylight_scene::{Edge, Scene, Span, Vertex};

/// Lights that light sets hand to `contributions` at a time.
pub const BATCH: usize = 64;

/// Answers a light set's questions about one receiver: each question that its kernel can answer, and no other.
pub struct Gather<'a, R, K, B: ?Sized> {
    /// The scene.
    pub scene: &'a Scene,
    /// Who asks.
    pub receiver: &'a R,
    /// How light gets from a light to the receiver.
    pub kernel: &'a K,
    /// Which part of it is kept.
    pub bounding: &'a B,
    /// Edges that a path may still take, the connection included.
    pub edges_left: u32,
    /// Lights of fewer edges than this are left out: what `min-depth` asks for.
    pub edges_least: u32,
    /// Counts.
    pub probe: &'a mut Probe,
}

impl<R, K, B: Bounding + ?Sized> Gather<'_, R, K, B> {
    /// Bounded, unshadowed, and what has to be clear; `None` if black, so that no ray is traced for nothing.
    #[inline]
    fn kept<L: VirtualLight>(&mut self, light: &L, s: &mut Stream) -> Option<(Kept, Edge)>
    where
        K: Kernel<R, L>,
    {
        let edges = light.edges();
        if edges >= self.edges_left || edges < self.edges_least {
            return None;
        }
        self.probe.evaluations += 1;
        let c = self.kernel.connect(self.scene, self.receiver, light, s)?;
        let keep = self.bounding.keep(&c.pair);
        let value = c.value * keep;
        if value.is_black() {
            return None;
        }
        Some((Kept { value, keep, g: c.pair.g, edges }, c.edge))
    }
    /// What gets through.
    #[inline]
    fn lit(&mut self, &Kept { value, keep, g, edges }: &Kept, edge: &Edge, through: Spectrum) -> Spectrum {
        let contribution = value * through;
        if let Some(explanation) = &mut self.probe.explain {
            explanation.lights.push(Explained { edge: *edge, contribution, g, keep, edges });
        }
        contribution
    }
}

/// A connection before its shadow ray.
struct Kept {
    value: Spectrum,
    keep: f32,
    g: f32,
    edges: u32,
}

impl<L: VirtualLight, R, K: Kernel<R, L>, B: Bounding + ?Sized> Contribute<L> for Gather<'_, R, K, B> {
    fn contribution(&mut self, light: &L, s: &mut Stream) -> Spectrum {
        let Some((kept, edge)) = self.kept(light, s) else { return Spectrum::BLACK };
        self.probe.shadow_rays += 1;
        let through = self.scene.transmittance(&edge, s);
        self.lit(&kept, &edge, through)
    }
    fn contributions(&mut self, lights: &[L], out: &mut [Spectrum], s: &mut Stream) {
        // Connect a batch, then trace it: the rays share this end, and go through the tree together.
        for (lights, out) in lights.chunks(BATCH).zip(out.chunks_mut(BATCH)) {
            let mut kept = ArrayVec::<(usize, Kept), BATCH>::new();
            let mut edges = ArrayVec::<Edge, BATCH>::new();
            for (i, l) in lights.iter().enumerate() {
                if let Some((k, edge)) = self.kept(l, s) {
                    kept.push((i, k));
                    edges.push(edge);
                }
            }
            let mut through = [Spectrum::BLACK; BATCH];
            let through = &mut through[..edges.len()];
            self.probe.shadow_rays += edges.len() as u64;
            self.scene.transmittances(&edges, through, &mut self.probe.occluders, s);
            out.fill(Spectrum::BLACK);
            for (((i, k), edge), through) in kept.iter().zip(&edges).zip(through) {
                out[*i] = self.lit(k, edge, *through);
            }
        }
    }
}
impl<L: VirtualLight, R, K: Kernel<R, L>, B: Bounding + ?Sized> Unshadowed<L> for Gather<'_, R, K, B> {
    fn unshadowed(&mut self, light: &L, s: &mut Stream) -> Spectrum {
        self.kept(light, s).map_or(Spectrum::BLACK, |(k, _)| k.value)
    }
}
impl<C, R, K: Bounds<R, C>, B: Bounding + ?Sized> BoundCluster<C> for Gather<'_, R, K, B> {
    #[inline]
    fn upper_bound(&self, cluster: &C) -> f32 {
        self.kernel.upper_bound(self.receiver, cluster, self.bounding.cap())
    }
}
impl<C, R, K: Reaches<R, C>, B: Bounding + ?Sized> ReachCluster<C> for Gather<'_, R, K, B> {
    #[inline]
    fn reach(&self, cluster: &C) -> Reach {
        self.kernel.reach(self.receiver, cluster, self.bounding.cap())
    }
}
impl Located for Vertex {
    fn position(&self) -> Vec3 {
        self.p
    }
}
impl<R: Located, K, B: ?Sized> Located for Gather<'_, R, K, B> {
    fn position(&self) -> Vec3 {
        self.receiver.position()
    }
}
impl Stretch for Vertex {
    fn stretch(&self) -> Ray {
        Ray { t_max: 0.0, ..Ray::new(self.p, Vec3::Z) }
    }
}
impl Stretch for Span {
    fn stretch(&self) -> Ray {
        self.ray
    }
}
impl<R: Stretch, K, B: ?Sized> Stretch for Gather<'_, R, K, B> {
    fn stretch(&self) -> Ray {
        self.receiver.stretch()
    }
}
impl<R, K, B: ?Sized> Limited for Gather<'_, R, K, B> {
    fn edges_left(&self) -> u32 {
        self.edges_left
    }
    fn edges_least(&self) -> u32 {
        self.edges_least
    }
}
impl<R, K, B: ?Sized> Notes for Gather<'_, R, K, B> {
    fn note(&mut self, aov: &'static str, value: f32) {
        self.probe.note(aov, value);
    }
}
