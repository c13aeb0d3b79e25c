//! The light set.

use crate::hierarchy::{Hierarchy, Met};
use crate::lattice::Lattice;
use manylight_framework::{
    Blend, BuildError, Claim, Contribute, KnobSet, LightSet, Limited, Located, Notes, Occlusion, Plan, Promise,
    Unshadowed,
};
use manylight_math::Spectrum;
use manylight_sampling::Stream;

/// Which of the lights that count at a receiver are asked for their shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadows {
    /// All: as many shadow rays.
    All,
    /// So many, drawn by what they would bring if nothing stood between: noise instead of rays.
    Drawn(u32),
}

/// A hierarchy of grids: lights near the receiver as they are, those farther away in averages, the coarser the farther (Yuksel and
/// Yuksel 2017).
#[derive(Clone, Copy, Debug)]
pub struct Lgh {
    /// r_l / h_l: level l counts most at the distance r_l. (The published header's parameter, `r_0 = alpha h_1`, is half of this.)
    pub alpha: f32,
    /// Where the vertices are; `None`: wherever this pass's lights are, so that vertices move with them.
    pub lattice: Option<Lattice>,
    /// Whose shadows are asked for.
    pub shadows: Shadows,
    /// Keeps lights of different edges in hierarchies of their own: needed where path lengths are limited.
    pub apart: bool,
}

impl Default for Lgh {
    fn default() -> Self {
        Lgh { alpha: 2.0, lattice: None, shadows: Shadows::All, apart: false }
    }
}

/// The hierarchies of a pass.
pub struct GridLights<L: Blend> {
    /// With the edges of its lights, if all have the same.
    groups: Vec<(Option<u32>, Hierarchy<L>)>,
    shadows: Shadows,
}

impl Promise for Lgh {
    /// An average is not where its lights are, and not as many: an error of either sign, that no bound is known of.
    fn claim(&self) -> Claim {
        Claim { noisy: self.shadows != Shadows::All, ..Claim::consistent(KnobSet::ALPHA) }
    }
}

impl<L: Blend> Plan<Vec<L>> for Lgh {
    type Set = GridLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<GridLights<L>, BuildError> {
        let mut groups: Vec<(Option<u32>, Vec<L>)> = Vec::new();
        if self.apart {
            for l in lights {
                let edges = Some(l.edges());
                match groups.iter_mut().find(|g| g.0 == edges) {
                    Some(g) => g.1.push(l),
                    None => groups.push((edges, vec![l])),
                }
            }
            groups.sort_by_key(|g| g.0);
        } else {
            groups.push((None, lights));
        }
        let alpha = f64::from(self.alpha);
        let built = groups.into_iter().map(|(e, l)| Ok((e, Hierarchy::new(l, self.lattice, alpha)?)));
        Ok(GridLights { groups: built.collect::<Result<_, BuildError>>()?, shadows: self.shadows })
    }
    fn merges(&self) -> bool {
        !self.apart
    }
}

impl<L: Blend> GridLights<L> {
    /// The hierarchies: one, or one for each number of edges.
    pub fn hierarchies(&self) -> impl Iterator<Item = &Hierarchy<L>> {
        self.groups.iter().map(|g| &g.1)
    }
}

impl<L: Blend, Q> LightSet<Q> for GridLights<L>
where
    Q: Located + Limited + Notes + Contribute<L> + Contribute<L::Synthetic> + Unshadowed<L> + Unshadowed<L::Synthetic>,
{
    /// Notes `grid lights`: how many lights count at the receiver, averages included.
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let (x, left, least) = (ask.position(), ask.edges_left(), ask.edges_least());
        let counting = self.groups.iter().filter(|g| g.0.is_none_or(|e| e < left && e >= least));
        let mut sum = [0.0f64; 3];
        let mut add = |w: f64, c: Spectrum| {
            let c = c.to_array();
            (0..3).for_each(|k| sum[k] += w * f64::from(c[k]));
        };
        let mut count = 0u32;
        match self.shadows {
            Shadows::All => {
                for (_, hierarchy) in counting {
                    hierarchy.at(x, |w, met| {
                        count += 1;
                        add(w, shadowed(ask, met, s));
                    });
                }
            }
            Shadows::Drawn(rays) => {
                let mut all = Vec::with_capacity(1024);
                let mut total = 0.0f64;
                for (_, hierarchy) in counting {
                    hierarchy.at(x, |w, met| {
                        count += 1;
                        let bright = w * f64::from(unshadowed(ask, met, s).luminance());
                        if bright > 0.0 {
                            total += bright;
                            all.push((total, bright, w, met));
                        }
                    });
                }
                let n = f64::from(rays.max(1));
                let mut next = 0;
                for stratum in 0..rays.max(1) {
                    if all.is_empty() {
                        break;
                    }
                    let at = (f64::from(stratum) + s.next_f64()) / n * total;
                    next += all[next..].partition_point(|l| l.0 <= at).min(all.len() - 1 - next);
                    let (_, bright, w, met) = all[next];
                    add(w * total / (n * bright), shadowed(ask, met, s));
                }
            }
        }
        ask.note("grid lights", count as f32);
        Spectrum::from(sum.map(|x| x as f32))
    }
}

fn shadowed<L: Blend, Q: Contribute<L> + Contribute<L::Synthetic>>(
    ask: &mut Q,
    met: Met<L>,
    s: &mut Stream,
) -> Spectrum {
    match met {
        Met::Given(l) => ask.contribution(l, s),
        Met::Made(l) => ask.contribution(l, s),
    }
}
fn unshadowed<L: Blend, Q: Unshadowed<L> + Unshadowed<L::Synthetic>>(
    ask: &mut Q,
    met: Met<L>,
    s: &mut Stream,
) -> Spectrum {
    match met {
        Met::Given(l) => ask.unshadowed(l, s),
        Met::Made(l) => ask.unshadowed(l, s),
    }
}
