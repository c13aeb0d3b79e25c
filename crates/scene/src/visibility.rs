//! What gets through between two points.

use crate::{Edge, Scene};
use arrayvec::ArrayVec;
use manylight_geometry::{Occluders, offset_from, shadow_segment};
use manylight_math::{Ray, Spectrum, Vec3};
use manylight_sampling::Stream;

impl Scene {
    /// What gets through along an edge: black if a surface blocks it, else one, or what the media on the way let through (an
    /// estimate where that has no closed form; only then is anything drawn). Media are known at the edge's first end.
    pub fn transmittance(&self, edge: &Edge, s: &mut Stream) -> Spectrum {
        match shadow_ray(edge) {
            None => Spectrum::ONE, // nothing fits between coincident points
            Some(ray) => match self.clearance(&ray) {
                clear if clear <= 0.0 => Spectrum::BLACK,
                clear => self.through_media(edge, ray, s) * clear,
            },
        }
    }
    /// The same for up to 64 edges at once, sooner: draws and answers are those of one after the other. The second end of each is
    /// the one that later edges will have too: what lies in its way is remembered in `occluders`.
    pub fn transmittances(&self, edges: &[Edge], out: &mut [Spectrum], occluders: &mut Occluders, s: &mut Stream) {
        if self.masked {
            // Rays pass surfaces, in order.
            edges.iter().zip(out).for_each(|(e, o)| *o = self.transmittance(e, s));
            return;
        }
        let mut rays = ArrayVec::<Ray, 64>::new();
        let mut shared = ArrayVec::<Vec3, 64>::new();
        let mut whose = ArrayVec::<usize, 64>::new();
        out.fill(Spectrum::ONE);
        for (k, edge) in edges.iter().enumerate() {
            if let Some(ray) = shadow_ray(edge) {
                rays.push(ray);
                whose.push(k);
                shared.push(match edge {
                    Edge::Between(_, b) => b.p,
                    Edge::ToInfinity(_, w) => *w,
                });
            }
        }
        let occluded = self.geometry.occluded_of(&rays, &shared, occluders);
        for (r, (&k, ray)) in whose.iter().zip(&rays).enumerate() {
            let blocked = occluded >> r & 1 != 0;
            out[k] = if blocked { Spectrum::BLACK } else { self.through_media(&edges[k], *ray, s) };
        }
    }
    /// What media let through along an edge that no surface blocks.
    fn through_media(&self, edge: &Edge, ray: Ray, s: &mut Stream) -> Spectrum {
        let Some(media) = &self.media else { return Spectrum::ONE };
        let (ray, from) = match edge {
            // The shadow ray may run either way.
            Edge::Between(a, b) => {
                let d = b.p - a.p;
                let length = d.length();
                (Ray { t_max: length, ..Ray::new(a.p, d / length) }, a)
            }
            Edge::ToInfinity(a, _) => (ray, a),
        };
        media.transmittance(&ray.within(from.towards(ray.dir)), s)
    }
}

/// The ray that has to be clear; `None` between coincident points.
fn shadow_ray(edge: &Edge) -> Option<Ray> {
    match edge {
        Edge::Between(a, b) => shadow_segment((a.p, a.surface), (b.p, b.surface)),
        Edge::ToInfinity(a, w) => {
            Some(Ray::new(a.surface.map_or(a.p, |(n, error)| offset_from(a.p, n, error, *w)), *w))
        }
    }
}
