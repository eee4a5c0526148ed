//! `_peelnet/manifest.json`: what a dataset is made of and where it comes from. And what its JSON files have in common.

use std::collections::BTreeMap;

use peelnet_core::files::hex;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::card;
use crate::column::{Column, ColumnKind};
use crate::error::DatasetError;
use crate::formats::Format;
use crate::statistics::ColumnStatistics;
use crate::store::{FRAGMENTS, MANIFEST, Store};

/// The version of the layout that this crate writes and reads.
pub const SCHEMA_VERSION: u32 = 2;

/// Work items (scene × copy × view) of one dataset.
pub const MAX_WORK_ITEMS: u32 = 1 << 16;

/// Pixels of a frame, and of a side of it.
const MAX_PIXELS: u64 = 1 << 28;
const MAX_SIDE: u32 = 1 << 16;

/// Bytes of a manifest, plan or record that are read. One of [`MAX_WORK_ITEMS`] parts in the format with the most files has fewer.
const MAX_BYTES: u64 = 1 << 28;

/// The whole manifest. The file is its JSON, with these names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema: u32,
    /// Hash of the plan that all writers followed.
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
    /// Everything else that shapes the rows, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// The scenes.
    pub scenes: Vec<SceneEntry>,
    /// Number of work items.
    pub work_items: u32,
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
    /// The files that describe the dataset to others, as it was sealed: `README.md`, `croissant.json` and pictures of scenes. They may be edited or removed, which
    /// changes nothing about the rows. Empty in manifests of earlier versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub card: Vec<FileEntry>,
    /// Statistics of all rows, one entry for each column in order. Empty where there are no rows, and in manifests of earlier versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub statistics: Vec<ColumnStatistics>,
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
    /// The same without its name and `held_out`: scenes of one content are one scene. Empty where nothing was read.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub content: String,
    /// Whether the scene must not be trained on.
    pub held_out: bool,
    /// The effects that it needs, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<String>,
}

/// A view's camera, in the scene file's terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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

/// A work item's rows: one view of one copy of one scene. From `rows` on, its writer fills the fields in.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// Statistics of the part's rows, in its record; the manifest has those of all parts together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub statistics: Vec<ColumnStatistics>,
    /// A picture of the scene for the dataset's card, in the record of its first part: PNG in base64.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<String>,
}

/// A file of a part, or of the card.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Name inside the dataset's folder.
    pub name: String,
    /// Length in bytes.
    pub bytes: u64,
    /// Hexadecimal sha256 of the contents.
    pub sha256: String,
}

impl Part {
    /// First part of the names of the part's files: `fragments-00003-cups-v1`, with `-c2` for a varied copy.
    pub(crate) fn stem(&self, scene_name: &str) -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
        let scene = scene_name.chars().take(64);
        let scene: String = scene.map(|c| if is_plain(c) { c } else { '-' }).collect();
        let copy = match self.copy {
            0 => String::new(),
            copy => format!("-c{copy}"),
        };
        format!("{FRAGMENTS}{:05}-{scene}{copy}-v{}", self.index, self.view)
    }
}

impl Manifest {
    /// Reads and checks the manifest of a sealed dataset; `None` where there is none.
    pub(crate) fn read(store: &dyn Store) -> Result<Option<Self>, DatasetError> {
        read_json(store, MANIFEST, "manifest", EXTRACT_AGAIN, Self::check)
    }

    /// What the types cannot say.
    pub(crate) fn check(&self) -> Result<(), String> {
        if self.columns != columns() {
            let names: Vec<_> = self.columns.iter().map(|c| c.name.as_str()).collect();
            let expected = Column::ALL.map(Column::name);
            return Err(format!(
                "the columns are {names:?}, expected {expected:?} in this order"
            ));
        }
        let (items, parts) = (self.work_items, self.parts.len());
        if items > MAX_WORK_ITEMS {
            return Err(format!(
                "{items} work items, and at most {MAX_WORK_ITEMS} are read"
            ));
        }
        if parts != items as usize {
            return Err(format!("{items} work items, but {parts} parts"));
        }
        for (k, part) in self.parts.iter().enumerate() {
            let checked = self.check_part(k, part);
            checked.map_err(|reason| format!("parts[{k}]: {reason}"))?;
        }
        let counted = |name: &str, stated: u64, of_part: fn(&Part) -> u64| {
            let held = self.parts.iter().map(of_part);
            let held = held.fold(0, u64::saturating_add);
            match held == stated {
                true => Ok(()),
                false => Err(format!("`{name}` is {stated} but the parts hold {held}")),
            }
        };
        counted("rows", self.rows, |p| p.rows)?;
        counted("pixels", self.pixels, |p| p.pixels)?;
        counted("lost_fragments", self.lost_fragments, |p| p.lost_fragments)?;
        counted("coplanar_ties", self.coplanar_ties, |p| p.coplanar_ties)?;
        if self.hash != hash_of_parts(&self.parts) {
            return Err("`hash` does not fit the files' hashes".to_owned());
        }
        // What is listed may be removed with the dataset.
        let mut card = self.card.iter();
        match card.find(|file| !card::is_name(&file.name)) {
            Some(file) => Err(format!("{:?} is no file of a card", file.name)),
            None => Ok(()),
        }
    }

    fn check_part(&self, k: usize, part: &Part) -> Result<(), String> {
        let (index, scene, rows) = (part.index, part.scene, part.rows);
        if index as usize != k {
            return Err(format!("index {index} where {k} is expected"));
        }
        if scene as usize >= self.scenes.len() {
            return Err(format!("scene {scene} is not listed"));
        }
        let [width, height] = [part.width, part.height];
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MAX_PIXELS || width.max(height) > MAX_SIDE {
            return Err(format!(
                "a frame of {width}x{height}, and at least 1x1, at most {MAX_SIDE} either way and {MAX_PIXELS} pixels are read"
            ));
        }
        // Files of other names are those of other parts, or lie elsewhere.
        let format = self.format;
        let expected = format.file_names(&part.stem(&self.scenes[scene as usize].name));
        if !part.files.iter().map(|file| &file.name).eq(&expected) {
            let expected = expected.join(", ");
            return Err(format!(
                "its files are not those of its scene, copy and view: {expected}"
            ));
        }
        for FileEntry { name, bytes, .. } in &part.files {
            // Of Parquet's compressed rows, only the file itself can say it.
            if *bytes < format.least_row_bytes().saturating_mul(rows) {
                return Err(format!(
                    "{rows} rows cannot be in {bytes} bytes of {name:?}"
                ));
            }
        }
        let mut groups = part.row_groups.iter();
        if groups.try_fold(0u64, |a, &g| a.checked_add(g)) != Some(rows) {
            return Err(format!("the row groups do not add up to {rows} rows"));
        }
        Ok(())
    }

    /// Whether every work item of the whole dataset has a part here.
    pub fn is_whole(&self) -> bool {
        self.parts.len() == self.work_items as usize
    }

    /// Rows of each scene, by name: for a training run's provenance.
    pub fn rows_by_scene(&self) -> BTreeMap<&str, u64> {
        let mut rows = BTreeMap::new();
        for part in &self.parts {
            let scene = self.scenes[part.scene as usize].name.as_str();
            *rows.entry(scene).or_default() += part.rows;
        }
        rows
    }
}

/// What helps where a manifest or a plan cannot be understood.
pub(crate) const EXTRACT_AGAIN: &str = "write the dataset again with `peelnet extract`";

/// Reads and checks a manifest, plan or record; `None` where there is none. The schema version first, because another version's fields are
/// bound to look wrong. An error ends with `fix`.
pub(crate) fn read_json<T: DeserializeOwned>(
    store: &dyn Store,
    name: &str,
    what: &str,
    fix: &str,
    check: impl FnOnce(&T) -> Result<(), String>,
) -> Result<Option<T>, DatasetError> {
    /// The version alone; everything else is skipped.
    #[derive(Deserialize)]
    struct Version {
        #[serde(default)]
        schema: serde_json::Value,
    }
    let Some(bytes) = store.get(name, MAX_BYTES)? else {
        return Ok(None);
    };
    let read = || -> Result<T, String> {
        let version: Version =
            serde_json::from_slice(&bytes).map_err(|e| format!("not JSON: {e}"))?;
        let Some(found) = version.schema.as_u64() else {
            return Err("the field `schema` is missing".to_owned());
        };
        if found != u64::from(SCHEMA_VERSION) {
            return Err(format!(
                "schema version {found}, but this program reads version {SCHEMA_VERSION}"
            ));
        }
        // From the text again, so that the message has the line.
        let value = serde_json::from_slice(&bytes).map_err(|e| format!("wrong {what}: {e}"))?;
        check(&value)?;
        Ok(value)
    };
    let wrong = |reason| DatasetError::invalid(&store.shown(name), format!("{reason}; {fix}"));
    read().map(Some).map_err(wrong)
}

pub(crate) fn to_json(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value);
    text.expect("string keys and finite numbers only") + "\n"
}

pub(crate) fn columns() -> Vec<ColumnEntry> {
    let entry = |column: Column| ColumnEntry {
        name: column.name().to_owned(),
        kind: column.kind(),
    };
    Column::ALL.map(entry).to_vec()
}

/// The dataset's hash: sha256 over one line `index sha256` for each file, by part and then by column.
pub(crate) fn hash_of_parts(parts: &[Part]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        for file in &part.files {
            hasher.update(format!("{} {}\n", part.index, file.sha256));
        }
    }
    hex(&hasher.finalize())
}
