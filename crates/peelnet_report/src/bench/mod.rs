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
    family::{self, Choice, MOST_TIME},
    front::{self, BASE, EXACT_MSE, Mean, Point, untimed},
    geometric_mean,
    ratios::{Bytes, MOMENTS, Ratios, ratios},
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

    /// One setting of each family of methods, chosen by the rule of [`family::choose`] on rows of *other* scenes, with its figures on these;
    /// and what was composited on the CPU, which has errors alone. A dash stands where these rows do not have a figure.
    pub fn families(&self, validation: &Bench) -> String {
        let all = ratios(&self.measured.rows);
        let of = |method: &str| all.iter().find(|r| r.method == method);
        // Errors of 0 have no logarithm; a method that is exact on some views only has a mean with the floor of errors.
        let mean = |method: &str| {
            let own = self.measured.rows.iter().filter(|r| r.method == method);
            geometric_mean(own.map(|r| r.mse_linear.max(EXACT_MSE)))
        };
        let error = |method: &str| match (mean(method), mean(MOMENTS)) {
            (Some(error), _) if error <= EXACT => "0".to_owned(),
            (Some(error), Some(moments)) if error < LEAST_SHOWN * moments => {
                format!("< {LEAST_SHOWN}")
            }
            (Some(error), Some(moments)) => format!("{:.3}", error / moments),
            _ => "–".to_owned(),
        };
        let choices = family::choose(&validation.rows);
        let line = |c: &Choice| {
            let method = c.chosen.as_ref().map(|p| p.method.as_str());
            let own = method.and_then(of);
            let bytes = own.and_then(|r| r.bytes_per_pixel);
            vec![
                c.family.name.to_owned(),
                method.map_or_else(|| "–".to_owned(), |m| format!("`{m}`")),
                method.map_or_else(|| "–".to_owned(), error),
                number(own.and_then(|r| r.time_to_base), 2),
                bytes.map_or_else(|| "–".to_owned(), |b| self::bytes(&b)),
            ]
        };
        let headings = [
            "family",
            "setting",
            "error / mboit4",
            "time / hardware blending",
            "bytes a pixel (mean, median, most)",
        ];
        let mut text = Table::new(headings, choices.iter().map(line)).markdown();
        for choice in choices.iter().filter(|c| !c.untimed.is_empty()) {
            let errors = choice
                .untimed
                .iter()
                .map(|(method, _)| format!("{} for `{method}`", error(method)));
            text += &format!(
                "\n{} also has {}, without a time: {}.\n",
                capital(choice.family.name),
                errors.collect::<Vec<_>>().join(", "),
                choice.untimed[0].1
            );
        }
        let scenes: Vec<String> = scenes_of(&validation.rows)
            .iter()
            .map(|s| format!("`{s}`"))
            .collect();
        text + &format!(
            "\nEach is its family's least error in at most {MOST_TIME} times the time of its fastest, chosen on {}; figures are of the {} held-out scenes.\n",
            scenes.join(", "),
            scenes_of(&self.measured.rows).len()
        )
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

/// Ratios below are shown as less than this: 0.000 would read as exact.
const LEAST_SHOWN: f64 = 0.001;

/// A geometric mean of floors, but for the roundings of logarithms.
const EXACT: f64 = EXACT_MSE * (1.0 + 1e-9);

/// With a capital letter, as at the beginning of a sentence.
fn capital(text: &str) -> String {
    let mut chars = text.chars();
    let first = chars.next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(chars).collect()
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
    use peelnet_eval::Row;

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

    /// Chosen on one set of rows, shown with the figures of another; what has no time stands below with its error.
    #[test]
    fn families_are_chosen_on_other_rows_than_those_shown() {
        let timed = |scene: &str, method: &str, mse, ms| Row {
            time_ms: Some(ms),
            ..row(scene, method, mse)
        };
        let rows = |scene: &str, four, six, mlab| {
            vec![
                timed(scene, BASE, 90.0, 1.0),
                timed(scene, MOMENTS, four, 2.0),
                timed(scene, "mboit6", six, 3.0),
                timed(scene, "linked-list", 0.0, 5.0),
                Row {
                    bytes_per_pixel: None,
                    ..row(scene, "mlab-4", mlab)
                },
            ]
        };
        // On the scenes shown the other one would be chosen.
        let mut b = rows("b", 4.0, 8.0, 2.0);
        b.push(timed("b", "kbuffer-8", 1e-4, 6.0));
        let mut a = rows("a", 8.0, 4.0, 1.0);
        a.push(timed("a", "kbuffer-8", 1e-4, 6.0));
        let validation = bench(a, &[]);
        let shown = bench(b, &[]).families(&validation.measured);
        for part in [
            "| moments | `mboit6` | 2.000 | 3.00 | 10 |",
            "| exact | `linked-list` | 0 | 5.00 | 10 |",
            "| bounded exact | `kbuffer-8` | &lt; 0.001 | 6.00 | 10 |",
            "| learned, ours | – | – | – | – |",
            "Bounded exact also has 0.500 for `mlab-4`, without a time: ",
            "at most 2 times the time of its fastest, chosen on `a`; figures are of the 1 held-out scenes.",
        ] {
            assert!(shown.contains(part), "{part} in\n{shown}");
        }
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
