//! Every kind of bad dataset gives one error that names the file, the place and the fix, and nothing half-written
//! stays.

use super::*;

const CSV: &str = "fragments-00000-cups-v0.csv";
const PARQUET: &str = "fragments-00000-cups-v0.parquet";
const MANIFEST: &str = "_peelnet/manifest.json";

/// Writes a dataset, lets a part's file be changed, and makes the manifest fit the change, so that only the contents
/// are wrong.
fn changed(format: Format, file: &str, change: impl Fn(&mut Vec<u8>)) -> TempDir {
    let folder = temporary();
    let mut manifest = write(folder.path(), format).unwrap();
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
    put_manifest(folder.path(), &manifest);
    folder
}

fn put_manifest(folder: &Path, manifest: &Manifest) {
    let text = serde_json::to_vec(manifest).unwrap();
    fs::write(folder.join(MANIFEST), text).unwrap();
}

/// The error of reading everything; opening must work.
fn reading_fails(folder: &Path, words: &[&str]) {
    let dataset = Dataset::open(folder).unwrap();
    dataset.verify().unwrap();
    let mut batches = dataset.batches(100);
    let error = batches.find_map(Result::err).expect("reading must fail");
    assert!(batches.next().is_none(), "an error ends the batches");
    has(&error, words);
}

fn writing_fails(folder: &Path, words: &[&str]) {
    let before = contents(folder);
    has(&write(folder, Format::Csv).unwrap_err(), words);
    assert_eq!(contents(folder), before);
}

type Change = Box<dyn Fn(&mut Vec<u8>)>;

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
        reading_fails(folder.path(), &[words, &[file]].concat());
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
        (6, "4000", ["row 4,", "column x", "below the frame's width"]),
        (
            7,
            "4000",
            ["row 4,", "column y", "below the frame's height"],
        ),
        (9, "-inf", ["row 4,", "column r", "finite"]),
        (13, "nan", ["row 4,", "far", "above 0"]),
        (6, "x", ["line 5,", "column x", "\"x\" is not a number"]),
        (6, "-1", ["line 5,", "column x", "u32"]),
        (1, "", ["line 5,", "linear_depth", "f32"]),
    ] {
        csv(field(k, value), &words);
    }
    let header = |from: &'static str, to: &'static str| line(1, move |l| l.replace(from, to));
    let words = "header: column linear_depth is missing";
    csv(header("linear_depth,", ""), &[words]);
    let words = "column 6 is \"x\" where view is expected";
    csv(header("view,x,y", "x,view,y"), &[words]);
    let cut = line(9, |l| l[..l.len() - 9].to_owned());
    csv(cut, &["line 9", "fields"]);
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
    let shape = bytes(b"'shape': (", b"'shape': (1000");
    npy("x", shape, &["(1000", "header"]);
    let length = bytes(b"v\0{", b"\xff\xff{");
    npy("y", length, &["not an NPY file", "header"]);
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
    refused(Format::Parquet, PARQUET, footer, &["2147483647 bytes"]);
    let page = |change| {
        let words = ["one_minus_alpha", "a page that peelnet does not write"];
        refused(Format::Parquet, PARQUET, change, &words);
    };
    // Of the first page: its length is larger than that of its values, and they are numbers of a dictionary that is not there.
    let length: Change = Box::new(|bytes| {
        assert_eq!(bytes[..7], *b"PAR1\x15\0\x15");
        bytes[8] = 127;
    });
    page(length);
    page(bytes(b"\x15\0\x15\x06", b"\x15\x10\x15\x06"));
}

#[test]
fn files_that_were_changed() {
    for format in Format::ALL {
        let folder = temporary();
        let manifest = write(folder.path(), format).unwrap();
        let entry = match format {
            Format::Npy => Column::LinearDepth as usize,
            _ => 0,
        };
        let file = manifest.parts[2].files[entry].name.as_str();
        // Same length, and a value that the column allows: found by the hash, whoever reads.
        let path = folder.path().join(file);
        let mut other = fs::read(&path).unwrap();
        let last = other.len() - if format == Format::Csv { 2 } else { 3 };
        other[last] ^= 1;
        fs::write(&path, &other).unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        for error in [
            dataset.verify().unwrap_err(),
            dataset.batches(100).find_map(Result::err).unwrap(),
            dataset.read_columns(&[Column::LinearDepth]).unwrap_err(),
        ] {
            has(&error, &[file, "sha256"]);
        }
        let mut others = dataset.batches_where(100, |p| p.index != 2);
        assert!(others.all(|b| b.is_ok()), "the other parts are whole");
        // Cut, and the manifest made to fit: found on reading.
        let folder = changed(format, file, |b| {
            let line = || b[..b.len() - 1].iter().rposition(|&c| c == b'\n').unwrap();
            let cut = match format {
                Format::Csv => line() + 1,
                _ => b.len() - 40,
            };
            b.truncate(cut);
        });
        reading_fails(folder.path(), &[file]);
    }
}

#[test]
fn manifests() {
    let folder = temporary();
    let folder = folder.path();
    opening_fails(folder, &["no _peelnet/manifest.json", "peelnet extract"]);
    opening_fails(
        &folder.join("nowhere"),
        &["nowhere", "no such dataset", "peelnet extract"],
    );
    write(folder, Format::Csv).unwrap();
    let path = folder.join(MANIFEST);
    let good = fs::read_to_string(&path).unwrap();
    let wrong = |from: &str, to: &str, words: &[&str]| {
        fs::write(&path, good.replace(from, to)).unwrap();
        opening_fails(folder, &[words, &["manifest.json"]].concat());
    };
    let schema = "\"schema\": 2,";
    wrong(schema, "\"schema\": 9,", &["version 9", "version 2"]);
    wrong(schema, "", &["`schema`", "missing"]);
    wrong("\"seed\": 7,", "", &["missing field `seed`", "line"]);
    wrong(": \"csv\"", ": \"xls\"", &["xls", "line"]);
    wrong(": \"view\"", ": \"eye\"", &["eye", "in this order"]);
    let items = "\"work_items\": 4";
    wrong(items, "\"work_items\": 5", &["5 work items", "4 parts"]);
    let most = u32::MAX.to_string();
    wrong(items, &items.replace('4', &most), &[&most, "65536"]);
    for name in [
        "../secret.csv",
        "/etc/passwd",
        "fragments-/../../x",
        "fragments-\\\\..\\\\x",
        "C:fragments-x",
        "fragments-x:stream",
        "manifest.json",
    ] {
        wrong(CSV, name, &["parts[0]", "not those of its scene", CSV]);
    }
    wrong(CSV, "fragments-00001-cups-v1.csv", &["parts[0]", CSV]);
    wrong("\"rows\"", "rows", &["not JSON", "line"]);
    let lost = "\"lost_fragments\": ";
    let words = &["`lost_fragments`", "but the parts hold"];
    wrong(lost, &format!("{lost}7"), words);
    // Records say what their writers measured.
    let mut manifest: Manifest = serde_json::from_str(&good).unwrap();
    manifest.parts[1].camera.near += 1.0;
    put_manifest(folder, &manifest);
    reading_fails(folder, &["_peelnet/parts", "part 1", "edited"]);
    // More rows than any file holds.
    for format in Format::ALL {
        let folder = temporary();
        let mut manifest = write(folder.path(), format).unwrap();
        let many = 1_000_000_000_000;
        manifest.rows += many - manifest.parts[0].rows;
        manifest.parts[0].rows = many;
        manifest.parts[0].row_groups = vec![many];
        put_manifest(folder.path(), &manifest);
        let read = |dataset: Dataset| dataset.read_columns(&Column::ALL);
        let error = Dataset::open(folder.path()).and_then(read).unwrap_err();
        has(&error, &["1000000000000"]);
    }
}

#[test]
fn the_writer_refuses_bad_rows() {
    let folder = temporary();
    let writer = DatasetWriter::create(folder.path().join("a/b"), header(Format::Parquet)).unwrap();
    let mut part = writer.begin(info(1)).unwrap();
    let good = view(1, 10, 1);
    part.write(&good).unwrap();
    let mut rows = view(1, 10, 2);
    rows.linear_depth[3] = f32::NAN;
    let row = format!("row {}", good.len() + 4);
    let words = ["fragments-00001-cups-v1", &row, "linear_depth"];
    has(&part.write(&rows).unwrap_err(), &words);
    rows.linear_depth.pop();
    let words = ["linear_depth", "values where the others"];
    has(&part.write(&rows).unwrap_err(), &words);
    drop(part);
    // A second part of the same item, one out of range, an item left out.
    assert!(writer.begin(info(1)).is_err());
    let wrong = Part {
        index: 4,
        ..info(0)
    };
    has(&writer.begin(wrong).err().unwrap(), &["work item 4 of 4"]);
    let words = ["4 work items were not written"];
    has(&writer.finish().unwrap_err(), &words);
    // Nothing is left, not even the folders.
    assert!(contents(folder.path()).is_empty());
    let many = Header {
        work_items: u32::MAX,
        ..header(Format::Csv)
    };
    let error = DatasetWriter::create(folder.path(), many).unwrap_err();
    has(&error, &["4294967295", "65536"]);
    // A file where a folder should be fails for every user, permissions would not for root.
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    for out in [file.clone(), file.join("out")] {
        let error = write(&out, Format::Csv).unwrap_err();
        has(&error, &[out.to_str().unwrap(), "cannot"]);
    }
    assert_eq!(contents(folder.path()).len(), 1);
}

/// A name says nothing: what a manifest of ours does not list, with its length, is somebody else's.
#[test]
fn files_that_no_manifest_lists_are_never_removed() {
    for (name, text) in [
        ("notes.txt", "mine"),
        ("manifest.json", r#"{"name": "an app", "icons": []}"#),
        ("_peelnet", "mine"),
        ("fragments-x.csv", "mine"),
        ("_peelnet/notes.txt", "mine"),
        ("_peelnet/manifest.json", "not even JSON"),
        ("_peelnet/.partial-notes/fragments-mine", "mine"),
    ] {
        let folder = temporary();
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        let shown = name.trim_end_matches("/fragments-mine");
        let words = [shown, "not empty", "move that file away"];
        writing_fails(folder.path(), &words);
        let shard = Header {
            shard: Some(Shard { index: 1, of: 2 }),
            ..header(Format::Csv)
        };
        assert!(name.contains('/') || write_by(folder.path(), shard, 1000).is_err());
    }
    // Beside a dataset of ours, and in place of one of its files.
    let folder = temporary();
    let folder = folder.path();
    write(folder, Format::Csv).unwrap();
    for name in ["fragments-x.csv", "notes.txt", CSV] {
        fs::write(folder.join(name), "mine").unwrap();
        writing_fails(folder, &[name, "move that file away"]);
        fs::remove_file(folder.join(name)).unwrap();
    }
    write(folder, Format::Npy).unwrap();
}

/// A pipe would wait for ever, a device never end.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_files_of_a_dataset() {
    let folder = temporary();
    let mut manifest = write(folder.path(), Format::Parquet).unwrap();
    let empty = manifest.parts[3].files[0].name.clone();
    let (part, path) = (folder.path().join(&empty), folder.path().join(MANIFEST));
    fs::remove_file(&part).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&part).status();
    assert!(made.unwrap().success());
    // The length of a pipe is 0, and no rows need no bytes.
    manifest.parts[3].files[0].bytes = 0;
    put_manifest(folder.path(), &manifest);
    let dataset = Dataset::open(folder.path()).unwrap();
    let error = dataset.batches_where(9, |p| p.index == 3).next().unwrap();
    has(&error.unwrap_err(), &[&empty, "regular"]);
    fs::remove_file(&path).unwrap();
    std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
    opening_fails(folder.path(), &["manifest.json", "regular"]);
}
