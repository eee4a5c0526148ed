//! Peels a scene and reads its fragments into `ndarray` arrays: features and target of the thesis's network.
//!
//! `cargo run --example rows_to_ndarray -- SCENE` (a file, or the name of a shipped scene)

use ndarray::{Array1, Array2, ArrayView1, Axis, concatenate, stack};
use peelnet::{
    AdapterRequest, Gpu,
    peel::{ExtractOptions, batches},
    scene::suite,
};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = std::env::args().nth(1).unwrap_or_else(|| "cups".into());
    let scene = suite::open(scene.as_ref(), None)?;
    let gpu = Gpu::open(&AdapterRequest::Auto)?;

    let options = ExtractOptions {
        size: [320, 240],
        ..ExtractOptions::new("")
    };
    // A batch holds whole pixels, column by column: a column is an array without a copy.
    let (mut features, mut targets) = (Array2::zeros((0, 3)), Array1::zeros(0));
    for batch in batches(&gpu, &[scene], &options)? {
        let batch = batch?;
        let count: Array1<f32> = batch.fragment_count.iter().map(|&n| n as f32).collect();
        let rows = stack![
            Axis(1),
            ArrayView1::from(&batch.linear_depth),
            ArrayView1::from(&batch.alpha_sum),
            count
        ];
        let target = ArrayView1::from(&batch.transmittance);
        features = concatenate![Axis(0), features, rows];
        targets = concatenate![Axis(0), targets, target];
    }
    let [rows, column] = [features.shape(), targets.shape()];
    println!("features {rows:?}, targets {column:?}");
    let mean = features.mean_axis(Axis(0)).unwrap_or_default();
    println!("mean of depth, sum of alpha, count: {mean:.3}");
    let mean = targets.mean().unwrap_or_default();
    println!("mean transmittance in front: {mean:.3}");
    Ok(())
}
