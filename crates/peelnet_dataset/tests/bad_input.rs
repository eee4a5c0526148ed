//! Every kind of bad dataset gives one error that names the file, the place and the fix, and nothing half-written
//! stays.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use std::fs;
use std::path::Path;

use common::*;
use peelnet_dataset::*;
use sha2::{Digest, Sha256};

/// Writes a dataset, lets a part's file be changed, and makes the manifest fit the change, so that only the contents
/// are wrong.
fn changed(format: Format, file: &str, change: impl Fn(Vec<u8>) -> Vec<u8>) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), format, None, 1, 1000).unwrap();
    let path = folder.path().join(file);
    let bytes = change(fs::read(&path).unwrap());
    fs::write(&path, &bytes).unwrap();
    let manifest_path = folder.path().join("_peelnet/manifest.json");
    let mut manifest: Manifest =
        serde_json::from_slice(&fs::read(&manifest_path).unwrap()).unwrap();
    let mut hasher = Sha256::new();
    for part in &mut manifest.parts {
        for entry in &mut part.files {
            if entry.name == file {
                entry.bytes = bytes.len() as u64;
                entry.sha256 = Sha256::digest(&bytes)
                    .iter()
                    .map(|b| format!("{b:02x}"))
                    .collect();
            }
            hasher.update(format!("{} {}\n", part.index, entry.sha256));
        }
    }
    manifest.hash = hasher
        .finalize()
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect();
    fs::write(&manifest_path, serde_json::to_vec(&manifest).unwrap()).unwrap();
    folder
}

/// The message of reading everything; opening must work.
fn reading_fails(folder: &Path) -> String {
    let dataset = Dataset::open(folder).unwrap();
    dataset.verify().unwrap();
    let mut batches = dataset.batches(100);
    let error = batches.find_map(Result::err).expect("reading must fail");
    assert!(batches.next().is_none(), "an error ends the batches");
    error.to_string()
}

fn has(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

const CSV: &str = "fragments-00000-cups-v0.csv";

fn edit_line(line: usize, edit: impl Fn(&str) -> String) -> impl Fn(Vec<u8>) -> Vec<u8> {
    move |bytes| {
        let text = String::from_utf8(bytes).unwrap();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines[line - 1] = edit(&lines[line - 1]);
        (lines.join("\n") + "\n").into_bytes()
    }
}

/// Replaces field `k` of a line.
fn field(k: usize, value: &str) -> impl Fn(&str) -> String {
    move |line| {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields[k] = value;
        fields.join(",")
    }
}

#[test]
fn values_out_of_range_in_csv() {
    for (k, value, words) in [
        (0, "NaN", ["row 4,", "one_minus_alpha", "from 0 to 1"]),
        (0, "1.5", ["row 4,", "one_minus_alpha: 1.5", "from 0 to 1"]),
        (1, "0", ["row 4,", "linear_depth", "above 0"]),
        (1, "inf", ["row 4,", "linear_depth", "above 0"]),
        (2, "-1", ["row 4,", "alpha_sum", "not below 0"]),
        (3, "0", ["row 4,", "fragment_count", "at least 1"]),
        (4, "-0.1", ["row 4,", "transmittance", "from 0 to 1"]),
        (5, "3", ["row 4,", "view", "index of the part"]),
        (9, "-inf", ["row 4,", "column r", "finite"]),
        (13, "nan", ["row 4,", "far", "above 0"]),
        (6, "x", ["line 5,", "column x", "\"x\" is not a number"]),
        (6, "-1", ["line 5,", "column x", "u32"]),
        (1, "", ["line 5,", "linear_depth", "f32"]),
    ] {
        let folder = changed(Format::Csv, CSV, edit_line(5, field(k, value)));
        let message = reading_fails(folder.path());
        has(&message, &words);
        has(&message, &[CSV]);
    }
}

#[test]
fn nan_in_the_binary_formats() {
    // The first value behind the fixed header.
    let file = "fragments-00000-cups-v0.transmittance.npy";
    let folder = changed(Format::Npy, file, |mut bytes| {
        bytes[128..132].copy_from_slice(&f32::NAN.to_le_bytes());
        bytes
    });
    let message = reading_fails(folder.path());
    has(&message, &[file, "row 1,", "column transmittance", "NaN"]);
    let dataset = Dataset::open(folder.path()).unwrap();
    assert!(dataset.read_columns(&[Column::Transmittance]).is_err());
    assert!(dataset.read_columns(&[Column::LinearDepth]).is_ok());
}

#[test]
fn wrong_columns() {
    let folder = changed(
        Format::Csv,
        CSV,
        edit_line(1, |l| l.replace("linear_depth,", "")),
    );
    has(
        &reading_fails(folder.path()),
        &[CSV, "header", "linear_depth is missing"],
    );
    let folder = changed(
        Format::Csv,
        CSV,
        edit_line(1, |l| l.replace("view,x,y", "x,view,y")),
    );
    has(
        &reading_fails(folder.path()),
        &[CSV, "column 6", "\"x\"", "view is expected"],
    );
    let folder = changed(
        Format::Csv,
        CSV,
        edit_line(9, |l| l[..l.len() - 9].to_owned()),
    );
    has(&reading_fails(folder.path()), &[CSV, "line 9", "fields"]);
    let folder = changed(
        Format::Npy,
        "fragments-00000-cups-v0.layer.npy",
        |mut bytes| {
            let at = bytes.windows(3).position(|w| w == b"<u4").unwrap();
            bytes[at..at + 3].copy_from_slice(b"<i8");
            bytes
        },
    );
    has(&reading_fails(folder.path()), &["layer.npy", "<i8", "<u4"]);
}

#[test]
fn truncated_files() {
    for (format, file) in [
        (Format::Csv, "fragments-00002-smoke-in-a-box-v0.csv"),
        (Format::Parquet, "fragments-00002-smoke-in-a-box-v0.parquet"),
        (Format::Npy, "fragments-00002-smoke-in-a-box-v0.x.npy"),
    ] {
        // Cut without a change of the manifest: found on opening.
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), format, None, 1, 1000).unwrap();
        let path = folder.path().join(file);
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let message = Dataset::open(folder.path()).unwrap_err().to_string();
        has(
            &message,
            &[file, "bytes", "write it again", "part 2 of worker test"],
        );
        // Same length, other contents: found by the hash.
        let mut other = bytes.clone();
        other[200] ^= 1;
        fs::write(&path, &other).unwrap();
        let message = Dataset::open(folder.path())
            .unwrap()
            .verify()
            .unwrap_err()
            .to_string();
        has(&message, &[file, "sha256"]);
        fs::remove_file(&path).unwrap();
        let message = Dataset::open(folder.path()).unwrap_err().to_string();
        has(&message, &[file]);
        // Cut, and the manifest made to fit: found on reading.
        let folder = changed(format, file, |b| match format {
            Format::Csv => {
                let cut = b[..b.len() - 1].iter().rposition(|&c| c == b'\n').unwrap();
                b[..=cut].to_vec()
            }
            _ => b[..b.len() - 40].to_vec(),
        });
        has(&reading_fails(folder.path()), &[file]);
    }
}

#[test]
fn manifests() {
    let folder = tempfile::tempdir().unwrap();
    let message = Dataset::open(folder.path()).unwrap_err().to_string();
    has(&message, &["no manifest.json", "peelnet extract"]);
    let message = Dataset::open(folder.path().join("nowhere"))
        .unwrap_err()
        .to_string();
    has(&message, &["nowhere", "open"]);

    write(folder.path(), Format::Csv, None, 1, 1000).unwrap();
    let path = folder.path().join("_peelnet/manifest.json");
    let good = fs::read_to_string(&path).unwrap();
    for (from, to, words) in [
        (
            "\"schema\": 2,",
            "\"schema\": 9,",
            ["schema version 9", "reads versions 1 to 2"],
        ),
        ("\"schema\": 2,", "", ["`schema`", "missing"]),
        ("\"seed\": 7,", "", ["missing field `seed`", "line"]),
        (
            "\"format\": \"csv\"",
            "\"format\": \"xls\"",
            ["xls", "line"],
        ),
        (
            "\"name\": \"view\"",
            "\"name\": \"eye\"",
            ["eye", "in this order"],
        ),
        (
            "\"work_items\": 4",
            "\"work_items\": 5",
            ["1 work items have no part", "4"],
        ),
        (CSV, "../secret.csv", ["parts[0]", "plain file name"]),
        (CSV, "/etc/passwd", ["parts[0]", "plain file name"]),
        (CSV, "fragments-/../../x", ["parts[0]", "plain file name"]),
        (
            CSV,
            "fragments-\\\\..\\\\x",
            ["parts[0]", "plain file name"],
        ),
        (CSV, "C:fragments-x", ["parts[0]", "plain file name"]),
        (CSV, "fragments-x:stream", ["parts[0]", "plain file name"]),
        (CSV, "manifest.json", ["parts[0]", "plain file name"]),
        (
            CSV,
            "fragments-00001-cups-v1.csv",
            ["listed twice", "v1.csv"],
        ),
        ("\"rows\"", "rows", ["not JSON", "line"]),
    ] {
        fs::write(&path, good.replace(from, to)).unwrap();
        let message = Dataset::open(folder.path()).unwrap_err().to_string();
        has(&message, &words);
        has(&message, &["manifest.json"]);
    }
}

#[test]
fn the_writer_refuses_bad_rows() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a/b");
    let writer = DatasetWriter::create(&out, header(Format::Parquet, None)).unwrap();
    let mut part = writer.begin(info(1)).unwrap();
    part.write(&view(1, 10, 1)).unwrap();
    let before = part.rows();
    let mut rows = view(1, 10, 2);
    rows.linear_depth[3] = f32::NAN;
    let message = part.write(&rows).unwrap_err().to_string();
    let row = format!("row {}", before + 4);
    has(&message, &["fragments-00001-cups-v1", &row, "linear_depth"]);
    rows.linear_depth.pop();
    let message = part.write(&rows).unwrap_err().to_string();
    has(&message, &["linear_depth", "values where the others"]);
    drop(part);
    // A second part of the same item, one out of range, an item left out.
    assert!(writer.begin(info(1)).is_err());
    let wrong = PartInfo {
        index: 4,
        ..info(0)
    };
    has(
        &writer.begin(wrong).err().unwrap().to_string(),
        &["work item 4 of 4"],
    );
    let message = writer.finish().unwrap_err().to_string();
    has(&message, &["4 work items were not written"]);
    // Nothing is left, not even the folders.
    assert!(contents(folder.path()).is_empty());
}

#[test]
fn an_unwritable_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    // A file where a folder should be fails for every user, permissions would not for root.
    for out in [file.clone(), file.join("out")] {
        let message = DatasetWriter::create(&out, header(Format::Csv, None))
            .unwrap_err()
            .to_string();
        has(&message, &[out.to_str().unwrap(), "cannot"]);
    }
    assert_eq!(
        contents(folder.path()),
        [("file".to_owned(), b"x".to_vec())]
    );
}

#[test]
fn only_datasets_are_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let notes = folder.path().join("notes.txt");
    fs::write(&notes, "mine").unwrap();
    let message = write(folder.path(), Format::Csv, None, 1, 1000)
        .unwrap_err()
        .to_string();
    has(&message, &["notes.txt", "not empty"]);
    let shard = Some(Shard::new(1, 2).unwrap());
    assert!(write(folder.path(), Format::Csv, shard, 1, 1000).is_err());
    assert_eq!(
        contents(folder.path()),
        [("notes.txt".to_owned(), b"mine".to_vec())]
    );
    fs::remove_file(&notes).unwrap();

    write(folder.path(), Format::Npy, None, 1, 1000).unwrap();
    let old = contents(folder.path());
    // A writer that is dropped leaves the old dataset as it was.
    let writer = DatasetWriter::create(folder.path(), header(Format::Csv, None)).unwrap();
    let mut part = writer.begin(info(0)).unwrap();
    part.write(&view(0, 10, 1)).unwrap();
    drop(part);
    // Meanwhile no other may write here.
    let busy = DatasetWriter::create(folder.path(), header(Format::Csv, None));
    has(&busy.unwrap_err().to_string(), &["another extraction"]);
    drop(writer);
    assert_eq!(contents(folder.path()), old);
    // A writer that was killed left its hidden folder.
    let dead = folder.path().join(".partial-dead");
    fs::create_dir(&dead).unwrap();
    fs::write(dead.join("lock"), "").unwrap();
    fs::write(dead.join("fragments-00000"), "x").unwrap();
    write(folder.path(), Format::Csv, None, 1, 1000).unwrap();
    let names: Vec<String> = contents(folder.path()).into_iter().map(|c| c.0).collect();
    assert_eq!(
        names,
        [
            "_peelnet/",
            "_peelnet/manifest.json",
            "_peelnet/parts/",
            "_peelnet/parts/00000.json",
            "_peelnet/parts/00001.json",
            "_peelnet/parts/00002.json",
            "_peelnet/parts/00003.json",
            "_peelnet/plan.json",
            CSV,
            "fragments-00001-cups-v1.csv",
            "fragments-00002-smoke-in-a-box-v0.csv",
            "fragments-00003-smoke-in-a-box-v1.csv",
        ]
    );
}

/// A name says nothing: what a manifest of ours does not list, with its length, is somebody else's.
#[test]
fn files_that_no_manifest_lists_are_never_removed() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str| {
        let before = contents(folder.path());
        let message = write(folder.path(), Format::Csv, None, 1, 1000).unwrap_err();
        has(&message.to_string(), &[name, "move that file away"]);
        assert_eq!(contents(folder.path()), before);
    };
    for (name, text) in [
        ("manifest.json", r#"{"name": "an app", "icons": []}"#),
        ("_peelnet", "mine"),
        ("manifest.json", "not even JSON"),
        ("fragments-x.csv", "mine"),
        (".partial-notes", "mine"),
    ] {
        let path = folder.path().join(name);
        if name.starts_with('.') {
            fs::create_dir(&path).unwrap();
            fs::write(path.join("fragments-mine"), text).unwrap();
        } else {
            fs::write(&path, text).unwrap();
        }
        refused(name);
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
    }
    // Beside a dataset of ours, and in place of one of its files.
    write(folder.path(), Format::Csv, None, 1, 1000).unwrap();
    for name in ["fragments-x.csv", "notes.txt"] {
        fs::write(folder.path().join(name), "mine").unwrap();
        refused(name);
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join(CSV), "mine").unwrap();
    refused(CSV);
    fs::remove_file(folder.path().join(CSV)).unwrap();
    write(folder.path(), Format::Npy, None, 1, 1000).unwrap();
}

/// Killed while the files moved: the hidden folder's manifests say which files are a dataset's.
#[test]
fn a_writer_killed_while_it_moved_files_is_not_in_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (folder.path().join("old"), folder.path().join("new"));
    write(&old, Format::Npy, None, 1, 1000).unwrap();
    write(&new, Format::Csv, None, 1, 1000).unwrap();
    let whole = contents(&new);
    let dead = old.join(".partial-dead");
    fs::create_dir(&dead).unwrap();
    fs::write(dead.join("lock"), "").unwrap();
    // The old manifest is away, some old files are gone, and one new file is there.
    let list = contents(&old)
        .into_iter()
        .map(|(name, c)| format!("{name:?}: {}", c.len()));
    let list = list
        .filter(|l| l.starts_with("\"fragments"))
        .collect::<Vec<_>>()
        .join(", ");
    fs::write(
        dead.join("replaced.json"),
        format!("{{\"files\": {{{list}}}}}"),
    )
    .unwrap();
    fs::remove_dir_all(old.join("_peelnet")).unwrap();
    fs::remove_file(old.join("fragments-00000-cups-v0.x.npy")).unwrap();
    fs::copy(new.join(CSV), old.join(CSV)).unwrap();
    fs::copy(
        new.join("_peelnet/manifest.json"),
        dead.join("manifest.json"),
    )
    .unwrap();
    fs::copy(new.join(CSV), dead.join("fragments-00001-cups-v1.csv")).unwrap();
    fs::write(old.join("fragments-mine"), "mine").unwrap();
    let message = write(&old, Format::Csv, None, 1, 1000).unwrap_err();
    has(&message.to_string(), &["fragments-mine"]);
    fs::remove_file(old.join("fragments-mine")).unwrap();
    write(&old, Format::Csv, None, 1, 1000).unwrap();
    assert_eq!(contents(&old), whole);
}

/// Files are read by nobody whose hash was not compared before.
#[test]
fn every_reader_checks_the_hashes() {
    for format in [Format::Csv, Format::Npy] {
        let folder = tempfile::tempdir().unwrap();
        let manifest = write(folder.path(), format, None, 1, 1000).unwrap();
        // A value that its column allows.
        let name = match format {
            Format::Npy => &manifest.parts[2].files[Column::LinearDepth.index()].name,
            _ => &manifest.parts[2].files[0].name,
        };
        let path = folder.path().join(name);
        let mut bytes = fs::read(&path).unwrap();
        let last = bytes.len() - if format == Format::Csv { 2 } else { 3 };
        bytes[last] ^= 1;
        fs::write(&path, bytes).unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        let error = dataset.batches(100).find_map(Result::err).unwrap();
        has(&error.to_string(), &[name, "sha256"]);
        let error = dataset.read_columns(&[Column::LinearDepth]).unwrap_err();
        has(&error.to_string(), &[name, "sha256"]);
        let error = dataset.clone().batches_where(9, |p| p.index == 2).next();
        assert!(error.unwrap().is_err());
        // The other parts are whole.
        let others = dataset.batches_where(100, |p| p.index != 2);
        assert!({ others }.all(|batch| batch.is_ok()));
    }
}

/// A file may claim any number of rows; memory is taken only for rows that its bytes can hold.
#[test]
fn absurd_counts_are_refused_before_memory_is_taken() {
    let trillion = 1_000_000_000_000u64;
    for format in Format::ALL {
        let folder = tempfile::tempdir().unwrap();
        let manifest = write(folder.path(), format, None, 1, 1000).unwrap();
        let path = folder.path().join("_peelnet/manifest.json");
        let mut more = manifest.clone();
        more.rows += trillion - more.parts[0].rows;
        more.parts[0].rows = trillion;
        more.parts[0].row_groups = vec![trillion];
        fs::write(&path, serde_json::to_vec(&more).unwrap()).unwrap();
        let message = Dataset::open(folder.path())
            .and_then(|dataset| dataset.read_columns(&Column::ALL).map(drop))
            .unwrap_err()
            .to_string();
        has(&message, &["1000000000000"]);
        let mut items = manifest.clone();
        items.work_items = u32::MAX;
        fs::write(&path, serde_json::to_vec(&items).unwrap()).unwrap();
        let message = Dataset::open(folder.path()).unwrap_err().to_string();
        has(
            &message,
            &["manifest.json", "4294967295 work items", "65536"],
        );
    }
    let npy = "fragments-00000-cups-v0.x.npy";
    let shape = changed(Format::Npy, npy, |mut bytes| {
        let at = bytes.iter().position(|b| *b == b'(').unwrap();
        bytes[at..at + 17].copy_from_slice(b"(1000000000000,)}");
        bytes
    });
    has(&reading_fails(shape.path()), &[npy, "1000000000000 rows"]);
    let length = changed(Format::Npy, npy, |mut bytes| {
        bytes[6] = 3;
        bytes[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        bytes
    });
    has(
        &reading_fails(length.path()),
        &[npy, "4294967295 bytes", "4096"],
    );
    let line = changed(Format::Csv, CSV, |mut bytes| {
        bytes.resize(1 << 20, b'1');
        bytes
    });
    has(
        &reading_fails(line.path()),
        &[CSV, "a line has more than 65536"],
    );
    let parquet = "fragments-00000-cups-v0.parquet";
    let footer = changed(Format::Parquet, parquet, |mut bytes| {
        let end = bytes.len() - 8;
        bytes[end..end + 4].copy_from_slice(&0x7fff_ffffu32.to_le_bytes());
        bytes
    });
    has(
        &reading_fails(footer.path()),
        &[parquet, "2147483647 bytes"],
    );
    let writer = Header {
        work_items: u32::MAX,
        ..header(Format::Csv, None)
    };
    let out = tempfile::tempdir().unwrap();
    let message = DatasetWriter::create(out.path(), writer).unwrap_err();
    has(&message.to_string(), &["4294967295", "65536"]);
}

/// A pipe would wait for ever, a device never end.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_files_of_a_dataset() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("_peelnet/manifest.json");
    fs::create_dir(folder.path().join("_peelnet")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    has(
        &Dataset::open(folder.path()).unwrap_err().to_string(),
        &["manifest.json", "regular"],
    );
    fs::remove_file(&path).unwrap();
    write(folder.path(), Format::Csv, None, 1, 1000).unwrap();
    let mut manifest: Manifest = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let empty = manifest.parts[3].files[0].clone();
    let part = folder.path().join(&empty.name);
    fs::remove_file(&part).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&part).status();
    assert!(made.unwrap().success());
    // The length of a pipe is 0, and no rows need no bytes.
    manifest.format = Format::Parquet;
    for part in &mut manifest.parts {
        part.files[0].bytes = fs::metadata(folder.path().join(&part.files[0].name))
            .unwrap()
            .len();
    }
    fs::write(&path, serde_json::to_vec(&manifest).unwrap()).unwrap();
    let dataset = Dataset::open(folder.path()).unwrap();
    let error = dataset.batches_where(9, |p| p.index == 3).next().unwrap();
    has(&error.unwrap_err().to_string(), &[&empty.name, "regular"]);
}
