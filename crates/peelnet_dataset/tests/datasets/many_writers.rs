//! Several writers of one dataset, and writers that die. What processes do is tested with the command line.

use super::*;

fn by(worker: &str, format: Format) -> Header {
    Header {
        worker: worker.to_owned(),
        ..header(format)
    }
}

/// A header of a worker that does what is missing, of a shard or of all.
fn joining(worker: &str, format: Format, shard: Option<[u32; 2]>) -> Header {
    Header {
        resume: true,
        shard: shard.map(|[index, of]| Shard { index, of }),
        ..by(worker, format)
    }
}

fn resume(folder: &Path, worker: &str) -> Result<Manifest, DatasetError> {
    write_by(folder, joining(worker, Format::Csv, None), 1000)
}

/// A writer that is killed: it does not come to its end, and leaves what it had.
fn killed(folder: &Path, header: Header, parts: &[u32]) {
    let writer = DatasetWriter::create(folder, header).unwrap();
    for &index in parts {
        part(&writer, index, &rows_of(index), 1000).unwrap();
    }
}

fn is_sealed(folder: &Path) -> bool {
    folder.join("_peelnet/manifest.json").exists()
}

fn sealing_fails(folder: &Path, words: &[&str]) {
    has(&seal(folder).unwrap_err(), words);
    assert!(!is_sealed(folder));
}

fn rows_and_manifest(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = contents(folder);
    let others = ["README.md", "croissant.json", "_peelnet/manifest.json"];
    all.retain(|(name, _)| name.starts_with("fragments") || others.contains(&name.as_str()));
    all
}

/// What is not a living writer's.
fn lasting(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = contents(folder);
    all.retain(|(name, _)| !name.contains("/."));
    all
}

/// A hidden folder of another writer, with this in it.
fn hidden(folder: &Path, host: &str, files: &[(&str, &str)]) -> std::path::PathBuf {
    let hidden = folder.join("_peelnet/.partial-other");
    fs::create_dir(&hidden).unwrap();
    for (name, text) in files.iter().chain(&[("lock", host)]) {
        fs::write(hidden.join(name), text).unwrap();
    }
    hidden
}

const PART_1: &str = "fragments-00001-cups-v1.csv";

/// Whoever writes the parts, in whatever order, at the same time or after another one was killed: rows and manifest are those of one
/// writer, to the byte.
#[test]
fn writers_together_write_the_whole() {
    for format in Format::ALL {
        let whole = temporary();
        write(whole.path(), format).unwrap();
        let whole = rows_and_manifest(whole.path());
        let folder = temporary();
        let folder = folder.path();
        // With five shards, one has no part. The one that finishes the last part seals.
        for index in (1..=5).rev() {
            let header = joining(&format!("w{index}"), format, Some([index, 5]));
            let manifest = write_by(folder, header, 500).unwrap();
            assert_eq!(manifest.is_whole(), index == 1, "shard {index}");
            assert_eq!(is_sealed(folder), index == 1);
        }
        assert!(rows_and_manifest(folder) == whole, "{format}");
        for _ in 0..6 {
            let folder = temporary();
            let folder = folder.path();
            std::thread::scope(|scope| {
                // And a second worker for each, as after a time-out of a scheduler.
                for (worker, index) in [1, 2, 3, 4].into_iter().flat_map(|k| [("v", k), ("w", k)]) {
                    let header = joining(worker, format, Some([index, 4]));
                    scope.spawn(move || write_by(folder, header, 1000).unwrap());
                }
            });
            assert!(rows_and_manifest(folder) == whole, "{format}");
            assert_eq!(lasting(folder), contents(folder));
        }
        let folder = temporary();
        let folder = folder.path();
        killed(folder, by("first", format), &[0, 2]);
        let words = [
            "2 of 4 parts are missing, the first is 1",
            "--resume",
            "peelnet seal",
        ];
        opening_fails(folder, &words);
        sealing_fails(folder, &words);
        let writer = DatasetWriter::create(folder, joining("second", format, None)).unwrap();
        assert_eq!(
            [0, 1, 2, 3].map(|k| writer.needs(k)),
            [false, true, false, true]
        );
        drop(writer);
        killed(folder, joining("third", format, None), &[1, 3]);
        opening_fails(folder, &["all 4 parts are there", "run `peelnet seal`"]);
        // Sealing twice, and resuming what is finished, is no error and changes nothing.
        let manifest = seal(folder).unwrap();
        let before = contents(folder);
        assert_eq!(seal(folder).unwrap(), manifest);
        let header = joining("fourth", format, None);
        assert_eq!(write_by(folder, header, 1000).unwrap(), manifest);
        assert_eq!(contents(folder), before);
        assert!(rows_and_manifest(folder) == whole, "{format}");
    }
    // Resuming where nothing is begins: a scheduler need not know whether a task ran before.
    let folder = temporary();
    assert!(resume(folder.path(), "a").unwrap().is_whole() && is_sealed(folder.path()));
    for text in ",1,0/4,5/4,1/0,a/2,-1/2,1/2/3,1/4294967295".split(',') {
        has(&text.parse::<Shard>().unwrap_err(), &["I/N"]);
    }
    assert_eq!("2/4".parse::<Shard>().unwrap().to_string(), "2/4");
}

#[test]
fn two_writers_of_one_part() {
    let folder = temporary();
    let folder = folder.path();
    let [a, b] = ["a", "b"].map(|worker| {
        let header = joining(worker, Format::Csv, Some([1, 1]));
        DatasetWriter::create(folder, header).unwrap()
    });
    let write = |writer, index, pixels| part(writer, index, &view(index, pixels, 1), 1000);
    write(&a, 0, 5).unwrap();
    let before = lasting(folder);
    // The same bytes are no error, and the first one's record stays.
    write(&b, 0, 5).unwrap();
    assert_eq!(lasting(folder), before);
    // Other bytes are one, whoever comes second, and change nothing.
    write(&b, 1, 5).unwrap();
    let before = lasting(folder);
    let words = ["part 1", "worker a", "worker b", "different bytes"];
    has(&write(&a, 1, 6).unwrap_err(), &words);
    drop((a, b));
    assert_eq!(lasting(folder), before);
}

/// A writer that dies between a part's files and its record: another one of the same bytes takes them over.
#[test]
fn files_without_a_record_are_taken_over_or_named() {
    let folder = temporary();
    killed(folder.path(), by("a", Format::Csv), &[0, 1]);
    fs::remove_file(folder.path().join("_peelnet/parts/00001.json")).unwrap();
    let error = write(folder.path(), Format::Csv).unwrap_err();
    has(&error, &[PART_1, "has no record", "--resume"]);
    assert!(resume(folder.path(), "b").unwrap().is_whole());

    let folder = temporary();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv), &[0]);
    fs::write(folder.join(PART_1), "other bytes").unwrap();
    let words = ["part 1", "worker b", "fragments-00001", "remove the file"];
    has(&resume(folder, "b").unwrap_err(), &words);
    assert_eq!(fs::read(folder.join(PART_1)).unwrap(), b"other bytes");
    // It is known as a dead writer's by the copy in that one's hidden folder.
    let dead = hidden(folder, "", &[(PART_1, "other bytes")]);
    assert!(resume(folder, "b").unwrap().is_whole());
    assert!(!dead.exists());
}

/// What a living writer of another machine has aside is left alone, even where locks do not reach.
#[test]
fn hidden_folders_of_other_machines_stay_until_they_are_old() {
    let folder = temporary();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv), &[0]);
    let hidden = hidden(folder, "another machine", &[(PART_1, "half")]);
    resume(folder, "b").unwrap();
    assert!(hidden.exists());
    let old = std::time::SystemTime::now() - std::time::Duration::from_hours(72);
    fs::File::open(&hidden).unwrap().set_modified(old).unwrap();
    seal(folder).unwrap();
    assert!(!hidden.exists());
}

/// Parts that were changed, doubled or mixed up are named with their worker, and no seal is made; what the message says helps.
#[test]
fn what_is_wrong_with_a_part_is_named() {
    let folder = temporary();
    let folder = folder.path();
    let file = folder.join(PART_1);
    killed(folder, by("node-a", Format::Csv), &[0, 1, 2, 3]);
    let good = fs::read(&file).unwrap();
    fs::write(&file, &good[1..]).unwrap();
    let words = ["part 1 of worker node-a", PART_1, "bytes", "--resume"];
    sealing_fails(folder, &words);
    // As long as it was.
    let mut edited = good.clone();
    edited[good.len() / 2] ^= 1;
    let words = ["part 1 of worker node-a", PART_1, "sha256", "--resume"];
    fs::write(&file, &edited).unwrap();
    sealing_fails(folder, &words);
    has(&resume(folder, "node-b").unwrap_err(), &words);
    fs::remove_file(&file).unwrap();
    sealing_fails(folder, &["part 1 of worker node-a", "is missing"]);
    // Before the seal, and behind it.
    for _ in 0..2 {
        assert!(resume(folder, "node-b").unwrap().is_whole());
        assert_eq!(fs::read(&file).unwrap(), good);
        fs::write(&file, &edited).unwrap();
        has(&seal(folder).unwrap_err(), &words);
        has(&resume(folder, "node-b").unwrap_err(), &words);
        fs::remove_file(&file).unwrap();
        opening_fails(folder, &["part 1 of worker node-a", "is missing"]);
    }
    fs::write(&file, &good).unwrap();
    fs::remove_file(folder.join("_peelnet/manifest.json")).unwrap();
    let copy = folder.join("fragments-00001-cups-v1 (copy).csv");
    fs::copy(&file, &copy).unwrap();
    sealing_fails(folder, &["(copy).csv", "move it away"]);
    fs::remove_file(&copy).unwrap();
    let [record, other] = [1, 2].map(|k| folder.join(format!("_peelnet/parts/{k:05}.json")));
    let other = fs::read_to_string(other).unwrap();
    let good = fs::read_to_string(&record).unwrap();
    let altered = |from: &str, to: &str| good.replace(from, to);
    let refused = |text: &str, words: [&str; 3]| {
        fs::write(&record, text).unwrap();
        sealing_fails(folder, &words);
    };
    refused(&other, ["part 1", "node-a", "of part 2"]);
    let plan = altered("\"plan\": \"", "\"plan\": \"0");
    refused(&plan, ["part 1", "node-a", "another plan"]);
    refused(&good[..good.len() / 2], ["00001.json", "JSON", "line"]);
    let rows = altered("\"rows\": ", "\"rows\": 9");
    refused(&rows, ["parts", "parts[1]", "rows"]);
    let schema = altered("\"schema\": 2", "\"schema\": 3");
    refused(&schema, ["schema version 3", "00001.json", "version 2"]);
    fs::write(&record, &good).unwrap();
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
    let folder = temporary();
    let folder = folder.path();
    killed(folder, by("a", Format::Csv), &[0, 1]);
    for _ in 0..2 {
        let before = contents(folder);
        assert!(replaces(folder, false).unwrap());
        assert!(!replaces(folder, true).unwrap());
        killed(folder, by("b", Format::Npy), &[0, 1, 2, 3]);
        assert_eq!(contents(folder), before, "unsealed, then sealed");
        let living = DatasetWriter::create(folder, by("c", Format::Csv)).unwrap();
        has(
            &write(folder, Format::Csv).unwrap_err(),
            &["another extraction"],
        );
        drop(living);
        write(folder, Format::Csv).unwrap();
    }
    // Edited, and as long as it was.
    let part = folder.join(PART_1);
    let own = fs::read(&part).unwrap();
    let mut edited = own.clone();
    *edited.last_mut().unwrap() = b' ';
    fs::write(&part, &edited).unwrap();
    has(
        &write(folder, Format::Csv).unwrap_err(),
        &[
            PART_1,
            "is not a file of a dataset as its manifest lists it",
        ],
    );
    assert_eq!(fs::read(&part).unwrap(), edited);
    fs::write(&part, own).unwrap();
    // Killed while it removed the older dataset, or while it moved its own: what lists files goes last.
    let fresh = temporary();
    write(fresh.path(), Format::Npy).unwrap();
    for gone in [PART_1, "_peelnet/plan.json", "_peelnet/parts/00002.json"] {
        fs::remove_file(folder.join(gone)).unwrap();
    }
    hidden(folder, "", &[]);
    write(folder, Format::Npy).unwrap();
    assert_eq!(contents(folder), contents(fresh.path()));
}

#[test]
fn a_folder_by_its_address() {
    let folder = temporary();
    let address = format!("file://{}/d", folder.path().display());
    let address = Path::new(&address);
    assert!(is_remote(address) && !is_remote(folder.path()));
    killed(address, by("a", Format::Csv), &[0, 1]);
    assert_eq!(unsealed_parts(address).unwrap(), Some((2, 4)));
    resume(address, "b").unwrap();
    assert_eq!(unsealed_parts(address).unwrap(), None);
    assert!(is_sealed(&folder.path().join("d")));
    Dataset::open(address).unwrap().verify().unwrap();
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
            write(Path::new(url), Format::Csv).unwrap_err(),
        ] {
            has(&error, &["object-store", &url[..2]]);
            assert!(!error.to_string().contains("hunter2"), "{error}");
        }
    }
}
