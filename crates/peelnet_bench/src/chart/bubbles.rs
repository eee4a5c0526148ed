//! Error against time on logarithmic axes, with the Pareto front drawn through it.

use crate::{
    chart::{Area, DRAWN, SIZE, Svg, name, range, width},
    front::{EXACT_MSE, Point},
};
use maud::{Markup, html};
use peelnet_core::files::one_line;
use plotters::prelude::*;

fn radius(p: &Point) -> f64 {
    (0.9 * p.bytes.mean.max(4.0).sqrt()).clamp(3.0, 18.0)
}

/// Shown where the pointer is over a bubble.
fn title(p: &Point) -> String {
    let (error, bytes) = (p.error_text(), p.bytes.text());
    let (method, time) = (&p.method, p.time_text());
    format!("{method}: {error}, {time}, {bytes} bytes a pixel")
}

/// A ratio to [hardware blending](crate::front::BASE), or milliseconds where no point has one.
fn time(p: &Point) -> f64 {
    p.time.unwrap_or(p.time_ms)
}

/// A bubble for each method, as large as its bytes per pixel; they come by time. Those whose time or error is outside of 1e-30 to 1e30 are
/// left out.
pub fn bubble_chart(points: &[Point]) -> Svg {
    let is_shown = |p: &&Point| DRAWN.contains(&time(p)) && DRAWN.contains(&p.error);
    let points: &[Point] = &points.iter().filter(is_shown).cloned().collect::<Vec<_>>();
    let (left, right) = range(points.iter().map(time));
    let (low, high) = range(points.iter().map(|p| p.error));
    let x = match points.iter().any(|p| p.time.is_some()) {
        true => "time, times hardware blending without sorting",
        false => "time, milliseconds",
    };
    let x_range = (left / 1.3..right * 1.8).log_scale();
    let y_range = (low / 3.0..high * 3.0).log_scale();
    Svg::new(|builder| {
        let mut chart = builder.build_cartesian_2d(x_range, y_range)?;
        chart
            .configure_mesh()
            .x_desc(x)
            .y_desc("mean squared error, linear light")
            .x_label_formatter(&|x| {
                let digits = format!("{x:.3}");
                let digits = digits.trim_end_matches('0');
                digits.trim_end_matches('.').to_owned()
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
        // Everything to the left of a bubble on the front is above it, so it is a staircase.
        let mut stairs: Vec<(f64, f64)> = Vec::new();
        for p in points.iter().filter(|p| p.on_front) {
            if let Some(&(_, y)) = stairs.last() {
                stairs.push((time(p), y));
            }
            stairs.push((time(p), p.error));
        }
        let front = RGBColor(213, 94, 0).stroke_width(2);
        chart.draw_series(LineSeries::new(stairs, front))?;
        let placed = points.iter().map(|p| {
            let (x, y) = chart.backend_coord(&(time(p), p.error));
            (p, x, y)
        });
        Ok(overlay(placed.collect()))
    })
}

/// The bubbles and their names.
fn overlay(mut placed: Vec<(&Point, i32, i32)>) -> Markup {
    // The large ones first, so that they hide no small one.
    placed.sort_by(|(a, ..), (b, ..)| b.bytes.mean.total_cmp(&a.bytes.mean));
    // Names on the front first: the others stand where there is room.
    let mut order = placed.clone();
    order.sort_by_key(|(p, ..)| !p.on_front);
    let mut taken = Vec::new();
    let mut named = |(p, x, y)| Some((p, place(p, x, y, &mut taken)?));
    let names: Vec<(&Point, Area)> = order.into_iter().filter_map(&mut named).collect();
    html! {
        @for (p, x, y) in placed {
            @let color = if p.on_front { "#d55e00" } else { "#0072b2" };
            circle class="point" cx=(x) cy=(y) r=(format!("{:.1}", radius(p))) fill=(color) fill-opacity="0.45" stroke=(color) {
                title { (one_line(&title(p))) }
            }
            "\n"
        }
        @for (p, area) in names { (name(&p.method, area, None, p.on_front)) }
    }
}

/// Beside the bubble, or above or below where that is taken by another name; nowhere where all is taken, but on the front.
fn place(point: &Point, x: i32, y: i32, taken: &mut Vec<Area>) -> Option<Area> {
    let (x, y, r) = (f64::from(x), f64::from(y), radius(point));
    let shifts: &[f64] = if point.on_front {
        &[0.0, -13.0, 13.0, -26.0, 26.0, -39.0, 39.0, -52.0, 52.0]
    } else {
        &[0.0]
    };
    let sides = [x + r + 3.0, x - r - 3.0 - width(&point.method)];
    let free = |a: &Area| {
        // Not over the axis, nor beyond the edge.
        a.0[0] > 102.0
            && a.0[2] < f64::from(SIZE.0) - 4.0
            && !taken.iter().any(|other| a.overlaps(other))
    };
    let beside = Area::new(&point.method, sides[0], y);
    let area = shifts
        .iter()
        .flat_map(|&shift| sides.map(|left| Area::new(&point.method, left, y + shift)))
        .find(free)
        .or(point.on_front.then_some(beside))?;
    taken.push(area);
    Some(area)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bubble_has_its_title() {
        let point = |method: &str, time, error, on_front| Point {
            method: method.to_owned(),
            time: Some(time),
            error,
            on_front,
            ..Point::default()
        };
        let svg = bubble_chart(&[
            point("plain", 1.0, 1e-2, true),
            point("a<b\u{1b}", 2.0, 1e-4, true),
            point("best", 4.0, 1e-10, true),
        ]);
        let text = svg.as_str();
        assert_eq!(text.matches("<circle class=\"point\"").count(), 3);
        assert!(
            text.contains("<title>a&lt;b\\u{1b}: MSE 1.00e-4, 2.00 x ") && text.contains("exact")
        );
        // Such characters are no XML.
        assert!(
            !text.contains("a<b")
                && !text.contains('\u{1b}')
                && text.trim_end().ends_with("</svg>")
        );
        // What no axis can show is left out: labels of such axes would have no end.
        let svg = bubble_chart(&[
            point("huge", 1e-300, 1e308, true),
            point("infinite", f64::INFINITY, f64::NAN, false),
            point("wide", 1e-30, 1e30, false),
            point("plain", 1.0, 1e-10, true),
        ]);
        assert_eq!(svg.as_str().matches("<circle class=\"point\"").count(), 2);
        // Nothing to draw is no failure.
        assert!(bubble_chart(&[]).as_str().contains("<svg"));
    }
}
