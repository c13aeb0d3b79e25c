//! Tabulated spectra as colours: the observer of the CIE of 1931, and its daylight D65.

/// At 360, 365, .. 830 nm: the colour matching functions x, y and z, and the relative power of D65 (100 at 560 nm).
#[rustfmt::skip]
const CIE: [[f64; 4]; 95] = [
    [0.0001299, 3.9e-06, 0.0006061, 46.6383057],
    [0.0002321, 7e-06, 0.001086, 49.3637032],
    [0.0004149, 1.24e-05, 0.001946, 52.0891037],
    [0.0007416, 2.2e-05, 0.003486, 51.032305],
    [0.001368, 3.9e-05, 0.00645, 49.9755003],
    [0.002236, 6.4e-05, 0.01055, 52.3118023],
    [0.004243, 0.00012, 0.02005, 54.6482046],
    [0.00765, 0.000217, 0.03621, 68.7015036],
    [0.01431, 0.000396, 0.06785, 82.7549028],
    [0.02319, 0.00064, 0.1102, 87.1204046],
    [0.04351, 0.00121, 0.2074, 91.4860067],
    [0.07763, 0.00218, 0.3713, 92.4589034],
    [0.13438, 0.004, 0.6456, 93.4318059],
    [0.21477, 0.0073, 1.0390501, 90.0570032],
    [0.2839, 0.0116, 1.3856, 86.6823008],
    [0.3285, 0.01684, 1.62296, 95.7736015],
    [0.34828, 0.023, 1.7470599, 104.8650025],
    [0.34806, 0.0298, 1.7826, 110.9360031],
    [0.3362, 0.038, 1.77211, 117.0080068],
    [0.3187, 0.048, 1.7441, 117.4100101],
    [0.2908, 0.06, 1.6691999, 117.8120016],
    [0.2511, 0.0739, 1.5281, 116.3360108],
    [0.19536, 0.09098, 1.28764, 114.8610112],
    [0.1421, 0.1126, 1.0419, 115.392004],
    [0.09564, 0.13902, 0.8129501, 115.9230085],
    [0.05795, 0.1693, 0.6162, 112.3670069],
    [0.03201, 0.20802, 0.46518, 108.8110053],
    [0.0147, 0.2586, 0.3533, 109.082013],
    [0.0049, 0.323, 0.272, 109.3540001],
    [0.0024, 0.4073, 0.2123, 108.5780101],
    [0.0093, 0.503, 0.1582, 107.8020082],
    [0.0291, 0.6082, 0.1117, 106.2960063],
    [0.06327, 0.71, 0.07825, 104.7900045],
    [0.1096, 0.7932, 0.05725, 106.2390055],
    [0.1655, 0.862, 0.04216, 107.6890097],
    [0.2257499, 0.9148501, 0.02984, 106.0470083],
    [0.2904, 0.954, 0.0203, 104.405007],
    [0.3597, 0.9803, 0.0134, 104.2250001],
    [0.4334499, 0.9949501, 0.00875, 104.046008],
    [0.5120501, 1.0, 0.00575, 102.0230099],
    [0.5945, 0.995, 0.0039, 100.0],
    [0.6784, 0.9786, 0.00275, 98.1671049],
    [0.7621, 0.952, 0.0021, 96.334204],
    [0.8425, 0.9154, 0.0018, 96.0611016],
    [0.9163, 0.87, 0.00165, 95.7880051],
    [0.9786, 0.8163, 0.0014, 92.2368067],
    [1.0263, 0.757, 0.0011, 88.6856082],
    [1.0567, 0.6949, 0.001, 89.3459091],
    [1.0622, 0.631, 0.0008, 90.0062099],
    [1.0456001, 0.5668, 0.0006, 89.8026001],
    [1.0026, 0.503, 0.00034, 89.5991025],
    [0.9384, 0.4412, 0.00024, 88.6489059],
    [0.8544499, 0.381, 0.00019, 87.6987033],
    [0.7514, 0.321, 0.0001, 85.4936035],
    [0.6424, 0.265, 5e-05, 83.288604],
    [0.5419, 0.217, 3e-05, 83.4939014],
    [0.4479, 0.175, 2e-05, 83.6992106],
    [0.3608, 0.1382, 1e-05, 81.8630052],
    [0.2835, 0.107, 0.0, 80.0268057],
    [0.2187, 0.0816, 0.0, 80.1207037],
    [0.1649, 0.061, 0.0, 80.2146016],
    [0.1212, 0.04458, 0.0, 81.2462044],
    [0.0874, 0.032, 0.0, 82.2778071],
    [0.0636, 0.0232, 0.0, 80.2810023],
    [0.04677, 0.017, 0.0, 78.2842092],
    [0.0329, 0.01192, 0.0, 74.0027039],
    [0.0227, 0.00821, 0.0, 69.7213049],
    [0.01584, 0.005723, 0.0, 70.6652055],
    [0.0113592, 0.004102, 0.0, 71.6091061],
    [0.0081109, 0.002929, 0.0, 72.9790022],
    [0.0057903, 0.002091, 0.0, 74.3490046],
    [0.0041095, 0.001484, 0.0, 67.9765074],
    [0.0028993, 0.001047, 0.0, 61.6040043],
    [0.0020492, 0.00074, 0.0, 65.7448013],
    [0.00144, 0.00052, 0.0, 69.8856042],
    [0.0009999, 0.0003611, 0.0, 72.4862992],
    [0.0006901, 0.0002492, 0.0, 75.087],
    [0.000476, 0.0001719, 0.0, 69.3398007],
    [0.0003323, 0.00012, 0.0, 63.5927075],
    [0.0002348, 8.48e-05, 0.0, 55.0054039],
    [0.0001662, 6e-05, 0.0, 46.4182035],
    [0.0001174, 4.24e-05, 0.0, 56.6118062],
    [8.31e-05, 3e-05, 0.0, 66.8054001],
    [5.87e-05, 2.12e-05, 0.0, 65.0941068],
    [4.15e-05, 1.5e-05, 0.0, 63.3828076],
    [2.94e-05, 1.06e-05, 0.0, 63.8434049],
    [2.07e-05, 7.5e-06, 0.0, 64.3040023],
    [1.46e-05, 5.3e-06, 0.0, 61.8779033],
    [1.03e-05, 3.7e-06, 0.0, 59.4519046],
    [7.2e-06, 2.6e-06, 0.0, 55.7054046],
    [5.1e-06, 1.8e-06, 0.0, 51.959005],
    [3.6e-06, 1.3e-06, 0.0, 54.6998004],
    [2.5e-06, 9e-07, 0.0, 57.4406076],
    [1.8e-06, 6e-07, 0.0, 58.8765032],
    [1.3e-06, 5e-07, 0.0, 60.3125049],
];
const FIRST: f64 = 360.0;
const LAST: f64 = 830.0;
/// Steps of the integral, as many as Mitsuba 3 takes: a narrow line depends on them.
const STEPS: usize = 1000;
/// XYZ to linear Rec. 709.
const TO_RGB: [[f64; 3]; 3] =
    [[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]];
/// Integral of y, by which Mitsuba 3 divides. \[nm\]
const LUMINANCE: f64 = 106.750_259_399_414_06;
/// D65 such that its luminance is one: Mitsuba's own scale.
const D65: f64 = 1.010127306 / 100.0;

/// Pairs of a wavelength [nm], rising, and a value: from text such as `400:0.1, 500:0.7`.
pub(crate) fn parse(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let pair = |entry: &str| match entry.split_once(':') {
        Some((wavelength, value)) => Ok([crate::value::number(wavelength)?, crate::value::number(value)?]),
        None => Err(format!("`{entry}` is no pair of a wavelength and a value, such as `500:0.7`")),
    };
    // Blanks may stand about the colons too.
    let joined = text.split(':').map(str::trim).collect::<Vec<_>>().join(":");
    let entries = joined.split([',', ';', ' ', '\t', '\n', '\r']).filter(|t| !t.is_empty());
    check(entries.map(pair).collect::<Result<_, _>>()?)
}

/// The same from a file: a line a pair, separated by blanks; what follows a `#` is a remark.
pub(crate) fn read(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut all = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        match crate::value::numbers(line).map_err(|e| format!("line {}: {e}", i + 1))?[..] {
            [] => {}
            [wavelength, value] => all.push([wavelength, value]),
            ref other => {
                return Err(format!("line {}: expected a wavelength and a value, found {}", i + 1, other.len()));
            }
        }
    }
    check(all)
}

fn check(table: Vec<[f64; 2]>) -> Result<Vec<[f64; 2]>, String> {
    if table.len() < 2 {
        return Err(format!("a spectrum needs two wavelengths or more, not {}", table.len()));
    }
    if let Some(w) = table.windows(2).find(|w| !(w[0][0] < w[1][0])) {
        return Err(format!("wavelengths must rise: {} follows {}", w[1][0], w[0][0]));
    }
    Ok(table)
}

/// Linear Rec. 709 of a spectrum as Mitsuba 3's RGB variants see it: nothing outside of its wavelengths, straight lines between them.
/// Light is looked at as it is; anything else under daylight, so that what reflects all of it is white.
pub(crate) fn to_rgb(table: &[[f64; 2]], light: bool) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    let mut above = 1;
    for step in 0..STEPS {
        let nm = FIRST + (LAST - FIRST) * step as f64 / (STEPS - 1) as f64;
        if !(table[0][0] <= nm && nm <= table[table.len() - 1][0]) {
            continue;
        }
        while above + 1 < table.len() && table[above][0] < nm {
            above += 1;
        }
        let ([x0, y0], [x1, y1]) = (table[above - 1], table[above]);
        let value = y0 + (y1 - y0) * (nm - x0) / (x1 - x0);
        let t = (nm - FIRST) / 5.0;
        let i = (t as usize).min(CIE.len() - 2);
        let at = |column: usize| CIE[i][column] + (CIE[i + 1][column] - CIE[i][column]) * (t - i as f64);
        let power = if light { value } else { value * at(3) * D65 };
        (0..3).for_each(|c| xyz[c] += power * at(c));
    }
    let scale = (LAST - FIRST) / (STEPS as f64 * LUMINANCE);
    TO_RGB.map(|row| (0..3).map(|c| row[c] * xyz[c]).sum::<f64>() * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_mitsubas() {
        // mitsuba 3.9.1, scalar_rgb: `reflectance` of a `diffuse`, `intensity` of a `point`; where a channel is negative that is zero.
        for (text, reflected, emitted) in [
            (
                "400:0.1, 500:0.7, 600:0.3, 700:0.9",
                [0.311_179_43, 0.550_708_95, 0.413_552_76],
                [0.409_550_13, 0.518_721_76, 0.366_459_58],
            ),
            ("360:1,830:1", [0.998_985_3, 0.998_873_7, 0.998_801_6], [1.204_883_7, 0.948_228_2, 0.909_266_8]),
            ("400 : 1 700 : 1", [0.995_342, 0.999_756_4, 0.994_909_1], [1.199_693_6, 0.949_520_35, 0.903_443_34]),
            (
                "500:0.5,501:0.5",
                [-0.003_040_76, 0.003_043_89, 0.001_044_74],
                [-0.002_754_48, 0.002_757_33, 0.000_946_37],
            ),
            ("400:2, 500:0.7, 700:3", [2.396_07, 1.099_46, 1.284_18], [2.779_774_4, 1.045_958_9, 1.181_861_5]),
        ] {
            let table = parse(text).unwrap();
            for (light, want) in [(false, reflected), (true, emitted)] {
                let got = to_rgb(&table, light);
                assert!((0..3).all(|c| (got[c] - want[c]).abs() < 2e-5), "{text}: {got:?}, Mitsuba has {want:?}");
            }
        }
        assert_eq!(read("# two\n 400 1\n700\t2 # red\n\n").unwrap(), [[400.0, 1.0], [700.0, 2.0]]);
    }
    #[test]
    fn what_is_no_spectrum_is_refused() {
        for (text, why) in [
            ("500:1", "two wavelengths or more"),
            ("700:1, 400:2", "wavelengths must rise"),
            ("400:1, 400:2", "wavelengths must rise"),
            ("400:1, b:2", "`b` is not a number"),
            ("400:1, 500", "`500` is no pair"),
            ("400:nan, 500:1", "not a finite number"),
        ] {
            let message = parse(text).unwrap_err();
            assert!(message.contains(why), "{text}: {message}");
        }
        assert!(read("400 1\n500 1 2").unwrap_err().contains("line 2: expected a wavelength and a value"));
    }
}
