//! The light set: asks the lights that a receiver can be near to, and no shadow ray.

use manylight_framework::{BuildError, Claim, LightSet, Occlusion, Plan, Promise, Stretch, Unshadowed, VirtualLight};
use manylight_math::{Aabb, Ray, Spectrum};
use manylight_sampling::Stream;
use rstar::{AABB, Envelope, RTree, RTreeObject, SelectionFunction};

/// A light that reaches no further than a box.
pub trait Near: VirtualLight {
    /// Holds all that it reaches.
    fn place(&self) -> Aabb;
}

/// Asks every light whose box the receiver meets: exact, for lights that reach no further.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nearby;

impl Promise for Nearby {
    fn claim(&self) -> Claim {
        Claim::EXACT
    }
}

/// An R-tree over the lights' boxes.
pub struct NearbyLights<L> {
    lights: Vec<L>,
    tree: RTree<Place>,
}

/// A light's box, and which one it is.
#[derive(Clone, Copy)]
struct Place {
    bounds: AABB<[f32; 3]>,
    light: u32,
}
impl RTreeObject for Place {
    type Envelope = AABB<[f32; 3]>;
    fn envelope(&self) -> Self::Envelope {
        self.bounds
    }
}

impl<L: Near> Plan<Vec<L>> for Nearby {
    type Set = NearbyLights<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<NearbyLights<L>, BuildError> {
        let most = u32::MAX as usize;
        if lights.len() > most {
            return Err(BuildError::TooMany { lights: lights.len(), limit: most });
        }
        let mut places = Vec::with_capacity(lights.len());
        for (i, l) in lights.iter().enumerate() {
            let place = l.place();
            let finite =
                l.intensity() >= 0.0 && l.intensity().is_finite() && place.lo.is_finite() && place.hi.is_finite();
            if !finite {
                return Err(BuildError::NotFinite { light: i });
            }
            let bounds = AABB::from_corners(place.lo.to_array(), place.hi.to_array());
            places.push(Place { bounds, light: i as u32 });
        }
        Ok(NearbyLights { lights, tree: RTree::bulk_load(places) })
    }
}

impl<L: Near, Q: Unshadowed<L> + Stretch> LightSet<Q> for NearbyLights<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let mut sum = [0.0f64; 3];
        for place in self.tree.locate_with_selection_function(Meets(ask.stretch())) {
            let c = ask.unshadowed(&self.lights[place.light as usize], s).to_array();
            (0..3).for_each(|k| sum[k] += f64::from(c[k]));
        }
        Spectrum::from(sum.map(|x| x as f32))
    }
}

/// Boxes that a segment meets.
struct Meets(Ray);
impl SelectionFunction<Place> for Meets {
    fn should_unpack_parent(&self, envelope: &AABB<[f32; 3]>) -> bool {
        // The envelope of an empty tree is turned inside out.
        envelope.area() >= 0.0 && meets(&self.0, envelope.lower(), envelope.upper())
    }
    fn should_unpack_leaf(&self, leaf: &Place) -> bool {
        meets(&self.0, leaf.bounds.lower(), leaf.bounds.upper())
    }
}

/// Does a segment meet a box? Slab by slab; of the kernel's own test this is only to save work.
fn meets(ray: &Ray, lo: [f32; 3], hi: [f32; 3]) -> bool {
    let (origin, dir) = (ray.origin.to_array(), ray.dir.to_array());
    let (mut from, mut to) = (0.0f32, ray.t_max);
    for k in 0..3 {
        // Rounding of the slabs' distances must not make a gap.
        let slack = 1e-6 * (lo[k].abs() + hi[k].abs() + origin[k].abs());
        let (a, b) = (lo[k] - slack - origin[k], hi[k] + slack - origin[k]);
        if dir[k].abs() * ray.t_max <= slack {
            if a > slack || b < -slack {
                return false;
            }
            continue;
        }
        let (a, b) = (a / dir[k], b / dir[k]);
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    from <= to * (1.0 + 4.0 * f32::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Vec3;
    use manylight_sampling::Purpose;

    #[test]
    fn every_box_that_holds_a_point_of_the_segment_is_met() {
        let mut s = Stream::new(3, [0; 3], Purpose::TEST);
        let mut met = 0;
        for i in 0..50_000 {
            let mut point = || Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * 4.0 - 2.0;
            let (a, b, c) = (point(), point(), point());
            let mut dir = (b - a).normalize();
            if i % 7 == 0 {
                dir = Vec3::Y; // along an axis: slabs without an inverse
            }
            let t_max = if i % 5 == 0 { 0.0 } else { (b - a).length() };
            let ray = Ray { t_max, ..Ray::new(a, dir) };
            let r = Vec3::splat(0.2 + s.next_f32());
            let place = Aabb { lo: c - r, hi: c + r };
            let inside = (0..=100).any(|k| place.contains(ray.at(t_max * k as f32 / 100.0)));
            let says = meets(&ray, place.lo.to_array(), place.hi.to_array());
            assert!(says || !inside, "{ray:?} {place:?}");
            met += usize::from(says);
        }
        assert!(met > 1000 && met < 40_000, "{met}");
    }
}
