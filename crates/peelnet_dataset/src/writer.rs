//! Writing a dataset, alone or beside other writers: a part is written aside, moved into place when it is finished, and then recorded. The
//! writer that finishes the last part seals the dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use crate::column::{Column, FragmentBatch};
use crate::error::DatasetError;
use crate::folder::{self, Partial};
use crate::formats::PartSink;
use crate::hash::hash_file;
use crate::manifest::{FileEntry, Manifest, Part, to_json};
use crate::parts::{self, PartRecord};
use crate::picture::Picture;
use crate::plan::{Header, Plan};
use crate::statistics::Gatherer;
use crate::store::{FRAGMENTS, Folder, PLAN, Store, store_at};

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
    /// Parts that this writer finished.
    parts: Mutex<Vec<Part>>,
    /// Where parts are written before they are the dataset's.
    scratch: Partial,
}

impl DatasetWriter {
    /// Starts to write into `folder`, which is created where it is missing. A shard, and a writer with [`Header::resume`], adds to the
    /// dataset that is there; any other replaces it when it comes to its end.
    ///
    /// # Errors
    /// If the folder holds anything but a dataset, the dataset there has another plan, another process writes a whole dataset there at the
    /// moment, or the folder cannot be written.
    pub fn create(folder: impl AsRef<Path>, header: Header) -> Result<Self, DatasetError> {
        let path = folder.as_ref();
        header.check(path)?;
        let mut store = store_at(path)?;
        let joins = header.resume || header.shard.is_some();
        let mut replaces = false;
        let scratch = match store.folder().map(Path::to_owned) {
            Some(path) => {
                replaces = folder::prepare(&path, joins)?;
                let partial = Partial::in_dataset(&path)?;
                let scratch = Some(partial.path.clone());
                store = Arc::new(Folder { path, scratch });
                partial
            }
            None => {
                let mut names = store.list("")?.into_keys();
                let has_rows = names.any(|name| name.starts_with(FRAGMENTS));
                if !joins && (has_rows || Plan::read(&*store)?.is_some()) {
                    let reason = "a dataset is there already, and one in an object store is not replaced; complete it with `--resume`, or choose another prefix";
                    return Err(DatasetError::invalid(path, reason));
                }
                Partial::temporary()?
            }
        };
        let mine = Plan::new(&header);
        let (plan, plan_is_new) = match replaces {
            true => (mine, false),
            false => mine.agree(&*store)?,
        };
        let done = match replaces || plan_is_new {
            true => BTreeSet::new(),
            false => finished(&*store, &plan)?,
        };
        Ok(Self {
            store,
            header,
            plan,
            plan_is_new,
            replaces,
            done,
            parts: Mutex::new(Vec::new()),
            scratch,
        })
    }

    /// Whether a work item is for this writer to do: it is of its shard, and was not finished when the writer began.
    pub fn needs(&self, index: u32) -> bool {
        self.header.shard.is_none_or(|s| s.contains(index)) && !self.done.contains(&index)
    }

    /// Starts the part of a work item, of which everything is known but what follows from its rows.
    ///
    /// # Errors
    /// If the work item is not this dataset's (or shard's), was begun before, or its files cannot be created.
    pub fn begin(&self, part: Part) -> Result<PartWriter<'_>, DatasetError> {
        let (index, header) = (part.index, &self.header);
        let is_mine = header.shard.is_none_or(|s| s.contains(index));
        let is_new = self.parts().iter().all(|p| p.index != index);
        let scene = header.scenes.get(part.scene as usize);
        let Some(scene) = scene.filter(|_| index < header.work_items && is_mine && is_new) else {
            let reason = format!(
                "work item {index} of {} (scene {}) is not one of this writer's, or was written before",
                header.work_items, part.scene
            );
            return Err(DatasetError::invalid(self.store.path(), reason));
        };
        let stem = part.stem(&scene.name);
        let picture = Picture::of(&part, header.pixels_fraction);
        let names = header.format.file_names(&stem);
        let files = names.iter().map(|name| self.scratch.path.join(name));
        // A second part of the same work item fails here, because its files exist.
        let sink = header.format.sink(files.collect())?;
        Ok(PartWriter {
            name: PathBuf::from(&stem),
            dataset: self,
            part,
            names,
            sink,
            statistics: Column::ALL.map(Gatherer::new).into(),
            picture,
            last_pixel: None,
        })
    }

    fn parts(&self) -> MutexGuard<'_, Vec<Part>> {
        self.parts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a part the dataset's: its files first, then its record.
    fn commit(&self, part: &Part) -> Result<(), DatasetError> {
        let store = &*self.store;
        let (index, worker) = (part.index, &self.header.worker);
        let record = PartRecord {
            schema: self.plan.schema,
            plan: self.plan.hash.clone(),
            worker: worker.clone(),
            part: part.clone(),
        };
        let recorded = || PartRecord::read(store, index, Some(&self.plan));
        if let Some(there) = recorded()? {
            record.check_same(store, &there)?;
        }
        for file in &part.files {
            let aside = self.scratch.path.join(&file.name);
            if store.put_file_if_absent(&file.name, &aside)?
                || store.fetch(&file.name)?.hash()? == (file.bytes, file.sha256.clone())
            {
                continue;
            }
            // The one whose file it is may have come to its end meanwhile.
            if let Some(there) = recorded()? {
                record.check_same(store, &there)?;
                let reason = "was changed after it was written";
                return Err(parts::damaged(store, index, &file.name, reason));
            }
            let reason = format!(
                "part {index}: worker {worker} computed other bytes than this file has, and no record says whose it is; if no other extraction is running, remove the file and resume"
            );
            return Err(DatasetError::invalid(&store.shown(&file.name), reason));
        }
        let name = PartRecord::name(index);
        if !store.put_if_absent(&name, to_json(&record).as_bytes())? {
            // Gone again where somebody removes records while this works.
            let there = recorded()?.ok_or_else(|| DatasetError::busy(store.path()))?;
            record.check_same(store, &there)?;
        }
        for file in &part.files {
            // It is linked, moved or sent: what stays here goes with the folder.
            let _ = std::fs::remove_file(self.scratch.path.join(&file.name));
        }
        Ok(())
    }

    /// While it lives, a process that ends waits; but not for a network.
    fn moving(&self) -> Option<peelnet_core::files::Moving> {
        self.store.folder().map(|_| peelnet_core::files::moving())
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
            return Err(DatasetError::invalid(self.store.path(), reason));
        }
        // All of them, or nothing where a foreign file came meanwhile.
        let older = match self.replaces {
            true => folder::older_files(self.store.path())?,
            false => Vec::new(),
        };
        let _moving = self.replaces.then(|| self.moving());
        for file in older {
            let failed = DatasetError::io(file.path(), "replace");
            file.remove().map_err(failed)?;
        }
        // The plan again: a first writer that gave up may have taken it away.
        self.plan.agree(&*self.store)?;
        if self.replaces {
            parts.iter().try_for_each(|part| self.commit(part))?;
        }
        // What others wrote may have been changed since; of shards, each would read all of it.
        let hashes = self.header.resume && self.header.shard.is_none();
        if let Some(manifest) = parts::whole(&*self.store, &self.plan, hashes)? {
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
        if let Some(index) = parts::part_of_file(name) {
            *files.entry(index).or_default() += 1;
        }
    }
    let expected = plan.header.format.files_of_a_part();
    let mut done = parts::recorded(store, plan)?;
    done.retain(|k| files.get(k).is_some_and(|&found| found >= expected));
    Ok(done)
}

impl Drop for DatasetWriter {
    fn drop(&mut self) {
        // What was made for this dataset goes, as far as nothing was finished in it.
        let nothing =
            || parts::recorded(&*self.store, &self.plan).is_ok_and(|done| done.is_empty());
        if self.plan_is_new && self.header.shard.is_none() && nothing() {
            // Other writers put it back when they come to their end.
            let _ = self.store.remove(PLAN);
        }
    }
}

/// Writes the rows of one work item, whole pixels in order, each from its nearest fragment to its farthest.
pub struct PartWriter<'a> {
    dataset: &'a DatasetWriter,
    part: Part,
    name: PathBuf,
    names: Vec<String>,
    sink: Box<dyn PartSink>,
    /// Of each column, gathered while rows pass.
    statistics: Vec<Gatherer>,
    picture: Option<Picture>,
    last_pixel: Option<[u32; 2]>,
}

impl PartWriter<'_> {
    /// Appends rows. Memory does not grow with their number; the cuts between calls do not matter.
    ///
    /// # Errors
    /// If the columns differ in length, a value is out of range (see [`Column`]), or the disk refuses.
    pub fn write(&mut self, rows: &FragmentBatch) -> Result<(), DatasetError> {
        rows.check()?;
        let (name, part) = (&self.name, &mut self.part);
        let columns = Column::ALL.into_par_iter().zip(&mut self.statistics);
        let checked = columns.map(|(column, statistics)| {
            rows.check_column(name, column, 0, part.rows, part)?;
            statistics.add(rows.column(column));
            Ok(())
        });
        // The first column's error, whichever came first.
        let checked: Vec<Result<(), DatasetError>> = checked.collect();
        checked.into_iter().collect::<Result<(), _>>()?;
        for (&x, &y) in rows.x.iter().zip(&rows.y) {
            let pixel = Some([x, y]);
            part.pixels += u64::from(pixel != self.last_pixel);
            self.last_pixel = pixel;
        }
        part.rows += rows.len() as u64;
        self.picture.iter_mut().for_each(|p| p.add(rows));
        self.sink.write(rows)
    }

    /// Ends the part, which from then on is the dataset's, with the numbers of fragments that peeling left out and of neighbouring
    /// fragments at the same depth. A part without rows is a part. If another writer finished the same part with the same bytes, that is
    /// no error.
    ///
    /// # Errors
    /// If the disk refuses, or another writer finished the part with other bytes.
    pub fn finish(self, lost_fragments: u64, coplanar_ties: u64) -> Result<(), DatasetError> {
        self.sink.finish(self.part.rows)?;
        let dataset = self.dataset;
        let hashed = self.names.into_par_iter().map(|name| {
            let path = dataset.scratch.path.join(&name);
            let (bytes, sha256) = hash_file(&path).map_err(DatasetError::io(&path, "read"))?;
            Ok(FileEntry {
                name,
                bytes,
                sha256,
            })
        });
        let part = Part {
            lost_fragments,
            coplanar_ties,
            row_groups: dataset.header.format.row_groups(self.part.rows),
            files: hashed.collect::<Result<_, DatasetError>>()?,
            statistics: self
                .statistics
                .iter()
                .filter_map(Gatherer::finish)
                .collect(),
            picture: self.picture.as_ref().and_then(Picture::encode),
            ..self.part
        };
        if !dataset.replaces {
            let _moving = dataset.moving();
            dataset.commit(&part)?;
        }
        dataset.parts().push(part);
        Ok(())
    }
}
