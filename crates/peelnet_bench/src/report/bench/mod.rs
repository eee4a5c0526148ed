//! The files of a bench: `results.json`, `results.csv`, `table.md`, `pareto.svg`, `pareto-mean.svg` and `report.html`.

pub(crate) mod page;

use crate::chart::{Svg, bubble_chart};
use crate::report::{
    Files, Measurement, Results, Table,
    files::csv,
    table::{marked, number, scene_heading},
};
use crate::{
    bench::Bench,
    front::{self, BASE, Mean, Point, untimed},
    rows::{MOMENTS, Rows, WEIGHTED},
};

/// Headings of errors over those of [`WEIGHTED`] and [`MOMENTS`], and of times over those of [`BASE`].
const TO_WEIGHTED: &str = "/ wboit-eq9";
const TO_MOMENTS: &str = "/ mboit4";
const TO_BASE: &str = "time / hardware blending";

/// How far a method is behind the front.
const TIME_TO_FRONT: &str = "time / front at equal error";
const ERROR_TO_FRONT: &str = "error / front at equal time";

impl Measurement for Bench {
    const FILES: Files<Self> = &[
        ("pareto.svg", |r, _| Ok(r.chart(Mean::Geometric).on_white())),
        ("pareto-mean.svg", |r, _| {
            Ok(r.chart(Mean::Arithmetic).on_white())
        }),
        ("report.html", page::page),
        ("results.json", Results::json),
        ("results.csv", |r, _| Ok(csv(&r.measured.rows))),
        ("table.md", |r, _| Ok(r.markdown())),
    ];
}

impl Results<Bench> {
    fn chart(&self, mean: Mean) -> Svg {
        bubble_chart(&front::points(&Rows::new(&self.measured.rows), mean))
    }

    /// Every method as ratios to the reference methods, over the views that all methods have.
    pub fn table(&self) -> Table {
        let all = Rows::new(&self.measured.rows);
        let rows = all.common();
        let points = front::points(&rows, Mean::Geometric);
        let point = |method: &str| points.iter().find(|p| p.method == method);
        let worst = |method: &str| {
            let (scene, x) = rows.worst_scene(method)?;
            let scene = marked(scene, &self.measured.trained_on, ", trained on");
            Some(format!("{x:.2} ({scene})"))
        };
        let dash = || "–".to_owned();
        let error = |m, to| number(rows.error_ratio(m, to), 3);
        let time = |m, to| number(rows.time_ratio(m, to), 3);
        let behind = |m, of: fn(&Point) -> f64| number(point(m).map(of), 2);
        Table::from_rows(
            &all.methods(),
            &[
                ("method", &|m| (*m).to_owned()),
                ("MSE (linear)", &|m| mse(rows.error_of(m))),
                (TO_WEIGHTED, &|m| error(m, WEIGHTED)),
                (TO_MOMENTS, &|m| error(m, MOMENTS)),
                ("worst scene / mboit4", &|m| worst(m).unwrap_or_else(dash)),
                (TO_BASE, &|m| time(m, BASE)),
                ("time / mboit4", &|m| time(m, MOMENTS)),
                ("time / wboit-eq9", &|m| time(m, WEIGHTED)),
                ("bytes a pixel (mean, median, most)", &|m| {
                    let own = rows.of_method(m).bytes();
                    own.map_or_else(dash, |b| b.text())
                }),
                (TIME_TO_FRONT, &|m| behind(m, |p| p.time_at_equal_error)),
                (ERROR_TO_FRONT, &|m| behind(m, |p| p.error_at_equal_time)),
            ],
        )
    }

    /// Times on every scene as ratios to hardware blending, the fastest exact method first: whether it is the right answer depends on the
    /// scene more than on anything else.
    pub fn times_by_scene(&self) -> Table {
        let rows = Rows::new(&self.measured.rows);
        let scenes = rows.scenes();
        let points = |scene: &&str| front::points(&rows.of_scene(scene), Mean::Geometric);
        let points: Vec<Vec<Point>> = scenes.iter().map(points).collect();
        // Points come by time.
        let exact = points.iter().map(|all| {
            let first = all.iter().find(|p| p.is_exact());
            let first = first.map(|p| format!("{} ({})", number(p.time, 2), p.method));
            first.unwrap_or_else(|| "–".to_owned())
        });
        let first = std::iter::once("the fastest exact one".to_owned());
        let first = first.chain(exact).collect();
        let trained_on = &self.measured.trained_on;
        let named = scenes.iter().map(|s| scene_heading(s, trained_on));
        let mut table = Table::matrix(TO_BASE, named, &rows.methods(), |method, k| {
            let own = points[k].iter().find(|p| p.method == method);
            number(own.and_then(|p| p.time), 2)
        });
        table.rows.insert(0, first);
        table
    }

    fn markdown(&self) -> String {
        let rows = Rows::new(&self.measured.rows);
        let mut reasons = rows
            .note()
            .map_or_else(String::new, |note| format!(" {note}"));
        for (method, why) in untimed(&rows) {
            reasons += &format!(" {method} has no time: {why}.");
        }
        format!(
            "{}\nErrors against `abuffer` in linear light over the whole frame, geometric means over scenes and views; one below 1e-10 counts as that.{reasons} {}\n\n{}",
            self.table().markdown(),
            self.credit(),
            self.times_by_scene().markdown(),
        )
    }
}

/// A mean squared error; 0 of an exact method.
fn mse(error: Option<f64>) -> String {
    match error {
        None => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(x) => format!("{x:.2e}"),
    }
}
