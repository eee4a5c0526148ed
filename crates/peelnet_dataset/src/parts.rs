//! Which parts of a dataset are there: `_peelnet/parts/00003.json` says that one is finished, and by whom, and the seal over all of them
//! makes them one dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use peelnet_core::files::printable;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::DatasetError;
use crate::folder;
use crate::hash::sha256;
use crate::manifest::{EXTRACT_AGAIN, FileEntry, Manifest, Part, read_json, to_json};
use crate::plan::Plan;
use crate::store::{FRAGMENTS, Fetched, MANIFEST, PARTS, Store, open_store, store_at};

/// Records that are read at a time: an object store answers each after tens of milliseconds.
const READERS: usize = 32;

/// A finished part. It is the dataset's once this record is there. The file is its JSON, with these names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PartRecord {
    /// [`SCHEMA_VERSION`](crate::SCHEMA_VERSION) of the writer.
    pub schema: u32,
    /// Hash of the plan that the writer followed.
    pub plan: String,
    pub worker: String,
    /// The part, as it will be in the manifest.
    pub part: Part,
}

impl PartRecord {
    pub(crate) fn name(index: u32) -> String {
        format!("{PARTS}/{index:05}.json")
    }

    pub(crate) fn index(name: &str) -> Option<u32> {
        let (_, digits) = name.strip_suffix(".json")?.rsplit_once('/')?;
        digits.parse().ok().filter(|&k| Self::name(k) == name)
    }

    /// Reads a part's record; `None` where there is none. It must be of this part, and follow this plan.
    pub(crate) fn read(
        store: &dyn Store,
        index: u32,
        plan: Option<&Plan>,
    ) -> Result<Option<Self>, DatasetError> {
        let fix = "remove this record and finish the part with `peelnet extract --resume`";
        read_json(store, &Self::name(index), "record", fix, |record: &Self| {
            let (worker, other) = (printable(&record.worker), record.part.index);
            if other != index {
                return Err(format!(
                    "part {index}: the record of worker {worker} is of part {other}, so it was copied or renamed"
                ));
            }
            let Some(plan) = plan.filter(|p| p.hash != record.plan) else {
                return Ok(());
            };
            let start = |hash: &str| -> String { printable(hash).chars().take(12).collect() };
            Err(format!(
                "part {index}: worker {worker} wrote it by another plan ({}) than the dataset's ({}): another version, size, seed, flag or adapter",
                start(&record.plan),
                start(&plan.hash)
            ))
        })
    }

    /// An error if another record of this part is of other bytes.
    pub(crate) fn check_same(&self, store: &dyn Store, there: &Self) -> Result<(), DatasetError> {
        if there.part.files == self.part.files {
            return Ok(());
        }
        let (index, worker, other) = (self.part.index, &self.worker, &there.worker);
        let reason = format!(
            "part {index}: worker {worker} and worker {other} wrote different bytes for it, so one of the machines computes differently, or a file was changed; the part of {other} stays; extract all parts on machines of one kind"
        );
        Err(DatasetError::invalid(store.path(), reason))
    }
}

pub(crate) fn part_of_file(name: &str) -> Option<u32> {
    let (digits, _) = name.strip_prefix(FRAGMENTS)?.split_once('-')?;
    let index = digits.parse().ok();
    index.filter(|k| format!("{k:05}") == digits)
}

/// The work items of a plan that have a record.
pub(crate) fn recorded(store: &dyn Store, plan: &Plan) -> Result<BTreeSet<u32>, DatasetError> {
    let names = store.list(PARTS)?.into_keys();
    let parts = names.filter_map(|name| PartRecord::index(&format!("{PARTS}/{name}")));
    Ok(parts.filter(|k| *k < plan.header.work_items).collect())
}

/// Seals a dataset of which every part is finished: checks the parts and writes the manifest. A dataset that is sealed stays as it is, and
/// its manifest is returned. The bytes of the manifest do not depend on who seals, or when. Files of a folder are read and hashed; an object
/// store, in which nothing is replaced, is asked for their lengths alone.
///
/// # Errors
/// If parts are missing; an error that names part and worker if a part is of another plan, or a file of it is missing, was changed, or is
/// there twice.
pub fn seal(path: impl AsRef<Path>) -> Result<Manifest, DatasetError> {
    let store = open_store(path.as_ref())?;
    let plan = Plan::read(&*store)?.ok_or_else(|| no_manifest(path.as_ref()))?;
    let Some(manifest) = whole(&*store, &plan, true)? else {
        return Err(unsealed(&*store, &plan)?);
    };
    if let Some(folder) = store.folder() {
        folder::remove_abandoned(folder)?;
    }
    Ok(manifest)
}

pub(crate) fn no_manifest(path: &Path) -> DatasetError {
    let reason = "no _peelnet/manifest.json here: this is not a dataset, or its extraction was interrupted; run `peelnet extract` again";
    DatasetError::invalid(path, reason)
}

/// The error of a dataset that lacks parts, or lacks its seal alone.
pub(crate) fn unsealed(store: &dyn Store, plan: &Plan) -> Result<DatasetError, DatasetError> {
    let recorded = recorded(store, plan)?;
    let of = plan.header.work_items;
    let reason = match (0..of).find(|k| !recorded.contains(k)) {
        Some(first) => format!(
            "{} of {of} parts are missing, the first is {first}; write them with `peelnet extract --resume` and the same command, or with the shards that did not run, then seal the dataset with `peelnet seal`",
            of - recorded.len() as u32
        ),
        None => format!(
            "all {of} parts are there, but the dataset is not sealed; run `peelnet seal` on it"
        ),
    };
    Ok(DatasetError::invalid(store.path(), reason))
}

/// How many parts of a dataset that is not sealed are finished, and how many it will have; `None` if it is sealed, or none.
pub fn unsealed_parts(path: impl AsRef<Path>) -> Result<Option<(u32, u32)>, DatasetError> {
    let store = store_at(path.as_ref())?;
    match Plan::read(&*store)? {
        Some(plan) if Manifest::read(&*store)?.is_none() => {
            let recorded = recorded(&*store, &plan)?;
            Ok(Some((recorded.len() as u32, plan.header.work_items)))
        }
        _ => Ok(None),
    }
}

/// Writes the manifest if every part is there and it is not, and returns it; `None` if parts are missing. Where this is asked for, files of a
/// folder are hashed.
pub(crate) fn whole(
    store: &dyn Store,
    plan: &Plan,
    hashes: bool,
) -> Result<Option<Manifest>, DatasetError> {
    let check = |manifest: &Manifest| {
        check_files(store, manifest, true)?;
        if !hashes || store.folder().is_none() {
            return Ok(());
        }
        let files = manifest
            .parts
            .iter()
            .flat_map(|p| p.files.iter().map(|f| (p.index, f)));
        for (index, file) in files {
            check_hash(store, index, file, &store.fetch(&file.name)?)?;
        }
        Ok(())
    };
    let wrong = |name: &str, reason: &str| {
        let reason = format!("{reason}; {EXTRACT_AGAIN}");
        Err(DatasetError::invalid(&store.shown(name), reason))
    };
    if let Some(manifest) = Manifest::read(store)? {
        if !plan.agrees_with(&manifest) {
            return wrong(MANIFEST, "the manifest says other things than plan.json");
        }
        check(&manifest)?;
        return Ok(Some(manifest));
    }
    let recorded = recorded(store, plan)?;
    if recorded.len() < plan.header.work_items as usize {
        return Ok(None);
    }
    let read = |index| Ok(PartRecord::read(store, index, Some(plan))?.map(|r| r.part));
    let readers = rayon::ThreadPoolBuilder::new().num_threads(READERS).build();
    let readers = readers.map_err(std::io::Error::other);
    let readers = readers.map_err(DatasetError::io(store.path(), "start to read"))?;
    let parts: Vec<Option<Part>> = readers.install(|| {
        let parts = recorded.into_par_iter().map(read);
        parts.collect::<Result<_, DatasetError>>()
    })?;
    let Some(parts) = parts.into_iter().collect::<Option<Vec<Part>>>() else {
        return Ok(None);
    };
    let (manifest, card) = plan.manifest_and_card(parts);
    check(&manifest)?;
    if let Err(reason) = manifest.check() {
        return wrong(PARTS, &reason);
    }
    // Before the seal: a sealed dataset has its card. What is there is another writer's of the same bytes, or the user's, and stays.
    for (name, bytes) in card {
        store.put_if_absent(&name, &bytes)?;
    }
    // Another writer may come to its end at the same time.
    if !store.put_if_absent(MANIFEST, to_json(&manifest).as_bytes())?
        && Manifest::read(store)?.as_ref() != Some(&manifest)
    {
        return wrong(MANIFEST, "the manifest that is there is of other parts");
    }
    Ok(Some(manifest))
}

/// What to say of a file that [`foreign_card`] lists, after its name.
pub const FOREIGN_CARD: &str =
    "is not as peelnet writes it, so it was written or edited by others; it stays as it is";

/// The files of a sealed dataset's card that somebody else wrote or edited, so that they say what others say; one that is gone is not
/// listed. They stay whatever peelnet does.
///
/// # Errors
/// Those of reading a manifest. What cannot be read in place of a card is somebody else's.
pub fn foreign_card(path: impl AsRef<Path>) -> Result<Vec<PathBuf>, DatasetError> {
    let store = store_at(path.as_ref())?;
    let card = Manifest::read(&*store)?.map_or(Vec::new(), |m| m.card);
    let is_foreign = |file: &FileEntry| match store.get(&file.name, file.bytes) {
        Ok(found) => found.is_some_and(|bytes| sha256(&bytes) != file.sha256),
        Err(_) => true,
    };
    let foreign = card.iter().filter(|file| is_foreign(file));
    Ok(foreign.map(|file| store.shown(&file.name)).collect())
}

/// Every file of the parts must be there with its length. For a seal, no other file of rows may lie beside them.
pub(crate) fn check_files(
    store: &dyn Store,
    manifest: &Manifest,
    alone: bool,
) -> Result<(), DatasetError> {
    let mut found: BTreeMap<String, u64> = store.list("")?;
    for part in &manifest.parts {
        for file in &part.files {
            let reason = match found.remove(&file.name) {
                Some(bytes) if bytes == file.bytes => continue,
                Some(bytes) => format!("has {bytes} bytes where {} were written", file.bytes),
                None => "is missing".to_owned(),
            };
            return Err(damaged(store, part.index, &file.name, &reason));
        }
    }
    let mut others = found.keys().filter(|name| name.starts_with(FRAGMENTS));
    match others.next().filter(|_| alone) {
        None => Ok(()),
        Some(name) => Err(DatasetError::invalid(
            &store.shown(name),
            "no part of the dataset has this file, and readers of the whole folder would read its rows as well; move it away",
        )),
    }
}

/// Compares the hash of a part's file with the one that was recorded.
pub(crate) fn check_hash(
    store: &dyn Store,
    index: u32,
    file: &FileEntry,
    fetched: &Fetched,
) -> Result<(), DatasetError> {
    let (_, found) = fetched.hash()?;
    if found == file.sha256 {
        return Ok(());
    }
    let expected = printable(&file.sha256);
    let reason = format!("was cut or changed: sha256 {found} where {expected} was written");
    Err(damaged(store, index, &file.name, &reason))
}

/// Whether a part of the manifest is as its writer recorded it, where there is a record. Files have hashes of their own.
pub(crate) fn is_as_recorded(store: &dyn Store, part: &Part) -> Result<bool, DatasetError> {
    let record = PartRecord::read(store, part.index, None)?;
    Ok(record.is_none_or(|record| {
        let (files, statistics) = (part.files.clone(), part.statistics.clone());
        Part {
            files,
            statistics,
            picture: None,
            ..record.part
        } == *part
    }))
}

/// The error of a part's file, with the worker that wrote it.
pub(crate) fn damaged(store: &dyn Store, index: u32, name: &str, reason: &str) -> DatasetError {
    let record = PartRecord::read(store, index, None).ok().flatten();
    let worker = record.map_or_else(|| "unknown".to_owned(), |r| r.worker);
    DatasetError::invalid(
        &store.shown(name),
        format!(
            "part {index} of worker {worker}: the file {reason}; remove it and write it again with `peelnet extract --resume` and the same command"
        ),
    )
}
