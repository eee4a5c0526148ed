//! Extraction to datasets: what they hold, in every format and by every way to peel. Shards, repetition and what is refused are tested with
//! the program.

use peelnet_dataset::{Column, Dataset, Format, FragmentBatch, Summary};
use peelnet_peel::{ExtractOptions, Peel, batches, extract};
use peelnet_scene::Scene;
use peelnet_tests::{gpu, scene, soup};
use std::sync::atomic::AtomicBool;

/// Two scenes of slanted panes, two views each; the second one has two effects.
fn scenes() -> [Scene; 2] {
    let mut scenes = [("first", 1), ("second", 2)].map(|(name, seed)| {
        let mut scene = scene(name, [0.0; 3], soup(seed, 12, 1, [2.0, 10.0]));
        let mut other = scene.views[0];
        other.position.x += 0.5;
        scene.views.push(other);
        scene
    });
    let material = &mut scenes[1].objects[0].materials[0];
    (material.emission, material.double_sided) = ([0.5, 0.0, 0.0], false);
    scenes
}

/// Recomputing from the rows gives what is stored, in every format and by every way to peel; rows are the same, also as batches in memory. The effects
/// that scenes need are recorded.
#[test]
fn sums_hold_and_formats_and_peels_agree() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
    let scenes = scenes();
    let mut first = None;
    for (format, peel) in [
        (Format::Parquet, Peel::SBuffer),
        (Format::Csv, Peel::Dual),
        (Format::Npy, Peel::Single),
    ] {
        let out = folder.path().join(format!("{format}-{peel}"));
        let options = ExtractOptions {
            format,
            peel,
            size: [40, 30],
            seed: 5,
            augment: 1,
            ..ExtractOptions::new(&out)
        };
        let stop = AtomicBool::new(false);
        let report = extract(&gpu, &scenes, &options, &stop, &mut |_| {}).unwrap();
        assert_eq!(report.manifest.parts.len(), 8);
        let effects = report.manifest.scenes.iter().map(|s| s.effects.clone());
        assert!(effects.eq([vec![], vec!["culling", "emission"]]));
        let dataset = Dataset::open(&out).unwrap();
        dataset.verify().unwrap();
        let summary = Summary::from_dataset(&dataset).unwrap();
        assert!(summary.passes(), "{:?}", summary.violations);
        assert!(summary.rows > 1000, "{}", summary.rows);
        let rows = dataset.read_columns(&Column::ALL).unwrap();
        let mut in_memory = FragmentBatch::default();
        for batch in batches(&gpu, &scenes, &options).unwrap() {
            let batch = batch.unwrap();
            in_memory.extend_from(&batch, 0..batch.len());
        }
        assert!(in_memory == rows, "{format}, {peel}");
        // One that is dropped early ends its thread.
        let mut dropped = batches(&gpu, &scenes, &options).unwrap();
        assert!(dropped.next().is_some_and(|batch| batch.is_ok()));
        match &first {
            None => first = Some(rows),
            Some(other) => assert!(&rows == other, "{format}, {peel}"),
        }
    }
}
