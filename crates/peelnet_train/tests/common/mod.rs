//! Datasets of views that tests make up.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should panic")]

use std::path::Path;

use peelnet_dataset::{
    CameraInfo, Dataset, DatasetWriter, Format, FragmentBatch, Header, Part, SceneEntry,
};

pub fn scene(name: &str, held_out: bool) -> SceneEntry {
    SceneEntry {
        name: name.to_owned(),
        file: format!("{name}.toml"),
        sha256: "0".repeat(64),
        held_out,
        effects: Vec::new(),
    }
}

/// A dataset with one view of each scene, of `side`×`side` pixels; `rows` makes a view from its number.
pub fn write_views(
    folder: &Path,
    side: u32,
    scenes: Vec<SceneEntry>,
    rows: impl Fn(u32) -> FragmentBatch,
) -> Dataset {
    let parts = scenes.len() as u32;
    let writer = DatasetWriter::create(
        folder,
        Header {
            format: Format::Npy,
            seed: 1,
            adapter: "none".to_owned(),
            adapter_class: "none".to_owned(),
            tool_version: "0".to_owned(),
            command: "test".to_owned(),
            peel: "sbuffer".to_owned(),
            pixels_fraction: 1.0,
            scenes,
            work_items: parts,
            worker: "test".to_owned(),
            ..Header::default()
        },
    )
    .unwrap();
    for index in 0..parts {
        let mut part = writer
            .begin(Part {
                index,
                scene: index,
                copy: 0,
                view: 0,
                camera: CameraInfo {
                    position: [0.0, 0.0, 6.0],
                    target: [0.0; 3],
                    up: [0.0, 1.0, 0.0],
                    fov_y_degrees: 45.0,
                    near: 0.1,
                    far: 100.0,
                },
                width: side,
                height: side,
                ..Part::default()
            })
            .unwrap();
        part.write(&rows(index)).unwrap();
        part.finish(0, 0).unwrap();
    }
    writer.finish().unwrap();
    Dataset::open(folder).unwrap()
}
