//! The bound of one pass.

use manylight_framework::{Bounding, Claim, Pair, Promise};

/// A bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Everything is kept.
    None,
    /// min(G, b), with b positive. [1/m^2]
    Geometry(f32),
}

impl Promise for Bound {
    fn claim(&self) -> Claim {
        match self {
            Bound::None => Claim::EXACT,
            Bound::Geometry(_) => Claim::DARKENS,
        }
    }
}
impl Bounding for Bound {
    fn keep(&self, pair: &Pair) -> f32 {
        match *self {
            Bound::Geometry(b) if pair.g > b => b / pair.g,
            _ => 1.0,
        }
    }
    fn cap(&self) -> f32 {
        match *self {
            Bound::None => f32::INFINITY,
            Bound::Geometry(b) => b,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_kept_never_exceeds_the_cap_and_nothing_small_is_touched(g in 0f32..1e30, b in 1e-6f32..1e6) {
            let keep = Bound::Geometry(b).keep(&Pair { g, lobes: None });
            prop_assert!((0.0..=1.0).contains(&keep) && keep * g <= b * 1.000001);
            prop_assert!(g > b || keep == 1.0);
        }
    }
    #[test]
    fn light_from_infinity_is_kept_whole() {
        assert_eq!(Bound::Geometry(1.0).keep(&Pair { g: 0.0, lobes: None }), 1.0);
    }
}
