//! The table like the thesis's 4.1: weighted blending and learned weighted blending on every scene.

use crate::{Row, ratios, thesis};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Figures of one scene, means over its views.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The scene's name.
    pub scene: String,
    /// Number of views that were averaged.
    pub views: usize,
    /// `mse255` of each method, by name.
    pub mse255: BTreeMap<String, f64>,
    /// `mse_linear` of each method, by name.
    pub mse_linear: BTreeMap<String, f64>,
    /// `mse255_covered` of each method, by name; methods without a covered pixel are absent.
    pub mse255_covered: BTreeMap<String, f64>,
}

impl Line {
    /// Error of one method relative to another on the 0–255 scale; `None` if either is missing or the divisor 0.
    pub fn ratio(&self, method: &str, reference: &str) -> Option<f64> {
        ratio(&self.mse255, method, reference)
    }

    /// The same in linear light.
    pub fn ratio_linear(&self, method: &str, reference: &str) -> Option<f64> {
        ratio(&self.mse_linear, method, reference)
    }
}

fn ratio(values: &BTreeMap<String, f64>, method: &str, reference: &str) -> Option<f64> {
    let (a, b) = (values.get(method)?, values.get(reference)?);
    (*b > 0.0).then(|| a / b)
}

/// All scenes, with the columns that are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// One line per scene, in the order of the rows.
    pub lines: Vec<Line>,
    /// The methods in the order of the rows.
    pub methods: Vec<String>,
    /// The published weighted blending with the smallest geometric mean error over all scenes.
    pub best_published: Option<String>,
}

/// Geometric mean; `None` of nothing or if a value is not positive.
pub fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut n) = (0.0, 0);
    for v in values {
        if v.is_nan() || v <= 0.0 {
            return None;
        }
        sum += v.ln();
        n += 1;
    }
    (n > 0).then(|| (sum / f64::from(n)).exp())
}

impl Table {
    /// Averages rows over the views of each scene.
    pub fn of(rows: &[Row]) -> Self {
        let mut methods: Vec<String> = Vec::new();
        let mut scenes: Vec<String> = Vec::new();
        for row in rows {
            if !methods.contains(&row.method) {
                methods.push(row.method.clone());
            }
            if !scenes.contains(&row.scene) {
                scenes.push(row.scene.clone());
            }
        }
        let lines: Vec<Line> = scenes
            .into_iter()
            .map(|scene| {
                let of = |pick: &dyn Fn(&Row) -> Option<f64>| {
                    let mut sums: BTreeMap<String, (f64, u32)> = BTreeMap::new();
                    for row in rows.iter().filter(|r| r.scene == scene) {
                        if let Some(value) = pick(row) {
                            let entry = sums.entry(row.method.clone()).or_default();
                            entry.0 += value;
                            entry.1 += 1;
                        }
                    }
                    sums.into_iter()
                        .map(|(m, (sum, n))| (m, sum / f64::from(n)))
                        .collect::<BTreeMap<_, _>>()
                };
                let mut views: Vec<u32> = rows
                    .iter()
                    .filter(|r| r.scene == scene)
                    .map(|r| r.view)
                    .collect();
                views.sort_unstable();
                views.dedup();
                Line {
                    views: views.len(),
                    mse255: of(&|r| Some(r.mse255)),
                    mse_linear: of(&|r| Some(r.mse_linear)),
                    mse255_covered: of(&|r| r.mse255_covered),
                    scene,
                }
            })
            .collect();
        let best_published = methods
            .iter()
            .filter(|m| m.starts_with("wboit-"))
            .filter_map(|m| {
                let errors: Option<Vec<f64>> =
                    lines.iter().map(|l| l.mse255.get(m).copied()).collect();
                Some((m, geometric_mean(errors?)?))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(m, _)| m.clone());
        Self {
            lines,
            methods,
            best_published,
        }
    }

    /// Headings of the table's columns, see [`Table::cells`].
    pub fn headings(&self) -> Vec<String> {
        let best = self.best_published.as_deref().map_or_else(
            || "best published".to_owned(),
            |b| format!("best published: {b}"),
        );
        [
            "scene",
            thesis::WEIGHTED,
            ratios::WEIGHTED,
            &best,
            thesis::DEEP,
            "deep / thesis's weight",
            "deep / best published",
            "thesis: weighted → deep",
            "thesis: ratio",
        ]
        .map(str::to_owned)
        .to_vec()
    }

    /// The cells of every line.
    pub fn cells(&self) -> Vec<Vec<String>> {
        let number = |v: Option<f64>, digits: usize| {
            v.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}"))
        };
        self.lines
            .iter()
            .map(|line| {
                let error = |m: &str| number(line.mse255.get(m).copied(), 2);
                let best = self.best_published.as_deref().unwrap_or_default();
                let measured = thesis::line(&line.scene);
                vec![
                    line.scene.clone(),
                    error(thesis::WEIGHTED),
                    error(ratios::WEIGHTED),
                    error(best),
                    error(thesis::DEEP),
                    number(line.ratio(thesis::DEEP, thesis::WEIGHTED), 2),
                    number(line.ratio(thesis::DEEP, best), 2),
                    measured.map_or_else(
                        || "not measured".to_owned(),
                        |m| format!("{:.2} → {:.2}", m.weighted, m.deep),
                    ),
                    number(measured.map(thesis::Measured::ratio), 2),
                ]
            })
            .collect()
    }

    /// Every method (a line each) on every scene (a column each), `mse255`: headings and cells.
    pub fn all_methods(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let headings = std::iter::once("method".to_owned())
            .chain(self.lines.iter().map(|l| l.scene.clone()))
            .collect();
        let cells = self
            .methods
            .iter()
            .map(|method| {
                std::iter::once(method.clone())
                    .chain(self.lines.iter().map(|l| {
                        l.mse255.get(method).map_or_else(
                            || "–".to_owned(),
                            |&v| match v {
                                0.0 => "0".to_owned(),
                                v if v < 0.005 => format!("{v:.1e}"),
                                v => format!("{v:.2}"),
                            },
                        )
                    }))
                    .collect()
            })
            .collect();
        (headings, cells)
    }
}

/// A table in Markdown: the first column to the left, numbers to the right.
pub fn markdown(headings: &[String], cells: &[Vec<String>]) -> String {
    let mut text = format!("| {} |\n|---|", headings.join(" | "));
    text.push_str(&"---:|".repeat(headings.len().saturating_sub(1)));
    text.push('\n');
    for line in cells {
        let _ = writeln!(text, "| {} |", line.join(" | "));
    }
    text
}

/// A table in plain text with aligned columns, for a terminal.
pub fn plain(headings: &[String], cells: &[Vec<String>]) -> String {
    let width = |k: usize| {
        std::iter::once(headings)
            .chain(cells.iter().map(Vec::as_slice))
            .filter_map(|line| line.get(k))
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..headings.len()).map(width).collect();
    let mut text = String::new();
    for line in std::iter::once(headings).chain(cells.iter().map(Vec::as_slice)) {
        let mut out = String::new();
        for (k, (cell, w)) in line.iter().zip(&widths).enumerate() {
            if k == 0 {
                let _ = write!(out, "{cell:<w$}");
            } else {
                let _ = write!(out, "  {cell:>w$}");
            }
        }
        text.push_str(out.trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
pub(crate) mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;

    /// A row with nothing but an error.
    pub(crate) fn row(scene: &str, view: u32, method: &str, mse255: f64) -> Row {
        Row {
            method: method.to_owned(),
            scene: scene.to_owned(),
            view,
            width: 4,
            height: 4,
            fragments: Some(8),
            max_layers: Some(2),
            lost: None,
            mse_linear: mse255 / 65025.0,
            mse_linear_covered: Some(mse255 / 65025.0),
            mse255,
            mse255_covered: Some(mse255),
            psnr: crate::metrics::psnr(mse255),
            ssim: None,
            flip: None,
            transmittance_error: None,
            p99_error: 0.0,
            max_error: 0.0,
            covered_pixels: 4,
            dark_pixels: 0,
            non_finite_pixels: 0,
            time_ms: None,
            time_ms_min: None,
            time_ms_p90: None,
            wall_ms: None,
            time_by_pass: String::new(),
            passes: 1,
            bytes_per_pixel: 10.0,
            adapter: "test".to_owned(),
        }
    }

    #[test]
    fn means_over_views_and_the_best_weight() {
        let rows = [
            row("sixteen-050", 0, "wboit-papakostas", 10.0),
            row("sixteen-050", 1, "wboit-papakostas", 30.0),
            row("sixteen-050", 0, "wboit-eq9", 4.0),
            row("sixteen-050", 1, "wboit-eq9", 6.0),
            row("sixteen-050", 0, "deep-thesis", 8.0),
            row("sixteen-050", 1, "deep-thesis", 12.0),
        ];
        let table = Table::of(&rows);
        assert_eq!(table.best_published.as_deref(), Some("wboit-eq9"));
        assert_eq!(table.lines[0].views, 2);
        let cells = &table.cells()[0];
        assert_eq!(
            cells,
            &[
                "sixteen-050",
                "20.00",
                "5.00",
                "5.00",
                "10.00",
                "0.50",
                "2.00",
                "16.35 → 10.50",
                "0.64"
            ]
        );
        assert_eq!(cells.len(), table.headings().len());
    }

    #[test]
    fn missing_methods_are_dashes() {
        let table = Table::of(&[row("cups", 0, "blended", 1.0)]);
        assert_eq!(table.best_published, None);
        assert_eq!(table.cells()[0][1..4], ["–", "–", "–"]);
        assert_eq!(table.cells()[0][7], "not measured");
    }

    #[test]
    fn markdown_has_one_bar_more_than_columns() {
        let text = markdown(
            &["a".to_owned(), "b".to_owned()],
            &[vec!["1".to_owned(), "2".to_owned()]],
        );
        assert_eq!(text, "| a | b |\n|---|---:|\n| 1 | 2 |\n");
    }

    #[test]
    fn geometric_means() {
        assert!((geometric_mean([1.0, 4.0]).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(geometric_mean([]), None);
        assert_eq!(geometric_mean([1.0, 0.0]), None);
    }
}
