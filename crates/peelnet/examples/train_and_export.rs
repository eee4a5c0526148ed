//! Peels a scene, trains the thesis's network on its fragments, and exports it as WGSL.
//!
//! `cargo run --example train_and_export -- FOLDER` writes `FOLDER/model.safetensors` and `FOLDER/model.wgsl`.

use peelnet::{
    AdapterRequest, Gpu, Recipe,
    dataset::Dataset,
    export,
    peel::{ExtractOptions, extract},
    scene::suite,
    train::{Config, RunOptions, TrainingData, train},
};
use std::{error::Error, path::PathBuf, sync::atomic::AtomicBool};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1);
    let folder = PathBuf::from(folder.unwrap_or_else(|| "out/example".into()));
    let gpu = Gpu::open(&AdapterRequest::Auto)?;
    // Set it from elsewhere to stop early: no half file is left behind.
    let stop = AtomicBool::new(false);

    let options = ExtractOptions {
        size: [320, 240],
        pixels: 0.5,
        ..ExtractOptions::new(folder.join("rows"))
    };
    extract(&gpu, &[suite::load("cups")?], &options, &stop, &mut |_| ())?;

    let config = Config {
        epochs: 4,
        learning_rate: 1e-3,
        ..Config::for_recipe(Recipe::THESIS)
    };
    let data = TrainingData::from_datasets(&config, &[Dataset::open(&options.out)?])?;
    let run = RunOptions::new(folder.join("model.safetensors"), &stop);
    let outcome = train(&config, &data, &run, |epochs| {
        if let Some(last) = epochs.last() {
            println!("epoch {}: loss {:.4}", last.epoch, last.train_loss);
        }
    })?;

    let wgsl = folder.join("model.wgsl");
    let verified = export::export(&gpu, &outcome.model, &wgsl, &export::Options::default())?;
    println!("{}: {verified}", wgsl.display());
    Ok(())
}
