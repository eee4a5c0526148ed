//! Files appear whole or not at all.

use crate::chart::Svg;
use crate::report::{ReportError, page};
use peelnet_core::files::Kind;
use serde::Serialize;
use std::path::Path;

/// First columns of the tables that are written as CSV.
const TABLES: [&str; 4] = [
    // Of paths: `method,scene,frames,` and `method,scene,frame,`.
    "method,scene,frame",
    "method,scene,view,",
    "method,case,property,",
    "method,series,value,",
];

/// By what a file of a measurement is known, from its name.
pub fn kind_of(name: &str) -> Kind {
    match name.rsplit('.').next().unwrap_or_default() {
        "html" => Kind {
            name: "a report of peelnet",
            is: |head| contains(head, &["<!DOCTYPE html>", page::GENERATOR_TAG]),
        },
        "svg" => Kind {
            name: "a chart of peelnet",
            is: Svg::is_ours,
        },
        "csv" => Kind {
            name: "a table of peelnet",
            is: |head| {
                TABLES
                    .iter()
                    .any(|start| head.starts_with(start.as_bytes()))
            },
        },
        "md" => Kind {
            name: "a table of peelnet",
            // The sentence under every table.
            is: |head| contains(head, &["Measured on ", ") with `"]),
        },
        _ => Kind {
            name: "results of peelnet",
            // The envelope begins with the machine.
            is: |head| {
                head.starts_with(b"{\n  \"machine\": {") && contains(head, &["\"command\": "])
            },
        },
    }
}

fn contains(head: &[u8], texts: &[&str]) -> bool {
    let head = String::from_utf8_lossy(head);
    texts.iter().all(|text| head.contains(text))
}

/// Writes a file whole, creating its folder if need be.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), ReportError> {
    let written = peelnet_core::files::write_whole(path, bytes.as_ref());
    written.map_err(ReportError::at(path, "cannot write"))
}

/// Rows of flat fields as CSV with a header.
pub(crate) fn csv(rows: &[impl Serialize]) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    for row in rows {
        table.serialize(row).expect("a row has flat fields");
    }
    let bytes = table.into_inner().expect("memory can be written");
    String::from_utf8(bytes).expect("fields are text")
}
