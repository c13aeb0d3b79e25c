//! How much a smooth interface reflects.

use manylight_math::Spectrum;

/// What an interface between two dielectrics does with unpolarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Fraction reflected.
    pub reflected: f32,
    /// Fraction transmitted: 1 - `reflected`, without its cancellation at grazing angles.
    pub transmitted: f32,
    /// Cosine of the refracted direction to the normal, on the far side; 0 under total internal reflection.
    pub cos_t: f32,
    /// Index of refraction of the far side over that of the near side.
    pub eta: f32,
}

/// Fresnel's equations between dielectrics. `cos_i` is positive outside and negative inside; `eta` is the index inside
/// over the index outside.
pub fn dielectric(cos_i: f32, eta: f32) -> Interface {
    let eta = if cos_i >= 0.0 { eta } else { 1.0 / eta };
    let p = Polarised::new(cos_i.abs(), eta);
    Interface { reflected: 0.5 * (p.r_s + p.r_p), transmitted: 0.5 * (p.t_s + p.t_p), cos_t: p.cos_t, eta }
}

/// Of what the bounds bound: an index near one reflects a small difference of large numbers.
const ROUNDING: f32 = 1e-6;

/// Bound of [`dielectric`]'s `reflected` over all cosines in \[`cos_min`, `cos_max`\], not negative.
///
/// The two polarisations are bounded apart: the perpendicular one falls with the cosine; the parallel one falls to its
/// only minimum, Brewster's angle, and rises again, so that it is largest at an end. (Their mean need not fall: above an
/// index of 2 + sqrt(3) it does not.)
pub(crate) fn dielectric_reflected_bound(cos_min: f32, cos_max: f32, eta: f32) -> f32 {
    let (low, high) = (Polarised::new(cos_min, eta), Polarised::new(cos_max, eta));
    0.5 * (low.r_s + low.r_p.max(high.r_p)) + ROUNDING
}

/// Bound of [`dielectric`]'s `transmitted`, by the same argument turned around.
pub(crate) fn dielectric_transmitted_bound(cos_min: f32, cos_max: f32, eta: f32) -> f32 {
    let (low, high) = (Polarised::new(cos_min, eta), Polarised::new(cos_max, eta));
    let brewster = 1.0 / (1.0 + eta * eta).sqrt();
    let t_p = if cos_min <= brewster && brewster <= cos_max { 1.0 } else { low.t_p.max(high.t_p) };
    0.5 * (high.t_s + t_p) + ROUNDING
}

struct Polarised {
    r_s: f32,
    r_p: f32,
    t_s: f32,
    t_p: f32,
    cos_t: f32,
}

impl Polarised {
    fn new(cos_i: f32, eta: f32) -> Self {
        if eta == 1.0 {
            return Polarised { r_s: 0.0, r_p: 0.0, t_s: 1.0, t_p: 1.0, cos_t: cos_i };
        }
        // Snell's law, without the cancellation of an index near one.
        let cos_t = ((eta - 1.0) * (eta + 1.0) + cos_i * cos_i).max(0.0).sqrt() / eta;
        // Total internal reflection, and light along the surface.
        if cos_t == 0.0 || cos_i == 0.0 {
            return Polarised { r_s: 1.0, r_p: 1.0, t_s: 0.0, t_p: 0.0, cos_t };
        }
        let (s, p) = (cos_i + eta * cos_t, cos_t + eta * cos_i);
        let square = |x: f32| x * x;
        let through = 4.0 * eta * cos_i * cos_t;
        Polarised {
            r_s: square((cos_i - eta * cos_t) / s),
            r_p: square((cos_t - eta * cos_i) / p),
            t_s: through / (s * s),
            t_p: through / (p * p),
            cos_t,
        }
    }
}

/// Fresnel's equations for a conductor of index `eta` + i `k`, relative to the outside, per channel. `cos_i` is not
/// negative.
pub fn conductor(cos_i: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    per_channel(eta, k, |eta, k| {
        let (r_s, r_p) = conductor_polarised(cos_i, eta, k);
        0.5 * (r_s + r_p)
    })
}

/// Bound of [`conductor`] over all cosines in \[`cos_min`, `cos_max`\]. As for dielectrics: the parallel polarisation has
/// its only minimum at the pseudo-Brewster angle (Humphreys-Owen 1961).
pub(crate) fn conductor_bound(cos_min: f32, cos_max: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    per_channel(eta, k, |eta, k| {
        let (s, p) = conductor_polarised(cos_min, eta, k);
        0.5 * (s + p.max(conductor_polarised(cos_max, eta, k).1)) + ROUNDING
    })
}

fn per_channel(eta: Spectrum, k: Spectrum, f: impl Fn(f32, f32) -> f32) -> Spectrum {
    let (eta, k) = (eta.to_array(), k.to_array());
    Spectrum::rgb(f(eta[0], k[0]), f(eta[1], k[1]), f(eta[2], k[2]))
}

/// Born and Wolf 1999, section 14.4: reflectance of both polarisations, perpendicular first.
fn conductor_polarised(cos_i: f32, eta: f32, k: f32) -> (f32, f32) {
    let cos2 = cos_i * cos_i;
    let sin2 = (1.0 - cos2).max(0.0);
    // With the refracted wave's normal component a + i b: its squared modulus and its real part.
    let real = (eta * eta - 1.0) - k * k + cos2;
    let modulus = (real * real + 4.0 * eta * eta * k * k).sqrt();
    // modulus + real, without its cancellation.
    let a2 = if real > 0.0 { 0.5 * (modulus + real) } else { 2.0 * (eta * k).powi(2) / (modulus - real) };
    let a = if a2 > 0.0 { a2.sqrt() } else { 0.0 };
    // Nothing but an index of one at cos = 0 makes a denominator vanish; light along the surface is all reflected.
    let ratio = |x: f32, y: f32| if x + y > 0.0 { ((x - y) / (x + y)).max(0.0) } else { 1.0 };
    let r_s = ratio(modulus + cos2, 2.0 * cos_i * a);
    let r_p = r_s * ratio(modulus * cos2 + sin2 * sin2, 2.0 * cos_i * a * sin2);
    (r_s, r_p)
}

/// [`diffuse_reflected`] as Mitsuba 3's plastic has it, where that is a good fit: Egan and Hilgeman 1973 below 1, d'Eon and
/// Irving 2011 above, relative error 0.6 %. Below 1/2 the former exceeds one, and the exact value takes its place.
pub(crate) fn diffuse_reflected_fit(eta: f32) -> f32 {
    let r = 1.0 / eta;
    if eta < 0.5 {
        diffuse_reflected(eta)
    } else if eta < 1.0 {
        -1.4399 * eta * eta + 0.7099 * eta + 0.6681 + 0.0636 * r
    } else {
        0.919317 + r * (-3.4793 + r * (6.75335 + r * (-7.80989 + r * (4.98554 - r * 1.36881))))
    }
}

/// Reflectance of an interface under diffuse light: the mean of [`dielectric`]'s `reflected` over the hemisphere outside,
/// weighted by the cosine (Duntley 1942).
pub fn diffuse_reflected(eta: f32) -> f32 {
    let n = f64::from(eta);
    if eta == 1.0 {
        return 0.0;
    }
    if n < 1.0 {
        // What goes through is the same from both sides, per area and per n^2 of solid angle.
        return (1.0 - n * n * (1.0 - duntley(1.0 / n))) as f32;
    }
    duntley(n) as f32
}

/// For n > 1.
fn duntley(n: f64) -> f64 {
    let (n2, n4) = (n * n, n.powi(4));
    let ln_n = (n - 1.0).ln_1p();
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * ln_n
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream};

    const INDICES: [f32; 9] = [0.2, 0.5, 0.7, 0.999, 1.0001, 1.33, 1.5, 2.5, 6.0];

    #[test]
    fn normal_incidence_has_its_closed_form() {
        for eta in INDICES {
            let r = ((eta - 1.0) / (eta + 1.0)).powi(2);
            assert!((dielectric(1.0, eta).reflected - r).abs() < 1e-6);
            let metal = conductor(1.0, Spectrum::gray(eta), Spectrum::gray(3.0)).0.x;
            assert!((metal - ((eta - 1.0).powi(2) + 9.0) / ((eta + 1.0).powi(2) + 9.0)).abs() < 1e-5);
        }
    }
    #[test]
    fn what_is_not_reflected_is_transmitted_and_the_same_comes_back_from_the_far_side() {
        for eta in INDICES {
            for i in 0..=1000 {
                let cos_i = i as f32 / 1000.0;
                let there = dielectric(cos_i, eta);
                assert!((there.reflected + there.transmitted - 1.0).abs() < 1e-5, "{eta} {cos_i} {there:?}");
                if cos_i > 0.1 && there.cos_t > 0.1 {
                    let back = dielectric(-there.cos_t, eta);
                    assert!((back.reflected - there.reflected).abs() < 1e-4, "{eta} {cos_i} {there:?} {back:?}");
                    assert!((back.cos_t - cos_i).abs() < 1e-3);
                }
            }
        }
    }
    #[test]
    fn a_conductor_that_does_not_absorb_is_a_dielectric() {
        for eta in INDICES {
            for i in 1..=1000 {
                let cos_i = i as f32 / 1000.0;
                let metal = conductor(cos_i, Spectrum::gray(eta), Spectrum::BLACK).0.x;
                let glass = dielectric(cos_i, eta).reflected;
                assert!((metal - glass).abs() < 2e-3, "{eta} {cos_i}: {metal} {glass}");
            }
        }
    }
    #[test]
    fn hard_cases_stay_between_zero_and_one() {
        for eta in INDICES.into_iter().chain([1.0]) {
            for cos in [0.0, -0.0, 1e-38, 1e-8, 1e-4, 1.0] {
                for sign in [1.0, -1.0] {
                    let i = dielectric(sign * cos, eta);
                    assert!((0.0..=1.0).contains(&i.reflected) && (0.0..=1.00001).contains(&i.transmitted), "{i:?}");
                }
                for k in [0.0, 1e-6, 1.0, 1e4] {
                    let r = conductor(cos, Spectrum::gray(eta), Spectrum::gray(k)).0.x;
                    assert!((0.0..=1.0).contains(&r), "{eta} {k} {cos}: {r}");
                }
            }
        }
        let mirror = conductor(0.3, Spectrum::BLACK, Spectrum::ONE).0.x;
        assert!((mirror - 1.0).abs() < 1e-6, "{mirror}");
    }
    #[test]
    fn bounds_hold_over_their_interval() {
        let mut s = Stream::new(8, [0; 3], Purpose::TEST);
        let draw = |s: &mut Stream, low: f32, high: f32| low * (high / low).powf(s.next_f32());
        for _ in 0..50_000 {
            let eta = draw(&mut s, 0.1, 10.0);
            let k = if s.next_f32() < 0.2 { 0.0 } else { draw(&mut s, 0.01, 10.0) };
            let centre = s.next_f32();
            let half = s.next_f32().powi(3);
            let (low, high) = ((centre - half).max(0.0), (centre + half).min(1.0));
            let reflected = dielectric_reflected_bound(low, high, eta);
            let transmitted = dielectric_transmitted_bound(low, high, eta);
            let metal = conductor_bound(low, high, Spectrum::gray(eta), Spectrum::gray(k)).0.x;
            for j in 0..=16 {
                let cos = (low + (high - low) * j as f32 / 16.0).min(high);
                let i = dielectric(cos, eta);
                assert!(i.reflected <= reflected && i.transmitted <= transmitted, "{eta} {cos}");
                let r = conductor(cos, Spectrum::gray(eta), Spectrum::gray(k)).0.x;
                assert!(r <= metal, "{eta} {k} {cos}: {r} {metal}");
            }
        }
    }
    #[test]
    fn diffuse_reflectance_is_the_integral_it_stands_for() {
        for eta in INDICES {
            let n = 20_000;
            let sum: f64 = (0..n)
                .map(|i| (i as f64 + 0.5) / n as f64)
                .map(|cos| 2.0 * cos * f64::from(dielectric(cos as f32, eta).reflected) / n as f64)
                .sum();
            assert!((sum - f64::from(diffuse_reflected(eta))).abs() < 1e-4, "{eta}: {sum} {}", diffuse_reflected(eta));
            let fit_error = (f64::from(diffuse_reflected_fit(eta)) / sum - 1.0).abs();
            // Near 1 little is reflected, and the relative error of the fits is large.
            if (eta - 1.0).abs() > 0.1 {
                assert!(fit_error < 0.006, "{eta}: {fit_error}");
            }
        }
    }
}
