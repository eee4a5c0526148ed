//! Recipes: each network is one declaration of its inputs, output, shape, loss and training budget.
//!
//! What trains, exports, draws and documents networks reads these declarations. It distinguishes recipes by what their
//! networks read ([`NetworkInputs`]) and answer ([`Output`]), never by name. To add one, see `CONTRIBUTING.md`.

use std::{fmt, ops::Deref, str::FromStr};

use peelnet_core::{
    methods::{one, slabs::Design},
    mlp::Activation,
    statistics::SumPrecision,
};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::inputs::{
    AnchoredInputs, DfaoitInputs, FIVE, NINE, NetworkInputs, NmtInputs, OneInputs, SlabInputs,
    ThesisInputs,
};
use crate::output::Output;

/// The shape of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Network {
    /// Widths of the hidden layers.
    pub hidden: &'static [usize],
    /// After each hidden layer.
    pub hidden_activation: Activation,
    /// After the last layer.
    pub output_activation: Activation,
}

/// How long and how fast a network is trained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Passes over the training examples.
    pub epochs: u32,
    /// Examples per step of the optimiser.
    pub batch: usize,
    /// Examples evaluated at once.
    pub chunk: usize,
    /// Adam's step size; the peak where a schedule changes it.
    pub learning_rate: f64,
    /// Share of the steps in which the step size rises, with a one-cycle schedule; none for a constant one.
    pub warmup: Option<f64>,
    /// Share of the examples held out for testing.
    pub held_out: f64,
    /// Share of the examples that choices are made by.
    pub validation: f64,
}

/// The loss of a whole pixel, with `k_i` a fragment's contribution before normalisation, `p̂_i` after it and `α_i T_i` the exact
/// one. Sums go over the fragments that the network is asked about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PixelLoss {
    /// Squared error of the pixel's colour, `|Σ (p̂_i − α_i T_i) c_i|² / 3`.
    #[default]
    Image,
    /// `Σ (p̂_i − α_i T_i)²`.
    Contributions,
    /// Squared error of T, weighted by opacity: `Σ (k_i − α_i T_i)²`.
    WeightedTransmittance,
    /// Squared error of what the network answers, the transmittance of the rest in front.
    Transmittance,
}

impl PixelLoss {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Image,
        Self::Contributions,
        Self::WeightedTransmittance,
        Self::Transmittance,
    ];
}

/// The name in files and on the command line.
impl fmt::Display for PixelLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

impl FromStr for PixelLoss {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|l| l.to_string() == name);
        let names = || Self::ALL.map(|l| l.to_string()).join(", ");
        found.ok_or_else(|| format!("no such loss; there are {}", names()))
    }
}

/// All that is known of a recipe.
#[derive(Debug)]
pub struct Declaration {
    /// The name in files and on the command line.
    pub name: &'static str,
    /// The name of the rendering method that draws with such a network.
    pub method: &'static str,
    /// What the network reads.
    pub inputs: &'static dyn NetworkInputs,
    /// What the network answers.
    pub output: Output,
    /// How the method keeps its sums by default; networks train on what they will read.
    pub sums: SumPrecision,
    /// The network's shape.
    pub network: Network,
    /// Its training.
    pub budget: Budget,
    /// What training minimises where the examples are whole pixels; the squared error of the output elsewhere.
    pub loss: Option<PixelLoss>,
}

/// A recipe: a reference to its [`Declaration`], known by its name.
#[derive(Clone, Copy)]
pub struct Recipe(&'static Declaration);

/// Budgets that were chosen on validation pixels.
const PIXELS: Budget = Budget {
    epochs: 24,
    batch: 1024,
    chunk: 256,
    learning_rate: 4e-3,
    warmup: Some(0.2),
    held_out: 0.1,
    validation: 0.1,
};

/// Of the competitors: neither half nor twice the rate gains anything (docs/learned-weights.md).
const COMPETITORS: Budget = Budget {
    epochs: 80,
    learning_rate: 3.2e-2,
    ..PIXELS
};

const fn relu(hidden: &'static [usize], output_activation: Activation) -> Network {
    Network {
        hidden,
        hidden_activation: Activation::Relu,
        output_activation,
    }
}

/// What the networks of fractions have in common; the inputs are those of the anchored ones.
const FRACTIONS: Declaration = Declaration {
    name: "",
    method: "",
    inputs: &AnchoredInputs {
        separate_extremes: false,
    },
    output: Output::BoundedShare,
    sums: SumPrecision::Half,
    network: relu(&[12], Activation::Sigmoid),
    budget: PIXELS,
    loss: Some(PixelLoss::Image),
};

/// What the competitors' networks have in common.
const COMPETITOR: Declaration = Declaration {
    output: Output::Transmittance,
    sums: SumPrecision::Exact,
    network: relu(&[32, 16], Activation::Sigmoid),
    budget: COMPETITORS,
    loss: None,
    ..FRACTIONS
};

impl Recipe {
    /// Papakostas 2022, with the published network and settings.
    pub const THESIS: Self = Self(&Declaration {
        name: "thesis",
        method: "deep-thesis",
        inputs: &ThesisInputs,
        output: Output::Transmittance,
        sums: SumPrecision::Exact,
        network: relu(&[10, 8], Activation::Identity),
        budget: Budget {
            epochs: 150,
            batch: 128,
            chunk: 2048,
            learning_rate: 1e-4,
            warmup: None,
            held_out: 1.0 / 3.0,
            validation: 0.0,
        },
        loss: None,
    });

    /// Three slabs in 38 bytes a pixel. No hidden layer: a larger network errs no less where so little is kept, and a formula of six numbers takes
    /// less time.
    pub const SMALL: Self = Self(&Declaration {
        name: "small",
        method: "deep-small",
        inputs: &SlabInputs {
            design: Design::SMALL,
            features: &FIVE,
        },
        network: relu(&[], Activation::Sigmoid),
        ..FRACTIONS
    });

    /// Three slabs in 42 bytes a pixel: the default.
    pub const MEDIUM: Self = Self(&Declaration {
        name: "medium",
        method: "deep-medium",
        inputs: &SlabInputs {
            design: Design::MEDIUM,
            features: &NINE,
        },
        network: relu(&[13], Activation::Sigmoid),
        ..FRACTIONS
    });

    /// Four slabs in 50 bytes a pixel: the best image.
    pub const LARGE: Self = Self(&Declaration {
        name: "large",
        method: "deep-large",
        inputs: &SlabInputs {
            design: Design::LARGE,
            features: &NINE,
        },
        ..FRACTIONS
    });

    /// Three sums of one geometry pass.
    pub const ONE: Self = Self(&Declaration {
        name: "one",
        method: "deep-one",
        inputs: &OneInputs {
            design: one::Design::ONE,
        },
        output: Output::AnchoredShare,
        ..FRACTIONS
    });

    /// Six.
    pub const ONE_WIDE: Self = Self(&Declaration {
        name: "one-wide",
        method: "deep-one-wide",
        inputs: &OneInputs {
            design: one::Design::WIDE,
        },
        output: Output::AnchoredShare,
        ..FRACTIONS
    });

    /// The pixel's moments and its two ends: the cheapest network that beats moments.
    pub const ANCHORED_SMALL: Self = Self(&Declaration {
        name: "anchored-small",
        method: "deep-anchored-small",
        output: Output::AnchoredShare,
        network: relu(&[8], Activation::Sigmoid),
        ..FRACTIONS
    });

    /// The same inputs, separate ends.
    pub const ANCHORED_MEDIUM: Self = Self(&Declaration {
        name: "anchored-medium",
        method: "deep-anchored-medium",
        inputs: &AnchoredInputs {
            separate_extremes: true,
        },
        output: Output::AnchoredShareSeparateEnds,
        ..FRACTIONS
    });

    /// Tsopouridis et al. 2024, "Neural Moment Transparency": transmittance from four moments.
    pub const NMT: Self = Self(&Declaration {
        name: "nmt",
        method: "nmt",
        inputs: &NmtInputs,
        // Its authors' own; with the loss of the image its answers are weights, and no transmittances.
        loss: Some(PixelLoss::Transmittance),
        ..COMPETITOR
    });

    /// Tsopouridis et al. 2024, "Deep and Fast Approximate Order Independent Transparency": the colour of a pixel.
    pub const DFAOIT: Self = Self(&Declaration {
        name: "dfaoit",
        method: "dfaoit",
        inputs: &DfaoitInputs,
        output: Output::Color,
        ..COMPETITOR
    });

    /// All recipes.
    pub const ALL: [Self; 10] = [
        Self::THESIS,
        Self::SMALL,
        Self::MEDIUM,
        Self::LARGE,
        Self::ONE,
        Self::ONE_WIDE,
        Self::ANCHORED_SMALL,
        Self::ANCHORED_MEDIUM,
        Self::NMT,
        Self::DFAOIT,
    ];

    /// A recipe that is not in [`Self::ALL`], to train networks that do not ship. The name must be no other recipe's. A model of it can be
    /// used by the program that trained it; its file is refused, because the file names the recipe only.
    pub const fn new(declaration: &'static Declaration) -> Self {
        Self(declaration)
    }

    /// The recipe of a rendering method, if it draws with a network.
    pub fn for_method(method: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|r| r.method == method)
    }

    /// The names of the inputs, in order.
    pub fn input_names(self) -> Vec<&'static str> {
        let features = self.inputs.features().into_iter();
        features.map(|about| about.name).collect()
    }
}

impl Deref for Recipe {
    type Target = Declaration;

    fn deref(&self) -> &Declaration {
        self.0
    }
}

impl PartialEq for Recipe {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Recipe {}

impl fmt::Debug for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}

impl FromStr for Recipe {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|r| r.name == text);
        found.ok_or_else(|| {
            let names = Self::ALL.map(|r| r.name).join(", ");
            format!("recipe {text:?}: expected one of {names}")
        })
    }
}

impl Serialize for Recipe {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

impl<'de> Deserialize<'de> for Recipe {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        name.parse().map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What everything that reads the declarations relies on.
    #[test]
    fn declarations_hold_together() {
        for recipe in Recipe::ALL {
            assert_eq!(recipe.name.parse(), Ok(recipe));
            assert_eq!(Recipe::for_method(recipe.method), Some(recipe));
            let names = recipe.input_names();
            for (i, name) in names.iter().enumerate() {
                assert!(!names[..i].contains(name), "{recipe} reads {name} twice");
            }
            let fractions = recipe.output.is_fraction();
            assert!(!fractions || recipe.loss.is_some(), "{recipe}");
            let separate = recipe.output == Output::AnchoredShareSeparateEnds;
            assert_eq!(recipe.inputs.known_apart(), separate, "{recipe}");
            assert!(!fractions || names[0] == "root_absorbance", "{recipe}");
            let bounded = recipe.output == Output::BoundedShare;
            let bounds = ["share_low", "share_high"];
            assert!(!bounded || names[3..5] == bounds, "{recipe}");
        }
    }
}
