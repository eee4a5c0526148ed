//! The files of a bench: `results.json`, `results.csv`, `table.md`, `pareto.svg`, `pareto-mean.svg` and `report.html`.

pub(crate) mod page;

use crate::{
    ReportError, Results, Table,
    files::{write_csv, write_file},
    table::number,
};
use peelnet_chart::{Bubble, BubbleChart, Svg};
use peelnet_eval::{
    bench::Bench,
    front::{self, BASE, EXACT_MSE, Mean, Point, untimed},
    ratios::{Ratios, ratios},
};
use std::path::Path;

impl Results<Bench> {
    /// The files that [`Self::write`] writes.
    pub const FILES: &[&str] = &[
        "pareto.svg",
        "pareto-mean.svg",
        "report.html",
        "results.json",
        "results.csv",
        "table.md",
    ];

    /// Writes all files of a bench into a folder; pictures are taken from `images/` in it.
    ///
    /// # Errors
    /// If a file cannot be written, or a picture not be read.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        let rows = &self.measured.rows;
        for (name, mean) in [
            ("pareto", Mean::Geometric),
            ("pareto-mean", Mean::Arithmetic),
        ] {
            let svg = chart(&front::points(rows, None, mean));
            write_file(&folder.join(format!("{name}.svg")), svg.on_white())?;
        }
        let page = page::page(self, &folder.join("images"))?;
        write_file(&folder.join("report.html"), page)?;
        self.write_json(&folder.join("results.json"))?;
        write_csv(&folder.join("results.csv"), rows)?;
        write_file(&folder.join("table.md"), self.markdown())
    }

    /// Every method as ratios to the reference methods.
    pub fn table(&self) -> Table {
        let headings = [
            "method",
            "MSE (linear)",
            "/ wboit-eq9",
            "/ mboit4",
            "worst scene / mboit4",
            "time / hardware blending",
            "time / mboit4",
            "time / wboit-eq9",
            "bytes a pixel",
        ];
        let line = |r: Ratios| {
            let worst = r.worst.as_ref();
            vec![
                r.method.clone(),
                r.mse_linear
                    .map_or_else(|| "0".to_owned(), |x| format!("{x:.2e}")),
                number(r.to_weighted, 3),
                number(r.to_moments, 3),
                worst.map_or_else(|| "–".to_owned(), |(scene, x)| format!("{x:.2} ({scene})")),
                number(r.time_to_base, 3),
                number(r.time_to_moments, 3),
                number(r.time_to_weighted, 3),
                number(r.bytes_per_pixel, 0),
            ]
        };
        Table::new(headings, ratios(&self.measured.rows).into_iter().map(line))
    }

    /// `table.md`.
    pub fn markdown(&self) -> String {
        let untimed = untimed(&self.measured.rows);
        let why = untimed
            .iter()
            .map(|(method, why)| format!(" {method} has no time: {why}."));
        format!(
            "{}\nErrors against `abuffer` in linear light over the whole frame, geometric means over scenes and views.{} {}\n",
            self.table().markdown(),
            why.collect::<String>(),
            self.credit(),
        )
    }
}

/// Error against time, the Pareto front drawn through it, a bubble for each method as large as its bytes per pixel.
pub(crate) fn chart(points: &[Point]) -> Svg {
    let bubble = |p: &Point| {
        let error = if p.is_exact() {
            "exact".to_owned()
        } else {
            format!("MSE {:.2e}", p.error)
        };
        Bubble {
            name: p.method.clone(),
            title: format!(
                "{}: {error}, {:.2} x hardware blending, {:.0} bytes a pixel",
                p.method, p.time, p.bytes
            ),
            x: p.time,
            y: p.error,
            weight: p.bytes,
            on_front: p.on_front,
        }
    };
    let bubbles: Vec<Bubble> = points.iter().map(bubble).collect();
    BubbleChart {
        bubbles: &bubbles,
        x: if points.iter().any(|p| p.method == BASE) {
            "time, times hardware blending without sorting"
        } else {
            "time, milliseconds"
        },
        y: "mean squared error, linear light",
        floor: (EXACT_MSE, "exact"),
    }
    .svg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_a_bubble_with_its_figures() {
        let point = |method: &str, error, time| Point {
            method: method.to_owned(),
            error,
            time,
            time_ms: time,
            bytes: 24.0,
            on_front: true,
        };
        let svg = chart(&[
            point(BASE, 1e-2, 1.0),
            point("a<b", 1e-4, 2.0),
            point("exact", EXACT_MSE, 4.0),
        ]);
        let svg = svg.as_str();
        assert_eq!(svg.matches("<circle class=\"point\"").count(), 3);
        assert!(
            svg.contains("a&lt;b: MSE 1.00e-4, 2.00 x") && svg.contains("exact: exact, 4.00 x")
        );
    }
}
