//! Whole runs: what they learn, that they repeat, resume, stop and refuse.

use peelnet_dataset::Subset;
use peelnet_model::{Model, Recipe};
use peelnet_train::{
    Config, End, OutputLock, RunOptions, Schedule, TrainingData, checkpoint_folder, train,
};

use super::{NEVER, assert_repeats, assert_resumes, resuming, run};

/// Rows like those of a scene with one α for all: T falls with depth and with the sum of alphas.
fn rows(n: usize) -> TrainingData {
    let mut data = TrainingData::new("synthetic", vec![Vec::new(); 3], vec![Vec::new()]);
    for i in 0..n {
        // Low-discrepancy points, so that no generator is needed.
        let point = |step: f64| (i as f64 * step).fract();
        let (share, alpha) = (point(0.618_033_988_75), 0.1 + 0.8 * point(0.414_213_562));
        let count = 1.0 + (9.0 * point(0.732_050_807_568)).floor();
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

fn with(change: impl FnOnce(&mut Config)) -> Config {
    let mut config = config();
    change(&mut config);
    config
}

#[test]
fn a_network_learns_and_its_file_answers_in_raw_units() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("deep/net.safetensors");
    let data = rows(6000);
    let config = with(|c| (c.epochs, c.learning_rate) = (30, 3e-3));
    let options = RunOptions::new(&out, &NEVER);
    let mut seen = Vec::new();
    let outcome = train(&config, &data, &options, |all| seen.push(all.len())).unwrap();
    assert!(seen.into_iter().eq(1..=30));
    assert_eq!((outcome.end, outcome.model_epoch), (End::Finished, 30));
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
    let error = (0..6000)
        .map(|i| {
            let raw = [data.inputs[0][i], data.inputs[1][i], data.inputs[2][i]];
            (model.forward_raw(&raw)[0] - data.targets[0][i]).abs()
        })
        .sum::<f32>()
        / 6000.0;
    assert!(error < 0.07, "{error}");

    for name in ["last", "best"] {
        Model::load(outcome.checkpoint.join(name).with_extension("safetensors")).unwrap();
    }
}

#[test]
fn runs_repeat_and_resume() {
    // Batches of 13 chunks, the last of them short.
    let chunks = with(|c| (c.batch, c.chunk) = (1600, 128));
    assert_repeats(&chunks, &|_| rows(5000));
    for config in [
        config(),
        with(|c| c.schedule = Schedule::OneCycle { warmup: 0.3 }),
        with(|c| c.patience = Some(4)),
    ] {
        assert_resumes(&config, &|| rows(3000));
    }
}

#[test]
fn epochs_can_be_added_to_a_finished_run() {
    let folder = tempfile::tempdir().unwrap();
    let data = rows(1000);
    let (short, long) = (config(), with(|c| c.epochs = 9));
    let straight = folder.path().join("straight.safetensors");
    run(&long, &data, &straight).unwrap();
    let out = folder.path().join("extended.safetensors");
    run(&short, &data, &out).unwrap();
    train(&long, &data, &resuming(&out), |_| {}).unwrap();
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
    let refuse = |change: fn(&mut Config, &mut TrainingData), word: &str| {
        let (mut config, mut data) = (config(), data.clone());
        change(&mut config, &mut data);
        let error = train(&config, &data, &resuming(&out), |_| {}).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("state.safetensors") && text.contains(word),
            "{text}"
        );
    };
    refuse(|config, _| config.seed = 2, "`seed`");
    refuse(|config, _| config.hidden = vec![4], "`hidden`");
    refuse(|_, data| data.targets[0][7] += 0.25, "other rows");

    let state = checkpoint_folder(&out).join("state.safetensors");
    let bytes = std::fs::read(&state).unwrap();
    for damaged in [
        &bytes[..bytes.len() - 9],
        &bytes[..40],
        &[][..],
        b"not a checkpoint",
    ] {
        std::fs::write(&state, damaged).unwrap();
        refuse(|_, _| {}, "delete the checkpoint folder");
    }
    // Training afresh replaces it.
    run(&config(), &data, &out).unwrap();
}

#[test]
fn divergence_is_an_error_that_keeps_the_last_good_weights() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    // One step an epoch: it sends the weights to about 9, so the next loss, of the size of their sixth power times the squares of both
    // widths, is beyond use.
    let diverging =
        |held_out| with(|c| (c.learning_rate, c.batch, c.held_out) = (9.0, 100, held_out));
    let error = run(&diverging(0.0), &rows(100), &out).unwrap_err();
    let text = error.to_string();
    let kept = checkpoint_folder(&out).join("last.safetensors");
    for words in ["in epoch 2:", "learning rate", &kept.display().to_string()] {
        assert!(text.contains(words), "{text}");
    }
    assert_eq!(Model::load(kept).unwrap().meta.epochs, 1);
    assert!(!out.exists());

    // With held-out rows the first epoch is found out already, and there is nothing to keep.
    let error = run(&diverging(0.5), &rows(100), &out).unwrap_err();
    let text = error.to_string();
    let is_kept = text.contains("weights before");
    assert!(text.contains("in epoch 1:") && !is_kept, "{text}");
}

#[test]
fn patience_stops_and_takes_the_best_epoch() {
    let folder = tempfile::tempdir().unwrap();
    // Noise cannot be learnt, so the held-out loss soon stops falling.
    let mut data = rows(90);
    for (i, target) in data.targets[0].iter_mut().enumerate() {
        *target = (i * 37 % 11) as f32 / 10.0;
    }
    let config = with(|c| (c.epochs, c.learning_rate, c.patience) = (5000, 1e-2, Some(5)));
    let outcome = run(&config, &data, &folder.path().join("net.safetensors")).unwrap();
    assert_eq!(outcome.end, End::StoppedEarly);
    assert_eq!(outcome.history.len(), outcome.model_epoch as usize + 5);
    let losses = outcome.history.iter().filter_map(|r| r.held_out_loss);
    let lowest = losses.fold(f64::INFINITY, f64::min);
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
    let long = with(|c| (c.epochs, c.learning_rate) = (200, 1e-2));
    let history = run(&long, &same, &out).unwrap().history;
    assert!(history[199].train_loss < 1e-4, "one answer is learnt");

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
}

#[test]
fn two_trainings_of_one_output_exclude_one_another() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("net.safetensors");
    let options = RunOptions::new(&out, &NEVER);
    let mut refused = 0;
    train(&config(), &rows(200), &options, |_| {
        let e = run(&config(), &rows(200), &out).unwrap_err();
        assert!(
            e.to_string().contains("another command writes there"),
            "{e}"
        );
        refused += 1;
    })
    .unwrap();
    assert_eq!(refused, config().epochs);
    // A caller that holds the lock longer than the run.
    let lock = OutputLock::take(&out).unwrap();
    let options = RunOptions {
        lock: Some(&lock),
        ..options
    };
    train(&config(), &rows(200), &options, |_| {}).unwrap();
}
