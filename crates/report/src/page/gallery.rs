//! Many figures on one page.

use super::{Picture, escaped, filled, viewer};
use crate::ReportError;

/// A figure: pictures to be compared, drawings, or both, with what is to be said of them.
pub struct Figure<'a> {
    /// Short, without spaces: what links go to.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// What there is to be seen.
    pub caption: String,
    /// What makes it, one command a line.
    pub commands: String,
    /// Of white: at 0 a radiance of 1. \[EV\]
    pub exposure: f32,
    /// Of one size; the first is what differences are taken from.
    pub pictures: Vec<Picture<'a>>,
    /// SVG, and a line below each.
    pub drawings: Vec<(String, String)>,
    /// Headings, and rows of numbers.
    pub table: (Vec<String>, Vec<Vec<String>>),
}

/// A page of figures that needs nothing else: no network, no other file.
pub struct Gallery<'a> {
    /// Its heading.
    pub title: String,
    /// What holds for all.
    pub about: String,
    /// In their order.
    pub figures: Vec<Figure<'a>>,
}

impl Gallery<'_> {
    /// The page.
    pub fn page(&self) -> Result<String, ReportError> {
        let link = |f: &Figure| format!("<li><a href=\"#{}\">{}</a></li>", escaped(&f.name), escaped(&f.title));
        let figures = self.figures.iter().map(Figure::section).collect::<Result<String, _>>()?;
        let fills = [
            ("TITLE", escaped(&self.title)),
            ("STYLE", include_str!("page.css").to_string()),
            ("ABOUT", escaped(&self.about)),
            ("CONTENTS", self.figures.iter().map(link).collect()),
            ("KEYS", include_str!("keys.html").to_string()),
            ("FIGURES", figures),
            ("SCRIPT", include_str!("page.js").to_string()),
        ];
        Ok(filled(include_str!("gallery.html"), &fills))
    }
}

impl Figure<'_> {
    fn section(&self) -> Result<String, ReportError> {
        let name = escaped(&self.name);
        let images = match self.pictures.is_empty() {
            true => String::new(),
            false => viewer(&format!("{name}-"), self.exposure, &self.pictures)?,
        };
        let drawn = |(svg, line): &(String, String)| {
            format!("<figure>{svg}<figcaption class=note>{}</figcaption></figure>\n", escaped(line))
        };
        let drawings: String = self.drawings.iter().map(drawn).collect();
        let row = |cells: &[String], tag: &str| -> String {
            let cells: String = cells.iter().map(|c| format!("<{tag}>{}</{tag}>", escaped(c))).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let (head, rows) = &self.table;
        let table = if rows.is_empty() {
            String::new()
        } else {
            let body: String = rows.iter().map(|r| row(r, "td")).collect();
            format!("<div class=wide><table><thead>{}</thead><tbody>{body}</tbody></table></div>", row(head, "th"))
        };
        Ok(format!(
            "<section id=\"{name}\"><h2>{}</h2>\n<p>{}</p>\n{images}<div class=drawings>{drawings}</div>{table}\n<pre>{}</pre></section>\n",
            escaped(&self.title),
            escaped(&self.caption),
            escaped(&self.commands)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ImageView;
    use manylight_math::Spectrum;

    #[test]
    fn each_figure_has_a_viewer_of_its_own_and_texts_are_escaped() {
        let pixels = [Spectrum::ONE; 6];
        let figure = |name: &str| Figure {
            name: name.into(),
            title: format!("{name} <b>"),
            caption: "a & b".into(),
            commands: "manylight".into(),
            exposure: 1.5,
            pictures: (0..2)
                .map(|_| Picture {
                    name: "one".into(),
                    caption: "</script>".into(),
                    image: ImageView::new(3, 2, &pixels).unwrap(),
                })
                .collect(),
            drawings: vec![("<svg></svg>".into(), "x < y".into())],
            table: (vec!["method".into()], vec![vec!["<i>".into()]]),
        };
        let gallery =
            Gallery { title: "all".into(), about: "..".into(), figures: vec![figure("first"), figure("second")] };
        let page = gallery.page().unwrap();
        for part in ["first-view", "second-view", "first-data", "second-left", "href=\"#second\"", "<svg></svg>"] {
            assert!(page.contains(part), "{part}");
        }
        assert!(page.contains("a &amp; b") && page.contains("x &lt; y") && page.contains("<td>&lt;i&gt;</td>"));
        assert!(!page.contains("{{") && !page.contains("<b>") && page.matches("</script>").count() == 3);
        // The script finds each by its identifiers, which stand once.
        for id in ["view", "left", "right", "mode", "exposure", "ev", "scale", "reset", "status", "captions"] {
            assert_eq!(page.matches(&format!("id=\"first-{id}\"")).count(), 1, "{id}");
        }
    }
    #[test]
    fn pictures_of_other_sizes_are_refused() {
        let pixels = [Spectrum::ONE; 6];
        let picture = |w, h| Picture {
            name: String::new(),
            caption: String::new(),
            image: ImageView::new(w, h, &pixels).unwrap(),
        };
        assert!(viewer("", 0.0, &[picture(3, 2), picture(2, 3)]).is_err());
    }
}
