//! Simple drawings as SVG.

use crate::ReportError;
use crate::plot::COLOURS;
use plotters::prelude::*;

/// Something drawn, in one of the colours (numbers begin again after the last).
#[derive(Clone, Debug)]
pub enum Mark {
    /// A line through points; with a name it is in the key.
    Line {
        /// In their order.
        points: Vec<(f64, f64)>,
        /// In the key, unless it is empty.
        name: String,
        /// Which.
        colour: usize,
    },
    /// A rectangle between two corners.
    Box {
        /// Lower left.
        low: (f64, f64),
        /// Upper right.
        high: (f64, f64),
        /// Which.
        colour: usize,
    },
    /// Discs, each with its radius in pixels; with a name they are in the key.
    Dots {
        /// Where.
        points: Vec<(f64, f64, f64)>,
        /// In the key, unless it is empty.
        name: String,
        /// Which.
        colour: usize,
    },
}

/// A chart with linear axes.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Of the chart. \[pixel\]
    pub size: (u32, u32),
    /// Below the horizontal axis, and beside the vertical one; without either there are no axes.
    pub labels: (String, String),
    /// From, to.
    pub x: (f64, f64),
    /// From, to.
    pub y: (f64, f64),
    /// In their order, later ones above.
    pub marks: Vec<Mark>,
}

impl Drawing {
    /// As SVG.
    pub fn svg(&self) -> Result<String, ReportError> {
        let mut svg = String::new();
        self.draw(&mut svg).map_err(|e| ReportError::Plot(e.to_string()))?;
        Ok(svg)
    }
    fn draw(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::with_string(svg, self.size).into_drawing_area();
        root.fill(&WHITE)?;
        let axes = !(self.labels.0.is_empty() && self.labels.1.is_empty());
        let mut chart = ChartBuilder::on(&root)
            .margin(10)
            .x_label_area_size(if axes { 40 } else { 0 })
            .y_label_area_size(if axes { 60 } else { 0 })
            .build_cartesian_2d(self.x.0..self.x.1, self.y.0..self.y.1)?;
        if axes {
            chart
                .configure_mesh()
                .x_desc(&self.labels.0)
                .y_desc(&self.labels.1)
                .label_style(("sans-serif", 13))
                .max_light_lines(0)
                .bold_line_style(RGBColor(228, 228, 228))
                .draw()?;
        }
        let mut keys = false;
        for mark in &self.marks {
            let colour = |i: usize| {
                let [r, g, b] = COLOURS[i % COLOURS.len()];
                RGBColor(r, g, b)
            };
            match mark {
                Mark::Line { points, name, colour: i } => {
                    let colour = colour(*i);
                    let drawn = chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?;
                    if !name.is_empty() {
                        keys = true;
                        drawn
                            .label(name)
                            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(3)));
                    }
                }
                Mark::Box { low, high, colour: i } => {
                    let colour = colour(*i);
                    chart.draw_series([
                        Rectangle::new([*low, *high], colour.mix(0.12).filled()),
                        Rectangle::new([*low, *high], colour.stroke_width(2)),
                    ])?;
                }
                Mark::Dots { points, name, colour: i } => {
                    let colour = colour(*i);
                    let discs = points.iter().map(|(x, y, r)| Circle::new((*x, *y), *r, colour.mix(0.8).filled()));
                    let drawn = chart.draw_series(discs)?;
                    if !name.is_empty() {
                        keys = true;
                        drawn.label(name).legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
                    }
                }
            }
        }
        if keys {
            chart
                .configure_series_labels()
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200))
                .label_font(("sans-serif", 13))
                .position(SeriesLabelPosition::UpperRight)
                .draw()?;
        }
        root.present()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mark_is_drawn_and_named_ones_are_in_the_key() {
        let drawing = Drawing {
            size: (300, 200),
            labels: ("t [m]".into(), "pdf".into()),
            x: (0.0, 1.0),
            y: (0.0, 2.0),
            marks: vec![
                Mark::Line { points: vec![(0.0, 0.0), (1.0, 2.0)], name: "rising".into(), colour: 0 },
                Mark::Box { low: (0.2, 0.2), high: (0.4, 0.6), colour: 1 },
                Mark::Dots { points: vec![(0.5, 0.5, 3.0), (0.6, 0.5, 3.0)], name: "lights".into(), colour: 9 },
            ],
        };
        let svg = drawing.svg().unwrap();
        for part in ["<svg", "rising", "lights", "t [m]", "pdf", "</svg>"] {
            assert!(svg.contains(part), "{part}");
        }
        // Two lights and one in the key.
        assert_eq!(svg.matches("<circle").count(), 3);
        let bare = Drawing { labels: Default::default(), marks: vec![], ..drawing };
        assert!(!bare.svg().unwrap().contains("<text"));
    }
}
