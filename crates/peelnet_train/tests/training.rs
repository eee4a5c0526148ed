//! Whole runs: what they learn, that they repeat, resume, stop and refuse.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should panic")]

use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use peelnet_dataset::Subset;
use peelnet_model::{Model, Recipe};
use peelnet_train::{
    Config, End, OutputLock, RunOptions, Schedule, TrainError, TrainingData, checkpoint_folder,
    train,
};

/// Rows like those of a scene with one α for all: T falls with depth and with the sum of alphas.
fn rows(n: usize) -> TrainingData {
    let mut data = TrainingData {
        source: "synthetic".to_owned(),
        inputs: vec![Vec::new(); 3],
        targets: vec![Vec::new()],
        weights: None,
        pixels: None,
        subsets: None,
        used: None,
        split: None,
        dataset: None,
    };
    for i in 0..n {
        // Low-discrepancy points, so that no generator is needed.
        let point = |step: f64| (i as f64 * step).fract();
        let (share, alpha) = (
            point(0.618_033_988_749_895),
            0.1 + 0.8 * point(0.414_213_562_373_095),
        );
        let count = 1.0 + (9.0 * point(0.732_050_807_568_877)).floor();
        data.inputs[0].push((2.0 + 10.0 * share) as f32);
        data.inputs[1].push((alpha * count) as f32);
        data.inputs[2].push(count as f32);
        data.targets[0].push((1.0 - alpha).powf(share * (count - 1.0)) as f32);
    }
    data
}

fn config() -> Config {
    Config {
        epochs: 6,
        learning_rate: 1e-3,
        ..Config::for_recipe(Recipe::THESIS)
    }
}

fn run(
    config: &Config,
    data: &TrainingData,
    out: &Path,
) -> Result<peelnet_train::Outcome, TrainError> {
    train(
        config,
        data,
        &RunOptions::new(out, &AtomicBool::new(false)),
        |_| {},
    )
}

#[test]
fn a_network_learns_and_its_file_answers_in_raw_units() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("deep/net.safetensors");
    let data = rows(6000);
    let config = Config {
        epochs: 30,
        learning_rate: 3e-3,
        ..config()
    };
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        loss_curve: vec![
            folder.path().join("loss.csv"),
            folder.path().join("loss.svg"),
        ],
        ..RunOptions::new(&out, &stop)
    };
    let mut seen = 0;
    let outcome = train(&config, &data, &options, |report| {
        seen += 1;
        assert_eq!((report.epoch, report.epochs), (seen, 30));
        assert!(report.rows_per_s > 0.0);
    })
    .unwrap();
    assert_eq!(seen, 30);
    assert_eq!(
        (outcome.end, outcome.model_epoch, outcome.resumed_from),
        (End::Finished, 30, None)
    );
    // The target's variance is about 0.1: a network that learnt nothing would stay there.
    let test = outcome.model.meta.losses.test.unwrap();
    assert!(test < 0.005, "{test}");
    assert!(
        outcome.model.meta.losses.validation.is_none(),
        "nothing was chosen by the held-out rows"
    );

    let model = Model::load(&out).unwrap();
    assert_eq!(model, outcome.model);
    assert_eq!(model.mlp.topology(), "3-10-8-1");
    assert_eq!(
        serde_json::from_value::<Config>(model.meta.config.clone()).unwrap(),
        config
    );
    let error = (0..data.rows())
        .map(|i| {
            let raw = [data.inputs[0][i], data.inputs[1][i], data.inputs[2][i]];
            (model.forward_raw(&raw)[0] - data.targets[0][i]).abs()
        })
        .sum::<f32>()
        / data.rows() as f32;
    assert!(error < 0.07, "{error}");

    let table = std::fs::read_to_string(folder.path().join("loss.csv")).unwrap();
    assert_eq!(table.lines().count(), 31);
    assert!(
        std::fs::read_to_string(folder.path().join("loss.svg"))
            .unwrap()
            .starts_with("<svg")
    );
    for name in ["last", "best"] {
        Model::load(outcome.checkpoint.join(name).with_extension("safetensors")).unwrap();
    }
}

#[test]
fn the_seed_decides_the_bytes_and_the_number_of_threads_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let data = rows(5000);
    // Batches of 13 chunks, the last of them short.
    let config = Config {
        batch: 1600,
        chunk: 128,
        ..config()
    };
    let stop = AtomicBool::new(false);
    let bytes = |threads: usize, config: &Config| {
        let out = folder.path().join("net.safetensors");
        let options = RunOptions {
            threads: NonZeroUsize::new(threads),
            ..RunOptions::new(&out, &stop)
        };
        train(config, &data, &options, |_| {}).unwrap();
        std::fs::read(out).unwrap()
    };
    let one = bytes(1, &config);
    for threads in [1, 2, 3, 7] {
        assert!(one == bytes(threads, &config), "{threads} threads");
    }
    assert!(one != bytes(1, &Config { seed: 2, ..config }));
}

#[test]
fn a_run_interrupted_after_an_epoch_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let data = rows(3000);
    for (name, config) in [
        ("plain", config()),
        (
            "cycle",
            Config {
                schedule: Schedule::OneCycle { warmup: 0.3 },
                ..config()
            },
        ),
        (
            "patient",
            Config {
                patience: Some(4),
                ..config()
            },
        ),
    ] {
        let whole = folder.path().join(name).with_extension("whole");
        let parts = folder.path().join(name).with_extension("parts");
        std::fs::create_dir(&whole).unwrap();
        let expected = run(&config, &data, &whole.join("net.safetensors")).unwrap();

        let out = parts.join("net.safetensors");
        let stop = AtomicBool::new(false);
        let mut options = RunOptions::new(&out, &stop);
        let first = train(&config, &data, &options, |report| {
            stop.store(report.epoch == 3, Ordering::Relaxed);
        })
        .unwrap();
        assert_eq!((first.end, first.history.len()), (End::Interrupted, 3));
        assert!(!out.exists(), "an interrupted run leaves no finished model");
        assert!(Model::load(first.checkpoint.join("last.safetensors")).is_ok());

        stop.store(false, Ordering::Relaxed);
        options.resume = true;
        let second = train(&config, &data, &options, |_| {}).unwrap();
        assert_eq!((second.end, second.resumed_from), (End::Finished, Some(3)));
        assert_eq!(
            std::fs::read(whole.join("net.safetensors")).unwrap(),
            std::fs::read(&out).unwrap(),
            "{name}"
        );
        let losses = |outcome: &peelnet_train::Outcome| -> Vec<_> {
            outcome
                .history
                .iter()
                .map(|r| (r.train_loss, r.held_out_loss, r.best))
                .collect()
        };
        assert_eq!(losses(&expected), losses(&second));

        // A finished run that is resumed has nothing to do and says the same.
        let third = train(&config, &data, &options, |_| panic!("no epoch is left")).unwrap();
        assert_eq!((third.resumed_from, third.model), (Some(6), second.model));
    }
}

/// The moment of the stop is left to chance: whatever it is, the result must be the same.
#[test]
fn a_run_interrupted_within_an_epoch_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let data = rows(20_000);
    let whole = folder.path().join("whole.safetensors");
    let config = Config {
        batch: 32,
        ..config()
    };
    run(&config, &data, &whole).unwrap();
    let out = folder.path().join("parts.safetensors");
    for attempt in 0..1000 {
        let stop = AtomicBool::new(false);
        let options = RunOptions {
            resume: checkpoint_folder(&out).exists(),
            ..RunOptions::new(&out, &stop)
        };
        let outcome = std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(20 * (attempt + 1)));
                stop.store(true, Ordering::Relaxed);
            });
            train(&config, &data, &options, |_| {}).unwrap()
        });
        if outcome.end == End::Finished {
            break;
        }
    }
    assert_eq!(std::fs::read(whole).unwrap(), std::fs::read(out).unwrap());
}

#[test]
fn epochs_can_be_added_to_a_finished_run() {
    let folder = tempfile::tempdir().unwrap();
    let data = rows(1000);
    let (short, long) = (
        config(),
        Config {
            epochs: 9,
            ..config()
        },
    );
    let straight = folder.path().join("straight.safetensors");
    run(&long, &data, &straight).unwrap();
    let out = folder.path().join("extended.safetensors");
    run(&short, &data, &out).unwrap();
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        resume: true,
        ..RunOptions::new(&out, &stop)
    };
    train(&long, &data, &options, |_| {}).unwrap();
    assert_eq!(
        std::fs::read(straight).unwrap(),
        std::fs::read(out).unwrap()
    );
}

#[test]
fn a_checkpoint_of_another_run_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    let data = rows(300);
    run(&config(), &data, &out).unwrap();
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        resume: true,
        ..RunOptions::new(&out, &stop)
    };
    let message = |config: &Config, data: &TrainingData| {
        train(config, data, &options, |_| {})
            .unwrap_err()
            .to_string()
    };
    let text = message(
        &Config {
            seed: 2,
            ..config()
        },
        &data,
    );
    assert!(
        text.contains("state.safetensors") && text.contains("`seed`"),
        "{text}"
    );
    let text = message(
        &Config {
            hidden: vec![4],
            ..config()
        },
        &data,
    );
    assert!(text.contains("`hidden`"), "{text}");
    let mut other = data.clone();
    other.targets[0][7] += 0.25;
    let text = message(&config(), &other);
    assert!(text.contains("other rows"), "{text}");

    let state = checkpoint_folder(&out).join("state.safetensors");
    let bytes = std::fs::read(&state).unwrap();
    for damaged in [
        &bytes[..bytes.len() - 9],
        &bytes[..40],
        &[][..],
        b"not a checkpoint",
    ] {
        std::fs::write(&state, damaged).unwrap();
        let text = message(&config(), &data);
        assert!(
            text.contains("state.safetensors") && text.contains("delete the checkpoint folder"),
            "{text}"
        );
    }
    // Training afresh replaces it.
    run(&config(), &data, &out).unwrap();
}

#[test]
fn resuming_without_a_checkpoint_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        resume: true,
        ..RunOptions::new(folder.path().join("net.safetensors"), &stop)
    };
    let refused = train(&config(), &rows(200), &options, |_| {
        panic!("no epoch may run")
    });
    let text = refused.unwrap_err().to_string();
    let file = "net.safetensors.checkpoint";
    assert!(
        text.contains(file) && text.contains("no such file"),
        "{text}"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn divergence_is_an_error_that_keeps_the_last_good_weights() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    // One step an epoch: it sends the weights to about 1e9, so the next loss, of the size of their sixth power,
    // is beyond 32 bits.
    let config = Config {
        learning_rate: 1e9,
        batch: 100,
        held_out: 0.0,
        ..config()
    };
    let error = run(&config, &rows(100), &out).unwrap_err();
    let TrainError::Diverged {
        epoch: 2,
        kept: Some(kept),
        ..
    } = &error
    else {
        panic!("{error}");
    };
    let model = Model::load(kept).unwrap();
    assert_eq!(model.meta.epochs, 1);
    assert!(error.to_string().contains("learning rate"), "{error}");
    assert!(!out.exists());

    // With held-out rows the first epoch is found out already, and there is nothing to keep.
    let error = run(
        &Config {
            held_out: 0.5,
            ..config
        },
        &rows(100),
        &out,
    )
    .unwrap_err();
    assert!(
        matches!(
            error,
            TrainError::Diverged {
                epoch: 1,
                kept: None,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn patience_stops_and_takes_the_best_epoch() {
    let folder = tempfile::tempdir().unwrap();
    // Noise cannot be learnt, so the held-out loss soon stops falling.
    let mut data = rows(90);
    for (i, target) in data.targets[0].iter_mut().enumerate() {
        *target = (i * 37 % 11) as f32 / 10.0;
    }
    let config = Config {
        epochs: 5000,
        learning_rate: 1e-2,
        patience: Some(5),
        ..config()
    };
    let outcome = run(&config, &data, &folder.path().join("net.safetensors")).unwrap();
    assert_eq!(outcome.end, End::StoppedEarly);
    assert_eq!(outcome.history.len(), outcome.model_epoch as usize + 5);
    let lowest = outcome
        .history
        .iter()
        .filter_map(|r| r.held_out_loss)
        .fold(f64::INFINITY, f64::min);
    assert_eq!(outcome.model.meta.losses.validation, Some(lowest));
    assert_eq!(outcome.model.meta.losses.test, None);
}

#[test]
fn rows_that_cannot_be_trained_on_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    let refuse = |data: &TrainingData, words: &[&str]| {
        let text = run(&config(), data, &out).unwrap_err().to_string();
        for word in words {
            assert!(text.contains(word), "{text}: no {word:?}");
        }
    };
    refuse(&rows(0), &["synthetic", "no rows"]);
    for (value, name) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        let mut data = rows(10);
        data.inputs[1][4] = value;
        refuse(&data, &["row 4", "alpha_sum", name]);
    }
    let mut data = rows(10);
    data.targets[0][9] = f32::NAN;
    refuse(&data, &["row 9", "target"]);
    let mut data = rows(10);
    data.inputs[2].pop();
    refuse(&data, &["fragment_count", "9 rows", "10"]);
    data.inputs.pop();
    refuse(
        &data,
        &["2 input columns", "linear_depth, alpha_sum, fragment_count"],
    );
    let mut data = rows(2);
    data.subsets = Some(vec![Subset::Test; 2]);
    refuse(&data, &["every row is held out"]);
    assert!(
        !out.exists() && !checkpoint_folder(&out).exists(),
        "nothing is written for refused rows"
    );
}

#[test]
fn few_equal_and_constant_rows_train_to_something_finite() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    let one = run(&config(), &rows(1), &out).unwrap();
    assert_eq!(
        one.model.meta.losses.test, None,
        "one row leaves none to hold out"
    );
    assert_eq!(one.history[5].held_out_loss, None);

    let mut same = rows(1);
    for column in same.inputs.iter_mut().chain(&mut same.targets) {
        column.resize(500, column[0]);
    }
    let same_rows = run(
        &Config {
            epochs: 200,
            learning_rate: 1e-2,
            ..config()
        },
        &same,
        &out,
    )
    .unwrap();
    assert!(
        same_rows.history[199].train_loss < 1e-4,
        "one answer is learnt"
    );

    // A column that never varies must not matter afterwards, and the others must still be learnt from.
    let mut constant = rows(2000);
    constant.inputs[0].fill(0.1);
    let model = run(&config(), &constant, &out).unwrap().model;
    let answer = |depth: f32| model.forward_raw(&[depth, 2.0, 4.0]);
    assert_eq!(answer(0.1), answer(1e9));
    assert_ne!(
        model.forward_raw(&[0.1, 2.0, 4.0]),
        model.forward_raw(&[0.1, 0.5, 4.0])
    );

    // Depths of a thousand million carry the same information as small ones.
    let mut far = rows(2000);
    for depth in &mut far.inputs[0] {
        *depth *= 1e8;
    }
    let (near, far) = (
        run(&config(), &rows(2000), &out).unwrap(),
        run(&config(), &far, &out).unwrap(),
    );
    let (near, far) = (near.history[5].train_loss, far.history[5].train_loss);
    assert!((near - far).abs() < 1e-4 * near, "{near} against {far}");
}

/// Endings are appended to the whole name: what follows the last dot of `exp-0.5` is part of it.
#[test]
fn models_with_dots_in_their_names_have_checkpoints_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let outs = ["exp-0.5", "exp-0.7"].map(|name| folder.path().join(name));
    let models = outs.each_ref().map(|out| {
        let outcome = run(&config(), &rows(200), out).unwrap();
        assert_eq!(outcome.checkpoint, checkpoint_folder(out));
        std::fs::read(outcome.checkpoint.join("last.safetensors")).unwrap()
    });
    assert_eq!(models[0], models[1]);
    assert!(
        folder
            .path()
            .join("exp-0.5.checkpoint/state.safetensors")
            .is_file()
    );
    assert!(
        folder
            .path()
            .join("exp-0.7.checkpoint/state.safetensors")
            .is_file()
    );
    // Locks are gone.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
}

#[test]
fn two_trainings_of_one_output_exclude_one_another() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    let stop = AtomicBool::new(false);
    let mut refused = 0;
    train(&config(), &rows(200), &RunOptions::new(&out, &stop), |_| {
        let e = run(&config(), &rows(200), &out).unwrap_err();
        assert!(matches!(&e, TrainError::Busy { .. }), "{e}");
        refused += 1;
    })
    .unwrap();
    assert_eq!(refused, config().epochs);
    run(&config(), &rows(200), &out).unwrap();
    // A caller that holds the lock longer than the run.
    let lock = OutputLock::take(&out).unwrap();
    let options = RunOptions {
        lock: Some(&lock),
        ..RunOptions::new(&out, &stop)
    };
    train(&config(), &rows(200), &options, |_| {}).unwrap();
}

#[test]
fn places_that_cannot_be_written_are_refused_before_training() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let stop = AtomicBool::new(false);
    let refuse = |options: RunOptions<'_>, word: &str| {
        let text = train(&config(), &rows(20), &options, |_| {
            panic!("no epoch may run")
        })
        .unwrap_err()
        .to_string();
        assert!(text.contains(word), "{text}");
    };
    refuse(
        RunOptions::new(file.join("net.safetensors"), &stop),
        "file/net.safetensors.lock",
    );
    refuse(
        RunOptions::new(folder.path(), &stop),
        &folder.path().display().to_string(),
    );
    let curve = RunOptions {
        loss_curve: vec![folder.path().join("loss.png")],
        ..RunOptions::new(folder.path().join("net.safetensors"), &stop)
    };
    refuse(curve, "loss.png");
}
