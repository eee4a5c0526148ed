//! Extraction to datasets: what they hold, in every format and by every way to peel. Shards, repetition and what is refused are tested with
//! the program.

use peelnet_dataset::{Column, Dataset, Format, FragmentBatch, Summary};
use peelnet_gpu::Gpu;
use peelnet_peel::{ExtractOptions, ExtractReport, Peel, extract};
use peelnet_scene::Scene;
use peelnet_tests::{gpu, scene, soup};
use std::sync::atomic::AtomicBool;

fn run(gpu: &Gpu, scenes: &[Scene], options: &ExtractOptions) -> ExtractReport {
    let stop = AtomicBool::new(false);
    extract(gpu, scenes, options, &stop, &mut |_| {}).unwrap()
}

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

/// Recomputing from the rows gives what is stored, in every format and by every way to peel; rows are the same. The effects that scenes
/// need are recorded.
#[test]
fn sums_hold_and_formats_and_peels_agree() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
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
        let report = run(&gpu, &scenes(), &options);
        assert_eq!(report.manifest.parts.len(), 8);
        let effects = report.manifest.scenes.iter().map(|s| s.effects.clone());
        assert!(effects.eq([vec![], vec!["culling", "emission"]]));
        let dataset = Dataset::open(&out).unwrap();
        dataset.verify().unwrap();
        let summary = Summary::of(&dataset).unwrap();
        assert!(summary.passes(), "{:?}", summary.violations);
        assert!(summary.rows > 1000, "{}", summary.rows);
        let rows = dataset.read_columns(&Column::ALL).unwrap();
        match &first {
            None => first = Some(rows),
            Some(other) => assert!(&rows == other, "{format}, {peel}"),
        }
    }
}

/// Batches in memory hold the rows of the dataset, in its order; one that is dropped early ends its thread.
#[test]
fn batches_hold_the_rows_of_the_dataset() {
    let gpu = gpu();
    let scenes = [peelnet_scene::suite::load("panes").unwrap()];
    let folder = tempfile::tempdir().unwrap();
    let options = ExtractOptions {
        size: [64, 48],
        ..ExtractOptions::new(folder.path().join("rows"))
    };
    run(&gpu, &scenes, &options);
    let dataset = Dataset::open(&options.out).unwrap();
    let mut written = FragmentBatch::default();
    for batch in dataset.batches(1 << 16) {
        let batch = batch.unwrap();
        written.extend_from(&batch, 0..batch.len());
    }
    let mut found = FragmentBatch::default();
    for batch in peelnet_peel::batches(&gpu, &scenes, &options).unwrap() {
        let batch = batch.unwrap();
        found.extend_from(&batch, 0..batch.len());
    }
    assert!(found.len() > 1000);
    assert_eq!(found, written);
    let mut dropped = peelnet_peel::batches(&gpu, &scenes, &options).unwrap();
    assert!(dropped.next().is_some_and(|batch| batch.is_ok()));
}
