//! All that differs between kinds of inputs.

use super::{feature::About, surroundings::Surroundings};
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::Fragment,
    methods::{
        known::KnownFragment,
        moments::{self, Settings},
        one::Around,
    },
    statistics::SumPrecision,
};
use std::{any::Any, fmt};

/// A kind of inputs. What must hold of one: `CONTRIBUTING.md`, "Add a feature to a recipe".
pub trait NetworkInputs: Any + fmt::Debug + Sync {
    /// Names, units and WGSL of the features, in order.
    fn features(&self) -> Vec<&'static About>;

    /// What surrounds the network in an exported text, and what a renderer does around that text.
    fn surroundings(&self) -> &'static Surroundings;

    /// What is known of each fragment of a pixel, in the fragments' order, and the raw inputs where the network says a fraction.
    fn known(&self, _pixel: &Observed<'_>) -> Vec<KnownFragment<Vec<f64>>> {
        Vec::new()
    }

    /// The weight of every fragment of a pixel, an estimate of the transmittance in front of it. Empty where the network predicts none.
    fn transmittances(&self, pixel: &Observed<'_>, network: Forward<'_>) -> Vec<f64> {
        let known = self.known(pixel).into_iter();
        known.map(|f| f.weight(|inputs| network(inputs))).collect()
    }

    /// What a recipe learns from a pixel.
    fn examples(&self, pixel: &PeeledPixel<'_>) -> Examples {
        Examples::Pixel(self.known(&pixel.observed))
    }

    /// Whether the inputs are columns of a dataset as they are: the network is evaluated in 32 bits as published, examples have no weights,
    /// and nothing depends on warped depth.
    fn are_columns(&self) -> bool {
        false
    }

    /// Whether they depend on [`Observed::around`]. Not asked of [`Self::surroundings`], which designs that are only compared do not have.
    fn reads_around(&self) -> bool {
        false
    }

    /// Whether fragments whose weight is known without the network have sums of their own, which are not normalised with the others'.
    fn known_apart(&self) -> bool {
        false
    }

    /// The colour of a pixel over black without the network, whose error says how hard the pixel is: drawn by MBOIT-4.
    fn baseline(&self, pixel: &PeeledPixel<'_>) -> [f64; 3] {
        let fragments = pixel.observed.fragments;
        let t = moments::transmittances(fragments, &pixel.observed.warp, &Settings::FOUR);
        let drawn = fragments.iter().zip(t);
        let drawn: Vec<f64> = drawn.map(|((_, alpha), t)| f64::from(*alpha) * t).collect();
        let scale = (1.0 - pixel.transmittance_behind()) / drawn.iter().sum::<f64>().max(1e-12);
        let mut sum = [0.0; 3];
        for (drawn, color) in drawn.iter().zip(pixel.colors) {
            for (sum, &c) in sum.iter_mut().zip(color) {
                *sum += drawn * scale * f64::from(c);
            }
        }
        sum
    }

    /// The colour of a pixel of which nothing is known of those around, where it is no weighted mean of its fragments' colours.
    fn color(
        &self,
        _fragments: &[Fragment],
        _background: [f32; 3],
        _warp: &DepthWarp,
        _network: Forward<'_>,
    ) -> Option<[f32; 3]> {
        None
    }

    /// What targets hold after all fragments, by their names in the surroundings, where a self-test says it.
    fn target_values(&self, _pixel: &Observed<'_>) -> Vec<(&'static str, Vec<f32>)> {
        Vec::new()
    }
}

impl dyn NetworkInputs {
    /// These inputs, if they are of that kind.
    pub fn downcast<T: NetworkInputs>(&self) -> Option<&T> {
        (self as &dyn Any).downcast_ref()
    }
}

/// The first output of a network for raw inputs.
pub type Forward<'a> = &'a dyn Fn(&[f64]) -> f64;

/// A pixel as geometry passes see it.
#[derive(Clone, Copy, Debug)]
pub struct Observed<'a> {
    /// Linear depth and opacity, in any order.
    pub fragments: &'a [(f32, f32)],
    /// Over the frame's range of depth.
    pub warp: DepthWarp,
    /// How sums are kept.
    pub precision: SumPrecision,
    /// What is known of the pixels around it.
    pub around: Around,
}

/// A pixel of a dataset, nearest fragment first.
#[derive(Clone, Copy, Debug)]
pub struct PeeledPixel<'a> {
    /// Depths and opacities.
    pub observed: Observed<'a>,
    /// `T_i`.
    pub transmittance: &'a [f32],
    /// Un-premultiplied radiance.
    pub colors: &'a [[f32; 3]],
    /// The pixel's sum of opacities as each row has it.
    pub alpha_sum: &'a [f32],
    /// The number of its fragments, likewise.
    pub fragment_count: &'a [u32],
}

impl PeeledPixel<'_> {
    /// `T_∞`.
    pub fn transmittance_behind(&self) -> f64 {
        let mut fragments = self.observed.fragments.iter().zip(self.transmittance);
        let last = fragments.next_back();
        last.map_or(1.0, |((_, alpha), t)| {
            f64::from(*t) * f64::from(1.0 - alpha)
        })
    }

    /// `α_i T_i`: how much of each fragment is seen.
    pub fn contributions(&self) -> impl Iterator<Item = f64> + '_ {
        let fragments = self.observed.fragments.iter().zip(self.transmittance);
        fragments.map(|((_, alpha), t)| f64::from(*alpha) * f64::from(*t))
    }
}

/// What a recipe learns from a pixel.
#[derive(Clone, Debug, PartialEq)]
pub enum Examples {
    /// Every row is an example.
    Rows(Vec<RowExample>),
    /// The pixel is one example: all of its fragments, nearest first.
    Pixel(Vec<KnownFragment<Vec<f64>>>),
    /// The pixel is one example: sums of its fragments.
    Sums(PixelSums),
}

/// Sums of a pixel that a network is asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelSums {
    /// The sums.
    pub sums: Vec<GuessedSum>,
    /// Coverage that is theirs.
    pub left: f64,
    /// The exact colour without what is known.
    pub color: [f64; 3],
}

/// A sum of which `weight e^(−absorbance · answer)` is seen, before normalisation.
#[derive(Clone, Debug, PartialEq)]
pub struct GuessedSum {
    /// Raw inputs.
    pub inputs: Vec<f64>,
    /// What an answer of 1 puts in front of it.
    pub absorbance: f64,
    /// Its own absorbance.
    pub weight: f64,
    /// Mean colour.
    pub color: [f64; 3],
    /// How much of it is seen.
    pub exact: f64,
}

/// An example that is a row.
#[derive(Clone, Debug, PartialEq)]
pub struct RowExample {
    /// Raw inputs.
    pub inputs: Vec<f64>,
    /// What the network should answer.
    pub targets: Vec<f64>,
}
