//! A program that writes, seals and reads datasets of made-up rows, with the command line and the answers of `peelnet extract --synthetic`,
//! `seal`, `inspect` and `train` as far as `tests/object_store.py` needs them. It needs no GPU and compiles in a fraction of the time.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program for a test"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use peelnet_dataset::*;
use std::path::Path;

/// Lists of one part, as `peelnet extract --synthetic` has them.
const LISTS: u32 = 1024;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let after = |flag: &str| {
        let k = words.iter().position(|w| w == flag)?;
        words.get(k + 1).cloned()
    };
    let result = match words[0].as_str() {
        "extract" => {
            let lists = after("--synthetic").unwrap().parse().unwrap();
            let resume = words.iter().any(|w| w == "--resume");
            let out = after("--out").unwrap();
            let before = done(&out);
            extract(Path::new(&out), lists, resume).inspect_err(|_| {
                let (done, of) = done(&out);
                if done > before.0 {
                    eprintln!("{done} of {of} parts stay");
                }
            })
        }
        "seal" => seal(&words[1]).map(|m| answer(&m, 0)),
        "inspect" | "train" => inspect(Path::new(&words[1])),
        other => panic!("{other}?"),
    };
    match result {
        Ok(text) => println!("{text}"),
        Err(error) => {
            eprintln!("error: {}", peelnet_files::error_line(&error));
            std::process::exit(1);
        }
    }
}

fn done(out: &str) -> (u32, u32) {
    unsealed_parts(out).ok().flatten().unwrap_or_default()
}

fn answer(m: &Manifest, written: u32) -> String {
    let (sealed, hash, rows) = (m.is_whole(), &m.hash, m.rows);
    format!(
        r#"{{"sealed": {sealed}, "hash": "{hash}", "rows": {rows}, "parts_written": {written}}}"#
    )
}

fn extract(out: &Path, lists: u32, resume: bool) -> Result<String, DatasetError> {
    let mut header = common::header(Format::Parquet, None);
    header.resume = resume;
    header.worker = worker_name();
    header.work_items = lists.div_ceil(LISTS);
    header.settings = [("number of lists".to_owned(), lists.to_string())].into();
    header.scenes.truncate(1);
    header.scenes[0].name = "synthetic".to_owned();
    let writer = DatasetWriter::create(out, header)?;
    let mut written = 0;
    for index in (0..lists.div_ceil(LISTS)).filter(|k| writer.needs(*k)) {
        let info = PartInfo {
            scene: 0,
            view: index,
            ..common::info(index)
        };
        let mut part = writer.begin(info)?;
        part.write(&common::view(index, LISTS.min(lists - index * LISTS), 1))?;
        part.finish(PartCounts::default())?;
        written += 1;
    }
    Ok(answer(&writer.finish()?, written))
}

fn inspect(path: &Path) -> Result<String, DatasetError> {
    let dataset = Dataset::open(path)?;
    dataset.verify()?;
    let summary = Summary::of(&dataset)?;
    assert!(summary.passes(), "{:?}", summary.violations);
    Ok(answer(dataset.manifest(), 0))
}
