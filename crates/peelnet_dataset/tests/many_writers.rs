//! Several writers of one dataset, and writers that die.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use std::fs;
use std::path::Path;

use common::*;
use peelnet_dataset::*;

fn shard(index: u32, of: u32) -> Option<Shard> {
    Some(Shard { index, of })
}

/// A header of a worker.
fn by(worker: &str, format: Format, shard: Option<Shard>) -> Header {
    Header {
        worker: worker.to_owned(),
        ..header(format, shard)
    }
}

fn resuming(worker: &str, format: Format) -> Header {
    Header {
        resume: true,
        ..by(worker, format, None)
    }
}

/// Does what is missing.
fn resume(folder: &Path, worker: &str) -> Result<Manifest, DatasetError> {
    write_by(folder, resuming(worker, Format::Csv), 1, 1000)
}

/// Writes one part, of `pixels` pixels.
fn view_part(writer: &DatasetWriter, index: u32, pixels: u32) -> Result<(), DatasetError> {
    part(writer, index, &view(index, pixels, 1), usize::MAX / 2)
}

/// A writer that is killed: it does not come to its end, and leaves what it had.
fn killed(folder: &Path, header: Header, parts: &[u32]) {
    let writer = DatasetWriter::create(folder, header).unwrap();
    for &index in parts {
        view_part(&writer, index, pixels(index)).unwrap();
    }
}

fn is_sealed(folder: &Path) -> bool {
    folder.join("_peelnet/manifest.json").exists()
}

fn sealing_fails(folder: &Path, words: &[&str]) {
    has(&seal(folder).unwrap_err().to_string(), words);
    assert!(!is_sealed(folder));
}

/// The manifest's bytes and those of all rows.
fn rows_and_manifest(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = contents(folder);
    all.retain(|(name, _)| name.starts_with("fragments") || name.ends_with("manifest.json"));
    all
}

/// What is not a living writer's.
fn lasting(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = contents(folder);
    all.retain(|(name, _)| !name.contains("/."));
    all
}

fn has_all_rows(folder: &Path) {
    let dataset = Dataset::open(folder).unwrap();
    dataset.verify().unwrap();
    let rows: Vec<_> = dataset.batches(usize::MAX).map(Result::unwrap).collect();
    assert_eq!(bits(&rows[0]), bits(&all_rows()));
}

#[test]
fn shards_in_one_folder_are_the_whole() {
    for format in Format::ALL {
        let whole = tempfile::tempdir().unwrap();
        write(whole.path(), format, None, 1, 1000).unwrap();
        for of in [1, 3, 5] {
            let folder = tempfile::tempdir().unwrap();
            let folder = folder.path();
            for index in (1..=of).rev() {
                let header = by(&format!("w{index}"), format, shard(index, of));
                let manifest = write_by(folder, header, 2, 500).unwrap();
                // The one that finishes the last part seals; with five shards, one has no part.
                let done = index == 1;
                assert_eq!(manifest.is_whole(), done, "shard {index} of {of}");
                assert_eq!(is_sealed(folder), done);
                if !done {
                    let words = ["of 4 parts are missing", "--resume", "peelnet seal"];
                    opening_fails(folder, &words);
                }
            }
            // Whoever wrote them, in whatever order: the manifest too is the same to the byte.
            let expected = rows_and_manifest(whole.path());
            assert!(
                rows_and_manifest(folder) == expected,
                "{format}, {of} shards"
            );
            has_all_rows(folder);
        }
    }
    for bad in [
        "",
        "1",
        "0/4",
        "5/4",
        "1/0",
        "a/2",
        "-1/2",
        "1/2/3",
        "1/4294967295",
    ] {
        has(&bad.parse::<Shard>().unwrap_err().to_string(), &["I/N"]);
    }
    assert_eq!("2/4".parse::<Shard>().unwrap().to_string(), "2/4");
}

#[test]
fn shards_at_the_same_time() {
    for _ in 0..20 {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        std::thread::scope(|scope| {
            // And a second worker for each, as after a time-out of a scheduler.
            for worker in ["v", "w"] {
                for index in 1..=4 {
                    let header = by(worker, Format::Npy, shard(index, 4));
                    scope.spawn(move || write_by(folder, header, 1, 1000).unwrap());
                }
            }
        });
        assert!(is_sealed(folder));
        has_all_rows(folder);
        assert_eq!(lasting(folder), contents(folder));
    }
}

#[test]
fn a_killed_writer_leaves_its_parts_and_another_does_the_rest() {
    for format in Format::ALL {
        let whole = tempfile::tempdir().unwrap();
        write(whole.path(), format, None, 1, 1000).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        killed(folder, by("first", format, None), &[0, 2]);
        opening_fails(folder, &["2 of 4 parts are missing", "the first is 1"]);
        sealing_fails(folder, &["2 of 4 parts"]);
        let writer = DatasetWriter::create(folder, resuming("second", format)).unwrap();
        let needed: Vec<u32> = (0..4).filter(|&k| writer.needs(k)).collect();
        assert_eq!(needed, [1, 3]);
        for index in needed {
            view_part(&writer, index, pixels(index)).unwrap();
        }
        assert!(writer.finish().unwrap().is_whole());
        assert_eq!(rows_and_manifest(folder), rows_and_manifest(whole.path()));
        // Once more: nothing is to be done.
        let before = contents(folder);
        let writer = DatasetWriter::create(folder, resuming("third", format)).unwrap();
        assert!((0..4).all(|k| !writer.needs(k)));
        assert!(writer.finish().unwrap().is_whole());
        assert_eq!(contents(folder), before);
    }
    // Resuming where nothing is begins: a scheduler need not know whether a task ran before.
    let folder = tempfile::tempdir().unwrap();
    assert!(resume(folder.path(), "a").unwrap().is_whole() && is_sealed(folder.path()));
}

#[test]
fn all_parts_without_a_seal_need_the_seal_alone() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv, None), &[0, 1, 2, 3]);
    opening_fails(folder, &["all 4 parts are there", "run `peelnet seal`"]);
    let manifest = seal(folder).unwrap();
    assert_eq!(Dataset::open(folder).unwrap().manifest(), &manifest);
    let before = contents(folder);
    // Sealing twice is no error and changes nothing.
    assert_eq!(seal(folder).unwrap(), manifest);
    assert_eq!(contents(folder), before);
}

#[test]
fn another_plan_is_refused_with_its_first_difference() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    killed(folder, by("node-a", Format::Csv, None), &[0]);
    let before = contents(folder);
    type Change = fn(&mut Header);
    let cases: [(&str, Change); 10] = [
        ("peelnet version is 0.1.0", |h| {
            h.tool_version = "0.2.0".to_owned()
        }),
        ("size is 640x480", |h| {
            h.settings.insert("size".to_owned(), "64x48".to_owned());
        }),
        ("max passes is nothing", |h| {
            h.settings.insert("max passes".to_owned(), "3".to_owned());
        }),
        ("seed is 7", |h| h.seed = 8),
        ("format is csv", |h| h.format = Format::Npy),
        ("adapter class is software", |h| {
            h.adapter_class = "H100".to_owned()
        }),
        ("peeling method is sbuffer", |h| h.peel = "dual".to_owned()),
        ("fraction of pixels is 1", |h| h.pixels_fraction = 0.5),
        ("number of copies is 0", |h| h.augment = 1),
        ("scene 1 is smoke in a box with sha256 abab", |h| {
            h.scenes[1].sha256 = "cd".repeat(32);
        }),
    ];
    for (words, change) in cases {
        for shard in [shard(1, 2), None] {
            let mut header = resuming("node-b", Format::Csv);
            header.shard = shard;
            change(&mut header);
            let message = write_by(folder, header, 1, 1000).unwrap_err().to_string();
            has(&message, &[words, "node-a", "node-b", "same command"]);
        }
    }
    assert_eq!(contents(folder), before);
    // The same scenes under other paths, and another command line: the same plan.
    let mut header = resuming("node-b", Format::Csv);
    header.scenes[0].file = "/elsewhere/cups.toml".to_owned();
    header.command = "peelnet extract --resume".to_owned();
    header.adapter = "another name".to_owned();
    assert!(write_by(folder, header, 1, 1000).unwrap().is_whole());
}

#[test]
fn two_writers_of_one_part() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let [a, b] = ["a", "b"]
        .map(|worker| DatasetWriter::create(folder, by(worker, Format::Csv, shard(1, 1))).unwrap());
    view_part(&a, 0, 5).unwrap();
    let before = lasting(folder);
    // The same bytes are no error, and the first one's record stays.
    view_part(&b, 0, 5).unwrap();
    assert_eq!(lasting(folder), before);
    // Other bytes are one, whoever comes second, and change nothing.
    view_part(&b, 1, 5).unwrap();
    let before = lasting(folder);
    let message = view_part(&a, 1, 6).unwrap_err().to_string();
    has(
        &message,
        &["part 1", "worker a", "worker b", "different bytes"],
    );
    drop((a, b));
    assert_eq!(lasting(folder), before);
}

/// A writer that dies between a part's files and its record: another one of the same bytes takes them over.
#[test]
fn files_without_a_record_are_taken_over_or_named() {
    let folder = tempfile::tempdir().unwrap();
    killed(folder.path(), by("a", Format::Csv, None), &[0, 1]);
    fs::remove_file(folder.path().join("_peelnet/parts/00001.json")).unwrap();
    assert!(resume(folder.path(), "b").unwrap().is_whole());

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv, None), &[0]);
    let foreign = folder.join("fragments-00001-cups-v1.csv");
    fs::write(&foreign, "other bytes").unwrap();
    let message = resume(folder, "b").unwrap_err().to_string();
    has(
        &message,
        &["part 1", "worker b", "fragments-00001", "remove the file"],
    );
    assert_eq!(fs::read(&foreign).unwrap(), b"other bytes");
    // It is known as a dead writer's by the copy in that one's hidden folder.
    let dead = folder.join("_peelnet/.partial-dead");
    fs::create_dir(&dead).unwrap();
    fs::write(dead.join("lock"), "").unwrap();
    fs::write(dead.join("fragments-00001-cups-v1.csv"), "other bytes").unwrap();
    assert!(resume(folder, "b").unwrap().is_whole());
    assert!(!dead.exists());
}

/// What a living writer of another machine has aside is left alone, even where locks do not reach.
#[test]
fn hidden_folders_of_other_machines_stay_until_they_are_old() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv, None), &[0]);
    let hidden = folder.join("_peelnet/.partial-far");
    fs::create_dir(&hidden).unwrap();
    fs::write(hidden.join("lock"), "another machine").unwrap();
    fs::write(hidden.join("fragments-00001-cups-v1.csv"), "half").unwrap();
    resume(folder, "b").unwrap();
    assert!(hidden.exists());
    let old = std::time::SystemTime::now() - std::time::Duration::from_hours(72);
    fs::File::open(&hidden).unwrap().set_modified(old).unwrap();
    seal(folder).unwrap();
    assert!(!hidden.exists());
}

#[test]
fn damaged_parts_are_named_with_their_worker() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let file = folder.join("fragments-00001-cups-v1.csv");
    killed(folder, by("node-a", Format::Csv, None), &[0, 1, 2, 3]);
    let good = fs::read(&file).unwrap();
    fs::write(&file, &good[..good.len() - 1]).unwrap();
    let words = [
        "part 1 of worker node-a",
        "fragments-00001",
        "bytes",
        "--resume",
    ];
    sealing_fails(folder, &words);
    fs::remove_file(&file).unwrap();
    sealing_fails(folder, &["part 1 of worker node-a", "is missing"]);
    // What the message says helps.
    assert!(resume(folder, "node-b").unwrap().is_whole());
    assert_eq!(fs::read(&file).unwrap(), good);
    // In a sealed dataset as well.
    fs::remove_file(&file).unwrap();
    opening_fails(folder, &["part 1 of worker node-a", "is missing"]);
    resume(folder, "node-b").unwrap();
    has_all_rows(folder);
}

#[test]
fn doubled_parts_and_foreign_records_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    killed(folder, by("node-a", Format::Csv, None), &[0, 1, 2, 3]);
    let copy = folder.join("fragments-00001-cups-v1 (copy).csv");
    fs::copy(folder.join("fragments-00001-cups-v1.csv"), &copy).unwrap();
    sealing_fails(folder, &["(copy).csv", "move it away"]);
    fs::remove_file(&copy).unwrap();
    let record = |k: u32| folder.join(format!("_peelnet/parts/{k:05}.json"));
    let good = fs::read_to_string(record(1)).unwrap();
    for (text, words) in [
        (
            fs::read_to_string(record(2)).unwrap(),
            ["part 1", "node-a", "of part 2"],
        ),
        (
            good.replace("\"plan\": \"", "\"plan\": \"0"),
            ["part 1", "node-a", "another plan"],
        ),
        (
            good[..good.len() / 2].to_owned(),
            ["00001.json", "JSON", "line"],
        ),
        (
            good.replace("\"rows\": ", "\"rows\": 9"),
            ["parts", "parts[1]", "rows"],
        ),
        (
            good.replace("\"schema\": 2", "\"schema\": 3"),
            ["schema version 3", "00001.json", "version 2"],
        ),
    ] {
        fs::write(record(1), text).unwrap();
        sealing_fails(folder, &words);
    }
    fs::write(record(1), &good).unwrap();
    let plan = folder.join("_peelnet/plan.json");
    let text = fs::read_to_string(&plan).unwrap();
    fs::write(&plan, text.replace("\"seed\": 7", "\"seed\": 8")).unwrap();
    sealing_fails(folder, &["plan.json", "edited"]);
    fs::write(&plan, text).unwrap();
    seal(folder).unwrap();
}

/// A writer that replaces a dataset leaves the older one as it was until its own end, and is alone.
#[test]
fn replacing_is_all_or_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv, None), &[0, 1]);
    for _ in 0..2 {
        let before = contents(folder);
        assert!(replaces(folder, false).unwrap());
        assert!(!replaces(folder, true).unwrap());
        killed(folder, by("b", Format::Npy, None), &[0, 1, 2, 3]);
        assert_eq!(contents(folder), before, "unsealed, then sealed");
        let living = DatasetWriter::create(folder, by("c", Format::Csv, None)).unwrap();
        let busy = write(folder, Format::Csv, None, 1, 1000).unwrap_err();
        has(&busy.to_string(), &["another extraction"]);
        drop(living);
        write(folder, Format::Csv, None, 1, 1000).unwrap();
    }
    // Killed while it removed the older dataset, or while it moved its own: what lists files goes last.
    let fresh = tempfile::tempdir().unwrap();
    write(fresh.path(), Format::Npy, None, 1, 1000).unwrap();
    for gone in [
        "fragments-00001-cups-v1.csv",
        "_peelnet/plan.json",
        "_peelnet/parts/00002.json",
    ] {
        fs::remove_file(folder.join(gone)).unwrap();
    }
    let dead = folder.join("_peelnet/.partial-dead");
    fs::create_dir(&dead).unwrap();
    fs::write(dead.join("lock"), "").unwrap();
    write(folder, Format::Npy, None, 1, 1000).unwrap();
    assert_eq!(contents(folder), contents(fresh.path()));
}

#[test]
fn a_folder_by_its_address() {
    let folder = tempfile::tempdir().unwrap();
    let address = format!("file://{}/d", folder.path().display());
    let address = Path::new(&address);
    assert!(is_remote(address) && !is_remote(folder.path()));
    killed(address, by("a", Format::Csv, None), &[0, 1]);
    assert_eq!(unsealed_parts(address).unwrap(), Some((2, 4)));
    resume(address, "b").unwrap();
    assert_eq!(unsealed_parts(address).unwrap(), None);
    assert!(is_sealed(&folder.path().join("d")));
    has_all_rows(address);
    // Nothing was written beside it.
    assert!(!Path::new("file:").exists());
    opening_fails(Path::new("file://d"), &["file:///path"]);
}

/// Without the feature for object stores, and without what could be a password in the message.
#[cfg(not(feature = "object-store"))]
#[test]
fn a_build_without_object_stores_says_so() {
    for url in ["s3://hunter2/d", "gs://user:hunter2@b/d", "az://hunter2"] {
        for error in [
            Dataset::open(url).unwrap_err(),
            seal(url).unwrap_err(),
            replaces(Path::new(url), false).unwrap_err(),
            DatasetWriter::create(url, header(Format::Csv, None)).unwrap_err(),
        ] {
            has(&error.to_string(), &["object-store", &url[..2]]);
            assert!(!error.to_string().contains("hunter2"), "{error}");
        }
    }
}
