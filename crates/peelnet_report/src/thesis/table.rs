//! The tables of a run.

use crate::{
    Table,
    table::{number, scene_heading},
};
use peelnet_eval::{
    by_scene::{ByScene, SceneErrors},
    ratios, thesis,
};

/// Like the thesis's table 4.1: weighted blending and learned weighted blending on every scene.
pub(super) fn like_the_thesis(errors: &ByScene, trained_on: &[String]) -> Table {
    let best = errors.best_published.as_deref();
    let best_heading = best.map_or_else(
        || "best published".to_owned(),
        |b| format!("best published: {b}"),
    );
    let best = best.unwrap_or_default();
    let error = |s: &SceneErrors, m: &str| number(s.mse255.get(m).copied(), 2);
    let theirs = |s: &SceneErrors| thesis::line(&s.scene);
    Table::of(
        &errors.scenes,
        &[
            ("scene", &|s| scene_heading(&s.scene, trained_on)),
            (thesis::WEIGHTED, &|s| error(s, thesis::WEIGHTED)),
            (ratios::WEIGHTED, &|s| error(s, ratios::WEIGHTED)),
            (&best_heading, &|s| error(s, best)),
            (thesis::DEEP, &|s| error(s, thesis::DEEP)),
            ("deep / thesis's weight", &|s| {
                number(s.ratio(thesis::DEEP, thesis::WEIGHTED), 2)
            }),
            ("deep / best published", &|s| {
                number(s.ratio(thesis::DEEP, best), 2)
            }),
            ("thesis: weighted → deep", &|s| match theirs(s) {
                None => "not measured".to_owned(),
                Some(m) => format!("{:.2} → {:.2}", m.weighted, m.deep),
            }),
            ("thesis: ratio", &|s| {
                number(theirs(s).map(thesis::Measured::ratio), 2)
            }),
        ],
    )
}

/// Every method (a row each) on every scene (a column each), `mse255`.
pub(super) fn all_methods(errors: &ByScene, trained_on: &[String]) -> Table {
    let scenes = errors.scenes.iter();
    let scenes = scenes.map(|s| scene_heading(&s.scene, trained_on));
    let headings = std::iter::once("method".to_owned()).chain(scenes);
    let line = |method: &String| {
        let cells = errors
            .scenes
            .iter()
            .map(|s| match s.mse255.get(method).copied() {
                None => "–".to_owned(),
                Some(0.0) => "0".to_owned(),
                Some(v) if v < 0.005 => format!("{v:.1e}"),
                Some(v) => format!("{v:.2}"),
            });
        std::iter::once(method.clone()).chain(cells).collect()
    };
    Table::new(headings, errors.methods.iter().map(line))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::row;

    #[test]
    fn the_thesis_stands_beside_our_figures() {
        let table = like_the_thesis(
            &ByScene::of(&[
                row("sixteen-050", "wboit-papakostas", 20.0),
                row("sixteen-050", "wboit-eq9", 5.0),
                row("sixteen-050", "deep-thesis", 10.0),
            ]),
            &[],
        );
        assert_eq!(
            table.rows[0],
            [
                "sixteen-050",
                "20.00",
                "5.00",
                "5.00",
                "10.00",
                "0.50",
                "2.00",
                "16.35 → 10.50",
                "0.64"
            ]
        );
        assert_eq!(table.rows[0].len(), table.headings.len());
    }

    /// A figure of a scene that the network learned from says so, in both tables.
    #[test]
    fn scenes_of_training_are_marked() {
        let rows = [
            row("cups", "blended", 1.0),
            row("cups-held", "blended", 1.0),
        ];
        let (errors, trained) = (ByScene::of(&rows), ["cups".to_owned()]);
        let table = like_the_thesis(&errors, &trained);
        assert_eq!(table.rows[0][0], "cups (trained on)");
        assert_eq!(table.rows[1][0], "cups-held");
        let headings = all_methods(&errors, &trained).headings;
        assert_eq!(headings, ["method", "cups (trained on)", "cups-held"]);
    }
}
