//! Sealing: from the records of finished parts to the manifest, which makes them one dataset.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::error::DatasetError;
use crate::folder;
use crate::layout::{self, FRAGMENTS};
use crate::manifest::Manifest;
use crate::plan::Plan;
use crate::record::PartRecord;
use crate::store::{Place, Store};

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
    if let Place::Folder(folder) = &place {
        if !folder.is_dir() {
            // The error of the system says why.
            std::fs::read_dir(folder)
                .map_err(DatasetError::io(folder, "open the dataset's folder"))?;
        }
        if folder.join(layout::OLD_MANIFEST).exists() {
            return Err(DatasetError::Usage {
                path: folder.clone(),
                reason:
                    "a dataset of schema 1 is whole once it is there, so there is nothing to seal"
                        .to_owned(),
            });
        }
    }
    let store = place.store();
    let plan = Plan::read(&*store)?.ok_or_else(|| DatasetError::NoManifest {
        path: path.to_owned(),
    })?;
    let manifest = match whole(&*store, &plan)? {
        Ok(manifest) => manifest,
        Err(missing) => return Err(unsealed(path, &plan, &missing)),
    };
    if let Place::Folder(folder) = &place {
        folder::clean_dead(folder)?;
    }
    Ok(manifest)
}

/// The error of a dataset that lacks parts, or lacks its seal alone.
pub(crate) fn unsealed(path: &Path, plan: &Plan, missing: &[u32]) -> DatasetError {
    DatasetError::Unsealed {
        path: path.to_owned(),
        missing: missing.len(),
        of: plan.work_items,
        first: missing.first().copied(),
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
    if Manifest::read_sealed(&*store)?.is_some() {
        return Ok(None);
    }
    let missing = missing(&*store, &plan)?.len() as u32;
    Ok(Some((plan.work_items - missing, plan.work_items)))
}

/// The work items that have a record.
pub(crate) fn recorded(store: &dyn Store) -> Result<BTreeSet<u32>, DatasetError> {
    let records = store.list(layout::PARTS)?;
    Ok(records
        .iter()
        .filter_map(|e| layout::record_index(&e.name))
        .collect())
}

/// The work items of a plan that lack a record.
pub(crate) fn missing(store: &dyn Store, plan: &Plan) -> Result<Vec<u32>, DatasetError> {
    let recorded = recorded(store)?;
    Ok((0..plan.work_items)
        .filter(|k| !recorded.contains(k))
        .collect())
}

/// The records of all parts, read by several threads: an object store answers each after tens of milliseconds.
fn records(store: &dyn Store, plan: &Plan) -> Result<Vec<(u32, Option<PartRecord>)>, DatasetError> {
    let parts: Vec<u32> = (0..plan.work_items).collect();
    let share = parts.len().div_ceil(READERS).max(1);
    let read = |parts: &[u32]| -> Result<Vec<_>, DatasetError> {
        let records = parts.iter();
        records
            .map(|&index| Ok((index, PartRecord::read(store, index, Some(plan))?)))
            .collect()
    };
    let mut all = Vec::with_capacity(parts.len());
    std::thread::scope(|scope| {
        let shares = parts.chunks(share);
        let readers: Vec<_> = shares.map(|parts| scope.spawn(|| read(parts))).collect();
        for reader in readers {
            // In the order of the parts, so that the error is that of the first wrong one.
            let records = reader
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            all.extend(records?);
        }
        Ok(all)
    })
}

/// Writes the manifest if every part is there, and returns it; otherwise the missing parts.
pub(crate) fn whole(
    store: &dyn Store,
    plan: &Plan,
) -> Result<Result<Manifest, Vec<u32>>, DatasetError> {
    if let Some(manifest) = Manifest::read_sealed(store)? {
        if manifest.plan != plan.hash {
            return Err(DatasetError::Manifest {
                path: store.shown(layout::MANIFEST),
                reason: "the manifest is of another plan than plan.json".to_owned(),
            });
        }
        check_files(store, &manifest, &BTreeMap::new())?;
        return Ok(Ok(manifest));
    }
    let missing = missing(store, plan)?;
    if !missing.is_empty() {
        return Ok(Err(missing));
    }
    let mut workers = BTreeMap::new();
    let mut parts = Vec::new();
    for (index, record) in records(store, plan)? {
        let Some(record) = record else {
            return Ok(Err(vec![index]));
        };
        workers.insert(index, record.worker);
        parts.push(record.part);
    }
    let manifest = plan.manifest(parts);
    check_files(store, &manifest, &workers)?;
    manifest.check().map_err(|reason| DatasetError::Manifest {
        path: store.shown(layout::PARTS),
        reason,
    })?;
    if !store.put_if_absent(layout::MANIFEST, manifest.to_json().as_bytes())? {
        // Another writer came to its end at the same time.
        let there = Manifest::read_sealed(store)?;
        if there.as_ref() != Some(&manifest) {
            return Err(DatasetError::Manifest {
                path: store.shown(layout::MANIFEST),
                reason: "the manifest that is there is of other parts".to_owned(),
            });
        }
    }
    Ok(Ok(manifest))
}

/// Every file of the parts must be there with its length, and no other file of rows beside them.
fn check_files(
    store: &dyn Store,
    manifest: &Manifest,
    workers: &BTreeMap<u32, String>,
) -> Result<(), DatasetError> {
    let found: BTreeMap<String, u64> = store
        .list("")?
        .into_iter()
        .map(|e| (e.name, e.bytes))
        .collect();
    let mut listed = BTreeSet::new();
    for part in &manifest.parts {
        for file in &part.files {
            listed.insert(file.name.as_str());
            let reason = match found.get(&file.name) {
                Some(&bytes) if bytes == file.bytes => continue,
                Some(bytes) => format!("has {bytes} bytes where {} were written", file.bytes),
                None => "is missing".to_owned(),
            };
            let worker = match workers.get(&part.index) {
                Some(worker) => Some(worker.clone()),
                None => PartRecord::read(store, part.index, None)?.map(|r| r.worker),
            };
            return Err(DatasetError::PartDamaged {
                path: store.shown(&file.name),
                index: part.index,
                worker: worker.unwrap_or_else(|| "unknown".to_owned()),
                reason,
            });
        }
    }
    let is_extra = |name: &&String| name.starts_with(FRAGMENTS) && !listed.contains(name.as_str());
    match found.keys().find(is_extra) {
        None => Ok(()),
        Some(name) => Err(DatasetError::Doubled {
            path: store.shown(name),
        }),
    }
}
