//! The files of a bench: `results.json`, `results.csv`, `table.md`, `pareto.svg`, `pareto-mean.svg` and `report.html`.

pub(crate) mod page;

use crate::{
    ReportError, Results, Table,
    files::{write_csv, write_file},
    table::{number, scene_heading, scene_in_cell},
};
use peelnet_chart::{Bubble, BubbleChart, Svg};
use peelnet_eval::{
    bench::Bench,
    front::{self, BASE, EXACT_MSE, Mean, Point, untimed},
    ratios::{Bytes, Ratios, ratios},
    scenes_of,
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
            "bytes a pixel (mean, median, most)",
            "time / front at equal error",
            "error / front at equal time",
        ];
        let points = front::points(&self.measured.rows, None, Mean::Geometric);
        let trained_on = &self.measured.trained_on;
        let line = |r: Ratios| {
            let point = points.iter().find(|p| p.method == r.method);
            let worst = r
                .worst
                .as_ref()
                .map(|(scene, x)| format!("{x:.2} ({})", scene_in_cell(scene, trained_on)));
            vec![
                r.method.clone(),
                r.mse_linear
                    .map_or_else(|| "0".to_owned(), |x| format!("{x:.2e}")),
                number(r.to_weighted, 3),
                number(r.to_moments, 3),
                worst.unwrap_or_else(|| "–".to_owned()),
                number(r.time_to_base, 3),
                number(r.time_to_moments, 3),
                number(r.time_to_weighted, 3),
                r.bytes_per_pixel
                    .map_or_else(|| "–".to_owned(), |b| bytes(&b)),
                number(point.map(|p| p.time_at_equal_error), 2),
                number(point.map(|p| p.error_at_equal_time), 2),
            ]
        };
        Table::new(headings, ratios(&self.measured.rows).into_iter().map(line))
    }

    /// Times on every scene as ratios to hardware blending, the fastest exact method first: whether it is the right answer depends on the
    /// scene more than on anything else.
    pub fn times_by_scene(&self) -> Table {
        let rows = &self.measured.rows;
        let scenes = scenes_of(rows);
        let points = |scene| front::points(rows, Some(scene), Mean::Geometric);
        let points: Vec<Vec<Point>> = scenes.iter().copied().map(points).collect();
        // Points come by time.
        let exact = points.iter().map(|all| {
            let first = all.iter().find(|p| p.is_exact());
            first.map_or_else(
                || "–".to_owned(),
                |p| format!("{:.2} ({})", p.time, p.method),
            )
        });
        let mut lines = vec![
            std::iter::once("the fastest exact one".to_owned())
                .chain(exact)
                .collect(),
        ];
        lines.extend(ratios(rows).into_iter().map(|r| {
            let time = |all: &Vec<Point>| {
                let own = all.iter().find(|p| p.method == r.method);
                number(own.map(|p| p.time), 2)
            };
            let times: Vec<String> = points.iter().map(time).collect();
            std::iter::once(r.method).chain(times).collect()
        }));
        let named = scenes
            .iter()
            .map(|s| scene_heading(s, &self.measured.trained_on));
        let headings = std::iter::once("time / hardware blending".to_owned()).chain(named);
        Table::new(headings, lines)
    }

    /// `table.md`.
    pub fn markdown(&self) -> String {
        let untimed = untimed(&self.measured.rows);
        let why = untimed
            .iter()
            .map(|(method, why)| format!(" {method} has no time: {why}."));
        format!(
            "{}\nErrors against `abuffer` in linear light over the whole frame, geometric means over scenes and views.{} {}\n\n{}",
            self.table().markdown(),
            why.collect::<String>(),
            self.credit(),
            self.times_by_scene().markdown(),
        )
    }
}

/// Bytes a pixel: one number, or mean, median and most over the views.
fn bytes(b: &Bytes) -> String {
    if b.is_one() {
        format!("{:.0}", b.most)
    } else {
        format!("{:.0}, {:.0}, {:.0}", b.mean, b.median, b.most)
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
                "{}: {error}, {:.2} x hardware blending, {} bytes a pixel",
                p.method,
                p.time,
                bytes(&p.bytes)
            ),
            x: p.time,
            y: p.error,
            weight: p.bytes.mean,
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
    use crate::testing::{machine, row};
    use peelnet_eval::{Row, ratios::MOMENTS};

    fn bench(rows: Vec<Row>, trained_on: &[&str]) -> Results<Bench> {
        let measured = Bench {
            load: [None, None],
            settings: None,
            trained_on: trained_on.iter().map(|&s| s.to_owned()).collect(),
            rows,
        };
        Results::new(machine(), "peelnet bench", measured)
    }

    /// The worst scene is marked like a heading where a network was trained on it, and only there.
    #[test]
    fn the_worst_scene_says_that_it_was_trained_on() {
        let mut rows = Vec::new();
        for (scene, error) in [("cups", 8.0), ("panes", 2.0)] {
            rows.push(row(scene, MOMENTS, 4.0));
            rows.push(row(scene, "wboit-eq9", error));
        }
        let worst = |trained_on: &[&str]| {
            let table = bench(rows.clone(), trained_on).table();
            table.rows[1][4].clone()
        };
        assert_eq!(worst(&["cups"]), "2.00 (cups, trained on)");
        assert_eq!(worst(&["panes"]), "2.00 (cups)");
    }

    #[test]
    fn every_method_is_a_bubble_with_its_figures() {
        let point = |method: &str, error, time| Point {
            method: method.to_owned(),
            error,
            time,
            time_ms: time,
            bytes: Bytes {
                mean: 24.0,
                median: 24.0,
                most: 24.0,
            },
            on_front: true,
            time_at_equal_error: 1.0,
            error_at_equal_time: 1.0,
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
