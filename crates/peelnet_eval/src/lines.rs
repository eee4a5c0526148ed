//! Line charts on logarithmic axes, a line for each name, the name at its end.

use plotters::prelude::*;

/// A name and its points.
pub(crate) type Line = (String, Vec<(f64, f64)>);

/// The chart as SVG text. Values that are not positive have no place on it and are left out.
pub(crate) fn chart(lines: &[Line], x: &str, y: &str) -> String {
    draw(lines, x, y).unwrap_or_else(|e| unreachable!("drawing into a string cannot fail: {e}"))
}

fn draw(lines: &[Line], x: &str, y: &str) -> Result<String, Box<dyn std::error::Error>> {
    let shown = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
        let positive = points.iter().filter(|p| p.0 > 0.0 && p.1 > 0.0);
        positive.copied().collect()
    };
    let all: Vec<(f64, f64)> = lines.iter().flat_map(|(_, points)| shown(points)).collect();
    let range = |value: &dyn Fn(&(f64, f64)) -> f64| {
        let low = all.iter().map(value).fold(f64::INFINITY, f64::min);
        let high = all.iter().map(value).fold(0.0, f64::max);
        if high > 0.0 {
            (low, high.max(2.0 * low))
        } else {
            (1.0, 10.0)
        }
    };
    let (left, right) = range(&|p| p.0);
    let (low, high) = range(&|p| p.1);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, (960, 600)).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(16)
            .x_label_area_size(48)
            .y_label_area_size(84)
            .build_cartesian_2d(
                // Room for the names.
                (left..right * (right / left).powf(0.3)).log_scale(),
                (low / 1.5..high * 1.5).log_scale(),
            )?;
        chart
            .configure_mesh()
            .x_desc(x)
            .y_desc(y)
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (k, (name, points)) in lines.iter().enumerate() {
            let color = Palette99::pick(k).to_rgba();
            let points = shown(points);
            let last = points.last().copied();
            chart.draw_series(LineSeries::new(points, color.stroke_width(2)).point_size(2))?;
            let style = ("sans-serif", 11).into_font().color(&color);
            let label = last.map(|(x, y)| Text::new(name.clone(), (x * 1.02, y), style));
            chart.draw_series(label)?;
        }
        area.present()?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_in_the_chart_and_zeros_do_not() {
        let svg = chart(
            &[
                (
                    "one".to_owned(),
                    vec![(1.0, 2.0), (10.0, 0.0), (100.0, 4.0)],
                ),
                ("two".to_owned(), vec![(1.0, 1.0)]),
                ("nowhere".to_owned(), vec![]),
            ],
            "x",
            "y",
        );
        assert!(svg.contains("one") && svg.contains("two") && !svg.contains("nowhere"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert!(chart(&[], "x", "y").contains("<svg"));
    }
}
