//! Values of attributes: numbers, vectors, colours, transforms.

use crate::diagnostic::{At, Report, suggestion};
use crate::xml::{Attribute, Element};
use manylight_math::{DAffine3, DMat3, DVec3};

/// A finite number that also fits an `f32`; otherwise why not.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    let text = text.trim();
    match text.parse::<f64>() {
        Ok(x) if (x as f32).is_finite() => Ok(x),
        Ok(_) => Err(format!("`{text}` is not a finite number")),
        Err(_) if text.is_empty() => Err("expected a number, found nothing".into()),
        Err(_) => Err(format!("`{}` is not a number", shorten(text))),
    }
}

/// Numbers separated by blanks or commas.
pub(crate) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split([',', ' ', '\t', '\n', '\r']).filter(|t| !t.is_empty()).map(number).collect()
}

pub(crate) fn integer(text: &str) -> Result<i64, String> {
    let text = text.trim();
    match text.parse::<i64>() {
        Ok(i) => Ok(i),
        Err(_) => Err(format!("`{}` is not a whole number", shorten(text))),
    }
}

pub(crate) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim().to_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(format!("`{}` is not a truth value: expected `true` or `false`", shorten(text))),
    }
}

/// One number for a gray, or three; linear Rec. 709.
pub(crate) fn rgb(text: &str) -> Result<[f64; 3], String> {
    if let Some(hex) = text.trim().strip_prefix('#') {
        return Err(no_hex(hex));
    }
    match numbers(text)?[..] {
        [x] => Ok([x; 3]),
        [r, g, b] => Ok([r, g, b]),
        ref other => Err(format!("a colour is one number or three, not {}", other.len())),
    }
}

/// Mitsuba 3 refuses `#rrggbb`, and it is not linear: says what to write for it.
fn no_hex(hex: &str) -> String {
    let channel = |i: usize| hex.get(2 * i..2 * i + 2).and_then(|h| u8::from_str_radix(h, 16).ok());
    match (hex.len(), channel(0), channel(1), channel(2)) {
        (6, Some(r), Some(g), Some(b)) => {
            let [r, g, b] = [r, g, b].map(|c| crate::image::srgb_to_linear(f32::from(c) / 255.0));
            format!(
                "`#{hex}` is no colour in Mitsuba 3, whose colours are linear: write `{r:.4} {g:.4} {b:.4}` for this sRGB one"
            )
        }
        _ => format!("`#{}` is not a colour: expected one number or three", shorten(hex)),
    }
}

/// A grey `<spectrum value="0.7"/>`.
pub(crate) fn spectrum(text: &str) -> Result<f64, String> {
    number(text).map_err(|e| format!("{e} (a <spectrum> is one number, or pairs such as `400:0.1, 500:0.7`)"))
}

/// A unit vector along `v`. One that is unit to single precision stays as it is, so that what is written comes back. `None`: zero.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    if (v.length_squared() - 1.0).abs() < 1e-6 { Some(v) } else { v.try_normalize() }
}

fn shorten(text: &str) -> String {
    if text.chars().count() <= 40 { text.into() } else { text.chars().take(40).chain("..".chars()).collect() }
}

/// The value of an attribute by a parser, or a mistake at its place.
pub(crate) fn parse<T>(a: &Attribute, report: &Report, parser: impl Fn(&str) -> Result<T, String>) -> Option<T> {
    if a.unknown {
        return None;
    }
    parser(&a.value).map_err(|message| report.error(a.value_at, message)).ok()
}

/// `x`, `y`, `z` or `value` (one number for all three, or three). `missing`: what an absent `x` means; `None`: it must be there.
pub(crate) fn vector(e: &Element, missing: Option<f64>, report: &Report) -> Option<DVec3> {
    let axes = ["x", "y", "z"];
    if let Some(value) = e.attribute("value") {
        if let Some(a) = axes.iter().find_map(|n| e.attribute(n)) {
            report.error(a.at, format!("<{}> has `value` already: `{}` cannot be given beside it", e.tag, a.name));
            return None;
        }
        return parse(value, report, |text| match numbers(text)?[..] {
            [x] => Ok(DVec3::splat(x)),
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            ref other => Err(format!("expected one number or three, found {}", other.len())),
        });
    }
    let mut v = DVec3::splat(missing.unwrap_or(0.0));
    for (i, name) in axes.into_iter().enumerate() {
        let attribute = if missing.is_none() { Some(e.required(name, report)?) } else { e.attribute(name) };
        if let Some(a) = attribute {
            v[i] = parse(a, report, number)?;
        }
    }
    Some(v)
}

const OPERATIONS: [&str; 5] = ["translate", "rotate", "scale", "lookat", "matrix"];

/// The product of a `<transform>`'s children; the first is applied first.
pub(crate) fn transform(e: &Element, report: &Report) -> Option<DAffine3> {
    let mut all = Some(DAffine3::IDENTITY);
    for c in &e.children {
        let step = operation(c, report);
        all = all.zip(step).map(|(all, step)| step * all);
    }
    let all = all?;
    let finite = all.matrix3.is_finite() && all.translation.is_finite();
    // Beyond this nothing is left of it in f32.
    if !finite || all.matrix3.to_cols_array().iter().chain(&all.translation.to_array()).any(|x| x.abs() > 1e30) {
        report.error(e.at, "the transform is not finite");
        return None;
    }
    Some(all)
}

fn operation(e: &Element, report: &Report) -> Option<DAffine3> {
    e.expect_no_children(report);
    match e.tag.as_str() {
        "translate" => {
            e.expect_attributes(&["x", "y", "z", "value"], report);
            vector(e, Some(0.0), report).map(DAffine3::from_translation)
        }
        "scale" => {
            e.expect_attributes(&["x", "y", "z", "value"], report);
            vector(e, Some(1.0), report).map(DAffine3::from_scale)
        }
        "rotate" => rotate(e, report),
        "lookat" => look_at(e, report),
        "matrix" => matrix(e, report),
        other => {
            let message = format!("<{other}> cannot stand inside <transform>");
            report.error_help(e.at, message, suggestion(other, OPERATIONS));
            None
        }
    }
}

fn rotate(e: &Element, report: &Report) -> Option<DAffine3> {
    e.expect_attributes(&["x", "y", "z", "value", "angle"], report);
    let angle = e.required("angle", report).and_then(|a| parse(a, report, number));
    let axis = vector(e, Some(0.0), report)?;
    let Some(unit) = axis.try_normalize() else {
        report.error(e.at, "the axis of <rotate> is zero: give `x`, `y` or `z`");
        return None;
    };
    if (axis.length() - 1.0).abs() > 1e-4 {
        report.warn(e.at, "the axis of <rotate> is not of unit length: normalised here, but not by Mitsuba 3");
    }
    Some(DAffine3::from_axis_angle(unit, angle?.to_radians()))
}

fn look_at(e: &Element, report: &Report) -> Option<DAffine3> {
    e.expect_attributes(&["origin", "target", "up"], report);
    let point = |a: &Attribute| {
        parse(a, report, |text| match numbers(text)?[..] {
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            ref other => Err(format!("expected three numbers, found {}", other.len())),
        })
    };
    let origin = e.required("origin", report).and_then(point);
    let target = e.required("target", report).and_then(point);
    let up = e.attribute("up").map(point);
    let (origin, target) = (origin?, target?);
    let up = if let Some(up) = up { up? } else { DVec3::ZERO };
    let Some(dir) = (target - origin).try_normalize() else {
        report.error(e.at, "`origin` and `target` of <lookat> are the same point");
        return None;
    };
    let up = if up == DVec3::ZERO { any_up(dir) } else { up };
    let Some(left) = up.cross(dir).try_normalize().filter(|_| up.normalize().cross(dir).length() > 1e-9) else {
        report.error(e.at, "`up` of <lookat> is parallel to its line of sight");
        return None;
    };
    Some(DAffine3 { matrix3: DMat3::from_cols(left, dir.cross(left), dir), translation: origin })
}

/// What Mitsuba 3 takes for up where none is given (Duff et al. 2017).
fn any_up(d: DVec3) -> DVec3 {
    let sign = 1f64.copysign(d.z);
    let a = -1.0 / (sign + d.z);
    DVec3::new(1.0 + sign * d.x * d.x * a, sign * d.x * d.y * a, -sign * d.x)
}

fn matrix(e: &Element, report: &Report) -> Option<DAffine3> {
    e.expect_attributes(&["value"], report);
    let value = e.required("value", report)?;
    let m = parse(value, report, |text| {
        let m = numbers(text)?;
        if let [.., a, b, c, d] = m[..]
            && m.len() == 16
            && !([a, b, c].iter().all(|x| x.abs() < 1e-6) && (d - 1.0).abs() < 1e-6)
        {
            return Err("the last row of <matrix> must be `0 0 0 1`".into());
        }
        if matches!(m.len(), 9 | 16) { Ok(m) } else { Err(format!("<matrix> takes 9 or 16 numbers, not {}", m.len())) }
    })?;
    let n = if m.len() == 9 { 3 } else { 4 };
    let column = |c: usize| DVec3::new(m[c], m[n + c], m[2 * n + c]);
    let translation = if n == 4 { column(3) } else { DVec3::ZERO };
    Some(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation })
}

/// Does it flatten space (or nearly: relative to the lengths of its axes)?
pub(crate) fn is_singular(m: &DMat3) -> bool {
    let lengths = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    !(m.determinant().abs() > 1e-9 * lengths) || !(lengths > 0.0)
}

/// The mistake of a flattening transform.
pub(crate) fn refuse_singular(m: &DAffine3, at: At, report: &Report) -> Option<DAffine3> {
    if is_singular(&m.matrix3) {
        report.error(at, "the transform is singular: it flattens its object (is a scale 0?)");
        return None;
    }
    Some(*m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::{Defines, Folders, Reading, read};
    use manylight_math::DVec3;
    use std::path::Path;

    fn of(children: &str) -> (Option<DAffine3>, String) {
        let mut report = Report::default();
        let source = report.add_source(Path::new("t"), format!("<transform>{children}</transform>"));
        let (mut defines, mut folders) = (Defines::new(&[]), Folders::new(Path::new("."), Path::new("t")));
        let mut reading = Reading { report: &mut report, defines: &mut defines, folders: &mut folders };
        let element = read(&mut reading, source).expect("well-formed");
        (transform(&element, &report), report.errors().to_string())
    }
    fn rows(m: DAffine3) -> [[f64; 4]; 3] {
        let t = m.matrix3.transpose();
        let row = |r: DVec3, w: f64| [r.x, r.y, r.z, w].map(|x| (x * 1e5).round() / 1e5 + 0.0);
        [row(t.x_axis, m.translation.x), row(t.y_axis, m.translation.y), row(t.z_axis, m.translation.z)]
    }

    #[test]
    fn transforms_are_those_of_mitsuba() {
        // Right-hand sides: mitsuba 3.9.1, scalar_rgb, `mi.traverse(shape)['to_world']`.
        for (xml, want) in [
            (
                r#"<rotate value="0,1,0" angle="40"/>"#,
                [[0.76604, 0., 0.64279, 0.], [0., 1., 0., 0.], [-0.64279, 0., 0.76604, 0.]],
            ),
            (r#"<translate x="1"/><scale x="2"/>"#, [[2., 0., 0., 2.], [0., 1., 0., 0.], [0., 0., 1., 0.]]),
            (r#"<scale value="2"/>"#, [[2., 0., 0., 0.], [0., 2., 0., 0.], [0., 0., 2., 0.]]),
            (r#"<scale value="2,3,4"/>"#, [[2., 0., 0., 0.], [0., 3., 0., 0.], [0., 0., 4., 0.]]),
            (r#"<translate value="2"/>"#, [[1., 0., 0., 2.], [0., 1., 0., 2.], [0., 0., 1., 2.]]),
            (
                r#"<lookat origin="1,2,3" target="4,2,-1"/>"#,
                [[0., 0.8, 0.6, 1.], [1., 0., 0., 2.], [0., 0.6, -0.8, 3.]],
            ),
            (
                r#"<lookat origin="1,2,3" target="4,2,-1" up="0,1,0"/>"#,
                [[-0.8, 0., 0.6, 1.], [0., 1., 0., 2.], [-0.6, 0., -0.8, 3.]],
            ),
            (r#"<matrix value="1 2 3 4 5 6 7 8 10"/>"#, [[1., 2., 3., 0.], [4., 5., 6., 0.], [7., 8., 10., 0.]]),
        ] {
            let (got, errors) = of(xml);
            assert_eq!(got.map(rows), Some(want), "{xml}: {errors}");
        }
    }
    #[test]
    fn a_flattening_matrix_is_singular_and_a_tiny_or_far_one_is_not() {
        let scale = |x, y, z| DMat3::from_diagonal(DVec3::new(x, y, z));
        assert!(is_singular(&scale(1.0, 0.0, 1.0)) && is_singular(&DMat3::from_cols_array(&[1.0; 9])));
        assert!(is_singular(&scale(f64::NAN, 1.0, 1.0)));
        assert!(!is_singular(&scale(1e-8, 1e-8, 1e-8)) && !is_singular(&scale(1e8, 1e-8, 1.0)));
    }
    #[test]
    fn a_hexadecimal_colour_is_refused_with_the_linear_one() {
        let message = rgb("#ff8000").unwrap_err();
        assert!(message.contains("`1.0000 0.2159 0.0000`"), "{message}");
    }
}
