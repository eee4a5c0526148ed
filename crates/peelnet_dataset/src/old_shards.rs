//! Schema 1 with shards: each lies in a folder of its own, `shard-I-of-N`, as a dataset. They are read, and written no more.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::DatasetError;
use crate::manifest::{Manifest, Part};
use crate::shard::Shard;

/// The manifest of the whole dataset, and the folder of each part.
pub(crate) fn open(path: &Path) -> Result<(Manifest, Vec<PathBuf>), DatasetError> {
    let mut shards: Vec<Shard> = fs::read_dir(path)
        .map_err(DatasetError::io(path, "open the dataset's folder"))?
        .filter_map(|entry| Shard::from_folder(entry.ok()?.file_name().to_str()?))
        .collect();
    shards.sort();
    let Some(&Shard { of, .. }) = shards.first() else {
        return Err(DatasetError::NoManifest {
            path: path.to_owned(),
        });
    };
    if shards.iter().any(|s| s.of != of) {
        return Err(DatasetError::Mixed {
            path: path.to_owned(),
            reason: "it holds shards of datasets with different numbers of shards",
        });
    }
    let mut manifests: Vec<(PathBuf, Manifest)> = Vec::new();
    let mut missing = Vec::new();
    for index in 1..=of {
        let shard = Shard { index, of };
        let folder = path.join(shard.folder());
        match Manifest::read_old(&folder) {
            Ok(manifest) => manifests.push((folder, manifest)),
            // Not written yet, or still being written: the same fix.
            Err(DatasetError::NoManifest { .. }) => missing.push(shard.to_string()),
            Err(_) if !folder.exists() => missing.push(shard.to_string()),
            Err(other) => return Err(other),
        }
    }
    if !missing.is_empty() {
        return Err(DatasetError::MissingShards {
            path: path.to_owned(),
            missing,
            of,
        });
    }
    for (k, (folder, manifest)) in manifests.iter().enumerate() {
        let expected = Shard {
            index: k as u32 + 1,
            of,
        };
        let (other, first) = &manifests[0];
        let differs = [
            ("number (it was renamed)", manifest.shard != Some(expected)),
            ("tool version", manifest.tool_version != first.tool_version),
            ("format", manifest.format != first.format),
            ("seed", manifest.seed != first.seed),
            ("peeling method", manifest.peel != first.peel),
            (
                "fraction of pixels",
                manifest.pixels_fraction != first.pixels_fraction,
            ),
            ("number of copies", manifest.augment != first.augment),
            ("list of scenes", manifest.scenes != first.scenes),
            (
                "number of work items",
                manifest.work_items != first.work_items,
            ),
        ];
        if let Some((field, _)) = differs.into_iter().find(|(_, differs)| *differs) {
            return Err(DatasetError::ShardsDiffer {
                path: folder.clone(),
                other: other.clone(),
                field,
            });
        }
    }
    let mut parts: Vec<(Part, PathBuf)> = Vec::new();
    let mut whole = manifests[0].1.clone();
    for (folder, manifest) in manifests {
        if !whole.adapter.split("; ").any(|a| a == manifest.adapter) {
            whole.adapter = format!("{}; {}", whole.adapter, manifest.adapter);
        }
        parts.extend(manifest.parts.into_iter().map(|p| (p, folder.clone())));
    }
    parts.sort_by_key(|(part, _)| part.index);
    let folders;
    (whole.parts, folders) = parts.into_iter().unzip();
    whole.shard = None;
    whole.total();
    Ok((whole, folders))
}
