//! Files appear whole or not at all.

use crate::{EvalError, chart::Svg, report::page};
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
    let (name, is): (_, fn(&[u8]) -> bool) = match name.rsplit('.').next().unwrap_or_default() {
        "html" => ("a report of peelnet", |head| {
            contains(head, &["<!DOCTYPE html>", page::GENERATOR_TAG])
        }),
        "svg" => ("a chart of peelnet", Svg::is_ours),
        "csv" => ("a table of peelnet", |head| {
            let mut starts = TABLES.iter().map(|start| start.as_bytes());
            starts.any(|start| head.starts_with(start))
        }),
        // The sentence under every table.
        "md" => ("a table of peelnet", |head| {
            contains(head, &["Measured on ", ") with `"])
        }),
        // The envelope begins with the machine.
        _ => ("results of peelnet", |head| {
            head.starts_with(b"{\n  \"machine\": {") && contains(head, &["\"command\": "])
        }),
    };
    Kind { name, is }
}

fn contains(head: &[u8], texts: &[&str]) -> bool {
    let head = String::from_utf8_lossy(head);
    texts.iter().all(|text| head.contains(text))
}

/// Writes a file whole, creating its folder if need be.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), EvalError> {
    let written = peelnet_core::files::write_whole(path, bytes.as_ref());
    written.map_err(EvalError::io(path, "write"))
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
