//! The files of `peelnet run`: the thesis's table of our scenes, what it says of the thesis's promise, and a page.

mod findings;
mod page;

use crate::chart::Svg;
use crate::report::{
    Files, Measurement, Results, Table,
    table::{number, scene_heading},
};
use crate::{
    Machine, Row,
    rows::{self, Rows},
    thesis::{self, DEEP, best_published},
};
use findings::findings;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// `extract`, `train`, `export`, `compare`, …
    pub name: String,
    pub seconds: f64,
    /// What it did, in figures.
    pub note: String,
}

/// A network trained as the thesis does, and its comparison with all methods.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ThesisRun {
    pub stages: Vec<Stage>,
    pub settings: Vec<(String, String)>,
    pub findings: Vec<String>,
    /// Scenes among them that the learned method was trained on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trained_on: Vec<String>,
    pub rows: Vec<Row>,
    /// Rows of one more scene, with shipped networks beside the trained one and timed frames.
    #[serde(default)]
    pub showcase: Vec<Row>,
    /// The loss curve, for the page alone.
    #[serde(skip)]
    pub loss: Option<Svg>,
    /// The dataset's summary as plain text, for the page alone.
    #[serde(skip)]
    pub dataset_summary: Option<String>,
}

impl Measurement for ThesisRun {
    const FILES: Files<Self> = &[
        ("results.json", Results::json),
        ("table.md", |r, _| Ok(r.markdown())),
        ("report.html", page::page),
    ];
}

impl Results<ThesisRun> {
    /// The results of these rows, with their findings, and without stages and settings.
    pub fn of_rows(machine: Machine, command: impl Into<String>, rows: Vec<Row>) -> Self {
        let run = ThesisRun {
            findings: findings(&rows),
            rows,
            ..ThesisRun::default()
        };
        Self::new(machine, command, run)
    }

    /// Weighted and learned weighted blending on every scene, beside the thesis's figures.
    pub fn table(&self) -> Table {
        let rows = Rows::new(&self.measured.rows);
        let trained_on = &self.measured.trained_on;
        let best = best_published(&rows);
        let best_heading = best.map_or_else(
            || "best published".to_owned(),
            |b| format!("best published: {b}"),
        );
        let best = best.unwrap_or_default();
        let error = |s: &str, m| number(thesis::error(&rows, s, m, |r| r.mse255), 2);
        let ratio = |s: &str, to| number(thesis::ratio(&rows, s, [DEEP, to], |r| r.mse255), 2);
        Table::from_rows(
            &rows.scenes(),
            &[
                ("scene", &|s| scene_heading(s, trained_on)),
                (thesis::WEIGHTED, &|s| error(s, thesis::WEIGHTED)),
                (rows::WEIGHTED, &|s| error(s, rows::WEIGHTED)),
                (&best_heading, &|s| error(s, best)),
                (DEEP, &|s| error(s, DEEP)),
                ("deep / thesis's weight", &|s| ratio(s, thesis::WEIGHTED)),
                ("deep / best published", &|s| ratio(s, best)),
                ("thesis: weighted → deep", &|s| match thesis::line(s) {
                    None => "not measured".to_owned(),
                    Some([weighted, deep]) => format!("{weighted:.2} → {deep:.2}"),
                }),
                ("thesis: ratio", &|s| {
                    let line = thesis::line(s);
                    number(line.map(|[weighted, deep]| deep / weighted), 2)
                }),
            ],
        )
    }

    /// Every method (a row each) on every scene (a column each), `mse255`.
    fn all_methods(&self) -> Table {
        let rows = Rows::new(&self.measured.rows);
        let trained_on = &self.measured.trained_on;
        let scenes = rows.scenes();
        let named = scenes.iter().map(|s| scene_heading(s, trained_on));
        Table::matrix(
            "method",
            named,
            &rows.methods(),
            |method, k| match thesis::error(&rows, scenes[k], method, |r| r.mse255) {
                None => "–".to_owned(),
                Some(0.0) => "0".to_owned(),
                Some(v) if v < 0.005 => format!("{v:.1e}"),
                Some(v) => format!("{v:.2}"),
            },
        )
    }

    /// `table.md`: the table like the thesis's, the findings, and all methods.
    fn markdown(&self) -> String {
        let findings = self.measured.findings.iter();
        let findings: String = findings.map(|f| format!("- {f}\n")).collect();
        format!(
            "# Weighted and learned weighted blending against the exact image\n\n{EXPLANATION}\n\n{}\n## Findings\n\n{findings}\n\
             ## All methods\n\nMean squared error (0–255) against `abuffer`, mean over the views.\n\n{}\n\
             Measured on {} ({}) with `{}`.\n",
            self.table().markdown(),
            self.all_methods().markdown(),
            self.machine.adapter,
            self.machine.cpu,
            self.command,
        )
    }
}

const EXPLANATION: &str = "Mean squared error against the exact image (`abuffer`), sRGB-encoded, 0–255 scale, not \
quantised, whole frame, mean over the views. The thesis's meshes and camera are unknown: its absolute figures do not \
compare with these, the ratios do. At α = 0.85 and with random alphas it reports artifacts and no figures.";
