use crate::{
    EvalError, Machine,
    report::{table::markdown, write_file},
};
use peelnet_core::files::{one_line, printable_json};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::path::Path;

/// Bytes of a results file that are read: a hundred thousand rows have half of it.
const MAX_BYTES: u64 = 1 << 28;

/// A finished measurement: what was measured, with which command, and on which machine, which names the version of peelnet as well.
///
/// Its JSON is one object: `machine`, `command`, and the fields of `measured` beside them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results<T> {
    pub machine: Machine,
    /// The command line, or what else started the measurement.
    pub command: String,
    #[serde(flatten)]
    pub measured: T,
}

/// Names and texts of files, which take pictures from `images/` in their folder.
pub type Files<T> = &'static [(&'static str, Text<T>)];
type Text<T> = fn(&Results<T>, &Path) -> Result<String, EvalError>;

/// A measurement that is written as a folder of files.
pub trait Measurement: Serialize + Sized + 'static {
    /// One of them is the JSON.
    const FILES: Files<Self>;
}

impl<T> Results<T> {
    pub fn new(machine: Machine, command: impl Into<String>, measured: T) -> Self {
        Self {
            machine,
            command: command.into(),
            measured,
        }
    }

    /// The sentence under a table of figures.
    pub(crate) fn credit(&self) -> String {
        let m = &self.machine;
        // This sign begins code and ends it.
        let plain = |text: &str| text.replace('`', "'");
        format!(
            "Measured on {} ({}, {} cores) with `{}`.",
            markdown(&plain(&m.adapter)),
            markdown(&plain(&m.cpu)),
            m.cores,
            plain(&one_line(&self.command))
        )
    }
}

impl<T: Measurement> Results<T> {
    pub fn files() -> Vec<&'static str> {
        T::FILES.iter().map(|(name, _)| *name).collect()
    }

    /// Writes the files into a folder; pages show the pictures in `images/` in it.
    pub fn write(&self, folder: &Path) -> Result<(), EvalError> {
        self.write_but("", folder)
    }

    /// The same without one of the files.
    pub fn write_but(&self, left: &str, folder: &Path) -> Result<(), EvalError> {
        for (name, text) in T::FILES.iter().filter(|(name, _)| *name != left) {
            let text = text(self, folder)?;
            let path = folder.join(name);
            // A chart of nothing is left out, and an older one is not of these results.
            if text.is_empty() && name.ends_with(".svg") {
                let _ = std::fs::remove_file(path);
            } else {
                write_file(&path, text)?;
            }
        }
        Ok(())
    }

    pub(crate) fn json(&self, _: &Path) -> Result<String, EvalError> {
        let json = serde_json::to_string_pretty(self)
            .expect("results have string keys only, and floats serialise always");
        Ok(printable_json(&format!("{json}\n")).into_owned())
    }
}

impl<T: DeserializeOwned> Results<T> {
    /// Reads what was written as JSON: a file, or the `results.json` in a folder.
    pub fn read(path: &Path) -> Result<Self, EvalError> {
        let file = path.join("results.json");
        let path = if path.is_dir() { &*file } else { path };
        let bytes = peelnet_core::files::read(path, MAX_BYTES);
        let bytes = bytes.map_err(EvalError::io(path, "read"))?;
        let read = serde_json::from_slice(&bytes);
        let place = format!("{}: not a result of this kind", path.display());
        read.map_err(EvalError::at(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of machines and command lines come from a file where results are drawn again.
    #[test]
    fn a_credit_is_one_line_of_markdown() {
        let machine = Machine {
            cpu: "<img src=x>\n# a|b".to_owned(),
            ..Machine::default()
        };
        let credit = Results::new(machine, "peelnet `<b>`\n", ()).credit();
        assert!(credit.contains(r"&lt;img src=x>\u{a}# a\|b"), "{credit}");
        assert!(credit.ends_with(r"`peelnet '<b>'\u{a}`."), "{credit}");
    }
}
