//! Virtual lights: plain data, made by a generator, read by kernels.

use manylight_math::Vec3;

/// A virtual light.
pub trait VirtualLight: Copy + Send + Sync + 'static {
    /// Luminance of its power; positive for every light that is worth storing, but a set that divides by it checks. \[W\]
    fn intensity(&self) -> f32;
    /// Edges from the emitter to this light: 0 on the emitter itself. What `max-depth` and residuals count.
    fn edges(&self) -> u32;
}

/// Lights that a tree can summarise. A cluster keeps the largest lobe of its lights.
#[diagnostic::on_unimplemented(
    message = "a tree cannot summarise lights of type `{Self}`",
    note = "implement `Clustered`, or use a light set that needs no tree: `all`, `power`"
)]
pub trait Clustered: VirtualLight {
    /// What is known of several lights together.
    type Cluster: Copy + Send + Sync;
    /// Where it is, for building. \[m\]
    fn position(&self) -> Vec3;
    /// The cluster of this light alone.
    fn cluster(&self) -> Self::Cluster;
    /// The cluster of two clusters.
    fn merge(a: &Self::Cluster, b: &Self::Cluster) -> Self::Cluster;
}

/// Lights that a grid can average into a made-up one (lighting grid hierarchy).
pub trait Blend: Clustered {
    /// The made-up light.
    type Synthetic: VirtualLight;
    /// Weighted lights as one, and where it is; keeps the sum of the intensities. `None` if they have none.
    fn blend(parts: &[(f32, Self)]) -> Option<(Vec3, Self::Synthetic)>;
}
