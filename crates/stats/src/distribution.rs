//! Normal and Student's t. Infinite degrees of freedom mean the normal distribution everywhere in this crate.

use statrs::function::beta::beta_reg;
use statrs::function::erf::{erfc, erfc_inv};
use std::f64::consts::SQRT_2;

/// Degrees from which t cannot be told from z.
const NORMAL_FROM: f64 = 1e9;

/// The z below which a standard normal falls with probability `p`. NaN outside [0, 1].
pub fn normal_quantile(p: f64) -> f64 {
    if (0.0..=1.0).contains(&p) { -SQRT_2 * erfc_inv(2.0 * p) } else { f64::NAN }
}

/// P(Z > z) of a standard normal.
pub fn normal_upper(z: f64) -> f64 {
    0.5 * erfc(z / SQRT_2)
}

/// The t below which Student's t falls with probability `p`. NaN outside [0, 1] or without positive degrees.
pub fn student_quantile(p: f64, degrees: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) || !(degrees > 0.0) {
        return f64::NAN;
    }
    if p > 0.5 {
        return -student_quantile(1.0 - p, degrees);
    }
    let normal = -normal_quantile(p);
    if degrees >= NORMAL_FROM || p == 0.0 || p == 0.5 {
        return -normal;
    }
    // Tails are heavier than normal: bracketed from there, then halved. (The inverse of `statrs` is off by a factor of
    // five at p = 1e-9 and one degree.)
    let (mut near, mut far) = (normal, 2.0 * normal.max(1.0));
    while student_upper(far, degrees) > p {
        (near, far) = (far, 2.0 * far);
    }
    while far - near > 1e-13 * far {
        let middle = 0.5 * (near + far);
        if student_upper(middle, degrees) > p { near = middle } else { far = middle }
    }
    -far
}

/// P(T > t) of Student's t.
pub fn student_upper(t: f64, degrees: f64) -> f64 {
    if t.is_nan() || !(degrees > 0.0) {
        return f64::NAN;
    }
    if degrees >= NORMAL_FROM {
        return normal_upper(t);
    }
    let square = t * t;
    let beyond = if square < 1.0 {
        // With many degrees the complement of a small t^2 / degrees would be rounded away.
        0.5 - 0.5 * beta_reg(0.5, 0.5 * degrees, square / (degrees + square))
    } else {
        0.5 * beta_reg(0.5 * degrees, 0.5, degrees / (degrees + square))
    };
    if t > 0.0 { beyond } else { 1.0 - beyond }
}

/// Which departures from "equal" count against a claim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alternative {
    /// Too large or too small: against a claim of no bias.
    #[default]
    Different,
    /// Too large: against a claim that a method only darkens.
    Greater,
    /// Too small: against a claim that a method only brightens.
    Less,
}

impl Alternative {
    /// Probability of a statistic at least this extreme if there is no difference.
    pub fn p_value(self, t: f64, degrees: f64) -> f64 {
        match self {
            Alternative::Different => 2.0 * student_upper(t.abs(), degrees),
            Alternative::Greater => student_upper(t, degrees),
            Alternative::Less => student_upper(-t, degrees),
        }
    }
    /// The size of t at which the p value is `alpha`.
    pub fn critical(self, alpha: f64, degrees: f64) -> f64 {
        let tail = if self == Alternative::Different { 0.5 * alpha } else { alpha };
        -student_quantile(tail, degrees)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabled_quantiles() {
        for (p, degrees, t) in [
            (0.975, 1.0, 12.706_204_736),
            (0.975, 10.0, 2.228_138_852),
            (0.995, 30.0, 2.749_995_654),
            (0.999, 100.0, 3.173_739_494),
            (0.975, f64::INFINITY, 1.959_963_985),
            (0.5, 7.0, 0.0),
        ] {
            let found = student_quantile(p, degrees);
            assert!((found - t).abs() < 1e-8, "{p} {degrees}: {found}");
            assert!((student_quantile(1.0 - p, degrees) + t).abs() < 1e-7, "{p} {degrees}");
        }
        assert!((Alternative::Different.p_value(2.228_138_852, 10.0) - 0.05).abs() < 1e-10);
    }
    #[test]
    fn quantile_and_tail_are_inverse_far_out() {
        for degrees in [1.0, 2.5, 15.0, 99.0, 1e4, 1e7, 1e12, f64::INFINITY] {
            for tail in [1e-9, 1.6e-7, 1e-5, 0.001, 0.01, 0.3, 0.499] {
                let t = -student_quantile(tail, degrees);
                let back = student_upper(t, degrees);
                assert!((back / tail - 1.0).abs() < 1e-6, "{degrees} {tail}: t {t}, back {back}");
                assert!((student_upper(-t, degrees) - (1.0 - tail)).abs() < 1e-9);
            }
        }
    }
    #[test]
    fn the_sides_of_an_alternative() {
        for alternative in [Alternative::Different, Alternative::Greater] {
            let t = alternative.critical(0.01, 12.0);
            assert!((alternative.p_value(t, 12.0) - 0.01).abs() < 1e-9);
        }
        assert!(Alternative::Greater.p_value(-5.0, 12.0) > 0.99 && Alternative::Less.p_value(-5.0, 12.0) < 0.001);
        assert_eq!(Alternative::Different.p_value(f64::INFINITY, 3.0), 0.0);
        assert_eq!(Alternative::Different.p_value(0.0, 3.0), 1.0);
    }
    #[test]
    fn what_is_no_probability_has_no_quantile() {
        assert!(normal_quantile(1.1).is_nan() && student_quantile(f64::NAN, 3.0).is_nan());
        assert!(student_quantile(0.5, 0.0).is_nan() && student_upper(1.0, -1.0).is_nan());
    }
}
