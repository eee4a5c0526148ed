//! Files appear whole or not at all.

use crate::ReportError;
use serde::Serialize;
use std::path::Path;

/// Writes a file whole, creating its folder if need be.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), ReportError> {
    peelnet_files::write_whole(path, bytes.as_ref()).map_err(|source| ReportError::Io {
        path: path.to_owned(),
        action: "write",
        source,
    })
}

/// Writes a value as indented JSON.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), ReportError> {
    let mut json = serde_json::to_vec_pretty(value)
        .expect("results have string keys only, and floats serialise always");
    json.push(b'\n');
    write_file(path, json)
}

/// Writes rows of flat fields as CSV with a header.
pub(crate) fn write_csv(path: &Path, rows: &[impl Serialize]) -> Result<(), ReportError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    for row in rows {
        table.serialize(row).expect("a row has flat fields");
    }
    write_file(path, table.into_inner().expect("memory can be written"))
}
