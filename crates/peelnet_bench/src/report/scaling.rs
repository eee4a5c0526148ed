//! The files of `peelnet bench scaling`: how time and memory grow.

use crate::chart::{Line, Scale, line_chart};
use crate::report::{Files, Measurement, Results, Table, files::csv, table::number};
use crate::{
    each_once,
    scaling::{Scaling, Series},
};

impl Measurement for Scaling {
    const FILES: Files<Self> = &[
        ("scaling.json", Results::json),
        ("scaling.csv", |r, _| Ok(csv(&r.measured.rows))),
        ("scaling.md", |r, _| Ok(r.markdown())),
        ("scaling-fragments.svg", |r, _| {
            Ok(r.chart(Series::Fragments))
        }),
        ("scaling-pixels.svg", |r, _| Ok(r.chart(Series::Pixels))),
        ("scaling-triangles.svg", |r, _| {
            Ok(r.chart(Series::Triangles))
        }),
    ];
}

impl Results<Scaling> {
    pub fn table(&self) -> Table {
        let exponents = &self.measured.exponents;
        let headings = |what: &str| Series::ALL.map(|s| format!("{what} ~ {s}^"));
        let columns = [headings("time"), headings("bytes")].into_iter().flatten();
        let methods = each_once(exponents.iter().map(|e| e.method.as_str()));
        Table::matrix("method", columns, &methods, |method, k| {
            let series = Series::ALL[k % Series::ALL.len()];
            let mut own = exponents.iter();
            let own = own.find(|e| e.method == method && e.series == series);
            let exponent = own.and_then(|e| [e.time, e.bytes][k / Series::ALL.len()]);
            number(exponent, 2)
        })
    }

    fn markdown(&self) -> String {
        let left_out = self.measured.left_out.iter();
        let left_out =
            left_out.map(|l| format!("- {} at {} {}: {}\n", l.method, l.value, l.series, l.why));
        let left_out: String = left_out.collect();
        format!(
            "{}\nExponents fitted to the upper half of the steps. {}\n\nNot measured:\n\n{left_out}",
            self.table().markdown(),
            self.credit(),
        )
    }

    fn chart(&self, series: Series) -> String {
        let mut lines: Vec<Line> = Vec::new();
        for row in self.measured.rows.iter().filter(|r| r.series == series) {
            let point = (row.value as f64, row.time_ms);
            match lines.iter_mut().find(|l| l.name == row.method) {
                Some(line) => line.points.push(point),
                None => lines.push(Line::new(&row.method, [point])),
            }
        }
        let x = ["fragments per pixel", "pixels", "triangles"][series as usize];
        line_chart(&lines, x, "frame time, ms", Scale::Logarithmic).on_white()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{machine, written};
    use crate::scaling::{Growth, exponents};

    #[test]
    fn files_are_written() {
        let row = |(method, series, value)| Growth {
            method: str::to_owned(method),
            series,
            value,
            time_ms: value as f64,
            bytes_per_pixel: 8.0,
        };
        let steps = [
            ("a", Series::Fragments, 1),
            ("a", Series::Fragments, 2),
            ("b", Series::Pixels, 64),
        ];
        let rows = steps.map(row).to_vec();
        let scaling = Scaling {
            exponents: exponents(&rows),
            rows,
            left_out: Vec::new(),
        };
        let results = Results::new(machine(), "peelnet bench scaling", scaling);
        let dir = tempfile::tempdir().unwrap();
        let text = written(dir.path(), &results);
        assert!(text.contains("| b |") && text.contains("–"), "{text}");
    }
}
