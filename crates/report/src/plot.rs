//! Plots of a study as SVG.

use crate::{Estimate, ReportError, Study, Summary};
use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::*;

/// What stands on the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Relative mean squared error without the reference's variance.
    RelMse,
    /// LDR-FLIP.
    Flip,
    /// 99.9th percentile of the pixels' relative errors.
    Percentile,
}

impl Axis {
    fn label(self) -> &'static str {
        match self {
            Axis::RelMse => "relMSE",
            Axis::Flip => "FLIP",
            Axis::Percentile => "99.9th percentile of relative error",
        }
    }
    fn value(self, s: &Summary) -> Option<Estimate> {
        match self {
            Axis::RelMse => Some(s.relmse_net),
            Axis::Flip => s.flip,
            Axis::Percentile => Some(s.percentile_999),
        }
    }
}

/// Colours that stay apart for the colour-blind (Okabe and Ito 2008), the first seven; then they come again.
pub(crate) const COLOURS: [[u8; 3]; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [90, 90, 90]];

/// A point with its band. [s, error, error, error]
type At = (f64, f64, f64, f64);

impl Study {
    /// Error against time, both on logarithmic axes, with a band of 95 % for each method; `None` where nothing is positive.
    pub fn plot(&self, axis: Axis) -> Result<Option<String>, ReportError> {
        let summary = self.summary();
        let points = |method: &str| -> Vec<At> {
            let of = summary.iter().filter(|s| s.method == method);
            let mut all: Vec<At> = of
                .filter_map(|s| {
                    let e = axis.value(s)?;
                    let fine = s.seconds > 0.0 && e.mean > 0.0;
                    let (low, high) = (e.low.filter(|l| *l > 0.0).unwrap_or(e.mean), e.high.unwrap_or(e.mean));
                    fine.then_some((s.seconds, e.mean, low, high))
                })
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all
        };
        let lines: Vec<(&str, Vec<At>)> =
            self.subjects.iter().map(|s| (s.method.as_str(), points(&s.method))).filter(|l| !l.1.is_empty()).collect();
        let range = |f: fn(&At) -> (f64, f64)| {
            let all = lines.iter().flat_map(|l| &l.1).map(f);
            all.fold((f64::INFINITY, 0.0f64), |r, p| (r.0.min(p.0), r.1.max(p.1)))
        };
        let ((left, right), (bottom, top)) = (range(|p| (p.0, p.0)), range(|p| (p.2, p.3)));
        if !(left.is_finite() && bottom > 0.0) {
            return Ok(None);
        }
        let mut svg = String::new();
        draw(&mut svg, &lines, (left / 1.2, right * 1.2), (bottom / 1.3, top * 1.3), axis)
            .map_err(|e| ReportError::Plot(e.to_string()))?;
        Ok(Some(svg))
    }
}

fn draw(
    svg: &mut String,
    lines: &[(&str, Vec<At>)],
    (left, right): (f64, f64),
    (bottom, top): (f64, f64),
    axis: Axis,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (820, 480)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(76)
        .build_cartesian_2d((left..right).log_scale(), (bottom..top).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("time [s]")
        .y_desc(axis.label())
        .x_label_formatter(&|x| plain(*x))
        .y_label_formatter(&|y| plain(*y))
        .label_style(("sans-serif", 13))
        .max_light_lines(0)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_labels(12)
        .draw()?;
    for (i, (name, points)) in lines.iter().enumerate() {
        let [r, g, b] = COLOURS[i % COLOURS.len()];
        let colour = RGBColor(r, g, b);
        let band: Vec<(f64, f64)> =
            points.iter().map(|p| (p.0, p.3)).chain(points.iter().rev().map(|p| (p.0, p.2))).collect();
        if points.len() > 1 {
            chart.draw_series([Polygon::new(band, colour.mix(0.15))])?;
        } else {
            // A single point has no band but a bar.
            chart.draw_series(points.iter().map(|p| PathElement::new(vec![(p.0, p.2), (p.0, p.3)], colour)))?;
        }
        let line = LineSeries::new(points.iter().map(|p| (p.0, p.1)), colour.stroke_width(2)).point_size(3);
        let key = move |(x, y): (i32, i32)| PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(3));
        chart.draw_series(line)?.label(*name).legend(key);
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 13))
        .position(SeriesLabelPosition::UpperRight)
        .draw()?;
    root.present()?;
    Ok(())
}

/// 0.01, 2, 3e-7.
fn plain(x: f64) -> String {
    if (1e-3..1e4).contains(&x) { format!("{}", (x * 1e6).round() / 1e6) } else { format!("{x:.0e}") }
}
