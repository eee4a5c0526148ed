//! Synthetic fragment lists, and the examples that recipes make of whole pixels.

use peelnet_dataset::{Dataset, SplitBy, Summary};
use peelnet_model::{Model, Recipe};
use peelnet_peel::{ExtractOptions, synthetic::synthetic};
use peelnet_train::{
    ALPHA, Config, LEFT, PixelLoss, RESIDUAL, RunOptions, SUM, TrainingData, train,
};
use std::{path::Path, sync::atomic::AtomicBool};

static NEVER: AtomicBool = AtomicBool::new(false);

fn lists(folder: &Path, lists: u64, seed: u64) -> Dataset {
    let options = ExtractOptions {
        seed,
        ..ExtractOptions::new(folder)
    };
    synthetic(lists, &options, &NEVER, &mut |_| {}).unwrap();
    Dataset::open(folder).unwrap()
}

/// As many lists as asked for, the same from the same seed and others from another, whose stored T is what their rows give.
#[test]
fn synthetic_lists_are_a_sound_dataset() {
    let dir = tempfile::tempdir().unwrap();
    let first = lists(&dir.path().join("a"), 3000, 7);
    let again = lists(&dir.path().join("b"), 3000, 7);
    let other = lists(&dir.path().join("c"), 3000, 8);
    assert_eq!(first.manifest().hash, again.manifest().hash);
    assert_ne!(first.manifest().hash, other.manifest().hash);
    let summary = Summary::from_dataset(&first).unwrap();
    assert!(summary.passes(), "{:?}", summary.violations);
    // A ray that meets nothing leaves no row.
    assert!((2401..=3000).contains(&summary.pixels));
    assert!(summary.rows > 4 * summary.pixels);
}

/// What is left to distribute is what the ends do not take: with the true shares the contributions before normalisation
/// are the exact ones, so nothing is scaled. For every pixel whose ends are single fragments.
///
/// Ends of 32-bit opacities and T: a rounding each. Fragments that share an end's level (2⁻¹¹ of the range) give weight 1 to
/// two: such pixels are few, and counted.
#[test]
fn with_the_true_shares_nothing_is_scaled() {
    let dir = tempfile::tempdir().unwrap();
    let dataset = lists(&dir.path().join("d"), 4096, 3);
    let anchored = [Recipe::ANCHORED_SMALL, Recipe::ANCHORED_MEDIUM];
    let in_slabs = [Recipe::SMALL, Recipe::MEDIUM, Recipe::LARGE];
    for recipe in anchored.into_iter().chain(in_slabs) {
        let config = Config::for_recipe(recipe);
        let data = TrainingData::from_datasets(&config, std::slice::from_ref(&dataset)).unwrap();
        let pixels = data.pixels.as_ref().unwrap();
        assert!(pixels.first.len() > 1000, "{recipe}");
        let mut shared = 0;
        let rows = data.rows() as usize;
        for (i, &first) in pixels.first.iter().enumerate() {
            let end = pixels.first.get(i + 1).map_or(rows, |&e| e as usize);
            let seen: f32 = data.targets[0][first as usize..end].iter().sum();
            let [left, sum] = [LEFT, SUM].map(|column| pixels.fixed[column][i]);
            let scale = f64::from(left) / f64::from(sum + seen).max(1e-3);
            shared += usize::from((scale - 1.0).abs() > 1e-3);
            // Contributions cannot exceed what lies between the ends.
            for row in first as usize..end {
                let (y, k) = (data.targets[0][row], pixels.rows[ALPHA][row]);
                assert!(pixels.rows[RESIDUAL][row] >= 0.0 && (0.0..=1.0).contains(&k) && y <= 1.0);
            }
        }
        assert!(shared * 5 < pixels.first.len(), "{recipe}: {shared}");
    }
}

/// Every loss falls, and by its own measure: the network that minimised one of them is another than those of the others.
#[test]
fn every_loss_trains() {
    let dir = tempfile::tempdir().unwrap();
    let dataset = lists(&dir.path().join("d"), 4096, 6);
    let mut files = std::collections::BTreeSet::new();
    // A share, and T itself.
    let recipes = [Recipe::SMALL, Recipe::NMT];
    for (recipe, loss) in recipes
        .iter()
        .flat_map(|&r| PixelLoss::ALL.map(|loss| (r, loss)))
    {
        assert_eq!(loss.to_string().parse(), Ok(loss));
        let mut config = Config::for_recipe(recipe);
        (config.epochs, config.batch, config.loss) = (10, 128, Some(loss));
        // A few worlds would be too few to judge by.
        config.split = SplitBy::Pixel;
        let data = TrainingData::from_datasets(&config, std::slice::from_ref(&dataset)).unwrap();
        let out = dir
            .path()
            .join(format!("{recipe}-{loss}"))
            .with_extension("safetensors");
        let outcome = train(&config, &data, &RunOptions::new(&out, &NEVER), |_| {}).unwrap();
        let epochs = outcome.history.iter();
        let losses: Vec<f64> = epochs.filter_map(|e| e.held_out_loss).collect();
        assert!(losses[9] < 0.9 * losses[0], "{recipe} {loss}: {losses:?}");
        let layer = Model::load(&out).unwrap().mlp.layers.remove(0);
        let weights: Vec<u32> = layer.weights.iter().map(|w| w.to_bits()).collect();
        assert!(files.insert(weights));
    }
}
