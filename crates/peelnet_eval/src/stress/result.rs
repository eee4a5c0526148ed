//! What a run over the hard cases found, as text, files and a page.

use super::{CASES, Outcome, Property, Row};
use crate::{
    EvalError, Machine,
    files::{write_csv, write_json},
    report, table, write_atomically,
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// All rows of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stressed {
    /// What it was run on.
    pub machine: Machine,
    /// The command line.
    pub command: String,
    /// One row per method, case and property.
    pub rows: Vec<Row>,
}

impl Stressed {
    /// Rows of one outcome.
    pub fn of(&self, result: Outcome) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |r| r.result == result)
    }

    /// A line for each method: passes, declared flaws (`d` and their number) and failures (`F`) in each case.
    pub fn matrix(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let mut methods: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !methods.contains(&row.method.as_str()) {
                methods.push(&row.method);
            }
        }
        let ids: Vec<&str> = CASES
            .iter()
            .map(|c| c.id)
            .filter(|id| self.rows.iter().any(|r| r.case == *id))
            .collect();
        let cell = |method: &str, case: &str| {
            let count = |result| {
                let of = self.of(result);
                of.filter(|r| r.method == method && r.case == case).count()
            };
            let [pass, declared, fail] =
                [Outcome::Pass, Outcome::Declared, Outcome::Fail].map(count);
            match (pass, declared, fail) {
                (0, 0, 0) => String::new(),
                (_, 0, 0) => "·".to_owned(),
                (_, n, 0) => format!("d{n}"),
                (_, _, n) => format!("F{n}"),
            }
        };
        let lines = methods.iter().map(|method| {
            let cells = ids.iter().map(|case| cell(method, case));
            std::iter::once((*method).to_owned()).chain(cells).collect()
        });
        let headings = std::iter::once("method".to_owned());
        (
            headings
                .chain(ids.iter().map(|id| (*id).to_owned()))
                .collect(),
            lines.collect(),
        )
    }

    /// The failures: method, case, property, value, limit, and where.
    pub fn failures(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let line = |r: &Row| {
            let value = r
                .value
                .map_or_else(|| "not finite".to_owned(), |x| format!("{x:.3e}"));
            vec![
                r.method.clone(),
                r.case.clone(),
                r.property.to_string(),
                value,
                format!("{:.3e}", r.limit),
                format!("{} {}", r.place, r.reason.as_deref().unwrap_or_default())
                    .trim()
                    .to_owned(),
            ]
        };
        let headings = ["method", "case", "property", "value", "limit", "where"];
        (
            headings.map(str::to_owned).to_vec(),
            self.of(Outcome::Fail).map(line).collect(),
        )
    }

    /// The declared flaws, those of one reason together: property, methods, cases, worst value as a multiple of its limit.
    pub fn flaws(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let mut groups: BTreeMap<(Property, &str), Vec<&Row>> = BTreeMap::new();
        for row in self.of(Outcome::Declared) {
            let reason = row.reason.as_deref().unwrap_or_default();
            groups.entry((row.property, reason)).or_default().push(row);
        }
        let names = |rows: &[&Row], of: fn(&Row) -> &str| {
            let mut all: Vec<&str> = Vec::new();
            for row in rows {
                if !all.contains(&of(row)) {
                    all.push(of(row));
                }
            }
            all.join(", ")
        };
        let lines = groups.iter().map(|((property, reason), rows)| {
            let excess = rows
                .iter()
                .map(|r| r.value.unwrap_or(f64::INFINITY) / r.limit);
            vec![
                property.to_string(),
                names(rows, |r| &r.method),
                names(rows, |r| &r.case),
                (*reason).to_owned(),
                format!("{:.1}", excess.fold(0.0, f64::max)),
            ]
        });
        let headings = ["property", "methods", "cases", "why", "worst / limit"];
        (headings.map(str::to_owned).to_vec(), lines.collect())
    }

    /// How many rows there are of each outcome.
    pub fn summary(&self) -> String {
        let [pass, declared, fail] =
            [Outcome::Pass, Outcome::Declared, Outcome::Fail].map(|o| self.of(o).count());
        format!("{pass} properties hold, {declared} declared flaws, {fail} failures")
    }

    /// `stress.md`.
    pub fn markdown(&self) -> String {
        let section = |title: &str, (headings, cells): (Vec<String>, Vec<Vec<String>>)| {
            if cells.is_empty() {
                return String::new();
            }
            format!("\n## {title}\n\n{}", table::markdown(&headings, &cells))
        };
        format!(
            "# Hard cases\n\n{}. In the table · is a case whose properties hold, d a number of declared flaws, F of failures.\n{}{}{}\n{}\n",
            self.summary(),
            section("Methods and cases", self.matrix()),
            section("Failures", self.failures()),
            section("Declared flaws", self.flaws()),
            self.machine.credit(&self.command),
        )
    }

    /// Writes `stress.json`, `stress.csv`, `stress.md` and `stress.html` into a folder.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), EvalError> {
        write_json(&folder.join("stress.json"), self)?;
        write_csv(&folder.join("stress.csv"), &self.rows)?;
        write_atomically(&folder.join("stress.md"), self.markdown().as_bytes())?;
        let page = report::stress_page(self);
        write_atomically(&folder.join("stress.html"), page.as_bytes())
    }
}
