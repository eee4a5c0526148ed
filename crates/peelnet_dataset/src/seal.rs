//! Sealing: from the records of finished parts to the manifest, which makes them one dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::error::DatasetError;
use crate::folder;
use crate::manifest::{Manifest, to_json};
use crate::plan::Plan;
use crate::record::{self, PartRecord};
use crate::store::{FRAGMENTS, MANIFEST, PARTS, Place, Store};

/// Records that are read at a time.
const READERS: usize = 32;

/// Seals a dataset of which every part is finished: checks the parts and writes the manifest. A dataset that is sealed stays as it is, and
/// its manifest is returned. The bytes of the manifest do not depend on who seals, or when.
///
/// # Errors
/// [`DatasetError::Unsealed`] if parts are missing; an error that names part and worker if a part is of another plan, or a file of it is
/// missing, has another length, or is there twice.
pub fn seal(path: impl AsRef<Path>) -> Result<Manifest, DatasetError> {
    let path = path.as_ref();
    let place = Place::of(path)?;
    let store = place.open()?;
    let plan = Plan::read(&*store)?.ok_or_else(|| DatasetError::NoManifest {
        path: path.to_owned(),
    })?;
    let Some(manifest) = whole(&*store, &plan)? else {
        return Err(unsealed(&*store, &plan));
    };
    if let Place::Folder(folder) = &place {
        folder::remove_abandoned(folder)?;
    }
    Ok(manifest)
}

/// The error of a dataset that lacks parts, or lacks its seal alone.
pub(crate) fn unsealed(store: &dyn Store, plan: &Plan) -> DatasetError {
    match missing(store, plan) {
        Ok(missing) => DatasetError::Unsealed {
            path: store.path().to_owned(),
            missing: missing.len(),
            of: plan.header.work_items,
            first: missing.first().copied(),
        },
        Err(error) => error,
    }
}

/// How many parts of a dataset that is not sealed are finished, and how many it will have; `None` if it is sealed, or none.
///
/// # Errors
/// If it cannot be read.
pub fn unsealed_parts(path: impl AsRef<Path>) -> Result<Option<(u32, u32)>, DatasetError> {
    let store = Place::of(path.as_ref())?.store();
    let Some(plan) = Plan::read(&*store)? else {
        return Ok(None);
    };
    if Manifest::read(&*store)?.is_some() {
        return Ok(None);
    }
    let of = plan.header.work_items;
    Ok(Some((of - missing(&*store, &plan)?.len() as u32, of)))
}

/// The work items that have a record.
pub(crate) fn recorded(store: &dyn Store) -> Result<BTreeSet<u32>, DatasetError> {
    let names = store.list(PARTS)?.into_keys();
    Ok(names
        .filter_map(|name| record::index(&format!("{PARTS}{name}")))
        .collect())
}

/// The work items of a plan that lack a record.
fn missing(store: &dyn Store, plan: &Plan) -> Result<Vec<u32>, DatasetError> {
    let recorded = recorded(store)?;
    let all = 0..plan.header.work_items;
    Ok(all.filter(|k| !recorded.contains(k)).collect())
}

/// The records of all parts, read by several threads: an object store answers each after tens of milliseconds.
fn records(store: &dyn Store, plan: &Plan) -> Result<Vec<Option<PartRecord>>, DatasetError> {
    let parts: Vec<u32> = (0..plan.header.work_items).collect();
    let read = |parts: &[u32]| -> Result<Vec<_>, DatasetError> {
        let records = parts.iter();
        records
            .map(|&index| PartRecord::read(store, index, Some(plan)))
            .collect()
    };
    let mut all = Vec::with_capacity(parts.len());
    std::thread::scope(|scope| {
        let pieces = parts.chunks(parts.len().div_ceil(READERS).max(1));
        let readers: Vec<_> = pieces.map(|parts| scope.spawn(|| read(parts))).collect();
        for reader in readers {
            // In the order of the parts, so that the error is that of the first wrong one.
            let records = reader.join();
            all.extend(records.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?);
        }
        Ok(all)
    })
}

/// Writes the manifest if every part is there and it is not, and returns it; `None` if parts are missing.
pub(crate) fn whole(store: &dyn Store, plan: &Plan) -> Result<Option<Manifest>, DatasetError> {
    let wrong = |reason: &str| DatasetError::manifest(&store.shown(MANIFEST), reason);
    if let Some(manifest) = Manifest::read(store)? {
        if manifest.plan != plan.hash {
            return Err(wrong("the manifest is of another plan than plan.json"));
        }
        check_files(store, &manifest, true)?;
        return Ok(Some(manifest));
    }
    if !missing(store, plan)?.is_empty() {
        return Ok(None);
    }
    let Some(records) = records(store, plan)?
        .into_iter()
        .collect::<Option<Vec<_>>>()
    else {
        return Ok(None);
    };
    let manifest = plan.manifest(records.into_iter().map(|r| r.part).collect());
    check_files(store, &manifest, true)?;
    let checked = manifest.check();
    checked.map_err(|reason| DatasetError::manifest(&store.shown(PARTS), reason))?;
    if !store.put_if_absent(MANIFEST, to_json(&manifest).as_bytes())? {
        // Another writer came to its end at the same time.
        if Manifest::read(store)?.as_ref() != Some(&manifest) {
            return Err(wrong("the manifest that is there is of other parts"));
        }
    }
    Ok(Some(manifest))
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
            return Err(damaged(store, part.index, &file.name, reason));
        }
    }
    match found
        .keys()
        .find(|name| alone && name.starts_with(FRAGMENTS))
    {
        None => Ok(()),
        Some(name) => Err(DatasetError::Doubled {
            path: store.shown(name),
        }),
    }
}

/// The error of a part's file, with the worker that wrote it.
pub(crate) fn damaged(
    store: &dyn Store,
    index: u32,
    name: &str,
    reason: impl Into<String>,
) -> DatasetError {
    let record = PartRecord::read(store, index, None).ok().flatten();
    DatasetError::PartDamaged {
        path: store.shown(name),
        index,
        worker: record.map_or_else(|| "unknown".to_owned(), |r| r.worker),
        reason: reason.into(),
    }
}
