//! `_peelnet/manifest.json`: what a dataset is made of and where it comes from. In schema 1 it lies at the top.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use peelnet_files::hex;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::column::{Column, ColumnKind};
use crate::error::DatasetError;
use crate::format::Format;
use crate::layout::{self, FRAGMENTS, is_part_name};
use crate::shard::Shard;
use crate::store::Store;

/// The version of the layout that this crate writes. It reads this one and all before.
pub const SCHEMA_VERSION: u32 = 2;

/// Work items (scene × copy × view) of one dataset.
pub const MAX_WORK_ITEMS: u32 = 1 << 16;

/// Bytes of a manifest that are read. One of [`MAX_WORK_ITEMS`] parts in the format with the most files has fewer.
const MAX_BYTES: u64 = 1 << 28;

/// The whole manifest. The file is its JSON, with these names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema: u32,
    /// Hash of the plan that all writers followed; empty in schema 1.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub plan: String,
    /// Version of the program that wrote it.
    pub tool_version: String,
    /// The command line that wrote it.
    pub command: String,
    /// Format of all parts.
    pub format: Format,
    /// Names and types of the columns, in order.
    pub columns: Vec<ColumnEntry>,
    /// Seed of sampling and augmentation.
    pub seed: u64,
    /// The GPU adapter that peeled.
    pub adapter: String,
    /// How it peeled: `sbuffer`, `dual` or `single`.
    pub peel: String,
    /// Fraction of the pixels that was kept, 0 … 1.
    pub pixels_fraction: f64,
    /// Number of varied copies of each scene beside the scene itself.
    pub augment: u32,
    /// Everything else that shapes the rows, by name; empty in schema 1.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// The scenes of the whole dataset, also when this is a shard.
    pub scenes: Vec<SceneEntry>,
    /// Number of work items of the whole dataset.
    pub work_items: u32,
    /// Which shard's parts these are; absent in a whole dataset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// Total rows.
    pub rows: u64,
    /// Total pixels that hold at least one row.
    pub pixels: u64,
    /// Total fragments that peeling left out (a pass limit, or coplanar ones).
    pub lost_fragments: u64,
    /// Total pairs of neighbouring fragments at the same depth.
    pub coplanar_ties: u64,
    /// Hash over (part index, sha256 of each file): the same for the same rows in the same format, however they
    /// were sharded.
    pub hash: String,
    /// One entry for each work item, by index.
    pub parts: Vec<Part>,
}

/// Name and type of a column.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ColumnEntry {
    /// The column's name.
    pub name: String,
    /// The values' type.
    #[serde(rename = "type")]
    pub kind: ColumnKind,
}

/// A scene that was peeled.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneEntry {
    /// The scene's name.
    pub name: String,
    /// The scene file, as given on the command line.
    pub file: String,
    /// Hash over the scene file and every file it reads.
    pub sha256: String,
    /// Whether the scene must not be trained on.
    pub held_out: bool,
    /// Its census: the effects that it needs, by name. Datasets of earlier versions have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<String>,
}

/// A view's camera, in the scene file's terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraInfo {
    /// Eye, scene units.
    pub position: [f32; 3],
    /// Point looked at, scene units.
    pub target: [f32; 3],
    /// Up direction.
    pub up: [f32; 3],
    /// Vertical field of view, degrees.
    pub fov_y_degrees: f32,
    /// Near clip distance, scene units.
    pub near: f32,
    /// Far clip distance, scene units.
    pub far: f32,
}

/// A work item's rows: one view of one copy of one scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Index of the work item: the rows' `view` value.
    pub index: u32,
    /// Index into [`Manifest::scenes`].
    pub scene: u32,
    /// 0 for the scene itself, then its varied copies.
    pub copy: u32,
    /// The view's number in the scene file.
    pub view: u32,
    /// The view's camera.
    pub camera: CameraInfo,
    /// Image width, pixels.
    pub width: u32,
    /// Image height, pixels.
    pub height: u32,
    /// Rows of the part.
    pub rows: u64,
    /// Pixels that hold at least one row.
    pub pixels: u64,
    /// Fragments that peeling left out.
    pub lost_fragments: u64,
    /// Pairs of neighbouring fragments at the same depth.
    pub coplanar_ties: u64,
    /// Rows of each row group (Parquet), or the part's rows as one group.
    pub row_groups: Vec<u64>,
    /// The part's files: one, or one for each column in the columns' order (NPY).
    pub files: Vec<FileEntry>,
}

/// A file of a part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Name inside the dataset's folder.
    pub name: String,
    /// Length in bytes.
    pub bytes: u64,
    /// Hexadecimal sha256 of the contents.
    pub sha256: String,
}

impl Manifest {
    /// Reads and checks the manifest of a folder of schema 1.
    pub(crate) fn read_old(folder: &Path) -> Result<Self, DatasetError> {
        Self::read_file(&folder.join(layout::OLD_MANIFEST)).map_err(|error| match error {
            DatasetError::Io { source, .. }
                if source.kind() == std::io::ErrorKind::NotFound && folder.is_dir() =>
            {
                DatasetError::NoManifest {
                    path: folder.to_owned(),
                }
            }
            other => other,
        })
    }

    /// Reads and checks the manifest of a sealed dataset; `None` where there is none.
    pub(crate) fn read_sealed(store: &dyn Store) -> Result<Option<Self>, DatasetError> {
        let bytes = store.get(layout::MANIFEST, MAX_BYTES)?;
        bytes
            .map(|bytes| Self::parse(&store.shown(layout::MANIFEST), &bytes))
            .transpose()
    }

    /// Reads and checks a manifest.
    pub(crate) fn read_file(path: &Path) -> Result<Self, DatasetError> {
        let bytes = peelnet_files::read(path, MAX_BYTES).map_err(DatasetError::io(path, "read"))?;
        Self::parse(path, &bytes)
    }

    /// Checks a manifest that was read.
    fn parse(path: &Path, bytes: &[u8]) -> Result<Self, DatasetError> {
        check_schema(path, bytes)?;
        let wrong = |reason: String| DatasetError::Manifest {
            path: path.to_owned(),
            reason,
        };
        // From the text again, so that the message has the line.
        let manifest: Self =
            serde_json::from_slice(bytes).map_err(|e| wrong(format!("wrong manifest: {e}")))?;
        manifest.check().map_err(wrong)?;
        Ok(manifest)
    }

    /// What the types cannot say.
    pub(crate) fn check(&self) -> Result<(), String> {
        if self.columns != columns() {
            let names: Vec<_> = self.columns.iter().map(|c| c.name.as_str()).collect();
            return Err(format!(
                "the columns are {names:?}, expected {:?} in this order",
                Column::ALL.map(Column::name)
            ));
        }
        if self.work_items > MAX_WORK_ITEMS {
            return Err(format!(
                "{} work items, and at most {MAX_WORK_ITEMS} are read",
                self.work_items
            ));
        }
        if let Some(shard) = self.shard {
            Shard::new(shard.index, shard.of).map_err(|e| e.to_string())?;
        }
        let files_expected = self.format.files_of_a_part();
        let mut rows = 0u64;
        let mut names = BTreeSet::new();
        for (k, part) in self.parts.iter().enumerate() {
            if k > 0 && self.parts[k - 1].index >= part.index {
                return Err(format!("parts[{k}]: the indices do not ascend"));
            }
            if part.index >= self.work_items {
                return Err(format!(
                    "parts[{k}]: index {} but there are {} work items",
                    part.index, self.work_items
                ));
            }
            if part.scene as usize >= self.scenes.len() {
                return Err(format!("parts[{k}]: scene {} is not listed", part.scene));
            }
            if part.files.len() != files_expected {
                return Err(format!(
                    "parts[{k}]: {} files, a part in format {} has {files_expected}",
                    part.files.len(),
                    self.format
                ));
            }
            for file in &part.files {
                if !is_part_name(&file.name) {
                    return Err(format!(
                        "parts[{k}]: {:?} is not a plain file name that begins with {FRAGMENTS}",
                        file.name
                    ));
                }
                if !names.insert(file.name.as_str()) {
                    return Err(format!("parts[{k}]: {:?} is listed twice", file.name));
                }
                // Of Parquet's compressed rows, only the file itself can say it.
                let least = self.format.least_row_bytes().saturating_mul(part.rows);
                if file.bytes < least {
                    return Err(format!(
                        "parts[{k}]: {} rows cannot be in {} bytes of {:?}",
                        part.rows, file.bytes, file.name
                    ));
                }
            }
            let grouped = part
                .row_groups
                .iter()
                .try_fold(0u64, |a, &g| a.checked_add(g));
            if grouped != Some(part.rows) {
                return Err(format!(
                    "parts[{k}]: the row groups do not add up to {} rows",
                    part.rows
                ));
            }
            rows = rows.saturating_add(part.rows);
        }
        if rows != self.rows {
            return Err(format!("`rows` is {} but the parts hold {rows}", self.rows));
        }
        let missing = self.missing_items();
        if let Some(first) = missing.first() {
            return Err(format!(
                "{} work items have no part, the first is {first}",
                missing.len()
            ));
        }
        if self.hash != hash_of_parts(&self.parts) {
            return Err("`hash` does not fit the files' hashes".to_owned());
        }
        Ok(())
    }

    /// Whether every work item of the whole dataset has a part here.
    pub fn is_whole(&self) -> bool {
        self.parts.len() == self.work_items as usize
    }

    /// Work items that should have a part here but have none.
    pub(crate) fn missing_items(&self) -> Vec<u32> {
        let present: BTreeSet<u32> = self.parts.iter().map(|p| p.index).collect();
        (0..self.work_items)
            .filter(|&k| self.shard.is_none_or(|s| s.contains(k)) && !present.contains(&k))
            .collect()
    }

    /// Recomputes the totals and the hash from the parts.
    pub(crate) fn total(&mut self) {
        self.parts.sort_by_key(|p| p.index);
        // Manifests of shards come from outside, with any numbers in them.
        let sum = |of: fn(&Part) -> u64| self.parts.iter().map(of).fold(0, u64::saturating_add);
        self.rows = sum(|p| p.rows);
        self.pixels = sum(|p| p.pixels);
        self.lost_fragments = sum(|p| p.lost_fragments);
        self.coplanar_ties = sum(|p| p.coplanar_ties);
        self.hash = hash_of_parts(&self.parts);
    }

    /// The length of each file, by name.
    pub(crate) fn lengths(&self) -> BTreeMap<String, u64> {
        let files = self.parts.iter().flat_map(|p| &p.files);
        files.map(|f| (f.name.clone(), f.bytes)).collect()
    }

    /// The JSON text of the file.
    pub(crate) fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self)
            .expect("a manifest has string keys and finite numbers only");
        text.push('\n');
        text
    }

    /// Rows of each scene, by name: for a training run's provenance.
    pub fn rows_by_scene(&self) -> BTreeMap<&str, u64> {
        let mut rows = BTreeMap::new();
        for part in &self.parts {
            *rows
                .entry(self.scenes[part.scene as usize].name.as_str())
                .or_default() += part.rows;
        }
        rows
    }
}

/// The schema version first: another version's fields are bound to look wrong.
pub(crate) fn check_schema(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    /// The version alone; everything else is skipped.
    #[derive(Deserialize)]
    struct Version {
        #[serde(default)]
        schema: serde_json::Value,
    }
    let wrong = |reason: String| DatasetError::Manifest {
        path: path.to_owned(),
        reason,
    };
    let version: Version =
        serde_json::from_slice(bytes).map_err(|e| wrong(format!("not JSON: {e}")))?;
    match version.schema.as_u64() {
        None => Err(wrong("the field `schema` is missing".to_owned())),
        Some(found) if !(1..=u64::from(SCHEMA_VERSION)).contains(&found) => {
            Err(DatasetError::Schema {
                path: path.to_owned(),
                found,
            })
        }
        Some(_) => Ok(()),
    }
}

/// The columns of every dataset of this schema.
pub(crate) fn columns() -> Vec<ColumnEntry> {
    Column::ALL
        .iter()
        .map(|c| ColumnEntry {
            name: c.name().to_owned(),
            kind: c.kind(),
        })
        .collect()
}

/// The dataset's hash: sha256 over one line `index sha256` for each file, by part and then by column.
fn hash_of_parts(parts: &[Part]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        for file in &part.files {
            hasher.update(format!("{} {}\n", part.index, file.sha256));
        }
    }
    hex(&hasher.finalize())
}
