//! The fast build: medians of places and directions, in parallel.

use crate::tree::Place;
use manylight_framework::Clustered;
use manylight_math::Vec3;

/// A light to be sorted: where it is, and the axis about which it shines.
#[derive(Clone, Copy)]
struct Item {
    place: Vec3,
    axis: Vec3,
    light: u32,
}

/// Below this many lights a subtree is built by one thread.
const ALONE: usize = 2048;

/// Orders `group` from left to right, and builds the subtree over it.
///
/// Halves the lights at the median along the longest side of their box, or of the box of their axes where these say more: where
/// the second term of `Clustered::cost` would exceed the first. A tie goes by the number of the light, so that the tree is
/// the same whatever the order in which threads come to it.
pub(crate) fn grow<L: Clustered>(lights: &[L], group: &mut [u32], place: Place<L::Cluster>) {
    let mut items: Vec<Item> = group
        .iter()
        .map(|&light| {
            let l = &lights[light as usize];
            Item { place: l.position(), axis: l.axis(), light }
        })
        .collect();
    let (lo, hi) = extent(&items, |i| i.place);
    halve(lights, &mut items, place, (hi - lo).length());
    for (slot, item) in group.iter_mut().zip(&items) {
        *slot = item.light;
    }
}

fn extent(items: &[Item], of: impl Fn(&Item) -> Vec3) -> (Vec3, Vec3) {
    items.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), i| (lo.min(of(i)), hi.max(of(i))))
}

fn halve<L: Clustered>(lights: &[L], items: &mut [Item], place: Place<L::Cluster>, scale: f32) {
    if let [item] = items {
        return place.leaf(lights[item.light as usize].cluster());
    }
    let left = items.len() / 2;
    let side = |of: fn(&Item) -> Vec3| {
        let (lo, hi) = extent(items, of);
        hi - lo
    };
    let (places, axes) = (side(|i| i.place), side(|i| i.axis));
    // The half diagonal of the axes' box is the sine of the half angle of their cone, or so; beyond a right angle it is the angle.
    let sine = 0.5 * axes.length();
    let turned = scale * if sine < 1.0 { 1.0 - (1.0 - sine * sine).sqrt() } else { sine };
    if turned > places.length() {
        let k = axes.max_position();
        select(items, left, |i| i.axis[k]);
    } else {
        let k = places.max_position();
        select(items, left, |i| i.place[k]);
    }
    let (a, b) = items.split_at_mut(left);
    let (root, left, right) = place.split(left);
    let (a, b) = if b.len() > ALONE {
        rayon::join(|| built(lights, a, left, scale), || built(lights, b, right, scale))
    } else {
        (built(lights, a, left, scale), built(lights, b, right, scale))
    };
    root.cluster = L::merge(&a, &b);
}

/// Builds a subtree, and hands its cluster on to its parent.
fn built<L: Clustered>(lights: &[L], items: &mut [Item], place: Place<L::Cluster>, scale: f32) -> L::Cluster {
    let Place { root, below, base, first } = place;
    halve(lights, items, Place { root: &mut *root, below, base, first }, scale);
    root.cluster
}

fn select(items: &mut [Item], left: usize, key: impl Fn(&Item) -> f32) {
    items.select_nth_unstable_by(left, |a, b| key(a).total_cmp(&key(b)).then(a.light.cmp(&b.light)));
}
