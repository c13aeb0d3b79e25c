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
    /// Where it is, for building; the direction that it comes from, if it is infinitely far away. \[m\]
    fn position(&self) -> Vec3;
    /// Unit, the axis about which it shines; zero if it shines alike to all sides. For building.
    fn axis(&self) -> Vec3 {
        Vec3::ZERO
    }
    /// Lights of different kinds share no cluster below the top of a tree, lest a few of one loosen the bounds of the other.
    fn kind(&self) -> u32 {
        0
    }
    /// The cluster of this light alone.
    fn cluster(&self) -> Self::Cluster;
    /// The cluster of two clusters.
    fn merge(a: &Self::Cluster, b: &Self::Cluster) -> Self::Cluster;
    /// What its lights together are weighed by: the sum over them, zero only if they can give nothing. A light that stands for
    /// its cluster is drawn by this, and is multiplied by the ratio: a kernel's upper bound has to hold for that too. [W/sr]
    fn weight(cluster: &Self::Cluster) -> f32;
    /// What it costs to take one of its lights for all: weight x (diagonal^2 + scale^2 (1 - cos half angle)^2) (Walter et al. 2005,
    /// section 3.1). `scale` \[m\] makes directions commensurable with places.
    fn cost(cluster: &Self::Cluster, scale: f32) -> f32;
}

/// Lights that a grid can average into made-up ones (lighting grid hierarchy). Many are averaged at once, in parts that are summed
/// by several threads, hence a running sum and not a slice of lights.
#[diagnostic::on_unimplemented(
    message = "a grid cannot average lights of type `{Self}`",
    note = "implement `Blend`, or use a light set that averages none"
)]
pub trait Blend: Clustered {
    /// The made-up light.
    type Synthetic: VirtualLight;
    /// Weighted sums over lights; the default is that of none.
    type Sum: Clone + Default + Send + Sync;
    /// May it be averaged? One that may not (it has no place) is asked for itself at every receiver.
    fn blends(&self) -> bool {
        true
    }
    /// Adds a light with its weight in (0, 1]. In f64: a million lights may differ by decades.
    fn add(&self, weight: f64, sum: &mut Self::Sum);
    /// Adds the sum over other lights.
    fn join(sum: &mut Self::Sum, other: &Self::Sum);
    /// The lights of a sum as one, and where it is; keeps the sum of the intensities. `None` if they have none.
    fn made(sum: &Self::Sum) -> Option<(Vec3, Self::Synthetic)>;
}
