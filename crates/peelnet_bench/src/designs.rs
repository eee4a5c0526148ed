//! Designs of slabs against one another: what the learned methods keep of a pixel, and what that is worth.
//!
//! Designs are data ([`read`]): one entry each. A caller trains the network of an entry ([`Entry::recipe`]) and measures it here
//! ([`Entry::measure`]) on whole frames that [`peel`] holds in memory. Pixels are composited on the CPU with statistics rounded as 16-bit
//! targets round them; colours are not rounded. The errors are ratios to those of two references on the same fragments ([`MOMENTS`] and
//! [`KBUFFER`]), composited by their CPU references.

mod file;
mod ranges;
#[cfg(test)]
mod tests;
mod views;

pub use file::{parse, read, shipped};
pub use ranges::Source;
pub use views::{Measured, Stacked, View, peel, score};

use peelnet_core::{
    methods::slabs::{self, Design, Interior},
    statistics::SumPrecision,
};
use peelnet_model::{Model, Recipe, inputs::Feature};

pub use crate::{
    records::{DesignRow as Row, Designs, Reference, Score},
    rows::MOMENTS,
};
pub use peelnet_core::methods::slabs::Kept;

/// The method that keeps the nearest four fragments, which errors are compared with as well.
pub const KBUFFER: &str = "kbuffer-4";

/// The learned method that two geometry passes draw, which flicker is compared with.
pub const ANCHORED: &str = "deep-anchored-medium";

/// By how many pixels what the camera looks at moves between two frames that are compared.
pub const MOTIONS: [f32; 2] = [0.1, 1.0];

/// Where the shipped designs lie in the repository.
pub const DESIGNS: &str = "data/designs.toml";

#[derive(Clone, Debug)]
pub struct Entry {
    pub name: String,
    pub design: Design,
    /// What is cut into slabs. A network of [`Source::Frame`] learns among the quantiles of tiles, one of [`Source::Boxes`] between the pixel's ends.
    pub source: Source,
    pub inputs: &'static [&'static Feature<Interior>],
    /// What is trained; its examples may be gathered with the sums apart where the design has one sum.
    pub recipe: Recipe,
    /// Decides initial weights and the order of examples.
    pub seed: u64,
}

impl Entry {
    /// The error of a view with this network, and how it moves; or without one (the middle of the bounds), still.
    ///
    /// # Panics
    /// If the model has other inputs.
    pub fn measure(&self, view: &View, model: Option<&Model>) -> Measured {
        let composite = |stack: &Stacked<'_>| {
            let design = Design {
                extent: stack.extent(self.source, self.design.extent),
                ..self.design
            };
            slabs::composite_on(
                stack.fragments(),
                [0.0; 3],
                |depth| stack.zeta(depth),
                design,
                SumPrecision::Half,
                |between| match model {
                    Some(model) => model.answer(self.inputs, between),
                    None => slabs::middle(between),
                },
            )
        };
        match model {
            Some(_) => view.measure_moving(composite),
            None => view.measure(composite),
        }
    }
}

impl Row {
    pub fn new(entry: &Entry, model: &Model, network: Score, middle: Score) -> Self {
        let (design, recipe) = (&entry.design, entry.recipe);
        let inputs = recipe.input_names().into_iter();
        Self {
            design: entry.name.clone(),
            slabs: design.slabs.to_vec(),
            records: format!("{}x{}", design.records.bins, design.records.alphas),
            range: entry.source.name().to_owned(),
            apart: design.apart,
            trained_apart: recipe.inputs.known_apart(),
            bytes: design.bytes() - u32::from(entry.source == Source::Frame),
            inputs: inputs.map(str::to_owned).collect(),
            topology: model.mlp.topology(),
            parameters: model.mlp.parameters() as u64,
            loss: recipe.loss.unwrap_or_default(),
            seed: entry.seed,
            examples: 0,
            seconds: 0.0,
            network,
            middle,
        }
    }
}
