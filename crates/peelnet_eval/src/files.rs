//! Files appear whole or not at all.

use crate::EvalError;
use serde::Serialize;
use std::path::Path;

/// Writes a file whole, creating its folder if need be.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), EvalError> {
    peelnet_files::write_whole(path, bytes).map_err(EvalError::io(path, "write"))
}

/// Writes a value as indented JSON.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), EvalError> {
    let mut json = serde_json::to_vec_pretty(value)
        .expect("results have string keys only, and floats serialise always");
    json.push(b'\n');
    write_atomically(path, &json)
}

/// Writes rows of flat fields as CSV with a header.
pub(crate) fn write_csv(path: &Path, rows: &[impl Serialize]) -> Result<(), EvalError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    for row in rows {
        table.serialize(row).expect("a row has flat fields");
    }
    let csv = table.into_inner().expect("memory can be written");
    write_atomically(path, &csv)
}
