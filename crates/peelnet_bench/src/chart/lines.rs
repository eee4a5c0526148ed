//! Line charts: a line for each name, the name at its end.

use crate::chart::{Area, DRAWN, Drawn, NAME_HEIGHT, Svg, name, range};
use maud::html;
use plotters::{
    coord::{
        combinators::LogCoord,
        ranged1d::{Ranged, ValueFormatter},
    },
    prelude::*,
};

pub struct Line {
    /// Stands at the end of the line.
    pub name: String,
    /// In the order in which they are joined.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points: points.into_iter().collect(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    Linear,
    Logarithmic,
}

/// Lines over a logarithmic y axis, with the titles of both axes. Values outside of 1e-30 to 1e30 are left out where an axis is logarithmic.
pub fn line_chart(lines: &[Line], x: &str, y: &str, x_scale: Scale) -> Svg {
    let is_shown = |&(x, y): &(f64, f64)| {
        let has_x = match x_scale {
            Scale::Linear => x.abs() <= *DRAWN.end(),
            Scale::Logarithmic => DRAWN.contains(&x),
        };
        has_x && DRAWN.contains(&y)
    };
    let shown = lines.iter().map(|line| {
        let points = line.points.iter().copied().filter(is_shown);
        Line::new(&line.name, points)
    });
    let lines: Vec<Line> = shown.collect();
    let points = lines.iter().flat_map(|line| &line.points);
    let (left, right) = range(points.clone().map(|p| p.0));
    let (low, high) = range(points.map(|p| p.1));
    let y_range = (low / 1.5..high.max(2.0 * low) * 1.5).log_scale();
    // Both leave room for the names.
    Svg::new(|builder| match x_scale {
        Scale::Linear => {
            let right = if right > left { right } else { left + 1.0 };
            let x_range = left..right + 0.2 * (right - left);
            draw(&lines, builder.build_cartesian_2d(x_range, y_range)?, x, y)
        }
        Scale::Logarithmic => {
            let right = right.max(2.0 * left);
            let x_range = (left..right * (right / left).powf(0.3)).log_scale();
            draw(&lines, builder.build_cartesian_2d(x_range, y_range)?, x, y)
        }
    })
}

/// Draws axes and lines; returns the names.
fn draw<X>(
    lines: &[Line],
    mut chart: ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, LogCoord<f64>>>,
    x: &str,
    y: &str,
) -> Drawn
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .x_desc(x)
        .y_desc(y)
        .label_style(("sans-serif", 14))
        .light_line_style(TRANSPARENT)
        .draw()?;
    let mut ends = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        // Dark enough for text on white paper.
        let (r, g, b) = Palette99::pick(k).rgb();
        let [r, g, b] = [r, g, b].map(|c| (f32::from(c) * 0.75) as u8);
        if let Some(last) = line.points.last() {
            let (x, y) = chart.backend_coord(last);
            ends.push((&line.name, x, y, format!("#{r:02x}{g:02x}{b:02x}")));
        }
        let stroke = RGBColor(r, g, b).stroke_width(2);
        let points = line.points.iter().copied();
        chart.draw_series(LineSeries::new(points, stroke).point_size(2))?;
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

/// The nearest place for a name at or below the end of its line.
fn free(name: &str, x: i32, y: i32, taken: &mut Vec<Area>) -> Area {
    let mut area = Area::new(name, f64::from(x) + 6.0, f64::from(y));
    while let Some(other) = taken.iter().find(|other| area.overlaps(other)) {
        area = Area::new(name, area.0[0], other.0[3] + NAME_HEIGHT / 2.0);
    }
    taken.push(area);
    area
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_in_the_chart_and_zeros_do_not() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            let lines = [
                Line::new("one", [(1.0, 2.0), (10.0, 0.0), (100.0, 4.0)]),
                Line::new("<two>", [(1.0, 1.0)]),
                Line::new("nowhere", []),
            ];
            let svg = line_chart(&lines, "x", "y", scale);
            let text = svg.as_str();
            assert!(text.contains("one") && !text.contains("nowhere"));
            assert!(text.contains("&lt;two&gt;") && !text.contains("<two>"));
            assert!(!text.contains("NaN") && !text.contains("inf"));
            assert!(text.trim_end().ends_with("</svg>"));
            assert!(svg.on_white().contains("#ffffff"));
            let none = line_chart(&[], "x", "y", scale);
            assert!(none.as_str().contains("<svg"));
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
