//! The declaration of a method: all that is known of it, in one place.
//!
//! Lists, help texts, benchmarks, hard cases and tests iterate over [`METHODS`](super::METHODS) and read these fields; none of
//! them knows a method by its name.

use super::{
    compositor::{Build, Compositor},
    parameter::{Parameter, Precision, SCALE, Values},
    plan::Plan,
    spec::MethodSpec,
};
use crate::{RenderError, flaw::Flaw};
use peelnet_core::{
    absorbance::DepthWarp,
    fragment::{Fragment, points},
    methods::composite,
};
use peelnet_model::Model;

/// A method.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// The number that its name ends in, as in `kbuffer-8`; `None` for a name that stands alone.
    pub numbered: Option<Numbered>,
    /// Its own parameters; see [`Method::all_parameters`].
    pub parameters: &'static [Parameter],
    /// Whether it draws with a trained network.
    pub learned: bool,
    /// Why only its CPU twin exists, for a method that needs what portable WebGPU lacks: its error is known, but no time and no bytes.
    /// The twin's colour is what it adds to `T_∞ C_0`.
    pub cpu_only: Option<&'static str>,
    /// What it promises, before a choice of targets or a lower resolution; see [`MethodSpec::promises`].
    pub promises: fn(&MethodSpec) -> Promises,
    /// What a benchmark of all methods draws: endings of its name, the default first.
    pub curve: &'static [&'static str],
    /// Its CPU twin.
    pub twin: Option<Twin>,
    /// Its estimate of every fragment's transmittance.
    pub transmittances: Option<Estimate>,
    /// Properties that it is known not to have.
    pub flaws: &'static [Flaw],
    pub(super) draws: Draws,
}

/// How a method draws.
#[derive(Clone, Copy, Debug)]
pub(super) enum Draws {
    /// By a fixed list of passes.
    Plan(fn(&mut Plan<'_>) -> Result<(), RenderError>),
    /// By itself.
    Own(fn(&Build<'_>) -> Result<Box<dyn Compositor>, RenderError>),
}

/// The colour that a pixel must have; `None` without the model that a learned method needs.
pub type Twin = fn(&MethodSpec, &Pixel<'_>) -> Option<[f32; 3]>;

/// The transmittance in front of each fragment, given as (linear depth, α), nearest first; `None` without the model that a
/// learned method needs.
pub type Estimate = fn(&MethodSpec, &[(f32, f32)], &DepthWarp, Option<&Model>) -> Option<Vec<f64>>;

/// The twin of a method whose weights are its estimates of transmittance.
pub(super) fn weighted_twin(spec: &MethodSpec, p: &Pixel<'_>) -> Option<[f32; 3]> {
    let t = spec.transmittances(&points(p.fragments), &p.warp, p.model)?;
    Some(composite(p.fragments, p.background, &t))
}

/// What a CPU twin composites.
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

/// The number at the end of a method's name.
#[derive(Clone, Copy, Debug)]
pub struct Numbered {
    /// The smallest.
    pub least: u32,
    /// The largest.
    pub most: u32,
    /// Whether it must be a power of two.
    pub power_of_two: bool,
}

/// What a method promises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promises {
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
    /// Fragments are rounded before they are composited, by its twin too.
    pub rounds_fragments: bool,
    /// A fragment's weight is a formula of its own depth and opacity (McGuire & Bavoil 2013).
    pub own_weight: bool,
    /// It takes a pass over the geometry for every layer or two: pixels of many layers take as many.
    pub peels: bool,
}

impl Promises {
    /// Of exact methods, whose fragments are kept in 32 bits.
    pub(super) const EXACT: Self = Self {
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
        own_weight: false,
        peels: false,
    };

    /// Of methods that normalise sums kept in 16 bits.
    pub(super) const NORMALISED: Self = Self {
        exact: false,
        sorted: false,
        sums: Precision::Half,
        statistics: Precision::Half,
        ..Self::EXACT
    };

    /// The same of methods that also draw light which takes a colour.
    pub(super) const TINTED: Self = Self {
        tinted: true,
        ..Self::NORMALISED
    };
}

/// What reports use methods as: the texts of their specifications.
pub mod role {
    /// The exact image that all others are compared with.
    pub const REFERENCE: &str = "abuffer";
    /// The cheapest that hardware does, which times are ratios to.
    pub const HARDWARE_BLENDING: &str = "painter-object:sort=off";
    /// The weighted blending that errors are ratios to.
    pub const WEIGHTED_BLENDING: &str = "wboit-eq9";
    /// The moment-based method that errors and times are ratios to.
    pub const MOMENT_BLENDING: &str = "mboit4";
    /// Weighted blending as in the thesis of Papakostas (Ioannina 2022).
    pub const THESIS_WEIGHT: &str = "wboit-papakostas";
    /// The thesis's network.
    pub const THESIS_NETWORK: &str = "deep-thesis";
}

impl Numbered {
    pub(super) const fn range(least: u32, most: u32) -> Option<Self> {
        Some(Self {
            least,
            most,
            power_of_two: false,
        })
    }

    pub(super) const fn powers(least: u32, most: u32) -> Option<Self> {
        Some(Self {
            least,
            most,
            power_of_two: true,
        })
    }

    pub(super) fn parse(self, name: &str, text: &str) -> Result<u32, String> {
        let Self { least, most, .. } = self;
        let allowed = match text.parse::<u32>() {
            Ok(n) if !(least..=most).contains(&n) => format!("{least} to {most}"),
            Ok(n) if self.power_of_two && !n.is_power_of_two() => {
                let above = n.next_power_of_two();
                format!("a power of two: {} or {above}", above / 2)
            }
            Ok(n) => return Ok(n),
            Err(_) => format!("{least} to {most}"),
        };
        Err(format!(
            "the number behind '{name}-' must be {allowed}, not '{text}'"
        ))
    }
}

impl Method {
    /// A method with what most have in common: normalised sums in 16 bits, no parameters, one point on its curve.
    pub(super) const fn new(
        name: &'static str,
        about: &'static str,
        plan: fn(&mut Plan<'_>) -> Result<(), RenderError>,
    ) -> Self {
        Self {
            name,
            about,
            numbered: None,
            parameters: &[],
            learned: false,
            cpu_only: None,
            promises: |_| Promises::NORMALISED,
            curve: &[""],
            twin: None,
            transmittances: None,
            flaws: &[],
            draws: Draws::Plan(plan),
        }
    }

    /// The same for a method that draws by itself.
    pub(super) const fn own(
        name: &'static str,
        about: &'static str,
        build: fn(&Build<'_>) -> Result<Box<dyn Compositor>, RenderError>,
    ) -> Self {
        Self {
            draws: Draws::Own(build),
            ..Self::new(name, about, |_| Ok(()))
        }
    }

    pub(super) fn build(&self, b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
        match self.draws {
            Draws::Plan(plan) => {
                let mut p = Plan::new(b);
                if self.learned {
                    b.learned_weight()?.wgsl.clone_into(&mut p.network);
                }
                plan(&mut p)?;
                p.build()
            }
            Draws::Own(build) => build(b),
        }
    }

    /// Whether it is exact with its default parameters.
    pub fn is_exact(&'static self) -> bool {
        MethodSpec::representative(self).promises().exact
    }

    /// Its parameters: its own, and those that every method has.
    pub fn all_parameters(&self) -> impl Iterator<Item = &'static Parameter> + use<> {
        self.parameters.iter().chain([&SCALE])
    }

    /// Whether the precision of its targets can be chosen.
    pub fn has_targets(&self) -> bool {
        let mut all = self.parameters.iter();
        all.any(|p| matches!(p.values, Values::Precision))
    }

    /// Its name as it is written, `-N` where a number follows.
    pub fn usage(&self) -> String {
        let ending = if self.numbered.is_some() { "-N" } else { "" };
        format!("{}{ending}", self.name)
    }
}
