//! Rows a second of writing a dataset, in each format, the hashing and the file system included.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "criterion's macros document nothing, and a failing benchmark may panic"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{header, info, view};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use peelnet_core::random::Random;
use peelnet_dataset::*;

fn write(c: &mut Criterion) {
    let mut rows = view(0, 640_000, 1);
    // Lit colours: hardly any repeats, which is the slow case for text.
    let mut random = Random::new(5, &[]);
    for color in [&mut rows.r, &mut rows.g, &mut rows.b] {
        color.iter_mut().for_each(|c| *c = random.unit());
    }
    let mut group = c.benchmark_group("write");
    group.sample_size(10);
    group.throughput(Throughput::Elements(rows.len() as u64));
    for format in Format::ALL {
        for threads in [1, 2] {
            let id = BenchmarkId::new(format.name(), format!("{threads} threads"));
            group.bench_function(id, |b| {
                b.iter_with_large_drop(|| {
                    let folder = tempfile::tempdir().unwrap();
                    let mut header = header(format, None);
                    header.work_items = 1;
                    let writer = DatasetWriter::create(folder.path(), header)
                        .unwrap()
                        .with_threads(threads);
                    let mut part = writer.begin(info(0)).unwrap();
                    part.write(&rows).unwrap();
                    part.finish(PartCounts::default()).unwrap();
                    let manifest = writer.finish().unwrap();
                    assert_eq!(manifest.rows, rows.len() as u64);
                    folder
                });
            });
        }
    }
    group.finish();
}

fn read(c: &mut Criterion) {
    let rows = view(0, 200_000, 1);
    let mut group = c.benchmark_group("read");
    group.sample_size(10);
    group.throughput(Throughput::Elements(rows.len() as u64));
    for format in Format::ALL {
        let folder = tempfile::tempdir().unwrap();
        let mut header = header(format, None);
        header.work_items = 1;
        let writer = DatasetWriter::create(folder.path(), header).unwrap();
        let mut part = writer.begin(info(0)).unwrap();
        part.write(&rows).unwrap();
        part.finish(PartCounts::default()).unwrap();
        writer.finish().unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        group.bench_function(BenchmarkId::new(format.name(), "batches"), |b| {
            b.iter(|| {
                dataset
                    .batches(1 << 16)
                    .map(|b| b.unwrap().len())
                    .sum::<usize>()
            });
        });
        let columns = [
            Column::LinearDepth,
            Column::AlphaSum,
            Column::FragmentCount,
            Column::Transmittance,
        ];
        group.bench_function(BenchmarkId::new(format.name(), "4 columns"), |b| {
            b.iter(|| dataset.read_columns(&columns).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, write, read);
criterion_main!(benches);
