//! The declaration of a method: all that is known of it, in one place.
//!
//! Lists, help texts, benchmarks, stress cases and tests iterate over [`METHODS`](super::METHODS) and read these fields; none of
//! them knows a method by its name.

use super::{
    expectations::Expectations,
    parameter::{Parameter, SCALE, Values},
    spec::MethodSpec,
};
use crate::{
    RenderError,
    passes::{
        Conditions, Passes,
        compositor::{Build, Compositor},
    },
};

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
    /// Why only its CPU reference exists, for a method that needs what portable WebGPU lacks: its error is known, but no time and no bytes.
    /// The reference's colour is what it adds to `T_∞ C_0`.
    pub cpu_only: Option<&'static str>,
    /// What a benchmark of all methods draws: endings of its name, the default first.
    pub curve: &'static [&'static str],
    /// What tests, stress cases and help texts expect of it.
    pub expectations: Expectations,
    /// Lists its passes.
    pub(super) list: fn(&mut Passes<'_>),
    pub(super) own: Option<OwnBuild>,
}

/// Builds a method that draws by itself, not by a fixed list of passes.
pub(super) type OwnBuild = fn(&Build<'_>) -> Result<Box<dyn Compositor>, RenderError>;

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
        list: fn(&mut Passes<'_>),
    ) -> Self {
        Self {
            name,
            about,
            numbered: None,
            parameters: &[],
            learned: false,
            cpu_only: None,
            curve: &[""],
            expectations: Expectations::DEFAULT,
            list,
            own: None,
        }
    }

    /// The same for a method that draws by itself.
    pub(super) const fn own(name: &'static str, about: &'static str, build: OwnBuild) -> Self {
        Self {
            own: Some(build),
            ..Self::new(name, about, |_| {})
        }
    }

    pub(crate) fn build(&self, b: &Build<'_>) -> Result<Box<dyn Compositor>, RenderError> {
        if let Some(why) = self.cpu_only {
            let why = format!("cannot be drawn: {why}; bench measures its error");
            return Err(RenderError::Refused(format!("{} {why}", b.spec)));
        }
        let network = match self.learned {
            true => b.learned_weight()?.wgsl.as_str(),
            false => "",
        };
        match self.own {
            Some(build) => build(b),
            None => self.passes(b.conditions(), network).build(b),
        }
    }

    /// Its passes with the text of a network; none for a method that draws by itself.
    pub(crate) fn passes<'a>(&self, on: Conditions<'a>, network: &str) -> Passes<'a> {
        let mut p = Passes::new(on);
        network.clone_into(&mut p.network);
        (self.list)(&mut p);
        p
    }

    /// Whether it is exact with its default parameters.
    pub fn is_exact(&'static self) -> bool {
        MethodSpec::representative(self).guarantees().exact
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
