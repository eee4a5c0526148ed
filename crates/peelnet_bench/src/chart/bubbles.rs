//! Bubble charts on logarithmic axes, with the Pareto front drawn through them.

use crate::chart::{Area, SIZE, Svg, name, range, width};
use maud::{Markup, html};
use plotters::prelude::*;

pub struct Bubble {
    /// Stands beside it where there is room.
    pub name: String,
    /// Shown where the pointer is over it.
    pub title: String,
    /// Must be positive.
    pub x: f64,
    /// Must be positive.
    pub y: f64,
    /// What its area grows with.
    pub weight: f64,
    /// Whether it is on the front: nothing is both left of it and below it.
    pub on_front: bool,
}

impl Bubble {
    fn radius(&self) -> f64 {
        (0.9 * self.weight.max(4.0).sqrt()).clamp(3.0, 18.0)
    }

    fn color(&self) -> &'static str {
        if self.on_front { "#d55e00" } else { "#0072b2" }
    }
}

/// Bubbles over two logarithmic axes with these titles, by x from left to right. Values of y up to `floor` bear its name.
pub fn bubble_chart(bubbles: &[Bubble], x: &str, y: &str, floor: (f64, &str)) -> Svg {
    let (left, right) = range(bubbles.iter().map(|b| b.x));
    let (low, high) = range(bubbles.iter().map(|b| b.y));
    let (floor, floor_name) = floor;
    let x_range = (left / 1.3..right * 1.8).log_scale();
    let y_range = (low / 3.0..high * 3.0).log_scale();
    Svg::new(|builder| {
        let mut chart = builder.build_cartesian_2d(x_range, y_range)?;
        chart
            .configure_mesh()
            .x_desc(x)
            .y_desc(y)
            .x_label_formatter(&|x| {
                let digits = format!("{x:.3}");
                let digits = digits.trim_end_matches('0');
                digits.trim_end_matches('.').to_owned()
            })
            .y_label_formatter(&|y| {
                if *y <= floor * 1.01 {
                    floor_name.to_owned()
                } else {
                    format!("{y:.0e}")
                }
            })
            .label_style(("sans-serif", 14))
            .light_line_style(TRANSPARENT)
            .draw()?;
        // Everything to the left of a bubble on the front is above it, so it is a staircase.
        let mut stairs: Vec<(f64, f64)> = Vec::new();
        for b in bubbles.iter().filter(|b| b.on_front) {
            if let Some(&(_, y)) = stairs.last() {
                stairs.push((b.x, y));
            }
            stairs.push((b.x, b.y));
        }
        let front = RGBColor(213, 94, 0).stroke_width(2);
        chart.draw_series(LineSeries::new(stairs, front))?;
        let placed = bubbles.iter().map(|bubble| {
            let (x, y) = chart.backend_coord(&(bubble.x, bubble.y));
            (bubble, x, y)
        });
        Ok(overlay(placed.collect()))
    })
}

/// The bubbles and their names.
fn overlay(mut placed: Vec<(&Bubble, i32, i32)>) -> Markup {
    // The large ones first, so that they hide no small one.
    placed.sort_by(|(a, ..), (b, ..)| b.weight.total_cmp(&a.weight));
    // Names on the front first: the others stand where there is room.
    let mut order = placed.clone();
    order.sort_by_key(|(b, ..)| !b.on_front);
    let mut taken = Vec::new();
    let mut named = |(b, x, y)| Some((b, place(b, x, y, &mut taken)?));
    let names: Vec<(&Bubble, Area)> = order.into_iter().filter_map(&mut named).collect();
    html! {
        @for (b, x, y) in placed {
            circle class="point" cx=(x) cy=(y) r=(format!("{:.1}", b.radius())) fill=(b.color()) fill-opacity="0.45" stroke=(b.color()) {
                title { (b.title) }
            }
            "\n"
        }
        @for (b, area) in names { (name(&b.name, area, None, b.on_front)) }
    }
}

/// Beside the bubble, or above or below where that is taken by another name; nowhere where all is taken, but on the front.
fn place(bubble: &Bubble, x: i32, y: i32, taken: &mut Vec<Area>) -> Option<Area> {
    let (x, y, r) = (f64::from(x), f64::from(y), bubble.radius());
    let shifts: &[f64] = if bubble.on_front {
        &[0.0, -13.0, 13.0, -26.0, 26.0, -39.0, 39.0, -52.0, 52.0]
    } else {
        &[0.0]
    };
    let sides = [x + r + 3.0, x - r - 3.0 - width(&bubble.name)];
    let free = |a: &Area| {
        // Not over the axis, nor beyond the edge.
        a.0[0] > 102.0
            && a.0[2] < f64::from(SIZE.0) - 4.0
            && !taken.iter().any(|other| a.overlaps(other))
    };
    let beside = Area::new(&bubble.name, sides[0], y);
    let area = shifts
        .iter()
        .flat_map(|&shift| sides.map(|left| Area::new(&bubble.name, left, y + shift)))
        .find(free)
        .or(bubble.on_front.then_some(beside))?;
    taken.push(area);
    Some(area)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bubble_has_its_title() {
        let bubble = |name: &str, x, y, on_front| Bubble {
            name: name.to_owned(),
            title: format!("{name} at {x}"),
            x,
            y,
            weight: 24.0,
            on_front,
        };
        let draw = |bubbles: &[Bubble]| bubble_chart(bubbles, "time", "error", (1e-10, "exact"));
        let svg = draw(&[
            bubble("plain", 1.0, 1e-2, true),
            bubble("a<b", 2.0, 1e-4, true),
            bubble("best", 4.0, 1e-10, true),
        ]);
        let text = svg.as_str();
        assert_eq!(text.matches("<circle class=\"point\"").count(), 3);
        assert!(text.contains("<title>a&lt;b at 2</title>") && text.contains("exact"));
        assert!(!text.contains("a<b") && text.trim_end().ends_with("</svg>"));
        // Nothing to draw is no failure.
        assert!(draw(&[]).as_str().contains("<svg"));
    }
}
