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
    methods_of,
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
        let points = front::points(&self.measured.rows, None, Mean::Geometric);
        let point = |r: &Ratios| points.iter().find(|p| p.method == r.method);
        let worst = |r: &Ratios| {
            let (scene, x) = r.worst.as_ref()?;
            let scene = scene_in_cell(scene, &self.measured.trained_on);
            Some(format!("{x:.2} ({scene})"))
        };
        let dash = || "–".to_owned();
        Table::of(
            &ratios(&self.measured.rows),
            &[
                ("method", &|r| r.method.clone()),
                ("MSE (linear)", &|r| mse(r.mse_linear)),
                ("/ wboit-eq9", &|r| number(r.to_weighted, 3)),
                ("/ mboit4", &|r| number(r.to_moments, 3)),
                ("worst scene / mboit4", &|r| worst(r).unwrap_or_else(dash)),
                ("time / hardware blending", &|r| number(r.time_to_base, 3)),
                ("time / mboit4", &|r| number(r.time_to_moments, 3)),
                ("time / wboit-eq9", &|r| number(r.time_to_weighted, 3)),
                ("bytes a pixel (mean, median, most)", &|r| {
                    r.bytes_per_pixel.map_or_else(dash, |b| bytes(&b))
                }),
                ("time / front at equal error", &|r| {
                    number(point(r).map(|p| p.time_at_equal_error), 2)
                }),
                ("error / front at equal time", &|r| {
                    number(point(r).map(|p| p.error_at_equal_time), 2)
                }),
            ],
        )
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
            let first = first.map(|p| format!("{:.2} ({})", p.time, p.method));
            first.unwrap_or_else(|| "–".to_owned())
        });
        let first = std::iter::once("the fastest exact one".to_owned());
        let mut lines: Vec<Vec<String>> = vec![first.chain(exact).collect()];
        lines.extend(methods_of(rows).into_iter().map(|method| {
            let times = points.iter().map(|all| {
                let own = all.iter().find(|p| p.method == method);
                number(own.map(|p| p.time), 2)
            });
            std::iter::once(method.to_owned()).chain(times).collect()
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

/// A mean squared error; 0 of an exact method.
fn mse(error: Option<f64>) -> String {
    error.map_or_else(|| "0".to_owned(), |x| format!("{x:.2e}"))
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
}
