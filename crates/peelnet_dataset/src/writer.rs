//! Writing a dataset: parts in a hidden folder, everything moved into place at the end.

use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::batch::FragmentBatch;
use crate::column::Column;
use crate::error::DatasetError;
use crate::folder::{self, Partial, check_not_mixed, create_folders, remove_empty};
use crate::format::Format;
use crate::formats::PartSink;
use crate::manifest::{
    self, CameraInfo, FRAGMENTS, MAX_WORK_ITEMS, Manifest, Part, SCHEMA_VERSION, SceneEntry,
};
use crate::shard::Shard;
use crate::validate::check_column;

/// What is known about a dataset before its first row.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Format of all parts.
    pub format: Format,
    /// Seed of sampling and augmentation.
    pub seed: u64,
    /// Name of the GPU adapter.
    pub adapter: String,
    /// Version of the program.
    pub tool_version: String,
    /// The command line, for provenance.
    pub command: String,
    /// `sbuffer`, `dual` or `single`.
    pub peel: String,
    /// Fraction of the pixels that is kept.
    pub pixels_fraction: f64,
    /// Varied copies of each scene beside the scene itself.
    pub augment: u32,
    /// All scenes of the whole dataset, also when a shard is written.
    pub scenes: Vec<SceneEntry>,
    /// Number of work items (scene × copy × view) of the whole dataset.
    pub work_items: u32,
    /// The shard to write; `None` writes the whole dataset.
    pub shard: Option<Shard>,
}

/// What is known about a part before its first row.
#[derive(Clone, Debug, PartialEq)]
pub struct PartInfo {
    /// Index of the work item, from 0 to `work_items − 1`: the rows' `view` value.
    pub index: u32,
    /// Index into [`Header::scenes`].
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
}

/// What peeling could not write, known when a part ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PartCounts {
    /// Fragments that peeling left out.
    pub lost_fragments: u64,
    /// Pairs of neighbouring fragments at the same depth.
    pub coplanar_ties: u64,
}

impl PartInfo {
    /// First part of the names of the part's files: `fragments-00003-cups-v1`, with `-c2` for a varied copy.
    pub fn stem(&self, scene_name: &str) -> String {
        let scene: String = scene_name
            .chars()
            .map(|c| match c {
                'a'..='z' | 'A'..='Z' | '0'..='9' | '_' | '-' => c,
                _ => '-',
            })
            .take(64)
            .collect();
        let copy = if self.copy == 0 {
            String::new()
        } else {
            format!("-c{}", self.copy)
        };
        format!("{FRAGMENTS}{:05}-{scene}{copy}-v{}", self.index, self.view)
    }
}

/// Writes a dataset, or one shard of it.
///
/// Parts may be written from several threads, each through its own [`PartWriter`]. Dropping the writer without
/// [`DatasetWriter::finish`] removes what it wrote and leaves an older dataset in the folder untouched.
#[derive(Debug)]
pub struct DatasetWriter {
    folder: PathBuf,
    /// Folders that did not exist before, outermost first.
    created: Vec<PathBuf>,
    /// `None` only once it has been closed.
    partial: Option<Partial>,
    header: Header,
    threads: usize,
    parts: Mutex<Vec<Part>>,
}

impl DatasetWriter {
    /// Starts a dataset in `folder`, which is created where it is missing. With a shard in the header, the dataset
    /// lies in `folder/shard-I-of-N`.
    ///
    /// # Errors
    /// If the folder holds anything but a dataset, mixes shards with a whole dataset, is written by another process
    /// at the moment, or cannot be written.
    pub fn create(folder: impl AsRef<Path>, header: Header) -> Result<Self, DatasetError> {
        let parent = folder.as_ref();
        let usage = |reason: &str| DatasetError::Usage {
            path: parent.to_owned(),
            reason: reason.to_owned(),
        };
        if header.scenes.is_empty() || header.work_items == 0 {
            return Err(usage("a dataset needs at least one scene and one view"));
        }
        if header.work_items > MAX_WORK_ITEMS {
            return Err(DatasetError::TooManyItems {
                items: header.work_items.into(),
            });
        }
        if !(header.pixels_fraction > 0.0 && header.pixels_fraction <= 1.0) {
            return Err(usage(
                "the fraction of pixels must be above 0 and at most 1",
            ));
        }
        check_not_mixed(parent, header.shard)?;
        let folder = match header.shard {
            Some(shard) => parent.join(shard.folder()),
            None => parent.to_owned(),
        };
        let created = create_folders(&folder)?;
        let mut undo = Undo {
            created: Some(created),
        };
        folder::prepare(&folder)?;
        let partial = Partial::create(&folder)?;
        Ok(Self {
            folder,
            created: undo.created.take().unwrap_or_default(),
            partial: Some(partial),
            header,
            threads: std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
            parts: Mutex::new(Vec::new()),
        })
    }

    /// Sets the number of threads that encode one part; the bytes are the same with any.
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// The folder that will hold the manifest.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Starts the part of a work item.
    ///
    /// # Errors
    /// If the work item is not this dataset's (or shard's), was begun before, or its files cannot be created.
    pub fn begin(&self, info: PartInfo) -> Result<PartWriter<'_>, DatasetError> {
        let usage = |reason: String| DatasetError::Usage {
            path: self.folder.clone(),
            reason,
        };
        let Some(scene) = self.header.scenes.get(info.scene as usize) else {
            return Err(usage(format!(
                "work item {}: scene {} is not listed",
                info.index, info.scene
            )));
        };
        if info.index >= self.header.work_items {
            return Err(usage(format!(
                "work item {} of {}",
                info.index, self.header.work_items
            )));
        }
        if let Some(shard) = self.header.shard.filter(|s| !s.contains(info.index)) {
            return Err(usage(format!(
                "work item {} does not belong to shard {shard}",
                info.index
            )));
        }
        let stem = info.stem(&scene.name);
        let folder = self.partial_path();
        // A second part of the same work item fails here, because its files exist.
        let sink = self.header.format.sink(folder, &stem, self.threads)?;
        Ok(PartWriter {
            name: PathBuf::from(&stem),
            dataset: self,
            info,
            sink,
            rows: 0,
            pixels: 0,
            last_pixel: None,
        })
    }

    /// Ends the dataset: writes the manifest and moves everything into place. An older dataset in the folder is
    /// replaced.
    ///
    /// # Errors
    /// If a work item has no part, or a file cannot be written or moved.
    pub fn finish(mut self) -> Result<Manifest, DatasetError> {
        let header = self.header.clone();
        let mut manifest = Manifest {
            schema: SCHEMA_VERSION,
            tool_version: header.tool_version,
            command: header.command,
            format: header.format,
            columns: manifest::columns(),
            seed: header.seed,
            adapter: header.adapter,
            peel: header.peel,
            pixels_fraction: header.pixels_fraction,
            augment: header.augment,
            scenes: header.scenes,
            work_items: header.work_items,
            shard: header.shard,
            rows: 0,
            pixels: 0,
            lost_fragments: 0,
            coplanar_ties: 0,
            hash: String::new(),
            parts: std::mem::take(
                &mut *self
                    .parts
                    .lock()
                    .unwrap_or_else(std::sync::PoisonError::into_inner),
            ),
        };
        manifest.total();
        let missing = manifest.missing_items();
        if let Some(first) = missing.first() {
            return Err(DatasetError::Usage {
                path: self.folder.clone(),
                reason: format!(
                    "{} work items were not written, the first is {first}",
                    missing.len()
                ),
            });
        }
        let partial = self.partial_path().to_owned();
        let partial_manifest = partial.join(manifest::FILE_NAME);
        fs::write(&partial_manifest, manifest.to_json())
            .map_err(DatasetError::io(&partial_manifest, "write"))?;

        let _moving = peelnet_files::Moving::begin();
        if let Some(partial) = self.partial.take() {
            partial.move_into(&self.folder, &manifest)?;
        }
        self.created.clear();
        Ok(manifest)
    }

    fn partial_path(&self) -> &Path {
        self.partial
            .as_ref()
            .expect("the hidden folder is closed only when the writer is consumed")
            .path()
    }
}

impl Drop for DatasetWriter {
    fn drop(&mut self) {
        // The hidden folder first; then the folders that were made for this dataset, as far as they are empty.
        drop(self.partial.take());
        remove_empty(&self.created);
    }
}

/// Writes the rows of one work item, whole pixels in order, each from its nearest fragment to its farthest.
pub struct PartWriter<'a> {
    dataset: &'a DatasetWriter,
    info: PartInfo,
    name: PathBuf,
    sink: Box<dyn PartSink>,
    rows: u64,
    pixels: u64,
    last_pixel: Option<[u32; 2]>,
}

impl PartWriter<'_> {
    /// Appends rows. Memory does not grow with their number; the cuts between calls do not matter.
    ///
    /// # Errors
    /// If the columns differ in length, a value is out of range (see [`Column`]), or the disk refuses.
    pub fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        rows.check()?;
        for column in Column::ALL {
            check_column(
                &self.name,
                column,
                rows.column(column),
                self.rows,
                self.info.index,
            )?;
        }
        for (&x, &y) in rows.x.iter().zip(&rows.y) {
            let pixel = Some([x, y]);
            self.pixels += u64::from(pixel != self.last_pixel);
            self.last_pixel = pixel;
        }
        self.sink.write(rows)?;
        self.rows += rows.len() as u64;
        Ok(())
    }

    /// Rows written so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Ends the part. A part without rows is a part.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn finish(self, counts: PartCounts) -> Result<(), DatasetError> {
        let (row_groups, files) = self.sink.finish()?;
        let part = Part {
            index: self.info.index,
            scene: self.info.scene,
            copy: self.info.copy,
            view: self.info.view,
            camera: self.info.camera,
            width: self.info.width,
            height: self.info.height,
            rows: self.rows,
            pixels: self.pixels,
            lost_fragments: counts.lost_fragments,
            coplanar_ties: counts.coplanar_ties,
            row_groups,
            files,
        };
        self.dataset
            .parts
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .push(part);
        Ok(())
    }
}

/// Removes the folders that were made when `create` fails half-way.
struct Undo {
    created: Option<Vec<PathBuf>>,
}

impl Drop for Undo {
    fn drop(&mut self) {
        if let Some(created) = &self.created {
            remove_empty(created);
        }
    }
}
