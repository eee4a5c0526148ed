use crate::{ReportError, files::write_json};
use peelnet_eval::Machine;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::path::Path;

/// Bytes of a results file that are read: a hundred thousand rows have half of it.
const MAX_BYTES: u64 = 1 << 28;

/// A finished measurement: what was measured, with which command, and on which machine, which names the version of peelnet as well.
///
/// Its JSON is one object: `machine`, `command`, and the fields of `measured` beside them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results<T> {
    /// What it was measured on.
    pub machine: Machine,
    /// The command line, or what else started the measurement.
    pub command: String,
    /// What was measured.
    #[serde(flatten)]
    pub measured: T,
}

impl<T> Results<T> {
    /// Puts a measurement into its envelope.
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
        format!(
            "Measured on {} ({}, {} cores) with `{}`.",
            m.adapter, m.cpu, m.cores, self.command
        )
    }
}

impl<T: Serialize> Results<T> {
    /// Writes it as JSON.
    pub(crate) fn write_json(&self, path: &Path) -> Result<(), ReportError> {
        write_json(path, self)
    }
}

impl<T: DeserializeOwned> Results<T> {
    /// Reads what was written as JSON.
    ///
    /// # Errors
    /// A file that cannot be read, or that holds something else.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let bytes = peelnet_files::read(path, MAX_BYTES).map_err(|source| ReportError::Io {
            path: path.to_owned(),
            action: "read",
            source,
        })?;
        serde_json::from_slice(&bytes).map_err(|source| ReportError::Format {
            path: path.to_owned(),
            source,
        })
    }
}
