//! What must hold of every method in the hard cases of `peelnet_bench::stress`, and the flaws that methods declare.

use crate::gpu::wgpu;
use crate::methods::{parameter::Precision, spec::MethodSpec};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A property that a method's frames have or lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Property {
    /// No NaN and no infinity in the image, nor in the network's output. Value: 1 where there is one.
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
    /// The network's output in half floats is that in 64 bits. Value: the difference.
    Half,
}

impl fmt::Display for Property {
    /// Its name in small letters, as serde writes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{self:?}").to_lowercase())
    }
}

/// A property that a method does not have in some hard cases.
///
/// A flaw that follows from the method's mathematics is declared for all adapters; one that depends on how an adapter rounds or blends,
/// for the one that it was seen on.
#[derive(Clone, Copy, Debug)]
pub struct Flaw {
    /// The property that does not hold.
    pub property: Property,
    /// Names of the cases, with blanks between them; see [`Flaw::cases`].
    cases: &'static str,
    /// The parameters with which it does not hold.
    pub when: fn(&MethodSpec) -> bool,
    /// Why, with its source.
    pub reason: &'static str,
    /// Whether it was seen on Mesa's software rasteriser alone.
    on_llvmpipe: bool,
}

impl Flaw {
    /// Names of the cases.
    pub fn cases(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.cases.split_whitespace()
    }

    /// The flaw that a method declares of a property in a case on an adapter.
    pub fn declared(
        method: &MethodSpec,
        case: &str,
        property: Property,
        adapter: &wgpu::AdapterInfo,
    ) -> Option<&'static Self> {
        method.method().flaws.iter().find(|flaw| {
            flaw.property == property
                && flaw.cases().any(|c| c == case)
                && (flaw.when)(method)
                && (!flaw.on_llvmpipe || is_llvmpipe(adapter))
        })
    }

    /// A flaw of a method's mathematics, whatever its parameters.
    pub(crate) const fn new(property: Property, cases: &'static str, reason: &'static str) -> Self {
        Self {
            property,
            cases,
            when: |_| true,
            reason,
            on_llvmpipe: false,
        }
    }

    /// The same flaw with some parameters only.
    pub(crate) const fn when(self, when: fn(&MethodSpec) -> bool) -> Self {
        Self { when, ..self }
    }

    /// The same flaw where it was seen only: it depends on how that adapter rounds when it blends.
    pub(crate) const fn seen_on_llvmpipe(self) -> Self {
        Self {
            on_llvmpipe: true,
            ..self
        }
    }

    /// Sums of hundreds of terms in half floats.
    pub(crate) const fn swallowed(cases: &'static str) -> Self {
        let reason = "half floats: a sum of hundreds of terms swallows what is small beside it";
        Self::new(Property::Hull, cases, reason)
            .when(half_sums)
            .seen_on_llvmpipe()
    }

    /// Sums of half floats that depend on the order in which they are rounded.
    pub(crate) const fn reordered(cases: &'static str) -> Self {
        let reason =
            "half floats: every order of drawing rounds a sum of many or of large terms otherwise";
        Self::new(Property::Order, cases, reason)
            .when(half_sums)
            .seen_on_llvmpipe()
    }

    /// Statistics in half floats, whose roundings are magnified where a transmittance is made of them.
    pub(crate) const fn unsettled(property: Property, cases: &'static str) -> Self {
        let reason = "16-bit statistics: what is reconstructed from them magnifies their roundings, and every order of drawing has others";
        Self::new(property, cases, reason)
            .when(half_statistics)
            .seen_on_llvmpipe()
    }

    /// Sums of large weights in half floats.
    pub(crate) const fn overflowing(cases: &'static str) -> Self {
        let reason = "half floats end at 65,504: after 22 layers of weight 3e3 nothing is left but the coverage (McGuire & Bavoil 2013)";
        Self::new(Property::Hull, cases, reason).when(half_sums)
    }

    /// Weights that do not depend on the layers in front.
    pub(crate) const BLIND: Self = Self::new(
        Property::Opaque,
        "alpha-near-one",
        "a weight of depth alone, or of depth and sums, does not know what lies in front (McGuire & Bavoil 2013, section 5)",
    );
}

fn is_llvmpipe(info: &wgpu::AdapterInfo) -> bool {
    let kind = (info.backend, info.device_type);
    let driver = format!("{} {}", info.driver, info.driver_info).to_lowercase();
    kind == (wgpu::Backend::Vulkan, wgpu::DeviceType::Cpu) && driver.contains("llvmpipe")
}

pub(crate) fn half_sums(spec: &MethodSpec) -> bool {
    spec.promises().sums == Precision::Half
}

pub(crate) fn half_statistics(spec: &MethodSpec) -> bool {
    spec.promises().statistics == Precision::Half
}
