//! Typed parameters of methods: what `name=value` behind a method's name may say.
//!
//! A parameter is a constant beside the method that has it. [`MethodSpec`](super::MethodSpec) parses its value once; the constant then reads it
//! from the specification, default included, and cannot fail.

use std::ops::{Bound, RangeBounds as _};

/// A parameter of a method.
#[derive(Clone, Copy, Debug)]
pub enum Parameter {
    /// A finite number.
    Number(Number),
    /// A whole number.
    Whole(Whole),
    /// A positive whole number that may be left out.
    Count(Count),
    /// One of some words.
    Word(Word),
    /// The precision of the method's targets.
    Targets(Targets),
}

/// A number within limits, with a default. Shaders read it in 32 bits.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// The value where none is given.
    pub default: f64,
    /// The smallest value, itself allowed or not.
    pub least: Bound<f64>,
    /// The largest value.
    pub most: f64,
}

/// A whole number with a default.
#[derive(Clone, Copy, Debug)]
pub struct Whole {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// The value where none is given.
    pub default: u32,
    /// The largest value; the smallest is 0.
    pub most: u32,
}

/// A positive whole number, such as a limit, that may be left out.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// The largest value; the smallest is 1.
    pub most: u64,
}

/// One of some words.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// Its name.
    pub name: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// The words, the default first.
    pub words: &'static [&'static str],
}

/// `targets=f16` or `targets=f32`: the precision of all targets; without it each target has its own.
#[derive(Clone, Copy, Debug)]
pub struct Targets {
    /// One line for help texts.
    pub about: &'static str,
}

/// Bits of a floating-point target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 16 bits.
    Half,
    /// 32 bits.
    Full,
}

/// `scale=S`, a parameter of every method.
pub const SCALE: Number = Number {
    name: "scale",
    about: "of the resolution that transparency is drawn at, 1 by default; upsampled by depth",
    default: 1.0,
    least: Bound::Excluded(0.0),
    most: 1.0,
};

/// `targets` of a method whose targets have 16 bits by default.
pub(super) const TARGETS: Parameter = Parameter::Targets(Targets {
    about: "f16 (default) or f32",
});

/// `targets` of a method that needs 32 bits for some of them.
pub(super) const MOMENT_TARGETS: Parameter = Parameter::Targets(Targets {
    about: "f16 or f32 for all; by default 32-bit moments and 16-bit sums",
});

/// A parsed value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Number(f64),
    Whole(u64),
    Word(&'static str),
    Targets(Precision),
}

impl Number {
    fn allows(&self, x: f64) -> bool {
        (self.least, Bound::Included(self.most)).contains(&x)
    }

    fn allowed(&self) -> String {
        let most = self.most;
        match self.least {
            Bound::Included(least) => format!("a number from {least} to {most}"),
            Bound::Excluded(least) => format!("a number above {least} and at most {most}"),
            Bound::Unbounded => format!("a number of at most {most}"),
        }
    }
}

impl Targets {
    /// Its name.
    pub const NAME: &'static str = "targets";
    /// The values it takes.
    pub const WORDS: [(&'static str, Precision); 2] =
        [("f16", Precision::Half), ("f32", Precision::Full)];
}

impl Parameter {
    /// Its name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Number(p) => p.name,
            Self::Whole(p) => p.name,
            Self::Count(p) => p.name,
            Self::Word(p) => p.name,
            Self::Targets(_) => Targets::NAME,
        }
    }

    /// One line for help texts: what it does, its values and its default.
    pub const fn about(&self) -> &'static str {
        match self {
            Self::Number(p) => p.about,
            Self::Whole(p) => p.about,
            Self::Count(p) => p.about,
            Self::Word(p) => p.about,
            Self::Targets(p) => p.about,
        }
    }

    /// The values it takes, for messages.
    pub fn allowed(&self) -> String {
        match self {
            Self::Number(p) => p.allowed(),
            Self::Whole(p) => format!("a whole number from 0 to {}", p.most),
            Self::Count(p) => format!("a whole number from 1 to {}", p.most),
            Self::Word(p) => p.words.join(" or "),
            Self::Targets(_) => Targets::WORDS.map(|(word, _)| word).join(" or "),
        }
    }

    /// Reads a value; `None` if it is not allowed.
    pub(super) fn parse(&self, text: &str) -> Option<Value> {
        match self {
            Self::Number(p) => {
                let x: f64 = text.parse().ok()?;
                p.allows(x).then_some(Value::Number(x))
            }
            Self::Whole(p) => {
                let n: u64 = text.parse().ok()?;
                (n <= p.most.into()).then_some(Value::Whole(n))
            }
            Self::Count(p) => {
                let n: u64 = text.parse().ok()?;
                (1..=p.most).contains(&n).then_some(Value::Whole(n))
            }
            Self::Word(p) => p
                .words
                .iter()
                .find(|word| **word == text)
                .map(|word| Value::Word(word)),
            Self::Targets(_) => Targets::WORDS
                .iter()
                .find(|(word, _)| *word == text)
                .map(|&(_, precision)| Value::Targets(precision)),
        }
    }
}
