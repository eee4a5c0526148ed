//! Rows a second of training epochs on synthetic rows: the thesis's batch, a medium and a large one.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use peelnet_model::Recipe;
use peelnet_train::{Config, RunOptions, TrainingData, train};

const ROWS: usize = 65_536;

fn rows() -> TrainingData {
    let column =
        |a: f32, b: f32| -> Vec<f32> { (0..ROWS).map(|i| a + b * (i as f32 * a).sin()).collect() };
    let inputs = vec![column(7.0, 5.0), column(3.3, 2.0), column(12.1, 11.0)];
    TrainingData::new("synthetic", inputs, vec![column(0.5, 0.5)])
}

fn epochs(c: &mut Criterion) {
    let data = rows();
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let stop = AtomicBool::new(false);
    let options = RunOptions::new(folder.path().join("model.safetensors"), &stop);
    let mut group = c.benchmark_group("train");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.sample_size(20);
    for batch in [128, 1024, 8192] {
        let config = Config {
            batch,
            epochs: 8,
            held_out: 0.0,
            ..Config::for_recipe(Recipe::THESIS)
        };
        group.bench_function(BenchmarkId::new("epoch", batch), |bencher| {
            // The loop times itself, so that normalisation and files are left out.
            bencher.iter_custom(|iterations| {
                let mut spent = Duration::ZERO;
                let mut left = iterations as u32;
                while left > 0 {
                    let config = Config {
                        epochs: left.min(64),
                        ..config.clone()
                    };
                    left -= config.epochs;
                    train(&config, &data, &options, |report| {
                        spent += Duration::from_secs_f64(report.seconds);
                    })
                    .expect("synthetic rows train");
                }
                spent
            });
        });
    }
    group.finish();
}

criterion_group!(benches, epochs);
criterion_main!(benches);
