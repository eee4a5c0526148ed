//! Datasets of versions before: read, never continued, and replaced as a whole.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use std::fs;

use common::*;
use peelnet_dataset::*;

fn has(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

/// Shards of schema 1, in folders of their own.
#[test]
fn old_shards_merge_to_the_whole() {
    for format in Format::ALL {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), format, None, 1, 1000).unwrap();
        let hash = Dataset::open(folder.path()).unwrap().hash().to_owned();
        for shards in [None, Some(3)] {
            let folder = tempfile::tempdir().unwrap();
            write(folder.path(), format, None, 2, 500).unwrap();
            make_old(folder.path(), shards);
            let merged = Dataset::open(folder.path()).unwrap();
            merged.verify().unwrap();
            assert_eq!(merged.hash(), hash);
            assert_eq!(merged.manifest().schema, 1);
            let rows: Vec<_> = merged.batches(usize::MAX).map(Result::unwrap).collect();
            assert_eq!(bits(&rows[0]), bits(&all_rows()));
        }
    }
}

/// Shards in folders of their own, as versions before wrote them, are read and never continued.
#[test]
fn old_shards_that_do_not_fit() {
    let folder = tempfile::tempdir().unwrap();
    let shard = |i, n| Some(Shard::new(i, n).unwrap());
    write(folder.path(), Format::Csv, None, 1, 1000).unwrap();
    make_old(folder.path(), Some(2));
    Dataset::open(folder.path()).unwrap();
    let path = folder.path().join("shard-2-of-2/manifest.json");
    let good = fs::read_to_string(&path).unwrap();
    fs::write(&path, good.replace("\"seed\": 7", "\"seed\": 8")).unwrap();
    let message = Dataset::open(folder.path()).unwrap_err().to_string();
    has(&message, &["shard-2-of-2", "shard-1-of-2", "seed"]);
    fs::remove_file(&path).unwrap();
    let message = Dataset::open(folder.path()).unwrap_err().to_string();
    has(&message, &["1 of 2 shards are missing", "2/2"]);
    let before = contents(folder.path());
    for shard in [shard(1, 3), None] {
        let message = write(folder.path(), Format::Csv, shard, 1, 1000).unwrap_err();
        has(
            &message.to_string(),
            &["shards of a dataset", "earlier version"],
        );
    }
    assert_eq!(contents(folder.path()), before);

    let whole = tempfile::tempdir().unwrap();
    write(whole.path(), Format::Csv, None, 1, 1000).unwrap();
    make_old(whole.path(), None);
    Dataset::open(whole.path()).unwrap();
    let message = write(whole.path(), Format::Csv, shard(1, 2), 1, 1000).unwrap_err();
    has(&message.to_string(), &["whole dataset", "earlier version"]);
    has(&seal(whole.path()).unwrap_err().to_string(), &["schema 1"]);
    // Whole on whole replaces it, and leaves nothing of schema 1.
    write(whole.path(), Format::Csv, None, 1, 1000).unwrap();
    assert!(!whole.path().join("manifest.json").exists());
    Dataset::open(whole.path()).unwrap().verify().unwrap();
}
