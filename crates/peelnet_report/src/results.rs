use crate::{
    ReportError,
    files::{json, write_file},
};
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

/// A measurement that is written as a folder of files.
pub trait Measurement: Serialize {
    /// The files. The JSON among them is the [`Results`].
    const FILES: &'static [&'static str];

    /// The text of any other of the files; none where it is left out. Pictures are taken from `images/` in the folder.
    ///
    /// # Errors
    /// If a picture cannot be read.
    fn text(
        results: &Results<Self>,
        file: &str,
        folder: &Path,
    ) -> Result<Option<String>, ReportError>
    where
        Self: Sized;
}

impl<T: Measurement> Results<T> {
    /// The files that [`Self::write`] writes.
    pub const FILES: &'static [&'static str] = T::FILES;

    /// Writes [`Self::FILES`] into a folder; pages show the pictures in `images/` in it.
    ///
    /// # Errors
    /// If a file cannot be written, or a picture not be read.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        for file in Self::FILES {
            let text = match file.ends_with(".json") {
                true => Some(json(self)),
                false => T::text(self, file, folder)?,
            };
            if let Some(text) = text {
                write_file(&folder.join(file), text)?;
            }
        }
        Ok(())
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
