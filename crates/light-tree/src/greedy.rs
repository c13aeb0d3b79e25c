//! The greedy build: the cheapest pair first.

use crate::tree::Place;
use manylight_framework::Clustered;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A cluster that is not part of another yet.
struct Open<C> {
    cluster: C,
    /// Its two parts, or the light that it is.
    made_of: Result<[u32; 2], u32>,
    /// Lights in it.
    count: u32,
    alive: bool,
}

/// A non-negative cost, ordered.
struct Cost(f32);
impl PartialEq for Cost {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o).is_eq()
    }
}
impl Eq for Cost {}
impl PartialOrd for Cost {
    fn partial_cmp(&self, o: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Cost {
    fn cmp(&self, o: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&o.0)
    }
}

/// Joins the pair whose cluster costs least, until one is left (Walter et al. 2005, section 3.1); a tie goes to the pair that came
/// first. A table of nearest neighbours behind a heap: N^2 evaluations of the cost and few more, so for small N.
pub(crate) fn grow<L: Clustered>(lights: &[L], group: &mut [u32], place: Place<L::Cluster>) {
    let scale = {
        let spread = |lo: bool| {
            let all = group.iter().map(|&i| lights[i as usize].position());
            all.reduce(|a, b| if lo { a.min(b) } else { a.max(b) }).unwrap_or_default()
        };
        (spread(false) - spread(true)).length()
    };
    let mut open: Vec<Open<L::Cluster>> = Vec::with_capacity(2 * group.len());
    for &light in group.iter() {
        open.push(Open { cluster: lights[light as usize].cluster(), made_of: Err(light), count: 1, alive: true });
    }
    let nearest = |open: &[Open<L::Cluster>], i: usize, among: std::ops::Range<usize>| {
        let cost = |j: usize| Cost(L::cost(&L::merge(&open[i].cluster, &open[j].cluster), scale));
        among.filter(|&j| j != i && open[j].alive).map(|j| (cost(j), j)).min()
    };
    let mut heap = BinaryHeap::new();
    // Each looks among those before it: so each pair is looked at once.
    for i in 1..open.len() {
        heap.extend(nearest(&open, i, 0..i).map(|(cost, j)| Reverse((cost, i, j))));
    }
    while let Some(Reverse((_, i, j))) = heap.pop() {
        if !open[i].alive {
            continue;
        }
        if !open[j].alive {
            heap.extend(nearest(&open, i, 0..i).map(|(cost, j)| Reverse((cost, i, j))));
            continue;
        }
        let (a, b) = (j.min(i), j.max(i));
        let cluster = L::merge(&open[a].cluster, &open[b].cluster);
        let count = open[a].count + open[b].count;
        (open[a].alive, open[b].alive) = (false, false);
        open.push(Open { cluster, made_of: Ok([a as u32, b as u32]), count, alive: true });
        let last = open.len() - 1;
        heap.extend(nearest(&open, last, 0..last).map(|(cost, j)| Reverse((cost, last, j))));
    }
    // Laid out from the root, without recursion: such a tree may be deep.
    let mut order = Vec::with_capacity(group.len());
    let mut stack = vec![(open.len() - 1, place)];
    while let Some((i, place)) = stack.pop() {
        match open[i].made_of {
            Err(light) => {
                order.push(light);
                place.leaf(open[i].cluster);
            }
            Ok([a, b]) => {
                let (root, left, right) = place.split(open[a as usize].count as usize);
                root.cluster = open[i].cluster;
                stack.push((b as usize, right));
                stack.push((a as usize, left));
            }
        }
    }
    group.copy_from_slice(&order);
}
