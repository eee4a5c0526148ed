//! Line charts: a line for each name, the name at its end.

use crate::{Area, Builder, DrawError, NAME_HEIGHT, Svg, name};
use maud::{Markup, html};
use plotters::{
    coord::{
        combinators::LogCoord,
        ranged1d::{Ranged, ValueFormatter},
    },
    prelude::*,
};

/// A name and its points.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Stands at the end of the line.
    pub name: String,
    /// In the order in which they are joined.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// A line through points.
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points: points.into_iter().collect(),
        }
    }
}

/// How an axis grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By factors.
    Logarithmic,
}

/// Lines over a logarithmic y axis. Values that are not positive are left out where an axis is logarithmic.
#[derive(Clone, Copy, Debug)]
pub struct LineChart<'a> {
    /// The lines.
    pub lines: &'a [Line],
    /// Title of the x axis.
    pub x: &'a str,
    /// Title of the y axis.
    pub y: &'a str,
    /// The x axis.
    pub x_scale: Scale,
}

impl LineChart<'_> {
    /// Draws it.
    pub fn svg(&self) -> Svg {
        Svg::new(|builder| self.draw(builder))
    }

    /// The points of a line that the axes can show.
    fn shown<'l>(&self, line: &'l Line) -> impl Iterator<Item = (f64, f64)> + use<'l> {
        let linear = self.x_scale == Scale::Linear;
        let points = line.points.iter().copied();
        points.filter(move |&(x, y)| y > 0.0 && y.is_finite() && (linear || x > 0.0))
    }

    /// The smallest and largest value of all lines.
    fn range(&self, value: fn((f64, f64)) -> f64) -> Option<(f64, f64)> {
        let values = || self.lines.iter().flat_map(|l| self.shown(l)).map(value);
        let low = values().reduce(f64::min)?;
        Some((low, values().reduce(f64::max)?))
    }

    fn draw(&self, builder: &mut Builder<'_, '_>) -> Result<Markup, DrawError> {
        let (left, right) = self.range(|p| p.0).unwrap_or((1.0, 10.0));
        let (low, high) = self.range(|p| p.1).unwrap_or((1.0, 10.0));
        let y = (low / 1.5..high.max(2.0 * low) * 1.5).log_scale();
        // Both leave room for the names.
        match self.x_scale {
            Scale::Linear => {
                let right = if right > left { right } else { left + 1.0 };
                let x = left..right + 0.2 * (right - left);
                self.series(builder.build_cartesian_2d(x, y)?)
            }
            Scale::Logarithmic => {
                let right = right.max(2.0 * left);
                let x = (left..right * (right / left).powf(0.3)).log_scale();
                self.series(builder.build_cartesian_2d(x, y)?)
            }
        }
    }

    /// Draws axes and lines; returns the names.
    fn series<X>(
        &self,
        mut chart: ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, LogCoord<f64>>>,
    ) -> Result<Markup, DrawError>
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .label_style(("sans-serif", 14))
            .light_line_style(TRANSPARENT)
            .draw()?;
        let mut ends = Vec::new();
        for (k, line) in self.lines.iter().enumerate() {
            let color = color(k);
            let points: Vec<(f64, f64)> = self.shown(line).collect();
            if let Some(last) = points.last() {
                let (x, y) = chart.backend_coord(last);
                let RGBColor(r, g, b) = color;
                ends.push((&line.name, x, y, format!("#{r:02x}{g:02x}{b:02x}")));
            }
            chart.draw_series(LineSeries::new(points, color.stroke_width(2)).point_size(2))?;
        }
        // From above: each name moves down until it covers no other.
        ends.sort_by_key(|(_, _, y, _)| *y);
        let mut taken: Vec<Area> = Vec::new();
        Ok(html! {
            @for (text, x, y, color) in ends {
                @let area = free(text, x, y, &mut taken);
                (name(text, area, Some(&color), false))
            }
        })
    }
}

/// The colour of a line, dark enough for text on white paper.
fn color(line: usize) -> RGBColor {
    let (r, g, b) = Palette99::pick(line).rgb();
    let darker = |c: u8| (f32::from(c) * 0.75) as u8;
    RGBColor(darker(r), darker(g), darker(b))
}

/// The nearest place for a name at or below the end of its line.
fn free(name: &str, x: i32, y: i32, taken: &mut Vec<Area>) -> Area {
    let mut area = Area::of(name, f64::from(x) + 6.0, f64::from(y));
    while let Some(other) = taken.iter().find(|other| area.overlaps(other)) {
        area = Area::of(name, area.0[0], other.0[3] + NAME_HEIGHT / 2.0);
    }
    taken.push(area);
    area
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(lines: &[Line], x_scale: Scale) -> Svg {
        LineChart {
            lines,
            x: "x",
            y: "y",
            x_scale,
        }
        .svg()
    }

    #[test]
    fn names_stand_in_the_chart_and_zeros_do_not() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            let svg = chart(
                &[
                    Line::new("one", [(1.0, 2.0), (10.0, 0.0), (100.0, 4.0)]),
                    Line::new("<two>", [(1.0, 1.0)]),
                    Line::new("nowhere", []),
                ],
                scale,
            );
            let text = svg.as_str();
            assert!(text.contains("one") && !text.contains("nowhere"));
            assert!(text.contains("&lt;two&gt;") && !text.contains("<two>"));
            assert!(!text.contains("NaN") && !text.contains("inf"));
            assert!(text.trim_end().ends_with("</svg>"));
            assert!(svg.on_white().contains("#ffffff"));
            assert!(chart(&[], scale).as_str().contains("<svg"));
        }
    }

    /// Lines that end at one point have their names one below the other.
    #[test]
    fn names_do_not_cover_each_other() {
        let mut taken = Vec::new();
        let areas = ["a", "bb", "ccc"].map(|name| free(name, 100, 50, &mut taken));
        for (k, a) in areas.iter().enumerate() {
            assert!(areas[..k].iter().all(|b| !a.overlaps(b)), "{areas:?}");
        }
    }
}
