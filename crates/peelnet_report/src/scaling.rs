//! The files of `peelnet bench --scaling`: how time and memory grow.

use crate::{Measurement, ReportError, Results, Table, files::csv, table::number};
use peelnet_chart::{Line, LineChart, Scale};
use peelnet_eval::{
    each_once,
    scaling::{Exponent, Scaling, Series},
};
use std::path::Path;

impl Measurement for Scaling {
    const FILES: &[&str] = &[
        "scaling.json",
        "scaling.csv",
        "scaling.md",
        "scaling-fragments.svg",
        "scaling-pixels.svg",
        "scaling-triangles.svg",
    ];

    fn text(results: &Results<Self>, file: &str, _: &Path) -> Result<Option<String>, ReportError> {
        Ok(Some(match file {
            "scaling.csv" => csv(&results.measured.rows),
            "scaling.md" => results.markdown(),
            "scaling-fragments.svg" => results.chart(Series::Fragments, "fragments per pixel"),
            "scaling-pixels.svg" => results.chart(Series::Pixels, "pixels"),
            _ => results.chart(Series::Triangles, "triangles"),
        }))
    }
}

impl Results<Scaling> {
    /// The exponents.
    pub fn table(&self) -> Table {
        let exponents = &self.measured.exponents;
        let of = |method: &str, series: Series, pick: fn(&Exponent) -> Option<f64>| {
            let mut own = exponents.iter();
            let own = own.find(|e| e.method == method && e.series == series);
            number(own.and_then(pick), 2)
        };
        let line = |method: &str| {
            let times = Series::ALL.map(|s| of(method, s, |e| e.time));
            let bytes = Series::ALL.map(|s| of(method, s, |e| e.bytes));
            let name = [method.to_owned()];
            name.into_iter().chain(times).chain(bytes).collect()
        };
        let of = |what: &str| Series::ALL.map(|s| format!("{what} ~ {s}^"));
        let headings = ["method".to_owned()].into_iter();
        let headings = headings.chain(of("time")).chain(of("bytes"));
        let methods = each_once(exponents.iter().map(|e| e.method.as_str()));
        Table::new(headings, methods.into_iter().map(line))
    }

    fn markdown(&self) -> String {
        let left_out = self.measured.left_out.iter();
        let left_out: String = left_out
            .map(|l| format!("- {} at {} {}: {}\n", l.method, l.value, l.series, l.why))
            .collect();
        format!(
            "{}\nExponents fitted to the upper half of the steps. {}\n\nNot measured:\n\n{left_out}",
            self.table().markdown(),
            self.credit(),
        )
    }

    /// Frame time of every method against a series.
    fn chart(&self, series: Series, x: &str) -> String {
        let mut lines: Vec<Line> = Vec::new();
        for row in self.measured.rows.iter().filter(|r| r.series == series) {
            let point = (row.value as f64, row.time_ms);
            match lines.iter_mut().find(|l| l.name == row.method) {
                Some(line) => line.points.push(point),
                None => lines.push(Line::new(&row.method, [point])),
            }
        }
        LineChart {
            lines: &lines,
            x,
            y: "frame time, ms",
            x_scale: Scale::Logarithmic,
        }
        .svg()
        .on_white()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{machine, written};
    use peelnet_eval::scaling::{Growth, exponents};

    fn row(method: &str, series: Series, value: u64, time_ms: f64) -> Growth {
        Growth {
            method: method.to_owned(),
            series,
            value,
            time_ms,
            bytes_per_pixel: 8.0,
        }
    }

    #[test]
    fn files_are_written() {
        let rows = vec![
            row("a", Series::Fragments, 1, 1.0),
            row("a", Series::Fragments, 2, 2.0),
            row("b", Series::Pixels, 64, 2.0),
        ];
        let scaling = Scaling {
            exponents: exponents(&rows),
            rows,
            left_out: Vec::new(),
        };
        let results = Results::new(machine(), "peelnet bench --scaling", scaling);
        let dir = tempfile::tempdir().unwrap();
        let text = written(dir.path(), &results);
        assert!(text.contains("| b |") && text.contains("–"), "{text}");
    }
}
