//! Datasets with known contents for the tests.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test file uses a part of this, and a failing test may panic"
)]

use std::path::Path;

use peelnet_core::random::Random;
use peelnet_dataset::*;

/// Rows of a view as peeling gives them: whole pixels, sums that agree, a few colours and alphas.
pub fn view(index: u32, pixels: u32, seed: u64) -> FragmentBatch {
    let mut random = Random::new(seed, &[index.into()]);
    let mut rows = FragmentBatch::default();
    let palette: Vec<[f32; 4]> = (0..16)
        .map(|_| [random.unit(), random.unit(), random.unit(), random.unit()])
        .collect();
    for p in 0..pixels {
        let n = 1 + random.bits() % 12;
        let first = rows.len();
        let (mut depth, mut t, mut sum) = (0.5f32, 1.0f32, 0.0f32);
        for layer in 0..n {
            depth += random.unit();
            let [r, g, b, alpha] = palette[random.below(16)];
            sum += alpha;
            rows.one_minus_alpha.push(1.0 - alpha);
            rows.linear_depth.push(depth);
            rows.fragment_count.push(n);
            rows.transmittance.push(t);
            rows.view.push(index);
            rows.x.push(p % 640);
            rows.y.push(p / 640);
            rows.layer.push(layer);
            rows.r.push(r);
            rows.g.push(g);
            rows.b.push(b);
            rows.near.push(0.1);
            rows.far.push(100.0);
            t *= 1.0 - alpha;
        }
        rows.alpha_sum.resize(first + n as usize, sum);
    }
    rows
}

pub fn camera() -> CameraInfo {
    CameraInfo {
        position: [0.0, 0.1, 6.0],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        fov_y_degrees: 45.0,
        near: 0.1,
        far: 100.0,
    }
}

/// Two scenes of two views each.
pub fn header(format: Format, shard: Option<Shard>) -> Header {
    let scene = |name: &str, held_out| SceneEntry {
        name: name.to_owned(),
        file: format!("scenes/{name}.toml"),
        sha256: "ab".repeat(32),
        held_out,
        effects: vec!["opaque".to_owned()],
    };
    Header {
        format,
        seed: 7,
        adapter: "test".to_owned(),
        adapter_class: "software".to_owned(),
        tool_version: "0.1.0".to_owned(),
        command: "peelnet extract".to_owned(),
        peel: "sbuffer".to_owned(),
        pixels_fraction: 1.0,
        settings: [("size".to_owned(), "640x480".to_owned())].into(),
        scenes: vec![scene("cups", false), scene("smoke in a box", true)],
        work_items: 4,
        shard,
        worker: "test".to_owned(),
        ..Header::default()
    }
}

pub fn info(index: u32) -> Part {
    Part {
        index,
        scene: index / 2,
        copy: 0,
        view: index % 2,
        camera: camera(),
        width: 640,
        height: 480,
        ..Part::default()
    }
}

/// Pixels of work item `index`: the last one has none.
pub fn pixels(index: u32) -> u32 {
    [700, 301, 1500, 0][index as usize]
}

/// Writes the test dataset in batches of so many rows.
pub fn write(
    folder: &Path,
    format: Format,
    shard: Option<Shard>,
    threads: usize,
    batch_rows: usize,
) -> Result<Manifest, DatasetError> {
    write_by(folder, header(format, shard), threads, batch_rows)
}

/// As [`write`], with a header of one's own.
pub fn write_by(
    folder: &Path,
    header: Header,
    threads: usize,
    batch_rows: usize,
) -> Result<Manifest, DatasetError> {
    let writer = DatasetWriter::create(folder, header)?.with_threads(threads);
    // Backwards: the order of the parts is by index, not by time.
    for index in (0..4).rev().filter(|&k| writer.needs(k)) {
        part(&writer, index, &view(index, pixels(index), 1), batch_rows)?;
    }
    writer.finish()
}

/// All rows that [`write`] writes, in order.
pub fn all_rows() -> FragmentBatch {
    let mut all = FragmentBatch::default();
    for index in 0..4 {
        let rows = view(index, pixels(index), 1);
        all.extend_from(&rows, 0..rows.len());
    }
    all
}

/// Names and contents of a folder's files, sorted, with those of its folders.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.file_type().unwrap().is_dir() {
            all.push((format!("{name}/"), Vec::new()));
            all.extend(
                contents(&entry.path())
                    .into_iter()
                    .map(|(n, c)| (format!("{name}/{n}"), c)),
            );
        } else {
            all.push((name, std::fs::read(entry.path()).unwrap()));
        }
    }
    all.sort();
    all
}

pub fn opening_fails(folder: &Path, words: &[&str]) {
    has(&Dataset::open(folder).unwrap_err().to_string(), words);
}

pub fn has(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

/// Writes one part, in batches of so many rows.
pub fn part(
    writer: &DatasetWriter,
    index: u32,
    rows: &FragmentBatch,
    batch_rows: usize,
) -> Result<(), DatasetError> {
    let mut part = writer.begin(info(index))?;
    for start in (0..rows.len()).step_by(batch_rows) {
        let mut piece = FragmentBatch::default();
        piece.extend_from(rows, start..rows.len().min(start + batch_rows));
        part.write(&piece)?;
    }
    part.finish(0, 0)
}

/// Writes a dataset of one part.
pub fn write_one(folder: &Path, format: Format, rows: &FragmentBatch) -> Manifest {
    let header = Header {
        work_items: 1,
        ..header(format, None)
    };
    let writer = DatasetWriter::create(folder, header).unwrap();
    part(&writer, 0, rows, usize::MAX / 2).unwrap();
    writer.finish().unwrap()
}

/// Bit patterns, so that −0 and 0 differ.
pub fn bits(rows: &FragmentBatch) -> Vec<Vec<u32>> {
    Column::ALL
        .iter()
        .map(|&c| match rows.column(c) {
            ColumnSlice::F32(v) => v.iter().map(|x| x.to_bits()).collect(),
            ColumnSlice::U32(v) => v.to_vec(),
        })
        .collect()
}
