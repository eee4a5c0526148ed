//! What lies in a dataset's folder: which files may be replaced, and what writers that died left behind.
//!
//! A file is a dataset's only by content: a manifest or a record that parses as ours lists it, with these bytes. Everything else is
//! foreign, and is an error, never removed.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use peelnet_core::files::{Found, Unfinished, check_outside_datasets};

use crate::error::DatasetError;
use crate::hash::hash_file;
use crate::manifest::Manifest;
use crate::parts::{PartRecord, part_of_file};
use crate::plan::{Plan, host};
use crate::store::{
    FRAGMENTS, Folder, MANIFEST, META, PARTIAL, PARTS, PLAN, is_absent, names_in, store_at,
};

/// A file in the hidden folder that its writer holds locked, with its machine's name. It is created first and removed last.
const LOCK: &str = "lock";

/// After so long without a change, a hidden folder of another machine is no living writer's: no part takes longer, and no clock is off
/// by more.
const ABANDONED_AFTER: Duration = Duration::from_hours(48);

/// So long, an empty hidden folder may be one whose writer is about to lock it.
const JUST_MADE: Duration = Duration::from_mins(1);

/// Where a writer that is alive has parts until they are finished. Dropping it removes the folder.
#[derive(Debug)]
pub(crate) struct Partial {
    pub path: PathBuf,
    lock: Option<File>,
    _unfinished: Unfinished,
    _created: CreatedFolders,
}

/// Folders that a writer created, innermost first. Dropping it removes those that are still empty.
#[derive(Debug)]
struct CreatedFolders(Vec<PathBuf>);

impl Drop for CreatedFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            // Not empty or gone: both are as they should be.
            let _ = fs::remove_dir(folder);
        }
    }
}

impl Partial {
    /// Creates and locks a hidden folder in a dataset's folder, which is created where it is missing.
    pub(crate) fn in_dataset(folder: &Path) -> Result<Self, DatasetError> {
        let meta = folder.join(META);
        let is_new = |a: &&Path| !a.as_os_str().is_empty() && !a.exists();
        let mut created = vec![meta.join("parts"), meta.clone()];
        let new = folder.ancestors().take_while(is_new);
        created.extend(new.map(Path::to_owned));
        let created = CreatedFolders(created);
        fs::create_dir_all(&meta).map_err(DatasetError::io(folder, "create the folder"))?;
        Self::create(&meta, created)
    }

    /// On this machine, for a dataset on another one.
    pub(crate) fn temporary() -> Result<Self, DatasetError> {
        Self::create(&std::env::temp_dir(), CreatedFolders(Vec::new()))
    }

    fn create(parent: &Path, _created: CreatedFolders) -> Result<Self, DatasetError> {
        let hidden = tempfile::Builder::new().prefix(PARTIAL).tempdir_in(parent);
        let hidden = hidden.map_err(DatasetError::io(parent, "write into"))?;
        let _unfinished = Unfinished::new(hidden.path());
        let lock_path = hidden.path().join(LOCK);
        // Locked before it has its name: nobody sees the folder of a living writer with a lock that is free.
        let lock = || -> std::io::Result<File> {
            let mut lock = tempfile::Builder::new()
                .prefix(PARTIAL)
                .tempfile_in(parent)?;
            lock.as_file().lock()?;
            lock.write_all(host().as_bytes())?;
            lock.persist(&lock_path).map_err(|e| e.error)
        };
        let lock = Some(lock().map_err(DatasetError::io(&lock_path, "lock"))?);
        Ok(Self {
            // From here on it is removed in an order of ours.
            path: hidden.keep(),
            lock,
            _unfinished,
            _created,
        })
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // Windows removes no file that is open.
        drop(self.lock.take());
        // Where it cannot be removed, the next writer does it.
        let _ = remove_partial(&self.path);
    }
}

/// Removes a hidden folder, its lock last: as long as there is anything in it, the lock says whose it is.
fn remove_partial(path: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(path)? {
        let entry = entry?;
        if entry.file_name() != LOCK {
            fs::remove_file(entry.path())?;
        }
    }
    match fs::remove_file(path.join(LOCK)) {
        Err(e) if e.kind() != ErrorKind::NotFound => return Err(e),
        _ => {}
    }
    fs::remove_dir(path)
}

/// The files of the dataset in a folder, in an order in which they can be removed: those that list others last. What living writers have
/// in `_peelnet/` is left out. The first file in the folder that is not a dataset's is an error, and so is one that is read-only.
pub(crate) fn older_files(folder: &Path) -> Result<Vec<Found>, DatasetError> {
    let store = Folder {
        path: folder.to_owned(),
        scratch: None,
    };
    let mut control = Vec::new();
    for meta in [META, PARTS] {
        match fs::symlink_metadata(folder.join(meta)) {
            Err(e) if is_absent(&e) => continue,
            Ok(found) if found.is_dir() => {}
            _ => return Err(not_ours(folder, meta, None)),
        }
        let inside = names_in(&folder.join(meta))?.into_iter();
        let inside = inside.filter(|name| !name.starts_with(PARTIAL));
        control.extend(inside.map(|name| format!("{meta}/{name}")));
    }
    control.retain(|name| name != PARTS);
    control.sort();
    let mut listed: BTreeMap<String, (u64, String)> = BTreeMap::new();
    let (mut plan, mut card, mut recorded) = (None, None, Vec::new());
    for name in &control {
        let parts = if name == PLAN {
            let read = Plan::read(&store).map(|found| plan = found);
            read.map(|()| Vec::new())
        } else if name == MANIFEST {
            let read = Manifest::read(&store);
            read.map(|m| {
                m.map_or(Vec::new(), |m| {
                    card = Some(m.card);
                    m.parts
                })
            })
        } else if let Some(index) = PartRecord::index(name) {
            let record = PartRecord::read(&store, index, None);
            let part = record.map(|r| r.map(|r| r.part));
            recorded.extend(part.iter().flatten().cloned());
            part.map(|part| part.into_iter().collect())
        } else {
            return Err(not_ours(folder, name, None));
        };
        let parts = parts.map_err(|why| not_ours(folder, name, Some(why)))?;
        let files = parts.into_iter().flat_map(|part| part.files);
        listed.extend(files.map(|f| (f.name, (f.bytes, f.sha256))));
    }
    // The card is written right before the manifest: a writer may have died between the two.
    let card = card.or_else(|| plan.map(|plan| plan.manifest(recorded).card));
    let card = card.into_iter().flatten();
    listed.extend(card.map(|f| (f.name, (f.bytes, f.sha256))));
    let mut files = Vec::new();
    for name in names_in(folder)?.into_iter().filter(|n| n != META) {
        let path = folder.join(&name);
        let found = fs::symlink_metadata(&path).map_err(DatasetError::io(&path, "look at"))?;
        // Before it is hashed, which takes as long as it is large.
        let as_it_is = Found::look(&path);
        let is_as_listed = |own: &(u64, String)| {
            own.0 == found.len() && hash_file(&path).is_ok_and(|hash| hash == *own)
        };
        let own = listed.get(&name);
        if own.is_none() && part_of_file(&name).is_some() && folder.join(PLAN).exists() {
            let reason = "has no record, so an extraction may have stopped here; go on with the same command and `--resume`, or move this file away";
            return Err(DatasetError::invalid(&path, reason));
        }
        if !found.is_file() || !own.is_some_and(is_as_listed) {
            return Err(not_ours(folder, &name, None));
        }
        files.push(as_it_is.map_err(DatasetError::io(&path, "look at"))?);
    }
    for name in control.iter().rev() {
        let path = folder.join(name);
        files.push(Found::look(&path).map_err(DatasetError::io(&path, "look at"))?);
    }
    let folders = ["", META, PARTS].map(|name| folder.join(name));
    let folders = folders.iter().map(PathBuf::as_path);
    let is_locked = |path: &&Path| fs::metadata(path).is_ok_and(|m| m.permissions().readonly());
    if let Some(locked) = files.iter().map(Found::path).chain(folders).find(is_locked) {
        let reason = "is read-only, so the dataset is not replaced; choose another folder, or let the file be written";
        return Err(DatasetError::invalid(locked, reason));
    }
    Ok(files)
}

/// The output folder holds something else; or why a manifest in it is not one.
fn not_ours(folder: &Path, found: &str, why: Option<DatasetError>) -> DatasetError {
    let why = why.map_or(String::new(), |why| format!(": {why}"));
    let reason = format!(
        "the folder is not empty, and {found:?} in it is not a file of a dataset as its manifest lists it; choose another folder, or move that file away{why}"
    );
    DatasetError::invalid(folder, reason)
}

/// Whether a whole dataset that is written into a folder replaces an older one. Nothing is changed: for a look before work begins. With
/// `join`, which is what shards and `--resume` do, nothing is replaced.
///
/// # Errors
/// Those of [`DatasetWriter::create`](crate::DatasetWriter::create) for the folder.
pub fn replaces(folder: &Path, join: bool) -> Result<bool, DatasetError> {
    let store = store_at(folder)?;
    let Some(folder) = store.folder().filter(|f| !join && f.is_dir()) else {
        return Ok(false);
    };
    // What a writer that died left behind is for the next writer to sort out.
    Ok(hidden_names(folder)?.is_empty() && !older_files(folder)?.is_empty())
}

/// Prepares a folder for a writer: removes what writers that died left in it. Returns whether there is an older dataset that a writer of a
/// whole one is going to replace; one that joins replaces nothing. A foreign file is an error, and for a whole dataset a living writer.
pub(crate) fn prepare(folder: &Path, joins: bool) -> Result<bool, DatasetError> {
    check_outside_datasets(folder).map_err(|e| DatasetError::invalid(folder, e.to_string()))?;
    let mut metas = [META, PARTS].into_iter();
    if let Some(link) = metas.find(|meta| folder.join(meta).is_symlink()) {
        return Err(not_ours(folder, link, None));
    }
    let any_alive = remove_abandoned(folder)?;
    if !joins {
        return match any_alive {
            true => Err(DatasetError::busy(folder)),
            false => Ok(!older_files(folder)?.is_empty()),
        };
    }
    // First the names, then the plan: whatever another writer created before its plan is ours.
    let names = names_in(folder)?;
    let found = names.iter().find(|n| *n != META);
    match found.filter(|_| !folder.join(PLAN).exists()) {
        Some(found) => Err(not_ours(folder, found, None)),
        None => Ok(false),
    }
}

/// Names in `_peelnet/` of what writers have there, alive or not.
fn hidden_names(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let mut names = names_in(&folder.join(META))?;
    names.retain(|n| n.starts_with(PARTIAL));
    Ok(names)
}

/// Whether a hidden folder's writer may be alive.
fn is_alive(hidden: &Path) -> bool {
    let lock = hidden.join(LOCK);
    let is_locked = peelnet_core::files::open(&lock)
        .is_ok_and(|lock| matches!(lock.try_lock(), Err(fs::TryLockError::WouldBlock)));
    if is_locked {
        return true;
    }
    // Locks of network file systems need not reach other machines.
    let of_this_host = peelnet_core::files::read_head(&lock, 1 << 10)
        .is_ok_and(|name| name.is_empty() || name == host().as_bytes());
    !of_this_host && lock.exists() && is_younger(hidden, ABANDONED_AFTER)
}

/// Whether a file or folder changed within this time. Where clocks differ, the future is young.
fn is_younger(path: &Path, than: Duration) -> bool {
    let changed = fs::metadata(path).and_then(|m| m.modified()).ok();
    changed.is_some_and(|t| t.elapsed().map_or(true, |past| past < than))
}

/// Removes the hidden folders of writers that died, and what they had moved into place without a record. Returns whether another writer is
/// alive.
pub(crate) fn remove_abandoned(folder: &Path) -> Result<bool, DatasetError> {
    let mut dead = Vec::new();
    let mut any_alive = false;
    for name in hidden_names(folder)? {
        let hidden = folder.join(META).join(&name);
        if hidden.is_symlink() {
            let reason = "is a link, which no writer makes; remove it";
            return Err(DatasetError::invalid(&hidden, reason));
        }
        if hidden.is_file() {
            // A writer was killed while it created this one; another one may have removed it.
            if !is_younger(&hidden, ABANDONED_AFTER) {
                let _ = fs::remove_file(&hidden);
            }
            continue;
        }
        let inside = names_in(&hidden)?;
        // Just made, or its writer came to its end meanwhile.
        if inside.is_empty() && (is_younger(&hidden, JUST_MADE) || !hidden.is_dir()) {
            continue;
        }
        let starts = [FRAGMENTS, PARTIAL];
        let is_known = |n: &String| n == LOCK || starts.iter().any(|start| n.starts_with(start));
        let has_lock = inside.is_empty() || inside.iter().any(|n| n == LOCK);
        if !has_lock || !inside.iter().all(is_known) {
            return Err(not_ours(folder, &format!("{META}/{name}"), None));
        }
        if is_alive(&hidden) {
            any_alive = true;
        } else {
            dead.push((hidden, inside));
        }
    }
    for (hidden, inside) in dead {
        // Beside a living writer, a file without a record may be that one's.
        if !any_alive {
            remove_unrecorded(folder, &hidden, &inside)?;
        }
        match remove_partial(&hidden) {
            // Two writers cleaned up at once.
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            other => other.map_err(DatasetError::io(&hidden, "remove"))?,
        }
    }
    Ok(any_alive)
}

/// Removes the files of a part that a writer had moved into place without a record. They are still in its hidden folder, so they are known
/// by their contents.
fn remove_unrecorded(folder: &Path, hidden: &Path, inside: &[String]) -> Result<(), DatasetError> {
    if folder.join(MANIFEST).exists() {
        return Ok(());
    }
    for name in inside {
        let Some(index) = part_of_file(name) else {
            continue;
        };
        let (path, copy) = (folder.join(name), hidden.join(name));
        if !path.is_file() || folder.join(PartRecord::name(index)).exists() {
            continue;
        }
        let hash = |path: &Path| hash_file(path).map_err(DatasetError::io(path, "read"));
        if hash(&path)? == hash(&copy)? {
            fs::remove_file(&path).map_err(DatasetError::io(&path, "remove"))?;
        }
    }
    Ok(())
}
