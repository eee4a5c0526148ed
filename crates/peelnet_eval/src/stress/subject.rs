//! A method under test, and what may be asked of it.

use peelnet_model::Model;
use peelnet_render::{LearnedWeight, METHODS, MethodSpec};

/// A method with the network it draws with.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The method and its knobs.
    pub method: MethodSpec,
    /// The network's text and itself, for learned methods.
    pub learned: Option<(LearnedWeight, Model)>,
    /// Whether sums are kept in 16 bits.
    pub(super) half_sums: bool,
    /// Whether statistics are kept in 16 bits.
    half_statistics: bool,
}

impl Subject {
    /// A method as it is drawn.
    pub fn new(method: MethodSpec, learned: Option<(LearnedWeight, Model)>) -> Self {
        let entry = method.entry();
        let targets = method.knob("targets");
        let has_targets = entry.knobs().any(|(knob, _)| knob == "targets");
        // Methods whose statistics have 32 bits by default name 16 bits as a point of their curve.
        let full_statistics = !has_targets || entry.points.contains(&":targets=f16");
        Self {
            // Wavelets have no choice: statistics of 32 bits, sums of 16.
            half_sums: (has_targets || method.name() == "wavelet-3") && targets != Some("f32"),
            half_statistics: targets.map_or(!full_statistics, |t| t == "f16"),
            method,
            learned,
        }
    }

    /// Every method, and every knob of each that changes a precision. Of those with a number, one in the middle.
    pub fn all_methods() -> Vec<MethodSpec> {
        let mut all: Vec<MethodSpec> = Vec::new();
        for entry in METHODS {
            let name = entry.representative();
            let mut names = vec![name.clone()];
            if entry.knobs().any(|(knob, _)| knob == "targets") {
                // One of them may be the default; both are named, so that the rows say what was drawn.
                names = ["f16", "f32"]
                    .map(|t| format!("{name}:targets={t}"))
                    .to_vec();
                if entry.points.contains(&":targets=f16") {
                    // By default 32-bit statistics and 16-bit sums.
                    names.insert(0, name);
                }
            }
            // Made from the list's own names: they parse.
            all.extend(names.iter().filter_map(|n| n.parse().ok()));
        }
        all
    }

    /// Whether it is exact by definition, and not capped.
    pub(super) fn is_exact(&self) -> bool {
        self.method.entry().exact && self.method.knob("passes").is_none() && !self.is_scaled()
    }

    /// Whether transparency is drawn at a lower resolution: pixels then mix their neighbours.
    pub(super) fn is_scaled(&self) -> bool {
        self.method.knob("scale").is_some()
    }

    /// Whether its colour is a mean of the fragments' colours and the background.
    pub(super) fn is_normalised(&self) -> bool {
        !matches!(self.method.name(), "weighted-sum" | "dfaoit") && !self.is_scaled()
    }

    /// Whether a different order of drawing gives the very same operations.
    pub(super) fn sorts(&self) -> bool {
        let sorted_first = self.method.name().starts_with("painter");
        self.is_exact() || (sorted_first && self.method.knob("sort") != Some("off"))
    }

    /// What each addition to the sums rounds by, relative to what is in them.
    pub(super) fn rounding(&self) -> f64 {
        if self.half_sums { HALF } else { FULL }
    }

    /// What roundings of the statistics of `n` fragments may change, as a share of the colour. Positions are roots of a polynomial
    /// of the moments: where roots coincide, a change of the moments moves them by its square root (four moments), or
    /// cube root (six).
    pub(super) fn reconstruction(&self, n: f64) -> f64 {
        let rounding = if self.half_statistics { HALF } else { FULL };
        let roots = match self.method.name() {
            "mboit6" => 3.0,
            "mboit4" | "nmt" | "deep-small" | "deep-medium" | "deep-large" => 2.0,
            _ => return 0.0,
        };
        4.0 * (n * rounding).powf(1.0 / roots)
    }
}

/// Unit roundoff of half floats.
const HALF: f64 = 1.0 / 2048.0;
/// Unit roundoff of 32-bit floats.
const FULL: f64 = 1.0 / 16_777_216.0;
