//! What must hold of every method in the hard cases of `peelnet_eval::stress`, and the flaws that methods declare.

use peelnet_gpu::{AdapterScope, wgpu};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A property that a method's frames have or lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Property {
    /// No NaN and no infinity in the image, nor in what the network answers. Value: 1 where there is one.
    Finite,
    /// A pixel without fragments keeps `C_0` bit for bit, and the coverage is right. Value: the error of the coverage.
    Background,
    /// The colour lies in the convex hull of the fragments' colours and `C_0`. Value: how far outside, linear light.
    Hull,
    /// A pixel with one fragment is exact. Value: the error, linear light.
    Single,
    /// Neither the reverse nor a shuffled order of drawing changes anything. Value: the largest change, linear light.
    Order,
    /// Exact methods agree with compositing in 64 bits. Value: the error, linear light.
    Exact,
    /// Multiplying all lengths by 1e-3 or 1e3 changes nothing visible. Value: the change on the display, of 255.
    Scale,
    /// No pixel is darker than the darkest of its fragments and `C_0`. Value: by how much, luminance in linear light.
    Dark,
    /// What lies behind nearly opaque layers does not show. Value: the error on the display, of 255.
    Opaque,
    /// The transmittance that the weights stand for is right. Value: the largest error of any fragment.
    Transmittance,
    /// Between two frames of a movement pixels jump by no more than in the exact image. Value: the mean excess, linear light.
    Steady,
    /// The network answers in half floats what it answers in 64 bits. Value: the difference.
    Half,
}

impl Property {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Background => "background",
            Self::Hull => "hull",
            Self::Single => "single",
            Self::Order => "order",
            Self::Exact => "exact",
            Self::Scale => "scale",
            Self::Dark => "dark",
            Self::Opaque => "opaque",
            Self::Transmittance => "transmittance",
            Self::Steady => "steady",
            Self::Half => "half",
        }
    }
}

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A property that does not hold of a method in some hard cases.
///
/// A flaw that follows from the method's mathematics is declared for [`AdapterScope::ANY`]; one that depends on how an adapter
/// rounds or blends, for the adapters that it was seen on.
#[derive(Clone, Copy, Debug)]
pub struct Flaw {
    /// Methods with their parameters; one that ends in `*` stands for all names that begin so.
    pub methods: &'static [&'static str],
    /// Names of the cases.
    pub cases: &'static [&'static str],
    /// The property that does not hold.
    pub property: Property,
    /// Why, with its source.
    pub reason: &'static str,
    /// The adapters on which it does not hold.
    pub adapters: AdapterScope,
}

impl Flaw {
    /// Whether a method's name is among [`Flaw::methods`].
    pub fn names(&self, method: &str) -> bool {
        self.methods.iter().any(|pattern| {
            pattern
                .strip_suffix('*')
                .map_or(*pattern == method, |start| method.starts_with(start))
        })
    }

    /// Whether it says that a method lacks a property in a case on an adapter.
    pub fn is_about(
        &self,
        method: &str,
        case: &str,
        property: Property,
        adapter: &wgpu::AdapterInfo,
    ) -> bool {
        self.property == property
            && self.cases.contains(&case)
            && self.names(method)
            && self.adapters.contains(adapter)
    }
}
