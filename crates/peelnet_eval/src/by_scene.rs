//! Errors of every method on every scene: means over the views.

use crate::{Row, geometric_mean, methods_of, scenes_of};
use peelnet_render::MethodSpec;
use std::collections::{BTreeMap, BTreeSet};

/// Figures of one scene, means over its views.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneErrors {
    /// The scene's name.
    pub scene: String,
    /// Number of views that were averaged.
    pub views: usize,
    /// `mse255` of each method, by name.
    pub mse255: BTreeMap<String, f64>,
    /// `mse_linear` of each method, by name.
    pub mse_linear: BTreeMap<String, f64>,
    /// `mse255_covered` of each method, by name; methods without a covered pixel are absent.
    pub mse255_covered: BTreeMap<String, f64>,
}

impl SceneErrors {
    /// Error of one method relative to another on the 0–255 scale; `None` if either is missing or the divisor 0.
    pub fn ratio(&self, method: &str, reference: &str) -> Option<f64> {
        ratio(&self.mse255, method, reference)
    }

    /// The same in linear light.
    pub fn ratio_linear(&self, method: &str, reference: &str) -> Option<f64> {
        ratio(&self.mse_linear, method, reference)
    }
}

fn ratio(values: &BTreeMap<String, f64>, method: &str, reference: &str) -> Option<f64> {
    let (a, b) = (values.get(method)?, values.get(reference)?);
    (*b > 0.0).then(|| a / b)
}

/// All scenes and methods.
#[derive(Clone, Debug, PartialEq)]
pub struct ByScene {
    /// The scenes, in the order of the rows.
    pub scenes: Vec<SceneErrors>,
    /// The methods in the order of the rows.
    pub methods: Vec<String>,
    /// The published weighted blending with the smallest geometric mean error over all scenes.
    pub best_published: Option<String>,
}

impl ByScene {
    /// Averages rows over the views of each scene.
    pub fn of(rows: &[Row]) -> Self {
        let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
        let methods: Vec<String> = owned(methods_of(rows));
        let scenes: Vec<SceneErrors> = scenes_of(rows)
            .into_iter()
            .map(|scene| {
                let own: Vec<&Row> = rows.iter().filter(|r| r.scene == scene).collect();
                let of = |pick: fn(&Row) -> Option<f64>| {
                    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
                    for row in &own {
                        let values = pick(row).into_iter();
                        all.entry(row.method.clone()).or_default().extend(values);
                    }
                    all.retain(|_, values| !values.is_empty());
                    let means = all.into_iter();
                    means
                        .map(|(m, v)| (m, v.iter().sum::<f64>() / v.len() as f64))
                        .collect()
                };
                let views: BTreeSet<u32> = own.iter().map(|r| r.view).collect();
                SceneErrors {
                    views: views.len(),
                    mse255: of(|r| Some(r.mse255)),
                    mse_linear: of(|r| Some(r.mse_linear)),
                    mse255_covered: of(|r| r.mse255_covered),
                    scene: scene.to_owned(),
                }
            })
            .collect();
        let best_published = methods
            .iter()
            .filter(|m| {
                m.parse::<MethodSpec>()
                    .is_ok_and(|spec| spec.promises().own_weight)
            })
            .filter_map(|m| {
                let errors: Option<Vec<f64>> =
                    scenes.iter().map(|s| s.mse255.get(m).copied()).collect();
                Some((m, geometric_mean(errors?)?))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(m, _)| m.clone());
        Self {
            scenes,
            methods,
            best_published,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test may panic")]
    use super::*;
    use crate::row::tests::row;

    #[test]
    fn means_over_views_and_the_best_weight() {
        let errors = ByScene::of(&[
            row("a", 0, "wboit-papakostas", 10.0),
            row("a", 1, "wboit-papakostas", 30.0),
            row("a", 0, "wboit-eq9", 4.0),
            row("a", 1, "wboit-eq9", 6.0),
            row("a", 0, "deep-thesis", 8.0),
            row("a", 1, "deep-thesis", 12.0),
        ]);
        assert_eq!(errors.best_published.as_deref(), Some("wboit-eq9"));
        let a = &errors.scenes[0];
        assert_eq!(a.views, 2);
        assert_eq!(
            (a.mse255["wboit-papakostas"], a.mse255["wboit-eq9"]),
            (20.0, 5.0)
        );
        assert_eq!(a.ratio("deep-thesis", "wboit-eq9"), Some(2.0));
        assert_eq!(a.ratio("deep-thesis", "nothing"), None);
        let none = ByScene::of(&[row("cups", 0, "blended", 1.0)]);
        assert_eq!(none.best_published, None);
    }
}
