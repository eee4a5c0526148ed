//! The chart: error against time on logarithmic axes, the Pareto front drawn through it, a bubble for every method as
//! large as its bytes a pixel.

use crate::front::{BASE, EXACT_MSE, Point};
use plotters::prelude::*;
use std::fmt::Write as _;

/// Width and height, pixels.
const SIZE: (u32, u32) = (960, 600);

/// Radius of a bubble; its area grows with the bytes.
fn radius(bytes: f64) -> f64 {
    (0.9 * bytes.max(4.0).sqrt()).clamp(3.0, 18.0)
}

/// The chart as SVG text; a bubble's title names the method and its figures.
pub(super) fn chart(points: &[Point]) -> String {
    draw(points).unwrap_or_else(|e| unreachable!("drawing into a string cannot fail: {e}"))
}

fn draw(points: &[Point]) -> Result<String, Box<dyn std::error::Error>> {
    let range = |value: &dyn Fn(&Point) -> f64, least: f64| {
        let low = points.iter().map(value).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(value).fold(least, f64::max);
        if low.is_finite() {
            (low, high)
        } else {
            (1.0, 10.0)
        }
    };
    let (fast, slow) = range(&|p| p.time, 0.0);
    let (low, high) = range(&|p| p.error, EXACT_MSE);
    let mut text = String::new();
    let mut overlay = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&area)
            .margin(16)
            .x_label_area_size(48)
            .y_label_area_size(84)
            .build_cartesian_2d(
                (fast / 1.3..slow * 1.8).log_scale(),
                (low / 3.0..high * 3.0).log_scale(),
            )?;
        let based = points.iter().any(|p| p.method == BASE);
        chart
            .configure_mesh()
            .x_desc(if based {
                "time, times hardware blending without sorting"
            } else {
                "time, milliseconds"
            })
            .y_desc("mean squared error, linear light")
            .x_label_formatter(&|x| {
                format!("{x:.3}")
                    .trim_end_matches('0')
                    .trim_end_matches('.')
                    .to_owned()
            })
            .y_label_formatter(&|y| {
                if *y <= EXACT_MSE * 1.01 {
                    "exact".to_owned()
                } else {
                    format!("{y:.0e}")
                }
            })
            .label_style(("sans-serif", 14))
            .light_line_style(TRANSPARENT)
            .draw()?;
        // Every faster method errs more: the front is a staircase.
        let mut stairs: Vec<(f64, f64)> = Vec::new();
        for p in points.iter().filter(|p| p.on_front) {
            if let Some(&(_, error)) = stairs.last() {
                stairs.push((p.time, error));
            }
            stairs.push((p.time, p.error));
        }
        chart.draw_series(LineSeries::new(
            stairs,
            RGBColor(213, 94, 0).stroke_width(2),
        ))?;
        // The large ones first, so that they hide no small one.
        let mut order: Vec<&Point> = points.iter().collect();
        order.sort_by(|a, b| b.bytes.total_cmp(&a.bytes));
        let mut placed = Vec::new();
        for p in order {
            let (x, y) = chart.backend_coord(&(p.time, p.error));
            bubble(&mut overlay, p, x, y);
            placed.push((p, x, y));
        }
        // Names of the front first: the others stand where there is room.
        placed.sort_by_key(|(p, ..)| !p.on_front);
        let mut names = Vec::new();
        for (p, x, y) in placed {
            name(&mut overlay, p, x, y, &mut names);
        }
        area.present()?;
    }
    let end = text.rfind("</svg>").unwrap_or(text.len());
    text.insert_str(end, &overlay);
    Ok(text)
}

/// A circle with a title.
fn bubble(svg: &mut String, p: &Point, x: i32, y: i32) {
    let name = super::page::escape(&p.method);
    let color = if p.on_front { "#d55e00" } else { "#0072b2" };
    let error = if p.is_exact() {
        "exact".to_owned()
    } else {
        format!("MSE {:.2e}", p.error)
    };
    let _ = writeln!(
        svg,
        "<circle class=\"point\" cx=\"{x}\" cy=\"{y}\" r=\"{:.1}\" fill=\"{color}\" fill-opacity=\"0.45\" stroke=\"{color}\">\
         <title>{name}: {error}, {:.2} x hardware blending, {:.0} bytes a pixel</title></circle>",
        radius(p.bytes),
        p.time,
        p.bytes
    );
}

/// Left, top, right, bottom.
type Area = [f64; 4];

/// A name beside its bubble, or above or below where that is taken by another; none where all is taken, but on the front.
fn name(svg: &mut String, p: &Point, x: i32, y: i32, taken: &mut Vec<Area>) {
    const HEIGHT: f64 = 12.0;
    let (x, y, r) = (f64::from(x), f64::from(y), radius(p.bytes));
    // Sans-serif letters are about 0.56 as wide as high.
    let width = p.method.chars().count() as f64 * 11.0 * 0.56;
    let area = |left: f64, shift: f64| {
        [
            left,
            y + shift - HEIGHT / 2.0,
            left + width,
            y + shift + HEIGHT / 2.0,
        ]
    };
    let shifts: &[f64] = if p.on_front {
        &[0.0, -13.0, 13.0, -26.0, 26.0, -39.0, 39.0, -52.0, 52.0]
    } else {
        &[0.0]
    };
    let sides = [x + r + 3.0, x - r - 3.0 - width];
    let free = |a: &Area| {
        let apart = |b: &Area| a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1];
        // Not over the axis, nor beyond the edge.
        a[0] > 102.0 && a[2] < f64::from(SIZE.0) - 4.0 && taken.iter().all(apart)
    };
    let place = shifts
        .iter()
        .flat_map(|&shift| sides.map(|left| area(left, shift)))
        .find(free);
    let Some(place) = place.or_else(|| p.on_front.then(|| area(sides[0], 0.0))) else {
        return;
    };
    let _ = writeln!(
        svg,
        "<text class=\"name\" x=\"{:.0}\" y=\"{:.0}\" font-family=\"sans-serif\" font-size=\"11\"{}>{}</text>",
        place[0],
        place[3] - 2.0,
        if p.on_front {
            " font-weight=\"bold\""
        } else {
            ""
        },
        super::page::escape(&p.method),
    );
    taken.push(place);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_a_bubble_with_its_figures() {
        let point = |method: &str, error, time, on_front| Point {
            method: method.to_owned(),
            error,
            time,
            time_ms: time,
            bytes: 24.0,
            on_front,
        };
        let svg = chart(&[
            point(BASE, 1e-2, 1.0, true),
            point("a<b", 1e-4, 2.0, true),
            point("exact", EXACT_MSE, 4.0, true),
        ]);
        assert_eq!(svg.matches("<circle class=\"point\"").count(), 3);
        assert!(
            svg.contains("a&lt;b: MSE 1.00e-4, 2.00 x") && svg.contains("exact: exact, 4.00 x")
        );
        assert!(svg.trim_end().ends_with("</svg>"));
        // Nothing to draw is no failure.
        assert!(chart(&[]).contains("<svg"));
    }
}
