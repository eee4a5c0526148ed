//! Writing a dataset, alone or beside other writers: a part is written aside, moved into place when it is finished, and then recorded. The
//! writer that finishes the last part seals the dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use crate::batch::FragmentBatch;
use crate::column::Column;
use crate::error::DatasetError;
use crate::folder::{self, Partial, check_not_mixed, create_folders, remove_empty};
use crate::format::Format;
use crate::formats::PartSink;
use crate::layout::{self, FRAGMENTS};
use crate::manifest::{CameraInfo, MAX_WORK_ITEMS, Manifest, Part, SceneEntry};
use crate::plan::Plan;
use crate::record::PartRecord;
use crate::seal;
use crate::shard::Shard;
use crate::store::{Folder, Place, Store};
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
    /// Adapters that are expected to give the same bytes: writers of another class are refused.
    pub adapter_class: String,
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
    /// Everything else that shapes the rows, by name: the frame size, the cameras, limits. Writers must agree on it.
    pub settings: BTreeMap<String, String>,
    /// All scenes of the whole dataset, also when a shard is written.
    pub scenes: Vec<SceneEntry>,
    /// Number of work items (scene × copy × view) of the whole dataset.
    pub work_items: u32,
    /// The shard to write; `None` writes the whole dataset.
    pub shard: Option<Shard>,
    /// Writes only what is missing of the dataset that is there. Shards always do.
    pub resume: bool,
    /// This writer's name, for records and errors: see [`worker_name`](crate::worker_name).
    pub worker: String,
}

impl Header {
    /// Whether the writer adds to a dataset that may be there.
    fn joins(&self) -> bool {
        self.resume || self.shard.is_some()
    }
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

/// Writes a dataset, or some parts of it.
///
/// Parts may be written from several threads, each through its own [`PartWriter`], and from several processes, each with a writer of its
/// own: of shards, or with [`Header::resume`]. A part that is finished stays, also when the writer is dropped or killed. Only a writer that
/// replaces an older dataset keeps all parts aside until [`DatasetWriter::finish`], so that the older one stays until then.
#[derive(Debug)]
pub struct DatasetWriter {
    folder: PathBuf,
    /// Folders that did not exist before, outermost first.
    created: Vec<PathBuf>,
    /// `None` only once it has been closed.
    scratch: Option<Scratch>,
    store: Arc<dyn Store>,
    header: Header,
    plan: Plan,
    /// Whether this writer made the plan.
    plan_is_new: bool,
    /// Whether an older dataset is replaced at the end.
    replaces: bool,
    /// Work items that were finished when this writer began.
    done: BTreeSet<u32>,
    threads: usize,
    /// Parts that this writer finished.
    parts: Mutex<Vec<Part>>,
}

/// Where parts are written before they are the dataset's.
#[derive(Debug)]
enum Scratch {
    /// In the dataset's folder.
    Hidden(Partial),
    /// On this machine, of a dataset on another one.
    Local(
        tempfile::TempDir,
        #[allow(dead_code, reason = "removes it")] peelnet_files::Unfinished,
    ),
}

impl Scratch {
    fn path(&self) -> &Path {
        match self {
            Self::Hidden(partial) => partial.path(),
            Self::Local(folder, _) => folder.path(),
        }
    }
}

impl DatasetWriter {
    /// Starts to write into `folder`, which is created where it is missing. A shard, and a writer with [`Header::resume`], adds to the
    /// dataset that is there; any other replaces it when it comes to its end.
    ///
    /// # Errors
    /// If the folder holds anything but a dataset, the dataset there has another plan, another process writes a whole dataset there at the
    /// moment, or the folder cannot be written.
    pub fn create(folder: impl AsRef<Path>, header: Header) -> Result<Self, DatasetError> {
        let folder = folder.as_ref();
        check_header(folder, &header)?;
        match Place::of(folder)? {
            Place::Folder(folder) => Self::in_folder(&folder, header),
            Place::Remote(store) => Self::in_store(store, header),
        }
    }

    fn in_folder(folder: &Path, header: Header) -> Result<Self, DatasetError> {
        check_not_mixed(folder, header.joins())?;
        let mut undo = Undo {
            folder: folder.to_owned(),
            created: Some(create_folders(folder)?),
        };
        let replaces = if header.joins() {
            folder::prepare_to_join(folder)?;
            false
        } else {
            folder::prepare(folder)?
        };
        let partial = Partial::create(folder)?;
        let store = Arc::new(Folder::new(folder, partial.path()));
        let mut writer = Self::new(store, Scratch::Hidden(partial), header, replaces)?;
        writer.created = undo.created.take().unwrap_or_default();
        Ok(writer)
    }

    fn in_store(store: Arc<dyn Store>, header: Header) -> Result<Self, DatasetError> {
        let is_there =
            || -> Result<bool, DatasetError> {
                let rows = store.list("")?;
                Ok(rows.iter().any(|e| e.name.starts_with(FRAGMENTS))
                    || Plan::read(&*store)?.is_some())
            };
        if !header.joins() && is_there()? {
            return Err(DatasetError::Usage {
                path: store.path().to_owned(),
                reason: "a dataset is there already, and one in an object store is not replaced; complete it with `--resume`, or choose another prefix"
                    .to_owned(),
            });
        }
        let local = tempfile::tempdir().map_err(DatasetError::io(
            &std::env::temp_dir(),
            "create a temporary folder",
        ))?;
        let unfinished = peelnet_files::Unfinished::new(local.path());
        Self::new(store, Scratch::Local(local, unfinished), header, false)
    }

    fn new(
        store: Arc<dyn Store>,
        scratch: Scratch,
        header: Header,
        replaces: bool,
    ) -> Result<Self, DatasetError> {
        let mine = Plan::of(&header);
        let (plan, plan_is_new) = if replaces {
            (mine, false)
        } else {
            mine.agree(&*store)?
        };
        let mut done = BTreeSet::new();
        if !replaces && !plan_is_new {
            done = finished(&*store, &plan)?;
        }
        Ok(Self {
            folder: store.path().to_owned(),
            created: Vec::new(),
            scratch: Some(scratch),
            store,
            header,
            plan,
            plan_is_new,
            replaces,
            done,
            threads: std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
            parts: Mutex::new(Vec::new()),
        })
    }

    /// Sets the number of threads that encode one part; the bytes are the same with any.
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// The dataset's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Whether a work item is for this writer to do: it is of its shard, and was not finished when the writer began.
    pub fn needs(&self, index: u32) -> bool {
        self.header.shard.is_none_or(|s| s.contains(index)) && !self.done.contains(&index)
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
        let mine = self.parts.lock();
        let mine = mine.unwrap_or_else(std::sync::PoisonError::into_inner);
        if mine.iter().any(|p| p.index == info.index) {
            return Err(usage(format!(
                "work item {} was written before",
                info.index
            )));
        }
        let stem = info.stem(&scene.name);
        // A second part of the same work item fails here, because its files exist.
        let sink = self
            .header
            .format
            .sink(self.scratch_path(), &stem, self.threads)?;
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

    /// Makes a part the dataset's: its files first, then its record.
    fn commit(&self, part: &Part) -> Result<(), DatasetError> {
        let store = &*self.store;
        let worker = &self.header.worker;
        let record = PartRecord::new(&self.plan, worker, part.clone());
        if let Some(there) = PartRecord::read(store, part.index, Some(&self.plan))? {
            record.same_bytes(store, &there)?;
        }
        // A process that ends waits; but not for a network.
        let _moving =
            matches!(self.scratch, Some(Scratch::Hidden(_))).then(peelnet_files::Moving::begin);
        for file in &part.files {
            let aside = self.scratch_path().join(&file.name);
            if !store.put_file_if_absent(&file.name, &aside)?
                && store.hash(&file.name)? != (file.bytes, file.sha256.clone())
            {
                let (path, index, worker) = (store.shown(&file.name), part.index, worker.clone());
                let there = PartRecord::read(store, index, Some(&self.plan))?;
                // The one whose file it is may have come to its end meanwhile.
                if let Some(there) = there {
                    record.same_bytes(store, &there)?;
                    return Err(DatasetError::PartDamaged {
                        path,
                        index,
                        worker: there.worker,
                        reason: "was changed after it was written".to_owned(),
                    });
                }
                return Err(DatasetError::PartInTheWay {
                    path,
                    index,
                    worker,
                });
            }
        }
        record.commit(store, &self.plan)?;
        for file in &part.files {
            // It is linked, moved or sent: what stays here goes with the folder.
            let _ = std::fs::remove_file(self.scratch_path().join(&file.name));
        }
        Ok(())
    }

    /// Ends this writer. Where every part of the dataset is finished now, the dataset is sealed, and its manifest is returned; otherwise a
    /// manifest of this shard's parts, for which [`Manifest::is_whole`] is false.
    ///
    /// # Errors
    /// If a work item of this writer has no part, a part of the dataset was changed, or a file cannot be written or moved.
    pub fn finish(mut self) -> Result<Manifest, DatasetError> {
        let parts = std::mem::take(
            &mut *self
                .parts
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner),
        );
        let written: BTreeSet<u32> = parts.iter().map(|p| p.index).collect();
        let missing: Vec<u32> = (0..self.header.work_items)
            .filter(|k| self.needs(*k) && !written.contains(k))
            .collect();
        if let Some(first) = missing.first() {
            return Err(DatasetError::Usage {
                path: self.folder.clone(),
                reason: format!(
                    "{} work items were not written, the first is {first}",
                    missing.len()
                ),
            });
        }
        if self.replaces {
            let manifest = self.plan.manifest(parts);
            let _moving = peelnet_files::Moving::begin();
            if let Some(Scratch::Hidden(partial)) = self.scratch.take() {
                partial.replace(&self.folder, &self.plan, &self.header.worker, &manifest)?;
            }
            self.created.clear();
            return Ok(manifest);
        }
        // The plan again: a first writer that gave up may have taken it away.
        self.plan.agree(&*self.store)?;
        let manifest = match seal::whole(&*self.store, &self.plan)? {
            Ok(manifest) => manifest,
            Err(_) => self.partial_manifest(parts)?,
        };
        self.created.clear();
        self.plan_is_new = false;
        Ok(manifest)
    }

    /// The manifest of this writer's work items alone.
    fn partial_manifest(&self, mut parts: Vec<Part>) -> Result<Manifest, DatasetError> {
        let is_mine = |k: &&u32| self.header.shard.is_none_or(|s| s.contains(**k));
        for &index in self.done.iter().filter(is_mine) {
            let record = PartRecord::read(&*self.store, index, Some(&self.plan))?;
            parts.extend(record.map(|r| r.part));
        }
        let mut manifest = self.plan.manifest(parts);
        manifest.shard = self.header.shard;
        Ok(manifest)
    }

    fn scratch_path(&self) -> &Path {
        self.scratch
            .as_ref()
            .expect("the place aside is closed only when the writer is consumed")
            .path()
    }
}

/// The work items whose record and files are there. A file that is gone is written again.
fn finished(store: &dyn Store, plan: &Plan) -> Result<BTreeSet<u32>, DatasetError> {
    let mut files: BTreeMap<u32, usize> = BTreeMap::new();
    for entry in store.list("")? {
        if let Some(index) = layout::part_index(&entry.name) {
            *files.entry(index).or_default() += 1;
        }
    }
    let expected = plan.format.files_of_a_part();
    let mut done = seal::recorded(store)?;
    done.retain(|k| files.get(k).is_some_and(|&found| found >= expected));
    Ok(done)
}

/// What a header must have.
fn check_header(folder: &Path, header: &Header) -> Result<(), DatasetError> {
    let usage = |reason: &str| {
        Err(DatasetError::Usage {
            path: folder.to_owned(),
            reason: reason.to_owned(),
        })
    };
    if header.scenes.is_empty() || header.work_items == 0 {
        return usage("a dataset needs at least one scene and one view");
    }
    if header.work_items > MAX_WORK_ITEMS {
        return Err(DatasetError::TooManyItems {
            items: header.work_items.into(),
        });
    }
    if !(header.pixels_fraction > 0.0 && header.pixels_fraction <= 1.0) {
        return usage("the fraction of pixels must be above 0 and at most 1");
    }
    Ok(())
}

impl Drop for DatasetWriter {
    fn drop(&mut self) {
        // What is aside first; then what was made for this dataset, as far as nothing was finished in it.
        drop(self.scratch.take());
        let nothing = || seal::recorded(&*self.store).is_ok_and(|done| done.is_empty());
        if self.plan_is_new && self.header.shard.is_none() && nothing() {
            // Other writers put it back when they come to their end.
            let _ = self.store.remove(layout::PLAN);
        }
        if !crate::store::is_remote(&self.folder) {
            folder::remove_empty_meta(&self.folder);
            remove_empty(&self.created);
        }
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

    /// Ends the part, which from then on is the dataset's. A part without rows is a part. If another writer finished the same part with the
    /// same bytes, that is no error.
    ///
    /// # Errors
    /// If the disk refuses, or another writer finished the part with other bytes.
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
        if !self.dataset.replaces {
            self.dataset.commit(&part)?;
        }
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
    folder: PathBuf,
    created: Option<Vec<PathBuf>>,
}

impl Drop for Undo {
    fn drop(&mut self) {
        if let Some(created) = &self.created {
            folder::remove_empty_meta(&self.folder);
            remove_empty(created);
        }
    }
}
