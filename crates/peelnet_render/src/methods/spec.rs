//! A method's name with its parameters. What the name stands for is looked up in `lookup.rs`.

use super::parameter::{Precision, SCALE};
use std::{collections::BTreeMap, fmt};

/// A method's name with its parameters, such as `wboit-eq10:factor=3e4,targets=f32`. Every value in it is allowed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MethodSpec {
    pub(super) name: &'static str,
    /// The number that the name ends in, where it ends in one.
    pub(super) number: Option<u32>,
    /// By name: the text as it was given, an allowed value of the parameter.
    pub(super) values: BTreeMap<&'static str, String>,
}

impl MethodSpec {
    /// The method's name without number and parameters.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The number that the name ends in; 0 where it ends in none.
    pub fn number(&self) -> u32 {
        self.number.unwrap_or_default()
    }

    /// The precision that was asked for of all targets; `None` leaves it to the method.
    pub fn targets(&self) -> Option<Precision> {
        let is_half = self.values.get("targets")? == Precision::WORDS[0];
        Some(if is_half {
            Precision::Half
        } else {
            Precision::Full
        })
    }

    /// Whether transparency is drawn at a lower resolution: pixels then mix their neighbours' fragments.
    pub fn is_scaled(&self) -> bool {
        SCALE.number(self) < 1.0
    }

    /// The same method with a parameter's default.
    #[must_use]
    pub fn without(&self, name: &str) -> Self {
        let mut changed = self.clone();
        changed.values.remove(name);
        changed
    }
}

impl fmt::Display for MethodSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        if let Some(number) = self.number {
            write!(f, "-{number}")?;
        }
        for (i, (name, text)) in self.values.iter().enumerate() {
            write!(f, "{}{name}={text}", if i == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}
