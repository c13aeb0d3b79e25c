//! Radiance of a black body, as a colour.

use manylight_math::Spectrum;

/// Planck's constant [J s], the speed of light [m/s], Boltzmann's constant [J/K].
const H: f64 = 6.626_070_15e-34;
const C: f64 = 299_792_458.0;
const K: f64 = 1.380_649e-23;

/// B_lambda(T) = 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1), for a wavelength \[m\] and a temperature \[K\]. [W/(m^2 sr m)]
pub fn planck(wavelength: f64, kelvin: f64) -> f64 {
    if !(kelvin > 0.0) {
        return 0.0;
    }
    2.0 * H * C * C / wavelength.powi(5) / (H * C / (wavelength * K * kelvin)).exp_m1()
}

/// Linear sRGB of a black body: its luminance is int B ybar dlambda, the radiance as the eye weighs it (683 times this are cd/m^2).
/// What lies outside the gamut is cut off. [W/(m^2 sr)]
pub fn radiance(kelvin: f32) -> Spectrum {
    const FROM: f64 = 380e-9;
    const STEP: f64 = 10e-9;
    let mut xyz = [0.0f64; 3];
    for i in 0..40 {
        let wavelength = FROM + (f64::from(i) + 0.5) * STEP;
        let b = planck(wavelength, f64::from(kelvin)) * STEP;
        let weights = matching(wavelength * 1e9);
        (0..3).for_each(|c| xyz[c] += b * weights[c]);
    }
    let [x, y, z] = xyz;
    let rgb = [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ];
    Spectrum::from(rgb.map(|c| c.max(0.0) as f32))
}

/// The eye's matching functions (CIE 1931, 2 degrees) at a wavelength [nm], as sums of lobes (Wyman, Sloan and Shirley 2013).
fn matching(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, centre: f64, below: f64, above: f64| {
        let t = (nm - centre) / if nm < centre { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plancks_law_has_its_integral_and_its_peak() {
        // Stefan and Boltzmann: sigma T^4 / pi.
        let step = 1e-8;
        let sum: f64 = (0..20_000).map(|i| planck((f64::from(i) + 0.5) * step, 1500.0) * step).sum();
        assert!((sum / 9.1375e4 - 1.0).abs() < 2e-3, "{sum}");
        let largest = (0..20_000)
            .map(|i| (f64::from(i) + 0.5) * 1e-9)
            .max_by(|a, b| planck(*a, 1500.0).total_cmp(&planck(*b, 1500.0)));
        assert!((largest.unwrap() - 1.932e-6).abs() < 2e-9);
        assert_eq!((planck(5e-7, 0.0), planck(5e-7, -3.0)), (0.0, 0.0));
    }
    #[test]
    fn colours_are_those_of_the_locus() {
        // Chromaticities of CIE illuminant A and of 6504 K on the Planckian locus.
        for (kelvin, x, y) in [(2855.5, 0.4476, 0.4074), (6504.0, 0.3135, 0.3237)] {
            let [r, g, b] = radiance(kelvin).to_array().map(f64::from);
            let big_x = 0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b;
            let big_y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175_0 * b;
            let big_z = 0.019_333_9 * r + 0.119_192_0 * g + 0.950_304_1 * b;
            let sum = big_x + big_y + big_z;
            assert!(
                (big_x / sum - x).abs() < 3e-3 && (big_y / sum - y).abs() < 3e-3,
                "{kelvin}: {} {}",
                big_x / sum,
                big_y / sum
            );
        }
        // Redder and darker the colder; black at the end.
        let (hot, cold) = (radiance(3000.0), radiance(1200.0));
        assert!(cold.0.y / cold.0.x < hot.0.y / hot.0.x && cold.luminance() < 1e-3 * hot.luminance());
        assert_eq!(radiance(0.0), Spectrum::BLACK);
        // Luminance of a black body at 2042 K (the old definition of the candela): 60 cd/cm^2.
        assert!((683.0 * radiance(2042.15).luminance() / 6e5 - 1.0).abs() < 0.03);
    }
}
