//! The files of `peelnet run`: the thesis's table of our scenes, what it says of the thesis's promise, and a page.

mod findings;
mod page;
mod table;

use crate::{Files, Measurement, Results, Table};
use findings::findings;
use peelnet_chart::Svg;
use peelnet_eval::{Machine, Row, rows::Rows};
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
    /// Settings that matter, as name and value.
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
        let run = &self.measured;
        table::like_the_thesis(&Rows::new(&run.rows), &run.trained_on)
    }

    /// `table.md`: the table like the thesis's, the findings, and all methods.
    fn markdown(&self) -> String {
        let rows = Rows::new(&self.measured.rows);
        let findings = self.measured.findings.iter();
        let findings: String = findings.map(|f| format!("- {f}\n")).collect();
        format!(
            "# Weighted and learned weighted blending against the exact image\n\n{EXPLANATION}\n\n{}\n## Findings\n\n{findings}\n\
             ## All methods\n\nMean squared error (0–255) against `abuffer`, mean over the views.\n\n{}\n\
             Measured on {} ({}) with `{}`.\n",
            self.table().markdown(),
            table::all_methods(&rows, &self.measured.trained_on).markdown(),
            self.machine.adapter,
            self.machine.cpu,
            self.command,
        )
    }
}

const EXPLANATION: &str = "Mean squared error against the exact image (`abuffer`), sRGB-encoded, 0–255 scale, not \
quantised, whole frame, mean over the views. The thesis's meshes and camera are unknown: its absolute figures do not \
compare with these, the ratios do. At α = 0.85 and with random alphas it reports artifacts and no figures.";
