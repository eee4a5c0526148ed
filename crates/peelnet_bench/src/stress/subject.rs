//! A method under test, and the limits that follow from its guarantees.

use peelnet_model::Model;
use peelnet_render::{
    LearnedWeight, METHODS, MethodSpec,
    methods::{Guarantees, Precision},
};

/// A method with the network it draws with.
#[derive(Clone, Debug)]
pub struct Subject {
    pub method: MethodSpec,
    /// The network's text and itself, for learned methods.
    pub learned: Option<(LearnedWeight, Model)>,
    pub(super) guarantees: Guarantees,
}

impl Subject {
    pub fn new(method: MethodSpec, learned: Option<(LearnedWeight, Model)>) -> Self {
        Self {
            guarantees: method.guarantees(),
            method,
            learned,
        }
    }

    /// Every method in every precision, and the points of its curve that keep colours otherwise. Of those with a
    /// number, one in the middle of its curve.
    pub fn all_methods() -> Vec<MethodSpec> {
        let mut all: Vec<MethodSpec> = Vec::new();
        for method in METHODS.iter().filter(|m| m.cpu_only.is_none()) {
            let default = MethodSpec::representative(method);
            let kept_otherwise = |ending: &&&str| ending.contains("colors=");
            let points = method.curve.iter().filter(kept_otherwise);
            // A test of the list of methods parses every point.
            all.extend(points.filter_map(|ending| format!("{}{ending}", method.name).parse().ok()));
            if !method.has_targets() {
                all.push(default);
                continue;
            }
            // Where 16 bits for all are a point of the curve of their own, they are not the default.
            if method.curve.iter().any(|c| c.ends_with(":targets=f16")) {
                all.push(default.clone());
            }
            // One of them may be the default; both are named, so that rows state the precision.
            let precisions = ["f16", "f32"].map(|word| default.with("targets", word));
            // The method has the parameter.
            all.extend(precisions.into_iter().flatten());
        }
        all
    }

    /// The rounding of each addition to the sums, relative to the sum.
    pub(super) fn rounding(&self) -> f64 {
        unit_roundoff(self.guarantees.sums)
    }

    /// What roundings of the statistics of `n` fragments may change, as a share of the colour. Positions are roots of a polynomial
    /// of the statistics: where roots coincide, a change of the statistics moves them by its root of the same degree.
    pub(super) fn reconstruction(&self, n: f64) -> f64 {
        let degree = self.guarantees.root.unwrap_or(1);
        let rounding = n * unit_roundoff(self.guarantees.statistics);
        4.0 * rounding.powf(1.0 / f64::from(degree))
    }
}

fn unit_roundoff(precision: Precision) -> f64 {
    match precision {
        Precision::Half => 1.0 / 2048.0,
        Precision::Full => 1.0 / 16_777_216.0,
    }
}
