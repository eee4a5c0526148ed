//! The files of `peelnet stress`: what holds, what is known not to, and what fails.

use crate::report::{Files, Measurement, Results, Table, files::csv, page};
use crate::{
    each_once,
    stress::{CASES, Outcome, Property, Row, Stressed},
};
use maud::html;
use std::collections::BTreeMap;

impl Measurement for Stressed {
    const FILES: Files<Self> = &[
        ("stress.json", Results::json),
        ("stress.csv", |r, _| Ok(csv(&r.measured.rows))),
        ("stress.md", |r, _| Ok(r.markdown())),
        ("stress.html", |r, _| Ok(r.page())),
    ];
}

impl Results<Stressed> {
    /// A row for each method: passes, known failures (`d` and their number) and failures (`F`) in each case.
    pub fn matrix(&self) -> Table {
        let rows = &self.measured.rows;
        let methods = each_once(rows.iter().map(|r| r.method.as_str()));
        let is_drawn = |id: &&str| rows.iter().any(|r| r.case == *id);
        let ids: Vec<&str> = CASES.iter().map(|c| c.id).filter(is_drawn).collect();
        let columns = ids.iter().map(|id| (*id).to_owned());
        Table::matrix("method", columns, &methods, |method, k| {
            let count = |result| {
                let own = |r: &&Row| r.method == method && r.case == ids[k];
                self.measured.rows_with(result).filter(own).count()
            };
            match [Outcome::Pass, Outcome::Declared, Outcome::Fail].map(count) {
                [0, 0, 0] => String::new(),
                [_, 0, 0] => "·".to_owned(),
                [_, n, 0] => format!("d{n}"),
                [_, _, n] => format!("F{n}"),
            }
        })
    }

    pub fn failures(&self) -> Table {
        Table::from_rows(
            self.measured.rows_with(Outcome::Fail),
            &[
                ("method", &|r| r.method.clone()),
                ("case", &|r| r.case.clone()),
                ("property", &|r| r.property.to_string()),
                ("value", &|r| {
                    let value = r.value.map(|x| format!("{x:.3e}"));
                    value.unwrap_or_else(|| "not finite".to_owned())
                }),
                ("limit", &|r| format!("{:.3e}", r.limit)),
                ("where", &|r| {
                    let place = format!("{} {}", r.place, r.reason.as_deref().unwrap_or_default());
                    place.trim().to_owned()
                }),
            ],
        )
    }

    /// The known failures, those of one reason together: property, methods, cases, worst value as a multiple of its limit.
    pub fn known_failures(&self) -> Table {
        let mut groups: BTreeMap<(Property, &str), Vec<&Row>> = BTreeMap::new();
        for row in self.measured.rows_with(Outcome::Declared) {
            let reason = row.reason.as_deref().unwrap_or_default();
            groups.entry((row.property, reason)).or_default().push(row);
        }
        let names =
            |rows: &[&Row], of: fn(&Row) -> &str| each_once(rows.iter().map(|r| of(r))).join(", ");
        let lines = groups.iter().map(|((property, reason), rows)| {
            let excess = |r: &&Row| r.value.unwrap_or(f64::INFINITY) / r.limit;
            vec![
                property.to_string(),
                names(rows, |r| &r.method),
                names(rows, |r| &r.case),
                (*reason).to_owned(),
                format!("{:.1}", rows.iter().map(excess).fold(0.0, f64::max)),
            ]
        });
        let headings = ["property", "methods", "cases", "why", "worst / limit"];
        Table::new(headings, lines)
    }

    fn exceptions(&self) -> impl Iterator<Item = (&'static str, Table)> {
        let all = [
            ("Failures", self.failures()),
            ("Known failures", self.known_failures()),
        ];
        all.into_iter().filter(|(_, table)| !table.rows.is_empty())
    }

    fn markdown(&self) -> String {
        let matrix = [("Methods and cases", self.matrix())].into_iter();
        let matrix = matrix.filter(|(_, table)| !table.rows.is_empty());
        let mut sections = String::new();
        for (title, table) in matrix.chain(self.exceptions()) {
            sections += &format!("\n## {title}\n\n{}", table.markdown());
        }
        format!(
            "# Stress cases\n\n{}. In the table · is a case whose properties hold, d a number of known failures, F of failures.\n{sections}\n{}\n",
            self.measured.summary(),
            self.credit(),
        )
    }

    fn page(&self) -> String {
        let matrix = self.matrix();
        let fails = |k: usize| matrix.rows[k].iter().any(|c| c.starts_with('F'));
        let cases = CASES
            .iter()
            .map(|c| [c.id, c.what, c.breaks].map(str::to_owned).to_vec());
        let cases = Table::new(["case", "what", "known to break"], cases);
        let body = html! {
            p { (self.measured.summary()) "." }
            p.note {
                "· all properties of the case hold; d: number of known failures; F: number of failures. Methods with a failure are orange."
            }
            (matrix.html("matrix", fails))
            @for (title, table) in self.exceptions() {
                h2 { (title) }
                (table.html("text", |_| false))
            }
            h2 { "The cases" }
            (cases.html("text", |_| false))
        };
        page::page(self, "Stress cases", body, &[], None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::{machine, written};

    /// What a row says of a method stands in all files; text is escaped in the page.
    #[test]
    fn outcomes_are_counted_and_grouped() {
        let row = |method: &str, case: &str, result| Row {
            method: method.to_owned(),
            case: case.to_owned(),
            property: Property::Hull,
            result,
            value: Some(2.0),
            limit: 1.0,
            place: "pixel <3>".to_owned(),
            reason: (result == Outcome::Declared).then(|| "rounds".to_owned()),
        };
        let rows = vec![
            row("a", "deep", Outcome::Declared),
            row("a", "far", Outcome::Pass),
            row("b", "deep", Outcome::Declared),
            row("b", "far", Outcome::Fail),
        ];
        let results = Results::new(machine(), "peelnet stress", Stressed { rows });
        let matrix = results.matrix();
        assert_eq!(matrix.headings, ["method", "deep", "far"]);
        assert_eq!(matrix.rows, [["a", "d1", "·"], ["b", "d1", "F1"]]);
        let known = results.known_failures().rows;
        assert_eq!(known, [["hull", "a, b", "deep", "rounds", "2.0"]]);
        let dir = tempfile::tempdir().unwrap();
        let page = written(dir.path(), &results);
        assert!(page.contains("pixel &lt;3&gt;") && !page.contains("pixel <3>"));
        assert!(page.contains("1 property holds, 2 known failures, 1 failure"));
    }
}
