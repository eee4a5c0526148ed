//! Training from a scratch file: the same examples as in memory, the same bytes for the same seed, and as good a network.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should panic")]

mod common;

use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use common::{scene, write_views};
use peelnet_core::random::Random;
use peelnet_dataset::{Dataset, FragmentBatch, SplitBy, Subset};
use peelnet_model::Recipe;
use peelnet_train::{
    Config, DataSplit, End, Outcome, Part, RunOptions, Source, StreamedData, TrainError,
    TrainingData, checkpoint_folder, train,
};

const SIDE: u32 = 40;

/// Pixels of 2 to 7 fragments of random depths, opacities and colours, about 7,200 rows.
fn view(index: u32) -> FragmentBatch {
    let mut batch = FragmentBatch::default();
    let mut random = Random::new(11, &[index.into()]);
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let count = 2 + random.below(6);
        let mut depths: Vec<f32> = (0..count).map(|_| random.between(1.0, 12.0)).collect();
        depths.sort_by(f32::total_cmp);
        // Views differ: the first are clear, the last nearly opaque.
        let alphas: Vec<f32> = (0..count)
            .map(|_| random.between(0.1, 0.3 + 0.08 * index as f32))
            .collect();
        let mut through = 1.0;
        for (layer, (&depth, &alpha)) in depths.iter().zip(&alphas).enumerate() {
            batch.one_minus_alpha.push(1.0 - alpha);
            batch.linear_depth.push(depth);
            batch.alpha_sum.push(alphas.iter().sum());
            batch.fragment_count.push(count as u32);
            batch.transmittance.push(through);
            batch.view.push(index);
            batch.x.push(x);
            batch.y.push(y);
            batch.layer.push(layer as u32);
            let [r, g, b] = random.color();
            batch.r.push(r);
            batch.g.push(g);
            batch.b.push(b);
            batch.near.push(0.1);
            batch.far.push(100.0);
            through *= 1.0 - alpha;
        }
    }
    batch
}

fn write(folder: &Path, views: u32) -> Dataset {
    let scenes = (0..views).map(|k| scene(&format!("s{k}"), false));
    write_views(folder, SIDE, scenes.collect(), view)
}

fn config(recipe: Recipe) -> Config {
    Config {
        epochs: 4,
        batch: 96,
        chunk: 40,
        learning_rate: 2e-3,
        split: SplitBy::Pixel,
        // About six windows of four views.
        buffer_rows: Some(3000),
        ..Config::for_recipe(recipe)
    }
}

fn streamed(config: &Config, dataset: &Dataset, folder: &Path) -> StreamedData {
    let stop = AtomicBool::new(false);
    let datasets = std::slice::from_ref(dataset);
    StreamedData::from_datasets(config, datasets, folder, &stop, |_, _| {}).unwrap()
}

fn run<'a>(config: &Config, data: impl Into<Source<'a>>, out: &Path) -> Outcome {
    let stop = AtomicBool::new(false);
    train(config, data, &RunOptions::new(out, &stop), |_| {}).unwrap()
}

/// Recipes of every kind of examples: rows, weighed rows, pixels.
const RECIPES: [Recipe; 4] = [Recipe::THESIS, Recipe::NMT, Recipe::DFAOIT, Recipe::MEDIUM];

#[test]
fn the_seed_decides_the_bytes_and_the_number_of_threads_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 4);
    for recipe in RECIPES {
        let bytes = |threads: usize, config: &Config| {
            // Everything anew, the pass over the dataset as well.
            let data = streamed(config, &dataset, folder.path());
            let out = folder.path().join("net.safetensors");
            let stop = AtomicBool::new(false);
            let options = RunOptions {
                threads: NonZeroUsize::new(threads),
                ..RunOptions::new(&out, &stop)
            };
            train(config, &data, &options, |_| {}).unwrap();
            std::fs::read(out).unwrap()
        };
        let config = config(recipe);
        let one = bytes(1, &config);
        for threads in [1, 2, 5] {
            assert!(
                one == bytes(threads, &config),
                "{recipe}, {threads} threads"
            );
        }
        assert!(one != bytes(1, &Config { seed: 2, ..config }), "{recipe}");
    }
}

#[test]
fn a_run_interrupted_and_resumed_has_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 4);
    for recipe in RECIPES {
        let config = config(recipe);
        let whole = folder.path().join(format!("{recipe}-whole.safetensors"));
        let expected = run(&config, &streamed(&config, &dataset, folder.path()), &whole);
        let out = folder.path().join(format!("{recipe}.safetensors"));
        let stop = AtomicBool::new(false);
        let mut options = RunOptions::new(&out, &stop);
        let data = streamed(&config, &dataset, &checkpoint_folder(&out));
        let first = train(&config, &data, &options, |report| {
            stop.store(report.epoch == 2, Ordering::Relaxed);
        })
        .unwrap();
        assert_eq!((first.end, first.history.len()), (End::Interrupted, 2));
        // A process that was killed has no scratch file any more.
        drop(data);
        stop.store(false, Ordering::Relaxed);
        options.resume = true;
        let data = streamed(&config, &dataset, &checkpoint_folder(&out));
        let second = train(&config, &data, &options, |_| {}).unwrap();
        assert_eq!((second.end, second.resumed_from), (End::Finished, Some(2)));
        assert_eq!(second.model, expected.model, "{recipe}");
        assert!(
            std::fs::read(&whole).unwrap() == std::fs::read(&out).unwrap(),
            "{recipe}"
        );
        // Another buffer has another order, and a training in memory is another one.
        for buffer_rows in [Some(3001), None] {
            let other = Config {
                buffer_rows,
                ..config.clone()
            };
            let error = train(&other, &data, &options, |_| {}).unwrap_err();
            assert!(error.to_string().contains("`buffer_rows`"), "{error}");
        }
    }
    let names = std::fs::read_dir(folder.path()).unwrap();
    let left: Vec<_> = names.map(|n| n.unwrap().file_name()).collect();
    assert!(
        left.iter()
            .all(|n| n.to_string_lossy().contains("safetensors") || n == "rows"),
        "scratch files have no name: {left:?}"
    );
}

/// The checkpoint belongs to the dataset: another one's hash is refused.
#[test]
fn a_checkpoint_of_another_dataset_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(Recipe::THESIS);
    let out = folder.path().join("net.safetensors");
    let of = |name: &str, views| {
        let dataset = write(&folder.path().join(name), views);
        streamed(&config, &dataset, folder.path())
    };
    run(&config, &of("a", 2), &out);
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        resume: true,
        ..RunOptions::new(&out, &stop)
    };
    let error = train(&config, &of("b", 3), &options, |_| {}).unwrap_err();
    assert!(error.to_string().contains("other rows"), "{error}");
}

#[test]
fn the_pass_can_be_stopped_and_too_few_pixels_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 2);
    let datasets = std::slice::from_ref(&dataset);
    let good = config(Recipe::MEDIUM);
    let begin = |config: &Config, stop| {
        let stop = AtomicBool::new(stop);
        StreamedData::from_datasets(config, datasets, folder.path(), &stop, |_, _| {})
    };
    assert!(matches!(begin(&good, true), Err(TrainError::Stopped)));
    let few = Config {
        held_out: 1e-9,
        ..good.clone()
    };
    let error = begin(&few, false).unwrap_err().to_string();
    assert!(
        error.contains("testing") && error.contains("without streaming"),
        "{error}"
    );
    let data = begin(&good, false).unwrap();
    assert_eq!(data.split, Some(DataSplit::Pixels { scenes: 2 }));
    assert!(data.scratch_bytes() > 0);
}

/// As many examples and rows of each part as in memory, and the same normalisation in the model file. The offsets and scales are
/// 32-bit roundings of 64-bit sums of n ≈ 20,000 terms, whose relative error is at most n ε₆₄ = 4e-12: two roundings to 32 bits of
/// nearly the same number are at most one unit in the last place apart, ε₃₂ of the number; of the offset, of the values that were added.
#[test]
fn examples_and_normalisation_are_those_of_memory() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 4);
    for recipe in Recipe::ALL {
        let mut config = config(recipe);
        config.epochs = 1;
        let stream = streamed(&config, &dataset, folder.path());
        let held = TrainingData::from_datasets(&config, std::slice::from_ref(&dataset)).unwrap();
        assert_eq!(stream.rows(), held.rows() as u64, "{recipe}");
        for (part, subset) in [
            (Part::Train, Subset::Train),
            (Part::Validation, Subset::Validation),
            (Part::Test, Subset::Test),
        ] {
            let subsets = held.subsets.iter().flatten();
            let count = subsets.filter(|s| **s == subset).count();
            assert_eq!(stream.examples(part), count as u64, "{recipe}");
        }
        let out = folder.path().join("net.safetensors");
        let a = run(&config, &stream, &out).model.meta;
        config.buffer_rows = None;
        let b = run(&config, &held, &out).model.meta;
        assert_eq!(a.dataset, b.dataset);
        for (a, b) in a.inputs.iter().zip(&b.inputs) {
            assert_eq!((a.min, a.max), (b.min, b.max), "{recipe}, {}", a.name);
            let largest = a.min.abs().max(a.max.abs());
            assert!(
                (a.offset - b.offset).abs() <= f32::EPSILON * largest,
                "{recipe}, {}",
                a.name
            );
            assert!(
                (a.scale - b.scale).abs() <= f32::EPSILON * b.scale,
                "{recipe}, {}",
                a.name
            );
        }
    }
}

/// Data that fit both ways: a streamed training ends where one in memory does. The tolerance is of the seeds: the means over n seeds of
/// two samples of one distribution of standard deviation s differ by more than 3 s √(2/n) once in 370 times, and s is estimated from
/// both.
#[test]
fn a_streamed_training_is_as_good_as_one_in_memory() {
    const SEEDS: u64 = 5;
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 4);
    for recipe in [Recipe::THESIS, Recipe::MEDIUM] {
        let mut losses = [Vec::new(), Vec::new()];
        for seed in 1..=SEEDS {
            let mut config = config(recipe);
            // The rows that judge must be the same: the split's seed is the run's, so they are drawn for each seed, alike both ways.
            (config.seed, config.epochs) = (seed, 6);
            let out = folder.path().join("net.safetensors");
            let stream = streamed(&config, &dataset, folder.path());
            let of = |outcome: Outcome| outcome.history.last().unwrap().held_out_loss.unwrap();
            losses[0].push(of(run(&config, &stream, &out)));
            config.buffer_rows = None;
            let held =
                TrainingData::from_datasets(&config, std::slice::from_ref(&dataset)).unwrap();
            losses[1].push(of(run(&config, &held, &out)));
        }
        let n = SEEDS as f64;
        let mean = |l: &Vec<f64>| l.iter().sum::<f64>() / n;
        let [a, b] = [mean(&losses[0]), mean(&losses[1])];
        let squares = |l: &Vec<f64>, m: f64| l.iter().map(|v| (v - m).powi(2)).sum::<f64>();
        let spread = ((squares(&losses[0], a) + squares(&losses[1], b)) / (2.0 * (n - 1.0))).sqrt();
        println!("{recipe}: streamed {a:.6}, in memory {b:.6}, deviation of a seed {spread:.6}");
        assert!(
            (a - b).abs() <= 3.0 * spread * (2.0 / n).sqrt(),
            "{recipe}: {losses:?}"
        );
    }
}
