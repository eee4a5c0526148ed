//! Parameters of methods: what `name=value` behind a method's name may say.
//!
//! A parameter is a constant beside the method that has it. [`MethodSpec`] checks its value once; the constant then reads it from the
//! specification, default included.

use super::spec::MethodSpec;
use std::str::FromStr;

/// A parameter of a method.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts: what it does, its values and its default.
    pub about: &'static str,
    /// The values that it takes.
    pub values: Values,
}

/// The values that a parameter takes.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// A finite number from 0. Shaders read it in 32 bits.
    Number {
        /// The value where none is given.
        default: f64,
        /// Whether 0 itself is not allowed.
        above_zero: bool,
        /// The largest value.
        most: f64,
    },
    /// A whole number.
    Whole {
        /// The value where none is given; `None` for a limit that may be left out.
        default: Option<u64>,
        /// The smallest value.
        least: u64,
        /// The largest value.
        most: u64,
    },
    /// One of some words, the default first.
    Words(&'static [&'static str]),
    /// `f16` or `f32`: the precision of all targets; without it each target has its own.
    Precision,
}

/// Bits of a floating-point target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 16 bits.
    Half,
    /// 32 bits.
    Full,
}

impl Precision {
    /// The words that choose one.
    pub const WORDS: [&'static str; 2] = ["f16", "f32"];
}

/// `scale=S`, a parameter of every method.
pub const SCALE: Parameter = Parameter::positive(
    "scale",
    "of the resolution that transparency is drawn at, 1 by default; upsampled by depth",
    1.0,
    1.0,
);

/// `targets` of a method whose targets have 16 bits by default.
pub(super) const TARGETS: Parameter = Parameter::targets("f16 (default) or f32");

/// `targets` of a method that needs 32 bits for some of them.
pub(super) const MOMENT_TARGETS: Parameter =
    Parameter::targets("f16 or f32 for all; by default 32-bit moments and 16-bit sums");

impl Parameter {
    const fn new(name: &'static str, about: &'static str, values: Values) -> Self {
        Self {
            name,
            about,
            values,
        }
    }

    pub(crate) const fn positive(
        name: &'static str,
        about: &'static str,
        default: f64,
        most: f64,
    ) -> Self {
        let values = Values::Number {
            default,
            above_zero: true,
            most,
        };
        Self::new(name, about, values)
    }

    pub(crate) const fn share(name: &'static str, about: &'static str, default: f64) -> Self {
        let values = Values::Number {
            default,
            above_zero: false,
            most: 1.0,
        };
        Self::new(name, about, values)
    }

    /// A whole number; without a default it may be left out.
    pub(crate) const fn whole(
        name: &'static str,
        about: &'static str,
        default: Option<u64>,
        (least, most): (u64, u64),
    ) -> Self {
        let values = Values::Whole {
            default,
            least,
            most,
        };
        Self::new(name, about, values)
    }

    /// One of some words, the default first.
    pub(crate) const fn words(
        name: &'static str,
        about: &'static str,
        words: &'static [&'static str],
    ) -> Self {
        Self::new(name, about, Values::Words(words))
    }

    pub(crate) const fn targets(about: &'static str) -> Self {
        Self::new("targets", about, Values::Precision)
    }

    /// The values it takes, for messages.
    pub fn allowed(&self) -> String {
        match self.values {
            Values::Number {
                above_zero, most, ..
            } => match above_zero {
                true => format!("a number above 0 and at most {most}"),
                false => format!("a number from 0 to {most}"),
            },
            Values::Whole { least, most, .. } => format!("a whole number from {least} to {most}"),
            Values::Words(words) => words.join(" or "),
            Values::Precision => Precision::WORDS.join(" or "),
        }
    }

    pub(super) fn allows(&self, text: &str) -> bool {
        match self.values {
            Values::Number {
                above_zero, most, ..
            } => text
                .parse()
                .is_ok_and(|x: f64| (0.0..=most).contains(&x) && !(above_zero && x == 0.0)),
            Values::Whole { least, most, .. } => {
                text.parse().is_ok_and(|n| (least..=most).contains(&n))
            }
            Values::Words(words) => words.contains(&text),
            Values::Precision => Precision::WORDS.contains(&text),
        }
    }

    /// The default as it is written; `None` where there is none.
    pub fn default(&self) -> Option<String> {
        match self.values {
            Values::Number { default, .. } => Some(default.to_string()),
            Values::Whole { default, .. } => default.map(|n| n.to_string()),
            Values::Words(words) => Some(words[0].to_owned()),
            Values::Precision => None,
        }
    }

    /// The value or the default, numbers in one spelling. `None` where there is neither, and of precisions, whose defaults are the methods'.
    pub(super) fn canonical(&self, spec: &MethodSpec) -> Option<String> {
        if matches!(self.values, Values::Precision) {
            return None;
        }
        let text = spec.values.get(self.name).cloned();
        let text = text.or_else(|| self.default())?;
        Some(text.parse().map_or(text, |x: f64| x.to_string()))
    }

    /// The value that was given.
    pub fn given<T: FromStr>(&self, spec: &MethodSpec) -> Option<T> {
        spec.values.get(self.name)?.parse().ok()
    }

    /// The number, or the default; 0 of parameters that are none.
    pub fn number(&self, spec: &MethodSpec) -> f64 {
        let default = || self.default()?.parse().ok();
        self.given(spec).or_else(default).unwrap_or_default()
    }

    /// The whole number, or the default; `None` where there is neither.
    pub fn count(&self, spec: &MethodSpec) -> Option<u64> {
        let default = || self.default()?.parse().ok();
        self.given(spec).or_else(default)
    }

    /// The word, or the default; empty where there is neither.
    pub fn word<'s>(&self, spec: &'s MethodSpec) -> &'s str {
        let default = match self.values {
            Values::Words(words) => words[0],
            _ => "",
        };
        spec.values.get(self.name).map_or(default, String::as_str)
    }
}
