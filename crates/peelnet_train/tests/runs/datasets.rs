//! From a dataset on disk to columns, and a model's error on its held-out scenes.

use std::path::Path;

use peelnet_dataset::{Dataset, FragmentBatch, PeeledFragment, SceneEntry, SplitBy, Subset};
use peelnet_model::Recipe;
use peelnet_train::{Config, DataSplit, TrainingData, held_out_errors};

use super::{run, scene, write_views};

const SIDE: u32 = 30;

/// A view of 30×30 pixels with fragments of α = ½ each.
fn stacks(index: u32, layers: u32) -> FragmentBatch {
    let mut batch = FragmentBatch::default();
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let fragments = (0..layers).map(|layer| PeeledFragment {
            depth: 1.0 + layer as f32 + x as f32 / 64.0,
            color: [0.5; 4],
        });
        batch.push_pixel([index, x, y], [0.1, 100.0], fragments);
    }
    batch
}

fn write(folder: &Path, layers: u32, scenes: Vec<SceneEntry>) -> Dataset {
    write_views(folder, SIDE, scenes, |index| stacks(index, layers))
}

/// Of rows that contradict one another, nothing sensible is learnt.
#[test]
fn rows_that_disagree_are_not_trained_on() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = write_views(folder.path(), SIDE, vec![scene("cups", false)], |index| {
        let mut rows = stacks(index, 3);
        rows.alpha_sum[4] += 1.0;
        rows
    });
    let config = Config::for_recipe(Recipe::THESIS);
    let error = TrainingData::from_datasets(&config, &[dataset]).unwrap_err();
    let text = error.to_string();
    for words in [
        "fragments-00000-cups",
        "pixel (1, 0), layer 1: alpha_sum is 2.5",
        "`peelnet inspect`",
    ] {
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn held_out_scenes_are_left_out_and_pixels_are_split_whole() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = vec![scene("cups", false), scene("panes", true)];
    let a = write(&folder.path().join("a"), 3, scenes);
    let b = write(&folder.path().join("b"), 3, vec![scene("smoke", false)]);
    let config = Config {
        epochs: 2,
        split: SplitBy::Pixel,
        ..Config::for_recipe(Recipe::THESIS)
    };
    let datasets = [a, b];
    let data = TrainingData::from_datasets(&config, &datasets).unwrap();
    let rows = 2 * 3 * (SIDE * SIDE) as usize;
    assert_eq!(data.rows(), rows as u64);
    assert_eq!(data.inputs[0][..3], [1.0, 2.0, 3.0]);
    assert_eq!(data.inputs[1], vec![1.5; rows]);
    assert_eq!(data.inputs[2], vec![3.0; rows]);
    assert_eq!(data.targets[0][..4], [1.0, 0.5, 0.25, 1.0]);
    let reference = data.dataset.clone().unwrap();
    assert_eq!(reference.scenes, ["cups", "smoke"]);
    assert_eq!(reference.rows, rows as u64);
    let hashes = datasets.each_ref().map(Dataset::hash);
    assert_eq!(reference.hash, hashes.join("+"));

    let held_out: Vec<bool> = (data.subsets.as_ref().unwrap().iter())
        .map(|&s| s == Subset::Test)
        .collect();
    let mut pixels = held_out.chunks_exact(3);
    assert!(pixels.all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2]));
    // 900 pixels, the same in both parts because both are view 0: a third of them, within five standard deviations
    // √(p(1−p)/900).
    let share = held_out.iter().filter(|&&h| h).count() as f64 / rows as f64;
    let deviation = (1.0 / 3.0 * 2.0 / 3.0 / 900.0f64).sqrt();
    assert!((share - 1.0 / 3.0).abs() < 5.0 * deviation, "{share}");

    let out = folder.path().join("net.safetensors");
    let model = run(&config, &data, &out).unwrap().model;
    let errors = held_out_errors(&model, &datasets).unwrap();
    assert_eq!(errors.keys().collect::<Vec<_>>(), ["panes"]);
    let batch = stacks(1, 3);
    let rows = batch.linear_depth.iter().zip(&batch.transmittance);
    let differences = rows.map(|(&depth, &t)| {
        let answer = model.forward_raw(&[depth, 1.5, 3.0])[0];
        (f64::from(answer) - f64::from(t)).abs()
    });
    let expected = differences.sum::<f64>() / batch.len() as f64;
    assert_eq!(errors["panes"], expected);

    // Of held-out scenes alone nothing is left.
    let alone = write(&folder.path().join("c"), 3, vec![scene("panes", true)]);
    let text = TrainingData::from_datasets(&config, &[alone]).unwrap_err();
    let text = text.to_string();
    assert!(text.contains(": no rows to train on"), "{text}");
}

/// Scenes in another order are the same scenes.
#[test]
fn a_view_in_two_datasets_would_count_twice() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = ["a", "b"].map(|name| SceneEntry {
        content: name.repeat(64),
        ..scene(name, false)
    });
    let write = |name: &str, scenes: &[SceneEntry], layers| {
        write_views(&folder.path().join(name), SIDE, scenes.to_vec(), |view| {
            stacks(view, layers)
        })
    };
    let [a, b] = scenes;
    let config = Config::for_recipe(Recipe::THESIS);
    let datasets = [
        write("ab", &[a.clone(), b.clone()], 3),
        write("ba", &[b, a], 4),
    ];
    assert!(TrainingData::from_datasets(&config, &datasets[..1]).is_ok());
    let error = TrainingData::from_datasets(&config, &datasets)
        .unwrap_err()
        .to_string();
    assert!(error.contains("both hold view 0 of scene 'b'"), "{error}");
}

/// One of them may be trained on and the other held out: which of both a network knows would be unknown.
#[test]
fn two_scenes_of_one_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |content: &str, layers, held_out| {
        let entry = SceneEntry {
            content: content.repeat(64),
            ..scene("a", held_out)
        };
        write_views(&folder.path().join(content), SIDE, vec![entry], |view| {
            stacks(view, layers)
        })
    };
    let config = Config::for_recipe(Recipe::THESIS);
    let datasets = [write("1", 3, false), write("2", 4, true)];
    let error = TrainingData::from_datasets(&config, &datasets).unwrap_err();
    assert!(error.to_string().contains("both named 'a'"), "{error}");
}

/// Of more rows than may be held, whole pixels are drawn: of every view its share, and the same ones for the same seed.
#[test]
fn more_rows_than_the_limit_are_drawn_by_whole_pixels_from_every_view() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = (0..8).map(|k| scene(&format!("s{k}"), k == 3)).collect();
    let dataset = write(folder.path(), 6, scenes);
    let datasets = std::slice::from_ref(&dataset);
    let of = 7 * 6 * u64::from(SIDE * SIDE);
    for recipe in [Recipe::THESIS, Recipe::NMT, Recipe::DFAOIT] {
        let draw = |seed, max_rows| {
            let config = Config {
                seed,
                max_rows,
                ..Config::for_recipe(recipe)
            };
            TrainingData::from_datasets(&config, datasets)
        };
        let whole = draw(1, of).unwrap();
        let used = whole.used.unwrap();
        assert_eq!((used.used, used.of), (of, of), "{recipe}");
        let part = draw(1, of / 4).unwrap();
        let used = part.used.unwrap();
        let is_a_quarter = used.used <= of / 4 && used.used > of / 5;
        assert!(is_a_quarter && used.used % 6 == 0, "{used:?}");
        let [some, all] = [&part, &whole].map(|data| data.subsets.as_ref().unwrap().len());
        let [share, want] = [some as f64 / all as f64, used.used as f64 / of as f64];
        assert!((share - want).abs() < 1e-9, "{recipe}: {share}");
        assert_eq!(part.inputs, draw(1, of / 4).unwrap().inputs);
        assert_ne!(part.inputs, draw(2, of / 4).unwrap().inputs);
        let none = draw(1, 5).unwrap_err().to_string();
        assert!(none.contains("`max_rows`"), "{none}");
    }
}

/// Where there are several scenes, whole ones are set aside, and the model file does not say that they were trained on. One scene
/// is split by pixel, as all are where that is asked, and the data say so.
#[test]
fn whole_scenes_are_set_aside() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["a", "b", "c", "d", "e", "f"];
    let mut scenes: Vec<SceneEntry> = names.iter().map(|n| scene(n, false)).collect();
    scenes.push(scene("held", true));
    let dataset = write(&folder.path().join("rows"), 6, scenes);
    let datasets = std::slice::from_ref(&dataset);
    let rows = 6 * (SIDE * SIDE) as usize;
    for recipe in [Recipe::THESIS, Recipe::MEDIUM] {
        let config = Config {
            held_out: 1.0 / 3.0,
            validation: 1.0 / 6.0,
            ..Config::for_recipe(recipe)
        };
        let data = TrainingData::from_datasets(&config, datasets).unwrap();
        let Some(DataSplit::Scenes { validation, test }) = &data.split else {
            panic!("{:?}", data.split);
        };
        assert_eq!((validation.len(), test.len()), (1, 2));
        // Examples of a scene are one run, in the order of the names.
        let subsets = data.subsets.as_ref().unwrap();
        for (name, of) in names.into_iter().zip(subsets.chunks(subsets.len() / 6)) {
            let is_in = |list: &[String]| list.iter().any(|n| n == name);
            let expected = match (is_in(validation), is_in(test)) {
                (true, _) => Subset::Validation,
                (_, true) => Subset::Test,
                _ => Subset::Train,
            };
            assert!(of.iter().all(|s| *s == expected), "{name}");
        }
        let reference = data.dataset.clone().unwrap();
        assert_eq!((reference.scenes.len(), reference.set_aside.len()), (3, 3));
        assert!(test.iter().all(|name| reference.set_aside.contains(name)));
        assert_eq!(data.used.unwrap().of as usize, 6 * rows);
        let by_pixel = Config {
            split: SplitBy::Pixel,
            ..config
        };
        let data = TrainingData::from_datasets(&by_pixel, datasets).unwrap();
        assert_eq!(data.split, Some(DataSplit::Pixels { scenes: 6 }));
        assert_eq!(data.dataset.unwrap().scenes.len(), 6);
    }
    let one = write(&folder.path().join("one"), 3, vec![scene("a", false)]);
    let config = Config::for_recipe(Recipe::THESIS);
    let data = TrainingData::from_datasets(&config, &[one]).unwrap();
    assert_eq!(data.split, Some(DataSplit::Pixels { scenes: 1 }));
}

/// Of scenes of a single layer nothing is learnt. Where the draw leaves nothing else for training, pixels of all scenes are set aside, and no scene
/// is named as not trained on.
#[test]
fn scenes_without_examples_are_no_split() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = ["a", "b", "c"].map(|name| scene(name, false)).to_vec();
    let layers = |view| if view == 0 { 7 } else { 1 };
    let dataset = write_views(folder.path(), SIDE, scenes, |view| {
        stacks(view, layers(view))
    });
    for seed in 0..6 {
        let config = Config {
            seed,
            held_out: 1.0 / 3.0,
            validation: 1.0 / 3.0,
            ..Config::for_recipe(Recipe::MEDIUM)
        };
        let data = TrainingData::from_datasets(&config, std::slice::from_ref(&dataset)).unwrap();
        assert_eq!(data.split, Some(DataSplit::Pixels { scenes: 3 }), "{seed}");
        let reference = data.dataset.unwrap();
        assert_eq!((reference.scenes.len(), reference.set_aside.len()), (3, 0));
    }
}
