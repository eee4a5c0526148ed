//! The files of a result: `results.json`, `table.md` and `report.html`.

mod bench_page;
mod chart;
mod effects_page;
mod page;
mod stress_page;

pub(crate) use effects_page::page as effects_page;
#[cfg(test)]
pub(crate) use page::tests::machine as machine_of_tests;
pub(crate) use stress_page::page as stress_page;

use crate::{
    EvalError, Machine, Row,
    findings::findings,
    front::{self, Mean},
    ratios, table,
    table::Table,
    write_atomically, write_csv, write_json,
};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A step of a run and how long it took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// `extract`, `train`, `export`, `compare`, …
    pub name: String,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// What it did, in figures.
    pub note: String,
}

/// Everything a report tells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// What it was measured on.
    pub machine: Machine,
    /// The command line.
    pub command: String,
    /// The steps, in order.
    pub stages: Vec<Stage>,
    /// Settings that matter, as name and value.
    pub settings: Vec<(String, String)>,
    /// What the rows say, computed from them when the record is written.
    pub findings: Vec<String>,
    /// All rows.
    pub rows: Vec<Row>,
}

/// What the page shows beside the record.
#[derive(Clone, Copy, Debug, Default)]
pub struct Attachments<'a> {
    /// The folder with `<scene>-<method>.png`.
    pub images: Option<&'a Path>,
    /// The loss curve as SVG text.
    pub loss_svg: Option<&'a str>,
    /// The dataset's summary as plain text.
    pub dataset_summary: Option<&'a str>,
}

impl Record {
    /// A record of these rows, with its findings.
    pub fn new(machine: Machine, command: String, rows: Vec<Row>) -> Self {
        Self {
            machine,
            command,
            stages: Vec::new(),
            settings: Vec::new(),
            findings: findings(&rows),
            rows,
        }
    }

    /// Writes `results.json`, `table.md` and `report.html` into a folder.
    ///
    /// # Errors
    /// If a file cannot be written or a picture cannot be read.
    pub fn write(&self, folder: &Path, attachments: &Attachments<'_>) -> Result<(), EvalError> {
        write_json(&folder.join("results.json"), self)?;
        write_atomically(&folder.join("table.md"), self.markdown().as_bytes())?;
        let page = page::page(self, attachments)?;
        write_atomically(&folder.join("report.html"), page.as_bytes())
    }

    /// `table.md`: the table like the thesis's, all methods, and the findings.
    pub fn markdown(&self) -> String {
        let t = Table::of(&self.rows);
        let (headings, cells) = t.all_methods();
        let findings: String = self.findings.iter().map(|f| format!("- {f}\n")).collect();
        format!(
            "# Weighted and learned weighted blending against the exact image\n\n{EXPLANATION}\n\n{}\n## Findings\n\n{findings}\n\
             ## All methods\n\nMean squared error (0–255) against `abuffer`, mean over the views.\n\n{}\n\
             Measured on {} ({}) with `{}`.\n",
            table::markdown(&t.headings(), &t.cells()),
            table::markdown(&headings, &cells),
            self.machine.adapter,
            self.machine.cpu,
            self.command,
        )
    }
}

/// A comparison of methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bench {
    /// What it was measured on.
    pub machine: Machine,
    /// The command line.
    pub command: String,
    /// Mean load of the machine before and after, see [`crate::load`].
    #[serde(default)]
    pub load: [Option<f64>; 2],
    /// One row per method, scene and view.
    pub rows: Vec<Row>,
}

impl Bench {
    /// Writes `results.json`, `results.csv`, `table.md`, `pareto.svg`, `pareto-mean.svg` and `report.html` into a folder; pictures are taken from
    /// `images/` in it.
    ///
    /// # Errors
    /// If a file cannot be written, or a picture not be read.
    pub fn write(&self, folder: &Path) -> Result<(), EvalError> {
        for (name, mean) in [
            ("pareto", Mean::Geometric),
            ("pareto-mean", Mean::Arithmetic),
        ] {
            let svg = chart::chart(&front::points(&self.rows, None, mean));
            // White paper under it; in the page it takes the page's colours.
            let paper = ">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n<";
            let svg = svg.replacen(">\n<", paper, 1);
            write_atomically(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
        }
        let page = bench_page::page(self, &folder.join("images"))?;
        write_atomically(&folder.join("report.html"), page.as_bytes())?;
        write_json(&folder.join("results.json"), self)?;
        write_csv(&folder.join("results.csv"), &self.rows)?;
        write_atomically(&folder.join("table.md"), self.markdown().as_bytes())
    }

    /// `table.md`: every method as ratios to the references.
    pub fn markdown(&self) -> String {
        format!(
            "{}\nErrors against `abuffer` in linear light over the whole frame, geometric means over scenes and views. {}\n",
            table::markdown(
                &ratios::HEADINGS.map(str::to_owned),
                &ratios::cells(&ratios::ratios(&self.rows))
            ),
            self.machine.credit(&self.command),
        )
    }
}

/// What the figures of the table are.
const EXPLANATION: &str = "Mean squared error against the exact image (`abuffer`), sRGB-encoded, 0–255 scale, not \
quantised, whole frame, mean over the views. The thesis's meshes and camera are unknown: its absolute figures do not \
compare with these, the ratios do. At α = 0.85 and with random alphas it reports artifacts and no figures.";
