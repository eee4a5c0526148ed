//! Writing a dataset, alone or beside other writers: a part is written aside, moved into place when it is finished, and then recorded. The
//! writer that finishes the last part seals the dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::batch::check_column;
use crate::column::{Column, FragmentBatch};
use crate::error::DatasetError;
use crate::folder::{self, MadeFolders, Partial};
use crate::formats::PartSink;
use crate::manifest::{CameraInfo, Manifest, Part};
use crate::plan::{Header, Plan};
use crate::record::{self, PartRecord};
use crate::seal;
use crate::store::{FRAGMENTS, Folder, PLAN, Place, Store};

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

/// Writes a dataset, or some parts of it.
///
/// Parts may be written from several threads, each through its own [`PartWriter`], and from several processes, each with a writer of its
/// own: of shards, or with [`Header::resume`]. A part that is finished stays, also when the writer is dropped or killed. Only a writer that
/// replaces an older dataset keeps all parts aside until [`DatasetWriter::finish`], so that the older one stays until then.
#[derive(Debug)]
pub struct DatasetWriter {
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
    /// Where parts are written before they are the dataset's.
    scratch: Partial,
    /// Dropped last.
    _made: Option<MadeFolders>,
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
        header.check(folder)?;
        match Place::of(folder)? {
            Place::Folder(folder) => {
                let made = MadeFolders::create(&folder)?;
                let replaces = if header.joins() {
                    folder::prepare_to_join(&folder)?;
                    false
                } else {
                    folder::prepare(&folder)?
                };
                let scratch = Partial::hidden(&folder)?;
                let store = Arc::new(Folder::new(&folder, scratch.path()));
                Self::new(store, header, replaces, scratch, Some(made))
            }
            Place::Remote(store) => {
                let mut names = store.list("")?.into_keys();
                let has_rows = names.any(|name| name.starts_with(FRAGMENTS));
                if !header.joins() && (has_rows || Plan::read(&*store)?.is_some()) {
                    let reason = "a dataset is there already, and one in an object store is not replaced; complete it with `--resume`, or choose another prefix";
                    return Err(DatasetError::usage(store.path(), reason));
                }
                Self::new(store, header, false, Partial::local()?, None)
            }
        }
    }

    fn new(
        store: Arc<dyn Store>,
        header: Header,
        replaces: bool,
        scratch: Partial,
        _made: Option<MadeFolders>,
    ) -> Result<Self, DatasetError> {
        let mine = Plan::new(&header);
        let (plan, plan_is_new) = if replaces {
            (mine, false)
        } else {
            mine.agree(&*store)?
        };
        let done = if replaces || plan_is_new {
            BTreeSet::new()
        } else {
            finished(&*store, &plan)?
        };
        Ok(Self {
            store,
            header,
            plan,
            plan_is_new,
            replaces,
            done,
            threads: std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
            parts: Mutex::new(Vec::new()),
            scratch,
            _made,
        })
    }

    /// Sets the number of threads that encode one part; the bytes are the same with any.
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads.max(1);
        self
    }

    /// The dataset's folder.
    pub fn folder(&self) -> &Path {
        self.store.path()
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
        let (index, header) = (info.index, &self.header);
        let usage = |reason: String| Err(DatasetError::usage(self.folder(), reason));
        let Some(scene) = header.scenes.get(info.scene as usize) else {
            let scene = info.scene;
            return usage(format!("work item {index}: scene {scene} is not listed"));
        };
        if index >= header.work_items {
            return usage(format!("work item {index} of {}", header.work_items));
        }
        if let Some(shard) = header.shard.filter(|s| !s.contains(index)) {
            return usage(format!(
                "work item {index} does not belong to shard {shard}"
            ));
        }
        if self.parts().iter().any(|p| p.index == index) {
            return usage(format!("work item {index} was written before"));
        }
        let stem = info.stem(&scene.name);
        // A second part of the same work item fails here, because its files exist.
        let sink = header
            .format
            .sink(self.scratch.path(), &stem, self.threads)?;
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

    fn parts(&self) -> MutexGuard<'_, Vec<Part>> {
        self.parts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a part the dataset's: its files first, then its record.
    fn commit(&self, part: &Part) -> Result<(), DatasetError> {
        let store = &*self.store;
        let record = PartRecord::new(&self.plan, &self.header.worker, part.clone());
        let recorded = || PartRecord::read(store, part.index, Some(&self.plan));
        if let Some(there) = recorded()? {
            record.check_same(store, &there)?;
        }
        for file in &part.files {
            let aside = self.scratch.path().join(&file.name);
            if store.put_file_if_absent(&file.name, &aside)?
                || store.fetch(&file.name)?.hash()? == (file.bytes, file.sha256.clone())
            {
                continue;
            }
            // The one whose file it is may have come to its end meanwhile.
            return Err(match recorded()? {
                Some(there) => {
                    record.check_same(store, &there)?;
                    let reason = "was changed after it was written";
                    seal::damaged(store, part.index, &file.name, reason)
                }
                None => DatasetError::PartInTheWay {
                    path: store.shown(&file.name),
                    index: part.index,
                    worker: self.header.worker.clone(),
                },
            });
        }
        record.commit(store, &self.plan)?;
        for file in &part.files {
            // It is linked, moved or sent: what stays here goes with the folder.
            let _ = std::fs::remove_file(self.scratch.path().join(&file.name));
        }
        Ok(())
    }

    /// While it lives, a process that ends waits; but not for a network.
    fn moving(&self) -> Option<peelnet_files::Moving> {
        let is_hidden = self.scratch.is_hidden();
        is_hidden.then(peelnet_files::Moving::begin)
    }

    /// Ends this writer. Where every part of the dataset is finished now, the dataset is sealed, and its manifest is returned; otherwise a
    /// manifest of this shard's parts, for which [`Manifest::is_whole`] is false.
    ///
    /// # Errors
    /// If a work item of this writer has no part, a part of the dataset was changed, or a file cannot be written or moved.
    pub fn finish(self) -> Result<Manifest, DatasetError> {
        let mut parts = std::mem::take(&mut *self.parts());
        let written: BTreeSet<u32> = parts.iter().map(|p| p.index).collect();
        let missing =
            (0..self.header.work_items).filter(|k| self.needs(*k) && !written.contains(k));
        if let Some(first) = missing.clone().next() {
            let count = missing.count();
            let reason = format!("{count} work items were not written, the first is {first}");
            return Err(DatasetError::usage(self.folder(), reason));
        }
        let _moving = self.replaces.then(|| self.moving());
        if self.replaces {
            folder::remove_older(self.folder())?;
        }
        // The plan again: a first writer that gave up may have taken it away.
        self.plan.agree(&*self.store)?;
        if self.replaces {
            parts.iter().try_for_each(|part| self.commit(part))?;
        }
        if let Some(manifest) = seal::whole(&*self.store, &self.plan)? {
            return Ok(manifest);
        }
        let is_mine = |k: &&u32| self.header.shard.is_none_or(|s| s.contains(**k));
        for &index in self.done.iter().filter(is_mine) {
            let record = PartRecord::read(&*self.store, index, Some(&self.plan))?;
            parts.extend(record.map(|r| r.part));
        }
        Ok(self.plan.manifest(parts))
    }
}

/// The work items whose record and files are there. A file that is gone is written again.
fn finished(store: &dyn Store, plan: &Plan) -> Result<BTreeSet<u32>, DatasetError> {
    let mut files: BTreeMap<u32, usize> = BTreeMap::new();
    for name in store.list("")?.keys() {
        if let Some(index) = record::part_index(name) {
            *files.entry(index).or_default() += 1;
        }
    }
    let expected = plan.header.format.files_of_a_part();
    let mut done = seal::recorded(store)?;
    done.retain(|k| files.get(k).is_some_and(|&found| found >= expected));
    Ok(done)
}

impl Drop for DatasetWriter {
    fn drop(&mut self) {
        // What was made for this dataset goes, as far as nothing was finished in it.
        let nothing = || seal::recorded(&*self.store).is_ok_and(|done| done.is_empty());
        if self.plan_is_new && self.header.shard.is_none() && nothing() {
            // Other writers put it back when they come to their end.
            let _ = self.store.remove(PLAN);
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
            let values = rows.column(column);
            check_column(&self.name, column, values, self.rows, self.info.index)?;
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
            let _moving = self.dataset.moving();
            self.dataset.commit(&part)?;
        }
        self.dataset.parts().push(part);
        Ok(())
    }
}
