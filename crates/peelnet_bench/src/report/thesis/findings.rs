//! What the figures say about the thesis's promise, in sentences computed from the rows.
//!
//! The promise is that the network's weight errs less than weighted blending with the thesis's analytic weight. The
//! sentences state counts and ratios in both directions alike.

use super::{best_published, published, ratio};
use crate::{
    Row,
    rows::{Rows, geometric_mean},
};
use peelnet_render::role::{THESIS_NETWORK, THESIS_WEIGHT};

pub(super) fn findings<'a>(rows: &'a [Row]) -> Vec<String> {
    let rows = &Rows::new(rows);
    let mut out = Vec::new();
    let both = |scene: &&str| {
        let methods = [THESIS_NETWORK, THESIS_WEIGHT];
        ratio(rows, scene, methods, |r| r.mse255).is_some()
    };
    let scenes = rows.scenes().into_iter().filter(both);
    let (in_table, beyond): (Vec<&str>, Vec<&str>) =
        scenes.partition(|scene| published(scene).is_some());
    if in_table.is_empty() && beyond.is_empty() {
        return vec![
            "The learned method or weighted blending with the thesis's weight was not drawn, so nothing can be said \
             about the thesis's promise."
                .to_owned(),
        ];
    }
    let ratios = |scenes: &[&'a str], reference: &str| -> Vec<(&'a str, f64)> {
        let ratio = |scene| ratio(rows, scene, [THESIS_NETWORK, reference], |r| r.mse255);
        let scenes = scenes.iter();
        scenes.filter_map(|&s| Some((s, ratio(s)?))).collect()
    };
    if !in_table.is_empty() {
        let (verdict, counted, list) = summary(&ratios(&in_table, THESIS_WEIGHT));
        let theirs = in_table.iter().filter_map(|scene| published(scene));
        let theirs = theirs.map(|[weighted, deep]| format!("{:.2}", deep / weighted));
        let theirs: Vec<String> = theirs.collect();
        out.push(format!(
            "On the scenes that the thesis measured, its promise {verdict}: the learned weight has {counted} (learned / analytic: {list}; \
             the thesis reports {}).",
            theirs.join(", "),
        ));
    }
    if !beyond.is_empty() {
        let (verdict, counted, list) = summary(&ratios(&beyond, THESIS_WEIGHT));
        out.push(format!(
            "On the scenes that the thesis did not measure, the promise {verdict}: the learned weight has {counted} ({list})."
        ));
    }
    let all = [in_table, beyond].concat();
    if let Some(best) = best_published(rows) {
        let r = ratios(&all, best);
        if let Some(mean) = geometric_mean(r.iter().map(|x| x.1)) {
            let linear =
                |scene: &&str| ratio(rows, scene, [THESIS_NETWORK, best], |r| r.mse_linear);
            let linear = geometric_mean(all.iter().filter_map(linear));
            out.push(format!(
                "Against the best published weight on these scenes ({best}), the learned weight has {}; geometric mean \
                 of the ratios {mean:.2} on the 0–255 scale{}.",
                summary(&r).1,
                linear.map_or_else(String::new, |l| format!(", {l:.2} in linear light")),
            ));
        }
    }
    out.push(artefacts(rows));
    out
}

/// Whether the promise is kept, on how many scenes the error is lower, and the ratio of each scene.
fn summary(ratios: &[(&str, f64)]) -> (&'static str, String, String) {
    let kept = ratios.iter().filter(|r| r.1 < 1.0).count();
    let verdict = match kept {
        n if n == ratios.len() => "is kept",
        0 => "is not kept",
        _ => "is kept in part",
    };
    let counted = format!("the lower error on {kept} of {} scenes", ratios.len());
    let list: Vec<String> = ratios.iter().map(|(s, r)| format!("{s} {r:.2}")).collect();
    (verdict, counted, list.join(", "))
}

/// Dark and non-finite pixels of the learned method, the thesis's "black artifacts".
fn artefacts(rows: &Rows<'_>) -> String {
    let of = |method: &str, count: fn(&Row) -> u64| -> u64 {
        rows.of_method(method).0.into_iter().map(count).sum()
    };
    let [dark, dark_weighted] = [THESIS_NETWORK, THESIS_WEIGHT].map(|m| of(m, |r| r.dark_pixels));
    let broken = of(THESIS_NETWORK, |r| r.non_finite_pixels);
    let covered = of(THESIS_NETWORK, |r| r.covered_pixels);
    format!(
        "Artefacts: {dark} of {covered} covered pixels are darker than the exact image by more than a quarter of the range \
         with the learned weight, {dark_weighted} with the thesis's analytic weight; {broken} pixels of the learned \
         method are not finite."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::testing::row;

    #[test]
    fn both_directions_are_told_alike() {
        for (error, verdict, words) in [
            (5.0, "is kept:", "the thesis reports 0.74"),
            (20.0, "is not kept:", "sixteen-085 2.00"),
        ] {
            let rows = ["sixteen-025", "sixteen-085"].map(|scene| {
                let deep = row(scene, "deep-thesis", error);
                [row(scene, "wboit-papakostas", 10.0), deep]
            });
            let text = findings(rows.as_flattened()).join("\n");
            assert_eq!(text.matches(verdict).count(), 2, "{text}");
            assert!(text.contains(words), "{text}");
        }
    }
}
