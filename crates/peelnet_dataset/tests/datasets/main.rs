//! Datasets that are written and read: what comes back, what is refused, and many writers. This file has datasets with known contents.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod bad_input;
mod cards;
mod many_writers;
mod round_trip;

use peelnet_core::random::Random;
use peelnet_dataset::*;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn temporary() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// Rows of a view as peeling gives them: whole pixels, sums that agree, a few colours and alphas.
fn view(index: u32, pixels: u32, seed: u64) -> FragmentBatch {
    let mut random = Random::new(seed, &[index.into()]);
    let mut rows = FragmentBatch::default();
    let palette: Vec<[f32; 4]> = (0..16)
        .map(|_| [random.unit(), random.unit(), random.unit(), random.unit()])
        .collect();
    for p in 0..pixels {
        let n = 1 + random.bits() % 12;
        let mut depth = 0.5f32;
        let fragment = |_| {
            depth += random.unit();
            let color = palette[random.below(16)];
            PeeledFragment { depth, color }
        };
        let fragments: Vec<PeeledFragment> = (0..n).map(fragment).collect();
        let pixel = [index, p % 640, p / 640];
        rows.push_pixel(pixel, [0.1, 100.0], fragments.into_iter());
    }
    rows
}

/// Two scenes of two views each.
fn header(format: Format) -> Header {
    let scene = |name: &str, held_out| SceneEntry {
        name: name.to_owned(),
        file: format!("scenes/{name}.toml"),
        sha256: "ab".repeat(32),
        content: String::new(),
        held_out,
        effects: vec!["opaque".to_owned()],
    };
    Header {
        format,
        seed: 7,
        adapter: "test".to_owned(),
        adapter_class: "software".to_owned(),
        tool_version: "0.1.0".to_owned(),
        command: "peelnet extract".to_owned(),
        peel: "sbuffer".to_owned(),
        pixels_fraction: 1.0,
        settings: [("size".to_owned(), "640x480".to_owned())].into(),
        scenes: vec![scene("cups", false), scene("smoke in a box", true)],
        work_items: 4,
        worker: "test".to_owned(),
        ..Header::default()
    }
}

fn info(index: u32) -> Part {
    Part {
        index,
        scene: index / 2,
        view: index % 2,
        width: 640,
        height: 480,
        ..Part::default()
    }
}

/// The rows of work item `index`: the last one has none.
fn rows_of(index: u32) -> FragmentBatch {
    view(index, [700, 301, 1500, 0][index as usize], 1)
}

fn write(folder: &Path, format: Format) -> Result<Manifest, DatasetError> {
    write_by(folder, header(format), 1000)
}

/// Writes what is missing of the test dataset, in batches of so many rows.
fn write_by(folder: &Path, header: Header, batch_rows: usize) -> Result<Manifest, DatasetError> {
    let writer = DatasetWriter::create(folder, header)?;
    // Backwards: the order of the parts is by index, not by time.
    for index in (0..4).rev().filter(|&k| writer.needs(k)) {
        part(&writer, index, &rows_of(index), batch_rows)?;
    }
    writer.finish()
}

fn part(
    writer: &DatasetWriter,
    index: u32,
    rows: &FragmentBatch,
    batch_rows: usize,
) -> Result<(), DatasetError> {
    let mut part = writer.begin(info(index))?;
    for start in (0..rows.len()).step_by(batch_rows) {
        let mut piece = FragmentBatch::default();
        piece.extend_from(rows, start..rows.len().min(start + batch_rows));
        part.write(&piece)?;
    }
    part.finish(0, 0)
}

fn write_one(folder: &Path, format: Format, rows: &FragmentBatch, batch_rows: usize) -> Manifest {
    let header = Header {
        work_items: 1,
        ..header(format)
    };
    let writer = DatasetWriter::create(folder, header).unwrap();
    part(&writer, 0, rows, batch_rows).unwrap();
    writer.finish().unwrap()
}

/// Bit patterns, so that −0 and 0 differ.
fn bits(rows: &FragmentBatch) -> [Vec<u32>; Column::ALL.len()] {
    Column::ALL.map(|c| match rows.column(c) {
        ColumnSlice::F32(v) => v.iter().map(|x| x.to_bits()).collect(),
        ColumnSlice::U32(v) => v.to_vec(),
    })
}

/// Names and contents of a folder's files, sorted, with those of its folders.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.file_type().unwrap().is_dir() {
            let inside = contents(&entry.path()).into_iter();
            all.extend(inside.map(|(n, c)| (format!("{name}/{n}"), c)));
            all.push((format!("{name}/"), Vec::new()));
        } else {
            all.push((name, fs::read(entry.path()).unwrap()));
        }
    }
    all.sort();
    all
}

fn opening_fails(folder: &Path, words: &[&str]) {
    has(&Dataset::open(folder).unwrap_err(), words);
}

fn has(error: &DatasetError, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}
