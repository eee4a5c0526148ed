//! Whole runs, and the datasets that they learn from.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should panic")]

mod datasets;
mod streaming;
mod training;

use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use peelnet_dataset::{Dataset, DatasetWriter, Format, FragmentBatch, Header, Part, SceneEntry};
use peelnet_model::Model;
use peelnet_train::{
    CHECKPOINT_FILES, Config, End, FINISHED_STATE, Outcome, RunOptions, TrainError, TrainingData,
    checkpoint_folder, history_csv, train,
};

static NEVER: AtomicBool = AtomicBool::new(false);

fn run(config: &Config, data: &TrainingData, out: &Path) -> Result<Outcome, TrainError> {
    train(config, data, &RunOptions::new(out, &NEVER), |_| {})
}

fn resuming(out: &Path) -> RunOptions<'static> {
    RunOptions {
        resume: true,
        ..RunOptions::new(out, &NEVER)
    }
}

/// The same bytes from the same seed with any number of threads, others from another seed. Everything is made anew for each run.
fn assert_repeats(config: &Config, load: &dyn Fn(&Config) -> TrainingData) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    let bytes = |threads: usize, config: &Config| {
        let options = RunOptions {
            threads: NonZeroUsize::new(threads),
            ..RunOptions::new(&out, &NEVER)
        };
        train(config, &load(config), &options, |_| {}).unwrap();
        std::fs::read(&out).unwrap()
    };
    let one = bytes(1, config);
    for threads in [1, 2, 3, 7] {
        assert!(one == bytes(threads, config), "{threads} threads");
    }
    let mut other = config.clone();
    other.seed += 1;
    assert!(one != bytes(1, &other));
}

/// A run that is interrupted after half of its epochs and resumed ends as one that was not.
fn assert_resumes(config: &Config, load: &dyn Fn() -> TrainingData) {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole/net.safetensors");
    let expected = run(config, &load(), &whole).unwrap();
    let out = folder.path().join("parts/net.safetensors");
    let stop = AtomicBool::new(false);
    let half = config.epochs / 2;
    let first = train(config, &load(), &RunOptions::new(&out, &stop), |epochs| {
        stop.store(epochs.len() as u32 == half, Ordering::Relaxed);
    })
    .unwrap();
    assert_eq!(
        (first.end, first.history.len() as u32),
        (End::Interrupted, half)
    );
    assert!(!out.exists(), "an interrupted run leaves no finished model");
    assert!(Model::load(first.checkpoint.join("last.safetensors")).is_ok());
    let table = || std::fs::read_to_string(checkpoint_folder(&out).join("loss.csv")).unwrap();
    assert_eq!(table(), history_csv(&first.history));
    let state = first.checkpoint.join(CHECKPOINT_FILES[0].0);
    let is_foreign = || FINISHED_STATE.is_foreign(&state).unwrap();
    assert!(is_foreign(), "a run that begins anew would replace it");

    let second = train(config, &load(), &resuming(&out), |_| {}).unwrap();
    assert_eq!(
        (second.end, second.resumed_from),
        (End::Finished, Some(half))
    );
    assert_eq!(second.model, expected.model);
    assert!(!is_foreign());
    let [whole, parts] = [&whole, &out].map(|file| std::fs::read(file).unwrap());
    assert!(whole == parts);
    let losses = |outcome: &Outcome| -> Vec<_> {
        let history = outcome.history.iter();
        history
            .map(|r| (r.train_loss, r.held_out_loss, r.best))
            .collect()
    };
    assert_eq!(losses(&expected), losses(&second));
    assert_eq!(table().lines().count() as u32, config.epochs + 1);

    // A finished run that is resumed has nothing to do and says the same.
    let third = train(config, &load(), &resuming(&out), |_| {
        panic!("no epoch is left")
    })
    .unwrap();
    assert_eq!(
        (third.resumed_from, third.model),
        (Some(config.epochs), second.model)
    );
    // No scratch file has a name.
    let names = std::fs::read_dir(checkpoint_folder(&out)).unwrap();
    let names = names.map(|n| n.unwrap().file_name().into_string().unwrap());
    assert!({ names }.all(|name| CHECKPOINT_FILES.iter().any(|(file, _)| *file == name)));
}

fn scene(name: &str, held_out: bool) -> SceneEntry {
    SceneEntry {
        name: name.to_owned(),
        file: format!("{name}.toml"),
        sha256: "0".repeat(64),
        content: String::new(),
        held_out,
        effects: Vec::new(),
    }
}

/// A dataset with one view of each scene, of `side`×`side` pixels; `rows` makes a view from its number.
fn write_views(
    folder: &Path,
    side: u32,
    scenes: Vec<SceneEntry>,
    rows: impl Fn(u32) -> FragmentBatch,
) -> Dataset {
    let parts = scenes.len() as u32;
    let writer = DatasetWriter::create(
        folder,
        Header {
            format: Format::Npy,
            pixels_fraction: 1.0,
            scenes,
            work_items: parts,
            ..Header::default()
        },
    )
    .unwrap();
    for index in 0..parts {
        let mut part = writer
            .begin(Part {
                index,
                scene: index,
                width: side,
                height: side,
                ..Part::default()
            })
            .unwrap();
        part.write(&rows(index)).unwrap();
        part.finish(0, 0).unwrap();
    }
    writer.finish().unwrap();
    Dataset::open(folder).unwrap()
}
