//! What the figures say about the thesis's promise, in sentences computed from the rows.
//!
//! The promise is that the network's weight errs less than weighted blending with the thesis's analytic weight. The
//! sentences state counts and ratios in both directions alike.

use peelnet_eval::{
    Row,
    by_scene::{ByScene, SceneErrors},
    geometric_mean, thesis,
};

/// One finding after the other, each a sentence or two.
pub fn findings(rows: &[Row]) -> Vec<String> {
    let table = ByScene::of(rows);
    let mut out = Vec::new();
    let (in_table, beyond): (Vec<_>, Vec<_>) = table
        .scenes
        .iter()
        .filter(|l| l.ratio(thesis::DEEP, thesis::WEIGHTED).is_some())
        .partition(|l| thesis::line(&l.scene).is_some());
    if in_table.is_empty() && beyond.is_empty() {
        return vec![
            "The learned method or weighted blending with the thesis's weight was not drawn, so nothing can be said \
             about the thesis's promise."
                .to_owned(),
        ];
    }
    let ratios = |lines: &[&SceneErrors], reference: &str| -> Vec<(String, f64)> {
        lines
            .iter()
            .filter_map(|l| Some((l.scene.clone(), l.ratio(thesis::DEEP, reference)?)))
            .collect()
    };
    if !in_table.is_empty() {
        let r = ratios(&in_table, thesis::WEIGHTED);
        let theirs: Vec<String> = in_table
            .iter()
            .filter_map(|l| thesis::line(&l.scene))
            .map(|m| format!("{:.2}", m.ratio()))
            .collect();
        out.push(format!(
            "On the scenes that the thesis measured, its promise {}: the learned weight has {} (learned / analytic: {}; \
             the thesis reports {}).",
            verdict(&r),
            counted(&r),
            list(&r),
            theirs.join(", "),
        ));
    }
    if !beyond.is_empty() {
        let r = ratios(&beyond, thesis::WEIGHTED);
        out.push(format!(
            "On the scenes that the thesis did not measure, the promise {}: the learned weight has {} ({}).",
            verdict(&r),
            counted(&r),
            list(&r),
        ));
    }
    let all: Vec<&SceneErrors> = in_table.into_iter().chain(beyond).collect();
    if let Some(best) = &table.best_published {
        let r = ratios(&all, best);
        if let Some(mean) = geometric_mean(r.iter().map(|x| x.1)) {
            let linear = geometric_mean(
                all.iter()
                    .filter_map(|l| l.ratio_linear(thesis::DEEP, best)),
            );
            out.push(format!(
                "Against the best published weight on these scenes ({best}), the learned weight has {}; geometric mean \
                 of the ratios {mean:.2} on the 0–255 scale{}.",
                counted(&r),
                linear.map_or_else(String::new, |l| format!(", {l:.2} in linear light")),
            ));
        }
    }
    out.push(artefacts(rows));
    out
}

fn verdict(ratios: &[(String, f64)]) -> &'static str {
    let kept = ratios.iter().filter(|r| r.1 < 1.0).count();
    if kept == ratios.len() {
        "is kept"
    } else if kept == 0 {
        "is not kept"
    } else {
        "is kept in part"
    }
}

fn counted(ratios: &[(String, f64)]) -> String {
    let kept = ratios.iter().filter(|r| r.1 < 1.0).count();
    format!("the lower error on {kept} of {} scenes", ratios.len())
}

fn list(ratios: &[(String, f64)]) -> String {
    let texts: Vec<String> = ratios
        .iter()
        .map(|(scene, r)| format!("{scene} {r:.2}"))
        .collect();
    texts.join(", ")
}

/// Dark and non-finite pixels of the learned method, the thesis's "black artifacts".
fn artefacts(rows: &[Row]) -> String {
    let of = |method: &str| {
        rows.iter().filter(|r| r.method == method).fold(
            (0u64, 0u64, 0u64),
            |(dark, broken, covered), r| {
                (
                    dark + r.dark_pixels,
                    broken + r.non_finite_pixels,
                    covered + r.covered_pixels,
                )
            },
        )
    };
    let (dark, broken, covered) = of(thesis::DEEP);
    let (dark_weighted, _, _) = of(thesis::WEIGHTED);
    format!(
        "Artefacts: {dark} of {covered} covered pixels are darker than the exact image by more than a quarter of the range \
         with the learned weight, {dark_weighted} with the thesis's analytic weight; {broken} pixels of the learned \
         method are not finite."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::row;

    fn text(deep: [f64; 2]) -> String {
        findings(&[
            row("sixteen-025", "wboit-papakostas", 10.0),
            row("sixteen-025", "deep-thesis", deep[0]),
            row("sixteen-085", "wboit-papakostas", 10.0),
            row("sixteen-085", "deep-thesis", deep[1]),
        ])
        .join("\n")
    }

    #[test]
    fn both_directions_are_told_alike() {
        let good = text([5.0, 5.0]);
        assert_eq!(good.matches("is kept:").count(), 2, "{good}");
        assert!(good.contains("the thesis reports 0.74"), "{good}");
        let bad = text([20.0, 20.0]);
        assert_eq!(bad.matches("is not kept:").count(), 2, "{bad}");
        assert!(bad.contains("sixteen-085 2.00"), "{bad}");
    }
}
