//! Extraction to datasets: what they hold, in every format and by every way to peel. Shards, repetition and what is refused are tested with
//! the program.

use peelnet_core::fragment::worked_example;
use peelnet_dataset::{Column, Dataset, Format, FragmentBatch, Summary};
use peelnet_gpu::Gpu;
use peelnet_peel::{ExtractOptions, Peel, extract};
use peelnet_scene::Scene;
use peelnet_tests::{gpu, scene, soup, walls};
use std::{path::Path, sync::atomic::AtomicBool};

fn options(out: &Path) -> ExtractOptions {
    ExtractOptions {
        size: [40, 30],
        seed: 5,
        ..ExtractOptions::new(out)
    }
}

static NEVER: AtomicBool = AtomicBool::new(false);

fn run(gpu: &Gpu, scenes: &[Scene], options: &ExtractOptions) -> peelnet_peel::ExtractReport {
    extract(gpu, scenes, options, &NEVER, &mut |_| {}).unwrap()
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

/// The worked example in every pixel: its rows are known.
#[test]
fn the_worked_example_as_rows() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("d");
    let small = ExtractOptions {
        size: [3, 2],
        ..options(&out)
    };
    let report = run(&gpu, &[walls(&worked_example(), [0.0; 3])], &small);
    let found = (report.manifest.rows, report.lost, report.coplanar);
    assert_eq!(found, (24, 0, 0));
    let dataset = Dataset::open(&out).unwrap();
    let columns = [Column::Transmittance, Column::LinearDepth, Column::AlphaSum];
    let columns = dataset.read_columns(&columns).unwrap();
    for pixel in columns.transmittance.chunks(4) {
        assert_eq!(pixel, [1.0, 0.5, 0.25, 0.125]);
    }
    for pixel in columns.linear_depth.chunks(4) {
        for (z, want) in pixel.iter().zip([1.0f32, 2.0, 4.0, 8.0]) {
            assert!((z - want).abs() <= 16.0 * f32::EPSILON * want);
        }
    }
    assert!(columns.alpha_sum.iter().all(|&s| s == 2.4));
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
            augment: 1,
            ..options(&out)
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
