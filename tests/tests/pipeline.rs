//! Extraction to datasets: what they hold, in every format and by every way to peel, and what is refused.

use peelnet_core::{fragment::worked_example, random::Random};
use peelnet_dataset::{Column, Dataset, Format, Shard, Summary};
use peelnet_gpu::Gpu;
use peelnet_peel::{ExtractOptions, Peel, Views, extract};
use peelnet_scene::{Material, Object, Scene};
use peelnet_tests::{gpu, scene, walls};
use std::{path::Path, sync::atomic::AtomicBool};

fn options(out: &Path) -> ExtractOptions {
    ExtractOptions {
        out: out.to_owned(),
        size: [40, 30],
        views: Views::All,
        format: Format::Parquet,
        peel: Peel::SBuffer,
        max_passes: None,
        pixels: 1.0,
        augment: 0,
        seed: 5,
        shard: None,
        resume: false,
        command: "test".into(),
        budget: None,
    }
}

fn run(gpu: &Gpu, scenes: &[Scene], options: &ExtractOptions) -> peelnet_peel::ExtractReport {
    extract(gpu, scenes, options, &AtomicBool::new(false), &mut |_| {}).unwrap()
}

/// Two scenes of slanted panes, two views each.
fn scenes() -> Vec<Scene> {
    ["first", "second"]
        .into_iter()
        .zip(1..)
        .map(|(name, seed)| {
            let mut stream = Random::new(seed, &[]);
            let mut random = move || stream.unit();
            let objects = (0..12)
                .map(|i| {
                    let vertices = [(); 3].map(|()| {
                        let z = 2.0 + 8.0 * random();
                        glam::Vec3::new((2.0 * random() - 1.0) * z, (2.0 * random() - 1.0) * z, -z)
                    });
                    let color = [random(), random(), random()];
                    Object::of_triangles(
                        &format!("pane {i}"),
                        &[vertices],
                        Material::unlit(color, random()),
                    )
                })
                .collect();
            let mut s = scene(name, [0.0; 3], objects);
            let mut other = s.views[0];
            other.position.x += 0.5;
            s.views.push(other);
            s
        })
        .collect()
}

fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.is_file() && p.extension().is_some_and(|e| e != "json"))
        .map(|p| {
            let name = p.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read(p).unwrap())
        })
        .collect();
    all.sort();
    all
}

/// The worked example in every pixel: its rows are known.
#[test]
fn the_worked_example_as_rows() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("d");
    let report = run(
        &gpu,
        &[walls(&worked_example(), [0.0; 3])],
        &ExtractOptions {
            size: [3, 2],
            ..options(&out)
        },
    );
    assert_eq!(
        (report.manifest.rows, report.lost, report.coplanar),
        (24, 0, 0)
    );
    let dataset = Dataset::open(&out).unwrap();
    let columns = dataset
        .read_columns(&[Column::Transmittance, Column::LinearDepth, Column::AlphaSum])
        .unwrap();
    for pixel in columns[0].as_f32().unwrap().chunks(4) {
        assert_eq!(pixel, [1.0, 0.5, 0.25, 0.125]);
    }
    for pixel in columns[1].as_f32().unwrap().chunks(4) {
        for (z, want) in pixel.iter().zip([1.0f32, 2.0, 4.0, 8.0]) {
            assert!((z - want).abs() <= 16.0 * f32::EPSILON * want);
        }
    }
    assert!(columns[2].as_f32().unwrap().iter().all(|&s| s == 2.4));
}

/// Recomputing from the rows gives what is stored, in every format and by every way to peel; rows are the same.
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
        let report = run(
            &gpu,
            &scenes(),
            &ExtractOptions {
                format,
                peel,
                augment: 1,
                ..options(&out)
            },
        );
        assert_eq!(report.manifest.parts.len(), 8);
        let dataset = Dataset::open(&out).unwrap();
        dataset.verify().unwrap();
        let summary = Summary::of(&dataset).unwrap();
        assert!(
            summary.passes() && summary.rows > 1000,
            "{:?}",
            summary.violations
        );
        let rows = dataset.read_columns(&Column::ALL).unwrap();
        match &first {
            None => first = Some(rows),
            Some(other) => assert!(&rows == other, "{format}, {peel}"),
        }
    }
}

/// The same seed gives the same bytes, and shards put together are the whole.
#[test]
fn extraction_repeats_and_shards_add_up() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
    let sampled = |out: &Path, shard| ExtractOptions {
        pixels: 0.5,
        shard,
        ..options(out)
    };
    let at = |name: &str| folder.path().join(name);
    let whole = run(&gpu, &scenes(), &sampled(&at("a"), None)).manifest;
    let again = run(&gpu, &scenes(), &sampled(&at("b"), None)).manifest;
    assert_eq!(files(&at("a")), files(&at("b")));
    assert_eq!(whole.hash, again.hash);
    for i in [2, 1, 3] {
        run(
            &gpu,
            &scenes(),
            &sampled(&at("c"), Some(Shard::new(i, 3).unwrap())),
        );
    }
    let merged = Dataset::open(at("c")).unwrap();
    assert_eq!(merged.hash(), whole.hash);
    assert_eq!(merged.rows(), whole.rows);
}

/// A dataset records the effects that its scenes needed.
#[test]
fn a_dataset_records_its_census() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("d");
    let mut all = scenes();
    all[1].objects[0].materials[0].emission = [0.5, 0.0, 0.0];
    all[1].objects[0].materials[0].double_sided = false;
    run(&gpu, &all, &options(&out));
    let found = Dataset::open(&out).unwrap();
    let effects: Vec<_> = found
        .manifest()
        .scenes
        .iter()
        .map(|s| s.effects.clone())
        .collect();
    assert_eq!(effects, [vec![], vec!["culling", "emission"]]);
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let gpu = gpu();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("d");
    let refused = |scenes: &[Scene], options: &ExtractOptions| {
        extract(&gpu, scenes, options, &AtomicBool::new(false), &mut |_| {})
            .unwrap_err()
            .to_string()
    };
    let all = scenes();
    let many = ExtractOptions {
        views: Views::First(3),
        ..options(&out)
    };
    assert!(refused(&all, &many).contains("2 of the 3 views"));
    let twice = [all[0].clone(), all[0].clone()];
    assert!(refused(&twice, &options(&out)).contains("rename one"));
    let none = ExtractOptions {
        pixels: 0.0,
        ..options(&out)
    };
    assert!(refused(&all, &none).contains("above 0"));
    // A dataset's transmittance is one number.
    let mut stained = all[0].clone();
    stained.objects[0].materials[0].transmission = [0.9, 0.1, 0.2];
    assert!(refused(&[stained], &options(&out)).contains("transmission_color"));
    assert!(!out.exists());
}

/// Batches in memory hold the rows of the dataset, in its order; one that is dropped early ends its thread.
#[test]
fn batches_hold_the_rows_of_the_dataset() {
    let gpu = gpu();
    let scene = peelnet_scene::suite::load("panes").expect("a shipped scene");
    let folder = tempfile::tempdir().expect("temporary folder");
    let options = ExtractOptions {
        size: [64, 48],
        ..ExtractOptions::new(folder.path().join("rows"))
    };
    let scenes = [scene];
    let stop = AtomicBool::new(false);
    extract(&gpu, &scenes, &options, &stop, &mut |_| ()).expect("extracts");
    let dataset = Dataset::open(&options.out).expect("opens");
    let mut written = peelnet_dataset::FragmentBatch::default();
    for batch in dataset.batches(1 << 16) {
        let batch = batch.expect("reads");
        written.extend_from(&batch, 0..batch.len());
    }
    let mut found = peelnet_dataset::FragmentBatch::default();
    for batch in peelnet_peel::batches(&gpu, &scenes, &options).expect("begins") {
        let batch = batch.expect("peels");
        found.extend_from(&batch, 0..batch.len());
    }
    assert!(found.len() > 1000);
    assert_eq!(found, written);
    let mut dropped = peelnet_peel::batches(&gpu, &scenes, &options).expect("begins");
    assert!(dropped.next().is_some_and(|batch| batch.is_ok()));
}
