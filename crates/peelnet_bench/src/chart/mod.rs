//! Charts as SVG text, drawn by plotters: [`line_chart`] and [`bubble_chart`]; and histograms, [`bar_chart`].
//!
//! Whatever names and titles hold, they are escaped: an [`Svg`] may stand inside a page.
//!
//! ```
//! use peelnet_bench::chart::{Line, Scale, line_chart};
//!
//! let line = Line::new("error <of> a method", [(1.0, 0.5), (2.0, 0.25)]);
//! let svg = line_chart(&[line], "passes", "error", Scale::Linear);
//! assert!(svg.as_str().contains("error &lt;of&gt; a method"));
//! ```

mod bars;
mod bubbles;
mod lines;

pub use bars::bar_chart;
pub use bubbles::bubble_chart;
pub use lines::{Line, Scale, line_chart};

use maud::{Markup, html};
use peelnet_core::files::one_line;
use plotters::prelude::*;
use std::ops::RangeInclusive;

/// Width and height of every chart, pixels.
const SIZE: (u32, u32) = (960, 600);

/// Values on logarithmic axes; of wider ranges plotters look for labels without end.
const DRAWN: RangeInclusive<f64> = 1e-30..=1e30;

/// Height of a name in a chart, pixels.
const NAME_HEIGHT: f64 = 12.0;

/// Says in a file who wrote it.
const MARK: &str = "<metadata>peelnet</metadata>";

/// The elements of our own that are added to what plotters draw.
type Drawn = Result<Markup, Box<dyn std::error::Error>>;

/// A picture as SVG text, without XML prolog and with a transparent background.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Svg(String);

impl Svg {
    /// What plotters draw, with the elements of our own that `draw` returns at its end.
    fn new(draw: impl FnOnce(&mut ChartBuilder<'_, '_, SVGBackend<'_>>) -> Drawn) -> Self {
        let mut text = String::new();
        let drawn = {
            let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            let mut builder = ChartBuilder::on(&area);
            builder
                .margin(16)
                .x_label_area_size(48)
                .y_label_area_size(84);
            draw(&mut builder).and_then(|overlay| {
                area.present()?;
                Ok(overlay)
            })
        };
        let overlay =
            drawn.unwrap_or_else(|e| unreachable!("drawing into a string cannot fail: {e}"));
        let end = text.rfind("</svg>").unwrap_or(text.len());
        text.insert_str(end, &overlay.0);
        Self(text)
    }

    /// The text, for use inside a page.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The text with white paper under it, for a file of its own, which says who wrote it.
    pub fn on_white(&self) -> String {
        let paper = "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>";
        let start = format!(">\n{MARK}\n{paper}\n<");
        self.0.replacen(">\n<", &start, 1)
    }

    /// Whether a file that begins with these bytes is a chart that [`Svg::on_white`] wrote.
    pub fn is_ours(head: &[u8]) -> bool {
        let start = String::from_utf8_lossy(&head[..head.len().min(512)]);
        start.starts_with("<svg") && start.contains(MARK)
    }
}

/// The smallest and the largest value; 1 and 10 of none.
fn range(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let low = values.clone().reduce(f64::min);
    low.zip(values.reduce(f64::max)).unwrap_or((1.0, 10.0))
}

/// Left, top, right and bottom of a name.
#[derive(Clone, Copy, Debug)]
struct Area([f64; 4]);

impl Area {
    /// A name of 11 pixels whose left end is at the middle of a point.
    fn new(name: &str, left: f64, middle: f64) -> Self {
        let half = NAME_HEIGHT / 2.0;
        Self([left, middle - half, left + width(name), middle + half])
    }

    fn overlaps(&self, other: &Self) -> bool {
        let (a, b) = (self.0, other.0);
        a[0] <= b[2] && b[0] <= a[2] && a[1] < b[3] && b[1] < a[3]
    }
}

/// About how wide a name is: sans-serif letters are 0.56 as wide as high.
fn width(name: &str) -> f64 {
    name.chars().count() as f64 * 11.0 * 0.56
}

/// A name in the chart.
fn name(text: &str, area: Area, color: Option<&str>, bold: bool) -> Markup {
    html! {
        text class="name" x=(format!("{:.0}", area.0[0])) y=(format!("{:.0}", area.0[3] - 2.0)) font-family="sans-serif" font-size="11"
            fill=[color] font-weight=[bold.then_some("bold")] { (one_line(text)) }
        "\n"
    }
}
