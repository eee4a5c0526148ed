//! The tables of a run.

use crate::{
    Table,
    table::{number, scene_heading},
};
use peelnet_eval::{
    rows::{self, Rows},
    thesis::{self, DEEP, best_published},
};

/// Like the thesis's table 4.1: weighted blending and learned weighted blending on every scene.
pub(super) fn like_the_thesis(rows: &Rows<'_>, trained_on: &[String]) -> Table {
    let best = best_published(rows);
    let best_heading = best.map_or_else(
        || "best published".to_owned(),
        |b| format!("best published: {b}"),
    );
    let best = best.unwrap_or_default();
    let error = |s: &str, m| number(thesis::error(rows, s, m, |r| r.mse255), 2);
    let ratio = |s: &str, to| number(thesis::ratio(rows, s, [DEEP, to], |r| r.mse255), 2);
    Table::of(
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
pub(super) fn all_methods(rows: &Rows<'_>, trained_on: &[String]) -> Table {
    let scenes = rows.scenes();
    let named = scenes.iter().map(|s| scene_heading(s, trained_on));
    Table::matrix(
        "method",
        named,
        &rows.methods(),
        |method, k| match thesis::error(rows, scenes[k], method, |r| r.mse255) {
            None => "–".to_owned(),
            Some(0.0) => "0".to_owned(),
            Some(v) if v < 0.005 => format!("{v:.1e}"),
            Some(v) => format!("{v:.2}"),
        },
    )
}
