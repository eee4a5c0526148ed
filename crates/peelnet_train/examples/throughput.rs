//! Trains on a file of raw columns and prints the rows a second of each epoch, for the comparison in `benches/peers`.
//!
//! `throughput FILE ROWS BATCH EPOCHS THREADS`: FILE holds four columns of ROWS little-endian 32-bit floats: the three
//! inputs and the target.

use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use peelnet_model::Recipe;
use peelnet_train::{Config, RunOptions, TrainingData, train};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, rows, batch, epochs, threads] = arguments.as_slice() else {
        return Err("usage: throughput FILE ROWS BATCH EPOCHS THREADS".into());
    };
    let rows: usize = rows.parse()?;
    let values: Vec<f32> = std::fs::read(file)?
        .as_chunks::<4>()
        .0
        .iter()
        .map(|bytes| f32::from_le_bytes(*bytes))
        .collect();
    if rows == 0 || values.len() != 4 * rows {
        return Err(format!(
            "{file}: {} values are not four columns of {rows} rows",
            values.len()
        )
        .into());
    }
    let mut columns: Vec<Vec<f32>> = values.chunks_exact(rows).map(<[f32]>::to_vec).collect();
    let target = columns.pop().unwrap_or_default();
    let data = TrainingData::new(file, columns, vec![target]);
    let config = Config {
        batch: batch.parse()?,
        epochs: epochs.parse()?,
        held_out: 0.0,
        ..Config::for_recipe(Recipe::THESIS)
    };
    let folder = tempfile::tempdir()?;
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        threads: NonZeroUsize::new(threads.parse()?),
        ..RunOptions::new(folder.path().join("model.safetensors"), &stop)
    };
    train(&config, &data, &options, |epochs| {
        let last = epochs.last().expect("one has ended");
        println!("{:.0} {:e}", last.rows_per_s, last.train_loss);
    })?;
    Ok(())
}
