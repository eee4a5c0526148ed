//! Training from a scratch file: the same examples as in memory, and the same bytes for the same seed.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use peelnet_core::random::Random;
use peelnet_dataset::{Dataset, FragmentBatch, PeeledFragment, SplitBy, Subset};
use peelnet_model::Recipe;
use peelnet_train::{Config, DataSplit, TrainError, TrainingData, train};

use super::{NEVER, assert_repeats, assert_resumes, resuming, run, scene, write_views};

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
        let points = depths.into_iter().zip(alphas).map(|(depth, alpha)| {
            let [r, g, b] = random.color();
            let color = [r, g, b, alpha];
            PeeledFragment { depth, color }
        });
        let fragments: Vec<_> = points.collect();
        batch.push_pixel([index, x, y], [0.1, 100.0], fragments.into_iter());
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

fn streamed(config: &Config, dataset: &Dataset, folder: &Path) -> TrainingData {
    let datasets = std::slice::from_ref(dataset);
    TrainingData::streamed(config, datasets, folder, &NEVER, |_, _| {}).unwrap()
}

/// Recipes of every kind of examples: rows, pixels of which T is asked, weighed rows, pixels of which shares are asked.
const RECIPES: [Recipe; 4] = [Recipe::THESIS, Recipe::NMT, Recipe::DFAOIT, Recipe::MEDIUM];

#[test]
fn streamed_runs_repeat_and_resume() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 4);
    for recipe in RECIPES {
        let config = config(recipe);
        assert_repeats(&config, &|config| streamed(config, &dataset, folder.path()));
        assert_resumes(&config, &|| streamed(&config, &dataset, folder.path()));
    }
}

/// The checkpoint belongs to the dataset and the buffer: another hash and another order are refused, and so is a training in memory.
#[test]
fn a_checkpoint_of_another_dataset_or_buffer_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(Recipe::THESIS);
    let out = folder.path().join("net.safetensors");
    let write_dataset = |name: &str, views| {
        let dataset = write(&folder.path().join(name), views);
        streamed(&config, &dataset, folder.path())
    };
    let data = write_dataset("a", 2);
    run(&config, &data, &out).unwrap();
    let error = train(&config, &write_dataset("b", 3), &resuming(&out), |_| {}).unwrap_err();
    assert!(error.to_string().contains("other rows"), "{error}");
    // The same files, of which a scene is held out now.
    let scenes = vec![scene("s0", false), scene("s1", true)];
    let marked = write_views(&folder.path().join("c"), SIDE, scenes, view);
    let marked = streamed(&config, &marked, folder.path());
    let hash = |data: &TrainingData| data.dataset.as_ref().unwrap().hash.clone();
    assert_eq!(hash(&marked), hash(&data));
    let error = train(&config, &marked, &resuming(&out), |_| {}).unwrap_err();
    assert!(error.to_string().contains("other rows"), "{error}");
    let mut other = config.clone();
    other.buffer_rows = None;
    let error = train(&other, &data, &resuming(&out), |_| {}).unwrap_err();
    assert!(error.to_string().contains("`buffer_rows`"), "{error}");
}

#[test]
fn the_pass_can_be_stopped_and_too_few_pixels_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write(&folder.path().join("rows"), 2);
    let datasets = std::slice::from_ref(&dataset);
    let good = config(Recipe::MEDIUM);
    let begin = |config: &Config, stop| {
        let stop = AtomicBool::new(stop);
        TrainingData::streamed(config, datasets, folder.path(), &stop, |_, _| {})
    };
    assert!(matches!(begin(&good, true), Err(TrainError::Stopped)));
    let mut few = good.clone();
    few.held_out = 1e-9;
    let error = begin(&few, false).unwrap_err().to_string();
    assert!(
        error.contains("testing") && error.contains("without streaming"),
        "{error}"
    );
    let data = begin(&good, false).unwrap();
    assert_eq!(data.split, Some(DataSplit::Pixels { scenes: 2 }));
    assert!(data.scratch_bytes() > Some(0));
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
        assert_eq!(stream.rows(), held.rows(), "{recipe}");
        for subset in [Subset::Train, Subset::Validation, Subset::Test] {
            assert_eq!(stream.examples(subset), held.examples(subset), "{recipe}");
        }
        let out = folder.path().join("net.safetensors");
        let a = run(&config, &stream, &out).unwrap().model.meta;
        config.buffer_rows = None;
        let b = run(&config, &held, &out).unwrap().model.meta;
        assert_eq!(a.dataset, b.dataset);
        for (a, b) in a.inputs.iter().zip(&b.inputs) {
            let largest = a.min.abs().max(a.max.abs());
            let is_near = |a: f32, b: f32, size: f32| (a - b).abs() <= f32::EPSILON * size;
            assert!(
                (a.min, a.max) == (b.min, b.max)
                    && is_near(a.offset, b.offset, largest)
                    && is_near(a.scale, b.scale, b.scale),
                "{recipe}: {a:?}, {b:?}"
            );
        }
    }
}
