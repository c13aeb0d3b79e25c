//! A study as one HTML page that needs nothing else: no network, no other file.

mod gallery;
mod pixels;

pub use gallery::{Figure, Gallery};

use crate::plot::{Axis, COLOURS};
use crate::{COLUMNS, Estimate, ImageView, ReportError, Study};
use serde::Serialize;

/// An image on the page.
pub struct Picture<'a> {
    /// What it is called: a method at a budget, or the reference.
    pub name: String,
    /// A sentence of numbers below it.
    pub caption: String,
    /// Its pixels.
    pub image: ImageView<'a>,
}

/// A picture as the page's script reads it.
#[derive(Serialize)]
struct Embedded {
    name: String,
    caption: String,
    width: usize,
    height: usize,
    /// RGB halves, little endian, base64.
    data: String,
}

impl Study {
    /// The page. The first picture is the reference, which differences are taken from; all have its size.
    pub fn page(&self, pictures: &[Picture]) -> Result<String, ReportError> {
        let plots = [Axis::RelMse, Axis::Flip, Axis::Percentile];
        let plots: Result<Vec<_>, _> = plots.into_iter().map(|axis| self.plot(axis)).collect();
        let plots: String = plots?.into_iter().flatten().map(|svg| format!("<figure>{svg}</figure>\n")).collect();
        let fills = [
            ("TITLE", escaped(&format!("{}: error against time", self.scene))),
            ("STYLE", include_str!("page.css").to_string()),
            ("ANSWER", self.answer()),
            ("ABOUT", self.about()),
            ("TABLE", self.table()),
            ("PLOTS", plots),
            ("METHODS", self.methods()),
            ("COLUMNS", columns()),
            ("VIEWER", viewer("", self.exposure, pictures)?),
            ("KEYS", include_str!("keys.html").to_string()),
            ("SCRIPT", include_str!("page.js").to_string()),
        ];
        Ok(filled(include_str!("page.html"), &fills))
    }
    /// Which method is best at each budget, and whether that is more than chance.
    fn answer(&self) -> String {
        let verdicts = self.verdict();
        let runs = self.summary().iter().map(|s| s.runs).max().unwrap_or(0);
        let item = |v: &crate::Verdict| {
            let duels: Vec<String> = v
                .duels
                .iter()
                .map(|d| {
                    let p = d.adjusted_p.map_or("one run: no test".into(), |p| format!("p = {}", number(p)));
                    let word = if d.significant { "significant" } else { "not significant" };
                    let of = escaped(&d.method);
                    format!("<code>{of}</code> has {} times its error ({word}, {p})", interval(&d.ratio))
                })
                .collect();
            let best = escaped(&v.best);
            let mut rest = duels;
            rest.extend(v.untold.iter().map(|m| format!("nothing can be said of <code>{}</code>", escaped(m))));
            rest.extend(v.late.iter().map(|m| format!("<code>{}</code> took longer and is not ranked", escaped(m))));
            let rest: String = rest.iter().map(|r| format!("; {r}")).collect();
            format!("<li>In {}: <strong><code>{best}</code></strong> has the least error{rest}.</li>", v.budget)
        };
        let list: String = verdicts.iter().map(item).collect();
        format!(
            "<ul>{list}</ul><p class=note>By relMSE without the reference's variance, over {runs} runs; t tests on its logarithm, \
             paired by run, Holm over the methods, significant below 0.05.</p>"
        )
    }
    fn about(&self) -> String {
        let noise = match self.reference_noise {
            Some(n) => format!("its own noise is a relMSE of {}, which is subtracted", number(n)),
            None => "its own noise is not known and not subtracted".into(),
        };
        let machine = match self.threads {
            1 => "1 thread".into(),
            n => format!("{n} threads"),
        };
        format!(
            "<p>Scene <code>{}</code> (hash {}), reference <code>{}</code>: {noise}. FLIP at exposure {:+.2}. {machine}; methods took \
             turns pass by pass. Intervals are 95 % over runs.</p>",
            escaped(&self.scene),
            self.scene_hash,
            escaped(&self.reference),
            self.exposure
        )
    }
    fn table(&self) -> String {
        let head = [
            "method",
            "budget",
            "passes",
            "time [s]",
            "preparing",
            "rays",
            "relMSE",
            "net",
            "bias",
            "noise",
            "RMSE",
            "MAPE",
            "FLIP",
            "99.9 %",
            "slope",
            "1 / (relMSE s)",
            "speed-up",
            "not finite",
        ];
        let head: String = head.iter().map(|h| format!("<th tabindex=0>{h}</th>")).collect();
        let none = || "<td data-value=''></td>".to_string();
        let cell = |value: f64, text: String| format!("<td data-value='{value}'>{text}</td>");
        let estimate = |e: &Estimate| cell(e.mean, interval(e));
        let body: String = self
            .summary()
            .iter()
            .map(|s| {
                let colour = self.subjects.iter().position(|o| o.method == s.method).unwrap_or(0);
                let [r, g, b] = COLOURS[colour % COLOURS.len()];
                let optional = |e: &Option<Estimate>| e.as_ref().map_or_else(none, estimate);
                let plain = |x: Option<f64>| x.map_or_else(none, |x| cell(x, number(x)));
                let cells = [
                    format!(
                        "<td><span class=key style='background:rgb({r},{g},{b})'></span><code>{}</code></td>",
                        escaped(&s.method)
                    ),
                    cell(s.budget.value(), if s.passes.is_some() { s.budget.to_string() } else { "image".into() }),
                    plain(s.passes),
                    cell(s.seconds, number(s.seconds)),
                    s.preparing.map_or_else(none, |p| cell(p, format!("{:.0} %", 100.0 * p))),
                    plain(s.rays),
                    estimate(&s.relmse),
                    estimate(&s.relmse_net),
                    optional(&s.bias),
                    optional(&s.noise),
                    estimate(&s.rmse),
                    estimate(&s.mape),
                    optional(&s.flip),
                    estimate(&s.percentile_999),
                    optional(&s.slope),
                    plain(s.efficiency),
                    if s.method == self.baseline { cell(1.0, "baseline".into()) } else { optional(&s.speedup) },
                    cell(s.non_finite as f64, s.non_finite.to_string()),
                ];
                format!("<tr>{}</tr>\n", cells.concat())
            })
            .collect();
        format!("<table id=table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")
    }
    /// What each promises, and whether a bias was seen.
    fn methods(&self) -> String {
        let summary = self.summary();
        let item = |s: &crate::Subject| {
            let last = summary.iter().rfind(|o| o.method == s.method);
            // All runs share the reference: what its noise adds to all of them is in no interval over runs.
            let seen =
                match last.and_then(|l| l.bias.map(|b| (b.widened(1.96 * self.reference_spread.unwrap_or(0.0)), l))) {
                    Some(_) if self.reference_noise.is_none() => {
                        "Whether it is biased cannot be told: the reference's own noise is not known.".into()
                    }
                    Some((Estimate { mean, low: Some(low), .. }, l)) if low > 0.0 => {
                        format!(
                            "A bias was seen: {:.1} % (root of its mean square) after {}.",
                            100.0 * mean.sqrt(),
                            l.budget
                        )
                    }
                    Some((Estimate { high: Some(high), .. }, l)) if high > 0.0 => {
                        format!("No bias was seen; it may be {:.1} % after {}.", 100.0 * high.sqrt(), l.budget)
                    }
                    Some((_, l)) if l.runs > 1 => "No bias was seen.".into(),
                    _ => "Whether it is biased takes two runs of two passes to tell.".into(),
                };
            let parameters: Vec<String> = s.parameters.iter().map(|(k, v)| format!("{k}={v}")).collect();
            format!(
                "<dt><code>{}</code></dt><dd>{}. {seen}<br><small>{}</small></dd>",
                escaped(&s.method),
                escaped(&s.claim),
                escaped(&parameters.join(" "))
            )
        };
        self.subjects.iter().map(item).collect()
    }
}

/// Pictures with a slider; `prefix` tells several on a page apart.
fn viewer(prefix: &str, exposure: f32, pictures: &[Picture]) -> Result<String, ReportError> {
    if let Some((first, rest)) = pictures.split_first() {
        rest.iter().try_for_each(|p| p.image.check_size(&first.image))?;
    }
    let shrink = pictures.first().map_or(1, |p| pixels::shrink(p.image.width(), p.image.height()));
    let embedded: Vec<Embedded> = pictures.iter().map(|p| pixels::embed(p, shrink)).collect();
    let data = serde_json::json!({ "exposure": exposure, "shrink": shrink, "pictures": embedded });
    // `</script>` in a name would end the script.
    let data = serde_json::to_string(&data)?.replace('<', "\\u003c");
    Ok(filled(include_str!("viewer.html"), &[("PREFIX", prefix.to_string()), ("DATA", data)]))
}

fn columns() -> String {
    COLUMNS.iter().map(|c| format!("<dt><code>{}</code></dt><dd>{}</dd>", c.name, escaped(c.about))).collect()
}

/// Puts texts in the places `{{NAME}}` of a template; what is put in is not looked at again.
fn filled(template: &str, fills: &[(&str, String)]) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some(begin) = rest.find("{{") {
        let end = begin + rest[begin..].find("}}").unwrap_or(rest.len() - begin);
        let name = &rest[begin + 2..end];
        out.push_str(&rest[..begin]);
        out.push_str(fills.iter().find(|f| f.0 == name).map_or("", |f| &f.1));
        rest = rest.get(end + 2..).unwrap_or("");
    }
    out + rest
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

/// Three digits.
fn number(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        "0".into()
    } else if !(1e-3..1e5).contains(&size) {
        format!("{x:.2e}")
    } else {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{x:.decimals$}")
    }
}

fn interval(e: &Estimate) -> String {
    match (e.low, e.high) {
        (Some(low), Some(high)) => {
            format!("{} <span class=interval>[{}, {}]</span>", number(e.mean), number(low), number(high))
        }
        _ => number(e.mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_are_filled_once() {
        assert_eq!(filled("a {{X}} b {{Y}} c", &[("X", "{{Y}}".into()), ("Y", "2".into())]), "a {{Y}} b 2 c");
        assert_eq!(filled("open {{X", &[]), "open ");
    }
    #[test]
    fn numbers_have_three_digits() {
        let shown = [0.0, 1.0, 0.01234, 123.4, 98765.0, 1.5e7, 3e-9, -0.25].map(number);
        assert_eq!(shown, ["0", "1.00", "0.0123", "123", "98765", "1.50e7", "3.00e-9", "-0.250"]);
    }
}
