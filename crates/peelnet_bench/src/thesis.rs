//! The figures of table 4.1 of Papakostas' thesis (Ioannina 2022): mean squared error (0–255) against dual depth
//! peeling, with its 16 models of 11,102 polygons. Its meshes and camera are not known, so absolute values differ
//! from ours, and the ratio of its two columns is what compares.

use crate::{
    Row,
    rows::{Rows, geometric_mean},
};
use peelnet_render::{MethodSpec, role};

/// Table 4.1, by the shipped scenes that are made like its own, whose names end in the opacity of all models: the errors of weighted
/// blending with the thesis's weight and with the network's.
const TABLE: [(&str, [f64; 2]); 3] = [
    ("sixteen-025", [15.96, 11.79]),
    ("sixteen-050", [16.35, 10.50]),
    ("sixteen-075", [13.62, 11.27]),
];

/// The errors of weighted and of learned weighted blending that the thesis has for a shipped scene; `None` where it measured nothing.
pub fn line(scene: &str) -> Option<[f64; 2]> {
    let found = TABLE.into_iter().find(|(name, _)| *name == scene);
    found.map(|(_, errors)| errors)
}

pub const WEIGHTED: &str = role::THESIS_WEIGHT;

pub const DEEP: &str = role::THESIS_NETWORK;

/// A mean of a method over the views of a scene.
pub fn error(rows: &Rows<'_>, scene: &str, method: &str, value: fn(&Row) -> f64) -> Option<f64> {
    let own = rows.of_scene(scene).of_method(method);
    own.mean(|r| Some(value(r)))
}

/// The same as a ratio to that of another method; `None` if either is missing or the divisor 0.
pub fn ratio(
    rows: &Rows<'_>,
    scene: &str,
    [method, reference]: [&str; 2],
    value: fn(&Row) -> f64,
) -> Option<f64> {
    let of = |method| error(rows, scene, method, value);
    let (a, b) = (of(method)?, of(reference)?);
    (b > 0.0).then(|| a / b)
}

/// The published weighted blending with the smallest geometric mean of `mse255` over all scenes.
pub fn best_published<'a>(rows: &Rows<'a>) -> Option<&'a str> {
    let has_weight = |m: &&str| {
        let spec = m.parse::<MethodSpec>();
        spec.is_ok_and(|spec| spec.guarantees().own_weight)
    };
    let errors = rows.methods().into_iter().filter(has_weight);
    let errors = errors.filter_map(|m| {
        let scenes = rows.scenes().into_iter();
        let own: Option<Vec<f64>> = scenes.map(|s| error(rows, s, m, |r| r.mse255)).collect();
        Some((m, geometric_mean(own?)?))
    });
    Some(errors.min_by(|a, b| a.1.total_cmp(&b.1))?.0)
}
