//! Files appear whole or not at all.

use crate::{EvalError, chart::Svg, report::page};
use peelnet_core::files::{Kind, one_line};
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

/// Starts of the tables that are written as Markdown.
const MARKDOWN: [&str; 7] = [
    "| method | MSE (linear) |",
    "| method | JOD |",
    "| method | time ~ ",
    "| design | ends |",
    "# Stress cases\n",
    "## What each effect costs\n",
    "# Weighted and learned weighted blending",
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
        // Or the sentence under every table, of older versions.
        "md" => ("a table of peelnet", |head| {
            let mut starts = MARKDOWN.iter().map(|start| start.as_bytes());
            starts.any(|start| head.starts_with(start))
                || contains(head, &["Measured on ", ") with `"])
        }),
        // The envelope begins with the machine.
        _ => ("results of peelnet", |head| {
            head.starts_with(b"{\n  \"machine\": {") && contains(head, &["\"command\": "])
        }),
    };
    Kind { name, is }
}

fn contains(head: &[u8], texts: &[&str]) -> bool {
    let mut texts = texts.iter();
    texts.all(|text| peelnet_core::files::holds(head, text.as_bytes()))
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
    let mut records = csv::ReaderBuilder::new();
    let mut records = records.has_headers(false).from_reader(&*bytes);
    let mut table = csv::Writer::from_writer(Vec::new());
    for record in records.records() {
        let record = record.expect("was written just now");
        let fields = record.iter().map(plain_field);
        table.write_record(fields).expect("memory can be written");
    }
    let bytes = table.into_inner().expect("memory can be written");
    String::from_utf8(bytes).expect("fields are text")
}

/// A field without what acts on terminals, and with an apostrophe before what spreadsheets take for a formula: names of scenes are anything.
fn plain_field(field: &str) -> String {
    let is_formula = field.starts_with(['=', '+', '-', '@']) && field.parse::<f64>().is_err();
    let apostrophe = if is_formula { "'" } else { "" };
    format!("{apostrophe}{}", one_line(field))
}

#[cfg(test)]
mod tests {
    #[test]
    fn fields_of_tables_are_plain() {
        let rows = [("=1+1", -2.5), ("@x\u{1b}[2J", 1.0), ("a, \"b\"", 0.0)];
        let text = super::csv(&rows);
        assert_eq!(
            text,
            "'=1+1,-2.5\n'@x\\u{1b}[2J,1.0\n\"a, \"\"b\"\"\",0.0\n"
        );
    }
}
