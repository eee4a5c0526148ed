//! The files of `peelnet run`: the thesis's table of our scenes, what it says of the thesis's promise, and a page.

mod findings;
mod page;

use crate::chart::Svg;
use crate::report::{
    Files, Measurement, Results, Table,
    table::{markdown, number, scene_heading},
};
use crate::{
    Machine, Row,
    rows::{self, Rows, geometric_mean},
};
use findings::findings;
use peelnet_render::{
    MethodSpec,
    role::{THESIS_NETWORK, THESIS_WEIGHT},
};
use serde::{Deserialize, Serialize};

/// Table 4.1 of Papakostas' thesis (Ioannina 2022), by the shipped scenes that are made like its own, whose names end in the opacity of
/// all models: mean squared error (0–255) against dual depth peeling, of weighted blending with the thesis's weight and with the network's.
///
/// Its 16 models of 11,102 polygons and its camera are not known, so absolute values differ from ours: the ratio of both columns compares.
const TABLE: [(&str, [f64; 2]); 3] = [
    ("sixteen-025", [15.96, 11.79]),
    ("sixteen-050", [16.35, 10.50]),
    ("sixteen-075", [13.62, 11.27]),
];

/// The errors that the thesis has for a shipped scene; `None` where it measured nothing.
fn published(scene: &str) -> Option<[f64; 2]> {
    let found = TABLE.into_iter().find(|(name, _)| *name == scene);
    found.map(|(_, errors)| errors)
}

/// A mean of a method over the views of a scene.
fn mean(rows: &Rows<'_>, scene: &str, method: &str, value: fn(&Row) -> f64) -> Option<f64> {
    let own = rows.of_scene(scene).of_method(method);
    own.mean(|r| Some(value(r)))
}

/// The same as a ratio to that of another method; `None` if either is missing or the divisor 0.
fn ratio(
    rows: &Rows<'_>,
    scene: &str,
    [method, reference]: [&str; 2],
    value: fn(&Row) -> f64,
) -> Option<f64> {
    let [a, b] = [method, reference].map(|m| mean(rows, scene, m, value));
    Some(a? / b.filter(|b| *b > 0.0)?)
}

/// The published weighted blending with the smallest geometric mean of `mse255` over all scenes.
fn best_published<'a>(rows: &Rows<'a>) -> Option<&'a str> {
    let has_weight = |m: &&str| {
        let spec = m.parse::<MethodSpec>();
        spec.is_ok_and(|spec| spec.guarantees().own_weight)
    };
    let errors = rows.methods().into_iter().filter(has_weight);
    let errors = errors.filter_map(|m| {
        let scenes = rows.scenes().into_iter();
        let own: Option<Vec<f64>> = scenes.map(|s| mean(rows, s, m, |r| r.mse255)).collect();
        Some((m, geometric_mean(own?)?))
    });
    Some(errors.min_by(|a, b| a.1.total_cmp(&b.1))?.0)
}

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
        let error = |s: &str, m| number(mean(&rows, s, m, |r| r.mse255), 2);
        let ratio = |s: &str, to| {
            let methods = [THESIS_NETWORK, to];
            number(ratio(&rows, s, methods, |r| r.mse255), 2)
        };
        Table::from_rows(
            &rows.scenes(),
            &[
                ("scene", &|s| scene_heading(s, trained_on)),
                (THESIS_WEIGHT, &|s| error(s, THESIS_WEIGHT)),
                (rows::WEIGHTED, &|s| error(s, rows::WEIGHTED)),
                (&best_heading, &|s| error(s, best)),
                (THESIS_NETWORK, &|s| error(s, THESIS_NETWORK)),
                ("deep / thesis's weight", &|s| ratio(s, THESIS_WEIGHT)),
                ("deep / best published", &|s| ratio(s, best)),
                ("thesis: weighted → deep", &|s| match published(s) {
                    None => "not measured".to_owned(),
                    Some([weighted, deep]) => format!("{weighted:.2} → {deep:.2}"),
                }),
                ("thesis: ratio", &|s| {
                    let errors = published(s);
                    number(errors.map(|[weighted, deep]| deep / weighted), 2)
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
        Table::matrix("method", named, &rows.methods(), |method, k| {
            match mean(&rows, scenes[k], method, |r| r.mse255) {
                None => "–".to_owned(),
                Some(0.0) => "0".to_owned(),
                Some(v) if v < 0.005 => format!("{v:.1e}"),
                Some(v) => format!("{v:.2}"),
            }
        })
    }

    /// `table.md`: the table like the thesis's, the findings, and all methods.
    fn markdown(&self) -> String {
        let findings = self.measured.findings.iter();
        let findings: String = findings.map(|f| format!("- {}\n", markdown(f))).collect();
        format!(
            "# Weighted and learned weighted blending against the exact image\n\n{EXPLANATION}\n\n{}\n## Findings\n\n{findings}\n\
             ## All methods\n\nMean squared error (0–255) against `abuffer`, mean over the views.\n\n{}\n\
             {}\n",
            self.table().markdown(),
            self.all_methods().markdown(),
            self.credit(),
        )
    }
}

const EXPLANATION: &str = "Mean squared error against the exact image (`abuffer`), sRGB-encoded, 0–255 scale, not \
quantised, whole frame, mean over the views. The thesis's meshes and camera are unknown: its absolute figures do not \
compare with these, the ratios do. At α = 0.85 and with random alphas it reports artifacts and no figures.";
