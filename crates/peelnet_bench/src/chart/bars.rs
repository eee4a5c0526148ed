//! Histograms: a bar for each bin, all of one width, edges below.

use crate::chart::Svg;
use maud::html;
use peelnet_core::files::{one_line, thousands};
use peelnet_dataset::{rounded, summary::Bin};

/// Width and height, pixels, and what the edges' names take of the height.
const SIZE: [f64; 2] = [240.0, 110.0];
const NAMES: f64 = 18.0;

/// Bars that are drawn: a file can claim any number.
const MOST: usize = 512;

/// A bar for each bin, as high as its count; pointing at one shows its edges and its count of `unit`.
pub fn bar_chart(bins: &[Bin], unit: &str) -> Svg {
    let bins = &bins[..bins.len().min(MOST)];
    let most = bins.iter().map(|bin| bin.count).max().unwrap_or(0).max(1) as f64;
    let [width, height] = SIZE;
    let (step, base) = (width / bins.len().max(1) as f64, height - NAMES);
    // About four names have room.
    let is_named = |k: usize| k.is_multiple_of(bins.len().div_ceil(4));
    let text = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {width} {height}")) role="img" {
            @for (k, bin) in bins.iter().enumerate() {
                @let left = k as f64 * step;
                // Even one of a million is seen.
                @let high = if bin.count == 0 { 0.0 } else { (bin.count as f64 / most * (base - 4.0)).max(1.0) };
                rect class="bar" fill="#0072b2" x=(format!("{left:.2}")) y=(format!("{:.2}", base - high))
                    width=(format!("{:.2}", (step - 1.0).max(0.5 * step))) height=(format!("{high:.2}")) {
                    title { (edge(bin.from, 6)) @if bin.from < bin.to { " – " (edge(bin.to, 6)) } ": " (thousands(bin.count)) " " (one_line(unit)) }
                }
                @if is_named(k) {
                    text x=(format!("{left:.2}")) y=(height - 4.0) font-family="sans-serif" font-size="11" { (edge(bin.from, 3)) }
                }
                "\n"
            }
            line x1="0" x2=(width) y1=(base) y2=(base) stroke="#888888" {}
        }
    };
    Svg(text.into_string())
}

/// An edge with so many digits; the first bin of columns with negative values begins at the least number that there is.
fn edge(value: f64, digits: usize) -> String {
    if value <= f64::from(f32::MIN) {
        return "−∞".to_owned();
    }
    let short = format!("{value:.*e}", digits - 1);
    rounded(short.parse().unwrap_or(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_as_high_as_their_counts() {
        let bin = |from, count| Bin {
            from,
            to: from + 1.0,
            count,
        };
        let svg = bar_chart(&[bin(0.0, 4), bin(1.0, 0), bin(2.0, 2)], "<rows>");
        let heights = svg.as_str().split(" height=\"").skip(1);
        let heights: Vec<&str> = heights.filter_map(|t| t.split('"').next()).collect();
        assert_eq!(heights, ["88.00", "0.00", "44.00"]);
        assert!(
            svg.as_str()
                .contains("<title>2 – 3: 2 &lt;rows&gt;</title>")
        );
        // What a file claims, and nothing at all.
        let many = vec![bin(f64::NAN, u64::MAX); 2 * MOST];
        let bars = |svg: Svg| svg.as_str().matches("<rect").count();
        assert_eq!(
            [bars(bar_chart(&many, "")), bars(bar_chart(&[], ""))],
            [MOST, 0]
        );
    }
}
