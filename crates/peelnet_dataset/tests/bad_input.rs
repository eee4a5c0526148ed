//! Every kind of bad dataset gives one error that names the file, the place and the fix, and nothing half-written
//! stays.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use std::fs;
use std::path::Path;

use common::*;
use peelnet_dataset::*;

const CSV: &str = "fragments-00000-cups-v0.csv";
const PARQUET: &str = "fragments-00000-cups-v0.parquet";
const MANIFEST: &str = "_peelnet/manifest.json";

/// Writes a dataset, lets a part's file be changed, and makes the manifest fit the change, so that only the contents
/// are wrong.
fn changed(format: Format, file: &str, change: impl Fn(&mut Vec<u8>)) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut manifest = write(folder.path(), format, None, 1, 1000).unwrap();
    let path = folder.path().join(file);
    let mut bytes = fs::read(&path).unwrap();
    change(&mut bytes);
    fs::write(&path, &bytes).unwrap();
    let mut lines = String::new();
    for part in &mut manifest.parts {
        for entry in &mut part.files {
            if entry.name == file {
                entry.bytes = bytes.len() as u64;
                entry.sha256 = sha256(&bytes);
            }
            lines += &format!("{} {}\n", part.index, entry.sha256);
        }
    }
    manifest.hash = sha256(lines.as_bytes());
    let text = serde_json::to_vec(&manifest).unwrap();
    fs::write(folder.path().join(MANIFEST), text).unwrap();
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

fn writing_fails(folder: &Path, words: &[&str]) {
    let before = contents(folder);
    let error = write(folder, Format::Csv, None, 1, 1000).unwrap_err();
    assert_eq!(contents(folder), before);
    has(&error.to_string(), words);
}

type Change = Box<dyn Fn(&mut Vec<u8>)>;

/// Changes a line of a text.
fn line(line: usize, edit: impl Fn(&str) -> String + 'static) -> Change {
    Box::new(move |bytes| {
        let text = std::str::from_utf8(bytes).unwrap();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines[line - 1] = edit(&lines[line - 1]);
        *bytes = (lines.join("\n") + "\n").into_bytes();
    })
}

/// Changes a field of row 4.
fn field(k: usize, value: &'static str) -> Change {
    line(5, move |line| {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields[k] = value;
        fields.join(",")
    })
}

/// Replaces some bytes by as many others.
fn bytes(from: &'static [u8], to: &'static [u8]) -> Change {
    Box::new(move |bytes| {
        let at = bytes.windows(from.len()).position(|w| w == from).unwrap();
        bytes[at..at + to.len()].copy_from_slice(to);
    })
}

/// Values that are not allowed and contents that are no part's. Memory is taken only for rows that a file's bytes can hold, whatever its
/// header claims.
#[test]
fn contents_that_are_none() {
    let refused = |format, file: &str, change: Change, words: &[&str]| {
        let folder = changed(format, file, change);
        let message = reading_fails(folder.path());
        has(&message, words);
        has(&message, &[file]);
        folder
    };
    let csv = |change, words: &[&str]| drop(refused(Format::Csv, CSV, change, words));
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
        csv(field(k, value), &words);
    }
    let header = |from: &'static str, to: &'static str| line(1, move |l| l.replace(from, to));
    csv(
        header("linear_depth,", ""),
        &["header: column linear_depth is missing"],
    );
    csv(
        header("view,x,y", "x,view,y"),
        &["column 6 is \"x\" where view is expected"],
    );
    csv(
        line(9, |l| l[..l.len() - 9].to_owned()),
        &["line 9", "fields"],
    );
    let long: Change = Box::new(|bytes| bytes.resize(1 << 20, b'1'));
    csv(long, &["a line has more", "65536"]);

    let npy = |column, change, words: &[&str]| {
        let file = format!("fragments-00000-cups-v0.{column}.npy");
        let folder = refused(Format::Npy, &file, change, words);
        // The other columns are whole.
        let dataset = Dataset::open(folder.path()).unwrap();
        let columns = [Column::from_name(column).unwrap()];
        assert!(dataset.read_columns(&columns).is_err());
        assert!(dataset.read_columns(&[Column::LinearDepth]).is_ok());
    };
    npy("layer", bytes(b"<u4", b"<i8"), &["<i8", "<u4"]);
    npy(
        "x",
        bytes(b"'shape': (", b"'shape': (1000"),
        &["(1000", "header"],
    );
    npy(
        "y",
        bytes(b"v\0{", b"\xff\xff{"),
        &["not an NPY file", "header"],
    );
    // The first value behind the header.
    let nan = bytes(b"\n\0\0\x80\x3f", b"\n\0\0\xc0\x7f");
    npy(
        "transmittance",
        nan,
        &["row 1, column transmittance", "NaN"],
    );

    let footer: Change = Box::new(|bytes| {
        let end = bytes.len() - 8;
        bytes[end..end + 4].copy_from_slice(&0x7fff_ffffu32.to_le_bytes());
    });
    drop(refused(
        Format::Parquet,
        PARQUET,
        footer,
        &["2147483647 bytes"],
    ));
}

#[test]
fn files_that_were_cut_or_changed() {
    for format in Format::ALL {
        let folder = tempfile::tempdir().unwrap();
        let manifest = write(folder.path(), format, None, 1, 1000).unwrap();
        let entry = match format {
            Format::Npy => Column::LinearDepth.index(),
            _ => 0,
        };
        let file = manifest.parts[2].files[entry].name.as_str();
        let path = folder.path().join(file);
        let whole = fs::read(&path).unwrap();
        // Cut without a change of the manifest: found on opening.
        fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        opening_fails(
            folder.path(),
            &[file, "bytes", "write it again", "part 2 of worker test"],
        );
        // Same length, and a value that the column allows: found by the hash, whoever reads.
        let mut other = whole.clone();
        let last = other.len() - if format == Format::Csv { 2 } else { 3 };
        other[last] ^= 1;
        fs::write(&path, &other).unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        let mut errors = vec![dataset.verify().unwrap_err()];
        if format != Format::Parquet {
            errors.push(dataset.batches(100).find_map(Result::err).unwrap());
            errors.push(dataset.read_columns(&[Column::LinearDepth]).unwrap_err());
        }
        for error in errors {
            has(&error.to_string(), &[file, "sha256"]);
        }
        let mut others = dataset.batches_where(100, |p| p.index != 2);
        assert!(
            others.all(|batch| batch.is_ok()),
            "the other parts are whole"
        );
        fs::remove_file(&path).unwrap();
        opening_fails(folder.path(), &[file, "is missing"]);
        // Cut, and the manifest made to fit: found on reading.
        let folder = changed(format, file, |b| {
            let line = || b[..b.len() - 1].iter().rposition(|&c| c == b'\n').unwrap();
            let cut = match format {
                Format::Csv => line() + 1,
                _ => b.len() - 40,
            };
            b.truncate(cut);
        });
        has(&reading_fails(folder.path()), &[file]);
    }
}

#[test]
fn manifests() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    opening_fails(folder, &["no _peelnet/manifest.json", "peelnet extract"]);
    opening_fails(&folder.join("nowhere"), &["nowhere", "open"]);
    write(folder, Format::Csv, None, 1, 1000).unwrap();
    let path = folder.join(MANIFEST);
    let good = fs::read_to_string(&path).unwrap();
    let wrong = |from: &str, to: &str, words: &[&str]| {
        fs::write(&path, good.replace(from, to)).unwrap();
        opening_fails(folder, words);
        opening_fails(folder, &["manifest.json"]);
    };
    wrong(
        "\"schema\": 2,",
        "\"schema\": 9,",
        &["version 9", "version 2"],
    );
    wrong("\"schema\": 2,", "", &["`schema`", "missing"]);
    wrong("\"seed\": 7,", "", &["missing field `seed`", "line"]);
    wrong(
        "\"format\": \"csv\"",
        "\"format\": \"xls\"",
        &["xls", "line"],
    );
    wrong(
        "\"name\": \"view\"",
        "\"name\": \"eye\"",
        &["eye", "in this order"],
    );
    let items = "\"work_items\": 4";
    wrong(items, "\"work_items\": 5", &["5 work items", "4 parts"]);
    wrong(
        items,
        "\"work_items\": 4294967295",
        &["4294967295", "65536"],
    );
    for name in [
        "../secret.csv",
        "/etc/passwd",
        "fragments-/../../x",
        "fragments-\\\\..\\\\x",
        "C:fragments-x",
        "fragments-x:stream",
        "manifest.json",
    ] {
        wrong(CSV, name, &["parts[0]", "plain file name"]);
    }
    let other = "fragments-00001-cups-v1.csv";
    wrong(CSV, other, &["listed twice", "v1.csv"]);
    wrong("\"rows\"", "rows", &["not JSON", "line"]);
    // More rows than any file holds.
    for format in Format::ALL {
        let folder = tempfile::tempdir().unwrap();
        let mut manifest = write(folder.path(), format, None, 1, 1000).unwrap();
        manifest.rows += 1_000_000_000_000 - manifest.parts[0].rows;
        manifest.parts[0].rows = 1_000_000_000_000;
        manifest.parts[0].row_groups = vec![1_000_000_000_000];
        let text = serde_json::to_vec(&manifest).unwrap();
        fs::write(folder.path().join(MANIFEST), text).unwrap();
        let error = Dataset::open(folder.path())
            .and_then(|dataset| dataset.read_columns(&Column::ALL).map(drop))
            .unwrap_err();
        has(&error.to_string(), &["1000000000000"]);
    }
}

#[test]
fn the_writer_refuses_bad_rows() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a/b");
    let writer = DatasetWriter::create(&out, header(Format::Parquet, None)).unwrap();
    let mut part = writer.begin(info(1)).unwrap();
    let good = view(1, 10, 1);
    part.write(&good).unwrap();
    let mut rows = view(1, 10, 2);
    rows.linear_depth[3] = f32::NAN;
    let message = part.write(&rows).unwrap_err().to_string();
    let row = format!("row {}", good.len() + 4);
    has(&message, &["fragments-00001-cups-v1", &row, "linear_depth"]);
    rows.linear_depth.pop();
    let message = part.write(&rows).unwrap_err().to_string();
    has(&message, &["linear_depth", "values where the others"]);
    drop(part);
    // A second part of the same item, one out of range, an item left out.
    assert!(writer.begin(info(1)).is_err());
    let wrong = Part {
        index: 4,
        ..info(0)
    };
    let message = writer.begin(wrong).err().unwrap().to_string();
    has(&message, &["work item 4 of 4"]);
    let message = writer.finish().unwrap_err().to_string();
    has(&message, &["4 work items were not written"]);
    // Nothing is left, not even the folders.
    assert!(contents(folder.path()).is_empty());
    let header = Header {
        work_items: u32::MAX,
        ..header(Format::Csv, None)
    };
    let message = DatasetWriter::create(folder.path(), header).unwrap_err();
    has(&message.to_string(), &["4294967295", "65536"]);
    // A file where a folder should be fails for every user, permissions would not for root.
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    for out in [file.clone(), file.join("out")] {
        let message = write(&out, Format::Csv, None, 1, 1000).unwrap_err();
        has(&message.to_string(), &[out.to_str().unwrap(), "cannot"]);
    }
    assert_eq!(contents(folder.path()).len(), 1);
}

/// A name says nothing: what a manifest of ours does not list, with its length, is somebody else's.
#[test]
fn files_that_no_manifest_lists_are_never_removed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, text) in [
        ("notes.txt", "mine"),
        ("manifest.json", r#"{"name": "an app", "icons": []}"#),
        ("_peelnet", "mine"),
        ("fragments-x.csv", "mine"),
        ("_peelnet/notes.txt", "mine"),
        ("_peelnet/manifest.json", "not even JSON"),
        ("_peelnet/.partial-notes/fragments-mine", "mine"),
    ] {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        let shown = name.trim_end_matches("/fragments-mine");
        writing_fails(folder, &[shown, "not empty", "move that file away"]);
        let shard = Some(Shard { index: 1, of: 2 });
        if !name.contains('/') {
            assert!(write(folder, Format::Csv, shard, 1, 1000).is_err());
        }
        let _ = fs::remove_dir_all(folder.join("_peelnet"));
        let _ = fs::remove_file(folder.join("_peelnet"));
        let _ = fs::remove_file(&path);
    }
    // Beside a dataset of ours, and in place of one of its files.
    write(folder, Format::Csv, None, 1, 1000).unwrap();
    for name in ["fragments-x.csv", "notes.txt", CSV] {
        fs::write(folder.join(name), "mine").unwrap();
        writing_fails(folder, &[name, "move that file away"]);
        fs::remove_file(folder.join(name)).unwrap();
    }
    write(folder, Format::Npy, None, 1, 1000).unwrap();
}

/// A pipe would wait for ever, a device never end.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_files_of_a_dataset() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(MANIFEST);
    fs::create_dir(folder.path().join("_peelnet")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    opening_fails(folder.path(), &["manifest.json", "regular"]);
    fs::remove_file(&path).unwrap();
    let mut manifest = write(folder.path(), Format::Csv, None, 1, 1000).unwrap();
    let empty = manifest.parts[3].files[0].name.clone();
    let part = folder.path().join(&empty);
    fs::remove_file(&part).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&part).status();
    assert!(made.unwrap().success());
    // The length of a pipe is 0, and no rows need no bytes.
    manifest.format = Format::Parquet;
    manifest.parts[3].files[0].bytes = 0;
    fs::write(&path, serde_json::to_vec(&manifest).unwrap()).unwrap();
    let dataset = Dataset::open(folder.path()).unwrap();
    let error = dataset.batches_where(9, |p| p.index == 3).next().unwrap();
    has(&error.unwrap_err().to_string(), &[&empty, "regular"]);
}
