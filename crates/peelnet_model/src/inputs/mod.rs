//! What networks read, one file for each kind of inputs. A kind is one value of [`NetworkInputs`], which answers all that the forward
//! pass, training and the exporter ask of it; its features are declared first in its file.

mod anchored;
mod dfaoit;
mod feature;
mod network_inputs;
mod nmt;
mod one;
mod slabs;
mod surroundings;
mod thesis;

pub use anchored::*;
pub use dfaoit::*;
pub use feature::{About, Feature, Shared, values};
pub use network_inputs::{
    Examples, Forward, GuessedSum, NetworkInputs, Observed, PeeledPixel, PixelSums, RowExample,
};
pub use nmt::*;
pub use one::*;
pub use slabs::*;
pub use surroundings::{Blend, Pass, SmallTexture, Surroundings, Target, Value, ValueKind};
pub use thesis::*;
