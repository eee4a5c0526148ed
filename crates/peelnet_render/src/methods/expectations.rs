//! What must hold of every method in the stress cases of `peelnet_bench::stress`: what methods guarantee, their CPU references, and the
//! failures that are known.

use super::{parameter::Precision, spec::MethodSpec};
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::{Fragment, points},
    methods::composite,
};
use peelnet_model::Model;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What tests, `peelnet stress` and help texts expect of a method.
#[derive(Clone, Copy, Debug)]
pub struct Expectations {
    /// What it guarantees, before a choice of targets or a lower resolution; see [`MethodSpec::guarantees`].
    pub guarantees: fn(&MethodSpec) -> Guarantees,
    /// Its CPU reference.
    pub reference: Option<Reference>,
    /// Its estimate of every fragment's transmittance.
    pub estimate: Option<Estimate>,
    /// Properties that it is known not to have.
    pub known_failures: &'static [KnownFailure],
}

impl Expectations {
    /// Normalised sums in 16 bits, no CPU reference, no failure.
    pub(crate) const DEFAULT: Self = Self {
        guarantees: |_| Guarantees::NORMALISED,
        reference: None,
        estimate: None,
        known_failures: &[],
    };

    /// The same with failures that are known.
    pub(crate) const fn failing(self, known_failures: &'static [KnownFailure]) -> Self {
        Self {
            known_failures,
            ..self
        }
    }
}

/// The colour that a pixel must have; `None` without the model that a learned method needs.
pub type Reference = fn(&MethodSpec, &Pixel<'_>) -> Option<[f32; 3]>;

/// The transmittance in front of each fragment, given as (linear depth, α), nearest first; `None` without the model that a
/// learned method needs.
pub type Estimate = fn(&MethodSpec, &[(f32, f32)], &DepthWarp, Option<&Model>) -> Option<Vec<f64>>;

/// The CPU reference of a method whose weights are its estimates of transmittance.
pub(crate) fn weighted_reference(spec: &MethodSpec, p: &Pixel<'_>) -> Option<[f32; 3]> {
    let t = spec.transmittances(&points(p.fragments), &p.warp, p.model)?;
    Some(composite(p.fragments, p.background, &t))
}

/// What a CPU reference composites.
#[derive(Clone, Copy, Debug)]
pub struct Pixel<'a> {
    /// The transparent fragments, in the order of drawing.
    pub fragments: &'a [Fragment],
    /// `C_0`.
    pub background: [f32; 3],
    /// The warp of the view's depths.
    pub warp: DepthWarp,
    /// Its position in the frame.
    pub position: [u32; 2],
    /// The network of a learned method.
    pub model: Option<&'a Model>,
}

/// What a method guarantees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guarantees {
    /// Every pixel equals the composite of its sorted fragments in 64 bits.
    pub exact: bool,
    /// The order of drawing does not matter.
    pub order_independent: bool,
    /// It sorts what it draws: another order of drawing gives the very same operations.
    pub sorted: bool,
    /// It blends into the target itself, in that target's precision; images are of the precision that `targets` says.
    pub straight: bool,
    /// A pixel is made of its own fragments alone.
    pub per_pixel: bool,
    /// A pixel's colour is a mean of its fragments' colours and `C_0`: it lies in their convex hull.
    pub normalised: bool,
    /// It draws light that takes a colour where it passes through surfaces.
    pub tinted: bool,
    /// Pixels that hold the same fragments may differ: it draws random numbers of the pixel's position.
    pub noisy: bool,
    /// Precision of the sums of colour.
    pub sums: Precision,
    /// Precision of the statistics that transmittance is estimated from.
    pub statistics: Precision,
    /// The estimate is a root of a polynomial of the statistics: where roots coincide, an error of the statistics moves them
    /// by its root of this degree.
    pub root: Option<u32>,
    /// Its estimate of transmittance is held to a fraction of the limits that published methods are held to.
    pub close_estimate: bool,
    /// How much of its own absorbance a fragment counts as in front of it, given exact statistics.
    pub own_share: f64,
    /// Fragments are rounded before they are composited, by its CPU reference too.
    pub rounds_fragments: bool,
    /// The nearest fragment's colour is kept in the steps of [`one`](peelnet_core::methods::one::step), hidden by noise.
    pub nearest_in_steps: bool,
    /// A fragment's weight is a formula of its own depth and opacity (McGuire & Bavoil 2013).
    pub own_weight: bool,
    /// It takes a pass over the geometry for every layer or two: pixels of many layers take as many.
    pub peels: bool,
}

impl Guarantees {
    /// Of exact methods, whose fragments are kept in 32 bits.
    pub(crate) const EXACT: Self = Self {
        exact: true,
        order_independent: true,
        sorted: true,
        straight: false,
        per_pixel: true,
        normalised: true,
        tinted: false,
        noisy: false,
        sums: Precision::Full,
        statistics: Precision::Full,
        root: None,
        close_estimate: false,
        own_share: 0.0,
        rounds_fragments: false,
        nearest_in_steps: false,
        own_weight: false,
        peels: false,
    };

    /// Of methods that normalise sums kept in 16 bits.
    pub(crate) const NORMALISED: Self = Self {
        exact: false,
        sorted: false,
        sums: Precision::Half,
        statistics: Precision::Half,
        ..Self::EXACT
    };

    /// The same of methods that also draw light which takes a colour.
    pub(crate) const TINTED: Self = Self {
        tinted: true,
        ..Self::NORMALISED
    };
}

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
    /// Neither the reverse nor a shuffled order of drawing changes anything. Value: the change that is farthest beyond its limit, linear light or
    /// on the display, of 255.
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
    /// The image errs by hardly more than it did when a table of errors was made. Value: the root of the mean squared error on the display, of 255.
    Image,
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

/// A property that a method does not have in some stress cases.
///
/// They were listed on Mesa's software rasteriser; those that [are elsewhere](KnownFailure::is_elsewhere) on an NVIDIA H200. One that depends on
/// how an adapter rounds or blends may hold on another.
#[derive(Clone, Copy, Debug)]
pub struct KnownFailure {
    /// The property that does not hold.
    pub property: Property,
    /// Names of the cases, with blanks between them; see [`KnownFailure::cases`].
    cases: &'static str,
    /// The parameters with which it does not hold.
    pub when: fn(&MethodSpec) -> bool,
    /// It was seen on other adapters than the software rasteriser, where it is none that is known.
    pub is_elsewhere: bool,
    /// Why, with its source.
    pub reason: &'static str,
}

impl KnownFailure {
    /// Names of the cases.
    pub fn cases(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.cases.split_whitespace()
    }

    /// The failure that is known of a method's property in a case, on Mesa's software rasteriser or on other adapters.
    pub fn find(
        method: &MethodSpec,
        case: &str,
        property: Property,
        on_software: bool,
    ) -> Option<&'static Self> {
        let mut known = method.method().expectations.known_failures.iter();
        known.find(|failure| {
            failure.property == property
                && !(failure.is_elsewhere && on_software)
                && failure.cases().any(|c| c == case)
                && (failure.when)(method)
        })
    }

    /// A failure of a method's mathematics, whatever its parameters.
    pub(crate) const fn new(property: Property, cases: &'static str, reason: &'static str) -> Self {
        Self {
            property,
            cases,
            when: |_| true,
            is_elsewhere: false,
            reason,
        }
    }

    /// The same failure with some parameters only.
    pub(crate) const fn when(self, when: fn(&MethodSpec) -> bool) -> Self {
        Self { when, ..self }
    }

    /// The same failure on other adapters than the software rasteriser.
    pub(crate) const fn elsewhere(self) -> Self {
        Self {
            is_elsewhere: true,
            ..self
        }
    }

    /// What lies behind nearly opaque layers shows.
    pub(crate) const fn translucent(reason: &'static str) -> Self {
        Self::new(Property::Opaque, "alpha-near-one lines", reason)
    }

    /// Of polygons on both sides of a line, some in front of it are taken for hidden ones, or the reverse.
    pub(crate) const fn lines(reason: &'static str) -> Self {
        Self::new(Property::Opaque, "lines", reason)
    }

    /// Coincident fragments depend on the order of drawing.
    pub(crate) const fn coincident(reason: &'static str) -> Self {
        Self::new(Property::Order, "coplanar", reason)
    }

    /// Sums of hundreds of terms in half floats.
    pub(crate) const fn swallowed(cases: &'static str) -> Self {
        let reason = "half floats: a sum of hundreds of terms swallows what is small beside it";
        Self::new(Property::Hull, cases, reason).when(half_sums)
    }

    /// Sums of half floats that depend on the order in which they are rounded.
    pub(crate) const fn reordered(cases: &'static str) -> Self {
        let reason =
            "half floats: every order of drawing rounds a sum of many or of large terms otherwise";
        Self::new(Property::Order, cases, reason).when(half_sums)
    }

    /// Statistics in half floats, whose roundings are magnified where a transmittance is made of them.
    pub(crate) const fn unsettled(property: Property, cases: &'static str) -> Self {
        let reason = "16-bit statistics: what is reconstructed from them magnifies their roundings, and every order of drawing has others";
        Self::new(property, cases, reason).when(half_statistics)
    }

    /// Sums of large weights in half floats.
    pub(crate) const fn overflowing(cases: &'static str) -> Self {
        let reason = "half floats end at 65,504: after 22 layers of weight 3e3 nothing is left but the coverage (McGuire & Bavoil 2013)";
        Self::new(Property::Hull, cases, reason).when(half_sums)
    }

    /// Weights of depth in scene units: another unit, another image.
    pub(crate) const fn in_scene_units(cases: &'static str) -> Self {
        let reason = "its weight is a function of depth in scene units";
        Self::new(Property::Scale, cases, reason)
    }

    /// Of no matter to what is drawn: such networks are exported in 32 bits.
    pub(crate) const MAGNIFIED: Self = Self::new(
        Property::Half,
        "half-float",
        "weights of the hidden layers up to 10 and more magnify the roundings of half floats, which the limit counts in the last layer alone",
    );

    /// Weights that do not depend on the layers in front.
    pub(crate) const BLIND: Self = Self::translucent(
        "a weight of depth alone, or of depth and sums, does not know what lies in front (McGuire & Bavoil 2013, section 5)",
    );
}

pub(crate) fn half_sums(spec: &MethodSpec) -> bool {
    spec.guarantees().sums == Precision::Half
}

pub(crate) fn half_statistics(spec: &MethodSpec) -> bool {
    spec.guarantees().statistics == Precision::Half
}
