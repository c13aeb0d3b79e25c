//! The bound of one pass.

use manylight_framework::{Bounding, Claim, Pair, Promise};

const PI2: f32 = std::f32::consts::PI * std::f32::consts::PI;

/// A bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Everything is kept.
    None,
    /// min(G, b), with b positive. [1/m^2]
    Geometry(f32),
    /// min(pi^2 f(x) G f(y), b): of the whole contribution per unit of the light's flux, lobes and all, so that a glossy light
    /// cannot make a spike either. In units of white diffuse surfaces, whose pi f is one, so that b is as above. [1/m^2]
    ///
    /// What is taken away depends on where the light came from, so that no compensation can estimate it.
    Contribution(f32),
}

impl Promise for Bound {
    fn claim(&self) -> Claim {
        match self {
            Bound::None => Claim::EXACT,
            Bound::Geometry(_) | Bound::Contribution(_) => Claim::DARKENS,
        }
    }
}
impl Bounding for Bound {
    fn keep(&self, pair: &Pair) -> f32 {
        match *self {
            Bound::Geometry(b) if pair.g > b => b / pair.g,
            Bound::Contribution(b) => {
                let c = PI2 * pair.lobes.unwrap_or(0.0) * pair.g;
                if c > b { b / c } else { 1.0 }
            }
            _ => 1.0,
        }
    }
    fn cap(&self) -> f32 {
        match *self {
            Bound::None | Bound::Contribution(_) => f32::INFINITY,
            Bound::Geometry(b) => b,
        }
    }
    fn compensable(&self) -> bool {
        !matches!(self, Bound::Contribution(_))
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
    fn the_whole_contribution_is_bounded_in_units_of_white_walls() {
        let white = std::f32::consts::FRAC_1_PI * std::f32::consts::FRAC_1_PI;
        for g in [0.1f32, 1.0, 7.0, 1e9] {
            let keep = |lobes| Bound::Contribution(5.0).keep(&Pair { g, lobes: Some(lobes) });
            let geometry = Bound::Geometry(5.0).keep(&Pair { g, lobes: None });
            assert!((keep(white) - geometry).abs() < 1e-6, "{g}: {} and {geometry}", keep(white));
            // A lobe a hundred times as high is kept down to the same contribution.
            assert!(keep(100.0 * white) * 100.0 * g <= 5.0 * 1.00001);
            assert_eq!(keep(0.0), 1.0);
        }
    }
    #[test]
    fn light_from_infinity_is_kept_whole() {
        assert_eq!(Bound::Geometry(1.0).keep(&Pair { g: 0.0, lobes: None }), 1.0);
    }
}
