//! What lies in a dataset's folder: which files may be replaced, and what writers that died left behind.
//!
//! A file is a dataset's only by content: a manifest or a record that parses as ours lists it, with this length. Everything else is
//! foreign, and is an error, never removed.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use peelnet_files::Unfinished;

use crate::error::DatasetError;
use crate::formats::hash_file;
use crate::manifest::{FileEntry, Manifest};
use crate::plan::{Plan, host};
use crate::record::{self, PartRecord};
use crate::store::{FRAGMENTS, Folder, MANIFEST, META, PLAN, Place};

/// Prefix of the hidden folder of a writer.
const PARTIAL: &str = ".partial-";
/// Prefix of small files that are being written.
pub(crate) const PUT: &str = ".put-";
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
    path: PathBuf,
    /// Of a folder inside the dataset's.
    lock: Option<File>,
    _unfinished: Unfinished,
}

impl Partial {
    /// Creates and locks a hidden folder in a dataset's.
    pub(crate) fn hidden(folder: &Path) -> Result<Self, DatasetError> {
        let meta = folder.join(META);
        fs::create_dir_all(&meta).map_err(DatasetError::io(&meta, "create the folder"))?;
        let builder = tempfile::Builder::new().prefix(PARTIAL).tempdir_in(&meta);
        let hidden = builder.map_err(DatasetError::io(folder, "write into"))?;
        let _unfinished = Unfinished::new(hidden.path());
        let lock_path = hidden.path().join(LOCK);
        // Locked before it has its name: nobody sees the folder of a living writer with a lock that is free.
        let lock = || -> std::io::Result<File> {
            let mut lock = tempfile::Builder::new().prefix(PUT).tempfile_in(&meta)?;
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
        })
    }

    /// Creates a folder on this machine, for a dataset on another one.
    pub(crate) fn local() -> Result<Self, DatasetError> {
        let folder = tempfile::tempdir().map_err(DatasetError::io(
            &std::env::temp_dir(),
            "create a temporary folder",
        ))?;
        Ok(Self {
            _unfinished: Unfinished::new(folder.path()),
            path: folder.keep(),
            lock: None,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn is_hidden(&self) -> bool {
        self.lock.is_some()
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

/// The files of the dataset in a folder, in an order in which they can be removed: those that list others last.
///
/// # Errors
/// The first file in the folder that is not a dataset's.
fn older_files(folder: &Path) -> Result<Vec<PathBuf>, DatasetError> {
    let mut control = Vec::new();
    let mut listed: BTreeMap<String, u64> = BTreeMap::new();
    let mut list =
        |files: Vec<FileEntry>| listed.extend(files.into_iter().map(|f| (f.name, f.bytes)));
    let store = Folder::new(folder, folder);
    for name in control_names(folder)? {
        let refuse = |e| not_ours(folder, &name, Some(e));
        if name == PLAN {
            Plan::read(&store).map_err(refuse)?;
        } else if name == MANIFEST {
            let manifest = Manifest::read(&store).map_err(refuse)?;
            let parts = manifest.into_iter().flat_map(|m| m.parts);
            parts.for_each(|part| list(part.files));
        } else if let Some(index) = record::index(&name) {
            let record = PartRecord::read(&store, index, None).map_err(refuse)?;
            record.into_iter().for_each(|r| list(r.part.files));
        } else {
            return Err(not_ours(folder, &name, None));
        }
        control.push(folder.join(name));
    }
    let mut files = Vec::new();
    for name in names_in(folder)?.into_iter().filter(|n| n != META) {
        let path = folder.join(&name);
        let found = fs::symlink_metadata(&path).map_err(DatasetError::io(&path, "look at"))?;
        if !found.is_file() || listed.get(&name) != Some(&found.len()) {
            return Err(not_ours(folder, &name, None));
        }
        files.push(path);
    }
    files.extend(control.into_iter().rev());
    Ok(files)
}

/// Names of what lies in `_peelnet/`, sorted, without what living writers have there.
fn control_names(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let mut names = Vec::new();
    for meta in [META.to_owned(), format!("{META}/parts")] {
        match fs::symlink_metadata(folder.join(&meta)) {
            Err(e) if e.kind() == ErrorKind::NotFound => continue,
            Ok(found) if found.is_dir() => {}
            _ => return Err(not_ours(folder, &meta, None)),
        }
        let inside = names_in(&folder.join(&meta))?.into_iter();
        let inside = inside.filter(|n| !n.starts_with(PARTIAL) && !n.starts_with(PUT));
        names.extend(inside.map(|n| format!("{meta}/{n}")));
    }
    names.retain(|n| *n != format!("{META}/parts"));
    names.sort();
    Ok(names)
}

fn not_ours(folder: &Path, found: &str, why: Option<DatasetError>) -> DatasetError {
    DatasetError::NotOurs {
        path: folder.to_owned(),
        found: found.to_owned(),
        source: why.map(Box::new),
    }
}

/// Whether a whole dataset that is written into a folder replaces an older one. Nothing is changed: for a look before work begins. With
/// `join`, which is what shards and `--resume` do, nothing is replaced.
///
/// # Errors
/// Those of [`DatasetWriter::create`](crate::DatasetWriter::create) for the folder.
pub fn replaces(folder: &Path, join: bool) -> Result<bool, DatasetError> {
    // An object store's dataset is never replaced.
    let Place::Folder(folder) = Place::of(folder)? else {
        return Ok(false);
    };
    // What a writer that died left behind is for the next writer to sort out.
    if !folder.is_dir() || join || !hidden_folders(&folder)?.is_empty() {
        return Ok(false);
    }
    Ok(!older_files(&folder)?.is_empty())
}

/// Prepares a folder for a whole dataset: removes what writers that died left in it. Returns whether there is an older dataset.
///
/// # Errors
/// A foreign file, or a writer that is alive.
pub(crate) fn prepare(folder: &Path) -> Result<bool, DatasetError> {
    if remove_abandoned(folder)? {
        return Err(DatasetError::Busy {
            path: folder.to_owned(),
        });
    }
    Ok(!older_files(folder)?.is_empty())
}

/// Removes the older dataset.
///
/// # Errors
/// A file that came meanwhile and is foreign, before anything is removed.
pub(crate) fn remove_older(folder: &Path) -> Result<(), DatasetError> {
    for path in older_files(folder)? {
        fs::remove_file(&path).map_err(DatasetError::io(&path, "replace"))?;
    }
    Ok(())
}

/// Prepares a folder for one of several writers of a dataset.
///
/// # Errors
/// A foreign file where there is no dataset yet.
pub(crate) fn prepare_to_join(folder: &Path) -> Result<(), DatasetError> {
    remove_abandoned(folder)?;
    // First the names, then the plan: whatever another writer created before its plan is ours.
    let names = names_in(folder)?;
    if Plan::read(&Folder::new(folder, folder))?.is_some() {
        return Ok(());
    }
    match names.iter().find(|n| *n != META) {
        Some(found) => Err(not_ours(folder, found, None)),
        None => Ok(()),
    }
}

/// The hidden folders of writers, alive or not.
fn hidden_folders(folder: &Path) -> Result<Vec<PathBuf>, DatasetError> {
    let meta = folder.join(META);
    if !meta.is_dir() {
        return Ok(Vec::new());
    }
    let names = names_in(&meta)?.into_iter();
    let names = names.filter(|n| n.starts_with(PARTIAL));
    Ok(names.map(|n| meta.join(n)).collect())
}

/// Whether a hidden folder's writer may be alive.
fn is_alive(hidden: &Path) -> bool {
    let lock = hidden.join(LOCK);
    let is_locked = peelnet_files::open(&lock)
        .is_ok_and(|lock| matches!(lock.try_lock(), Err(fs::TryLockError::WouldBlock)));
    if is_locked {
        return true;
    }
    // Locks of network file systems need not reach other machines.
    let of_this_host = peelnet_files::read_head(&lock, 1 << 10)
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
    for hidden in hidden_folders(folder)? {
        let Ok(inside) = names_in(&hidden) else {
            // Its writer came to its end between the two looks.
            continue;
        };
        if inside.is_empty() && is_younger(&hidden, JUST_MADE) {
            continue;
        }
        let is_known = |n: &String| n == LOCK || n.starts_with(FRAGMENTS) || n.starts_with(PUT);
        let has_lock = inside.is_empty() || inside.iter().any(|n| n == LOCK);
        if !has_lock || !inside.iter().all(is_known) {
            let name = hidden.strip_prefix(folder).unwrap_or(&hidden);
            return Err(not_ours(folder, &name.to_string_lossy(), None));
        }
        if is_alive(&hidden) {
            any_alive = true;
        } else {
            dead.push((hidden, inside));
        }
    }
    remove_old_puts(folder)?;
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

/// Removes small files of writers that were killed while they created these.
fn remove_old_puts(folder: &Path) -> Result<(), DatasetError> {
    let meta = folder.join(META);
    if !meta.is_dir() {
        return Ok(());
    }
    for name in names_in(&meta)?.iter().filter(|n| n.starts_with(PUT)) {
        let path = meta.join(name);
        if path.is_file() && !is_younger(&path, ABANDONED_AFTER) {
            // Another writer may have done it.
            let _ = fs::remove_file(&path);
        }
    }
    Ok(())
}

/// Removes the files of a part that a writer had moved into place without a record. They are still in its hidden folder, so they are known
/// by their contents.
fn remove_unrecorded(folder: &Path, hidden: &Path, inside: &[String]) -> Result<(), DatasetError> {
    if folder.join(MANIFEST).exists() {
        return Ok(());
    }
    for name in inside {
        let Some(index) = record::part_index(name) else {
            continue;
        };
        let (path, copy) = (folder.join(name), hidden.join(name));
        if !path.is_file() || folder.join(record::name(index)).exists() {
            continue;
        }
        let hash = |path: &Path| hash_file(path).map_err(DatasetError::io(path, "read"));
        if hash(&path)? == hash(&copy)? {
            fs::remove_file(&path).map_err(DatasetError::io(&path, "remove"))?;
        }
    }
    Ok(())
}

/// A dataset's folder with those around it that a writer made: dropping it removes what is still empty of them.
#[derive(Debug)]
pub(crate) struct MadeFolders {
    /// Outermost first.
    folders: Vec<PathBuf>,
}

impl MadeFolders {
    /// Creates a folder, and what is missing of those around it.
    pub(crate) fn create(folder: &Path) -> Result<Self, DatasetError> {
        let is_new = |a: &&Path| !a.as_os_str().is_empty() && !a.exists();
        let new = folder.ancestors().take_while(is_new);
        let mut folders: Vec<PathBuf> = new.map(Path::to_owned).collect();
        folders.reverse();
        folders.extend([folder.join(META), folder.join(META).join("parts")]);
        let made = Self { folders };
        fs::create_dir_all(folder).map_err(DatasetError::io(folder, "create the folder"))?;
        Ok(made)
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in self.folders.iter().rev() {
            // Not empty or gone: both are as they should be.
            let _ = fs::remove_dir(folder);
        }
    }
}

fn names_in(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(DatasetError::io(folder, "list"))? {
        let entry = entry.map_err(DatasetError::io(folder, "list"))?;
        names.push(entry.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
