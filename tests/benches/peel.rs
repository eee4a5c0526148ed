//! Peeling a `sixteen` scene: the three ways, the sort alone, and turning fragments into rows.
//!
//! `cargo bench -p peelnet_tests`; ratios within one run are what counts.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use peelnet_dataset::FragmentBatch;
use peelnet_gpu::{AdapterRequest, Gpu};
use peelnet_peel::{
    Peel,
    harvest::Harvester,
    rows::{RawTile, ViewConstants, append_rows},
};
use peelnet_render::{MethodOptions, PixelSample, Renderer};
use peelnet_scene::suite;
use std::{hint::black_box, time::Duration};

const SIZE: [u32; 2] = [1024, 768];

fn benches(c: &mut Criterion) {
    let gpu = Gpu::open(&AdapterRequest::Auto).unwrap_or_else(|e| panic!("{e}"));
    let scene = suite::load("sixteen-050").unwrap_or_else(|e| panic!("{e}"));
    let camera = scene.views[0];
    println!("adapter {}, {}×{}", gpu.info.name, SIZE[0], SIZE[1]);

    let mut group = c.benchmark_group("peel");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(10));
    let mut tiles = Vec::new();
    for peel in [Peel::SBuffer, Peel::Dual, Peel::Single] {
        let mut harvester =
            Harvester::new(&gpu, &scene, SIZE, peel, false, None).unwrap_or_else(|e| panic!("{e}"));
        group.bench_function(peel.to_string(), |b| {
            b.iter(|| {
                tiles.clear();
                harvester
                    .harvest(&camera, PixelSample::ALL, None, RawTile::default, |tile| {
                        tiles.push(tile);
                        Ok(())
                    })
                    .unwrap_or_else(|e| panic!("{e}"))
            });
        });
    }
    group.finish();

    // The GPU's own time of the sort, from timestamps.
    let renderer = Renderer::new(&gpu, &scene).unwrap_or_else(|e| panic!("{e}"));
    let spec = "abuffer".parse().unwrap_or_else(|e| panic!("{e}"));
    let mut prepared = renderer
        .method(&spec, MethodOptions::sized(SIZE))
        .unwrap_or_else(|e| panic!("{e}"));
    let fragments: usize = tiles.iter().map(|t| t.depths.len()).sum();
    let mut group = c.benchmark_group("kernels");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(5))
        .throughput(Throughput::Elements(fragments as u64));
    group.bench_function("sort", |b| {
        b.iter_custom(|n| {
            let micros: f64 = (0..n)
                .flat_map(|_| {
                    let frame = renderer
                        .profile(&mut prepared, &camera)
                        .unwrap_or_else(|e| panic!("{e}"));
                    frame.times
                })
                .filter(|t| t.label == "sort")
                .map(|t| t.micros)
                .sum();
            Duration::from_secs_f64(micros / 1e6)
        });
    });
    let constants = ViewConstants {
        view: 0,
        width: SIZE[0],
        near: camera.near,
        far: camera.far,
    };
    group.bench_function("features and rows", |b| {
        let mut batch = FragmentBatch::default();
        b.iter(|| {
            for tile in &tiles {
                append_rows(tile, constants, &mut batch, 1 << 18, |rows| {
                    black_box(rows.len());
                    Ok::<_, std::convert::Infallible>(())
                })
                .unwrap_or_else(|e| match e {});
            }
        });
    });
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
