//! What lies in a dataset's folder: which files may be replaced, and what writers that died left behind.
//!
//! A file is a dataset's only by content: a manifest or a record that parses as ours lists it, with this length. Everything else is
//! foreign, and is an error, never removed.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use peelnet_files::Unfinished;
use serde::{Deserialize, Serialize};

use crate::error::DatasetError;
use crate::hashed_file::hash_file;
use crate::layout::{self, FRAGMENTS, META, OLD_MANIFEST};
use crate::manifest::Manifest;
use crate::plan::Plan;
use crate::record::PartRecord;
use crate::shard::Shard;
use crate::store::{Folder, Place, Store as _};
use crate::worker::host;

/// Prefix of the hidden folder of a writer, and of what it creates in passing.
const PARTIAL: &str = ".partial-";
/// Prefix of small files that are being written.
const PUT: &str = ".put-";
/// A file in the hidden folder that its writer holds locked, with its machine's name. It is created first and removed last.
const LOCK: &str = "lock";
/// The files of the older dataset, in the hidden folder while they are replaced.
const REPLACED: &str = "replaced.json";
/// The manifest of a dataset that replaces an older one, in the hidden folder.
const MANIFEST: &str = "manifest.json";

/// After so long without a change, a hidden folder of another machine is no living writer's: no part takes longer, and no clock is off
/// by more.
const ABANDONED_AFTER: Duration = Duration::from_hours(48);

/// So long, an empty hidden folder may be one whose writer is about to lock it.
const JUST_MADE: Duration = Duration::from_mins(1);

/// Files of a dataset and their lengths.
#[derive(Serialize, Deserialize)]
struct Lengths {
    files: BTreeMap<String, u64>,
}

/// The hidden folder of a writer that is alive. Dropping it removes the folder.
#[derive(Debug)]
pub(crate) struct Partial {
    path: PathBuf,
    _lock: Option<File>,
    _unfinished: Unfinished,
}

impl Partial {
    /// Creates and locks a hidden folder in a dataset's.
    pub(crate) fn create(folder: &Path) -> Result<Self, DatasetError> {
        let meta = folder.join(META);
        fs::create_dir_all(&meta).map_err(DatasetError::io(&meta, "create the folder"))?;
        let hidden = tempfile::Builder::new()
            .prefix(PARTIAL)
            .tempdir_in(&meta)
            .map_err(DatasetError::io(folder, "write into"))?;
        let unfinished = Unfinished::new(hidden.path());
        let lock_path = hidden.path().join(LOCK);
        // Locked before it has its name: nobody sees the folder of a living writer with a lock that is free.
        let lock = || -> std::io::Result<File> {
            let mut lock = tempfile::Builder::new().prefix(PUT).tempfile_in(&meta)?;
            lock.as_file().lock()?;
            lock.write_all(host().as_bytes())?;
            lock.persist(&lock_path).map_err(|e| e.error)
        };
        let lock = lock().map_err(DatasetError::io(&lock_path, "lock"))?;
        Ok(Self {
            // From here on it is removed in an order of ours.
            path: hidden.keep(),
            _lock: Some(lock),
            _unfinished: unfinished,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Moves every part from here into the folder, in place of an older dataset, and the manifest last.
    ///
    /// The folder has no manifest until everything is in place: whoever opens it meanwhile, or after a crash, learns that it is
    /// incomplete. After a crash the lists in the hidden folder say which files are a dataset's.
    pub(crate) fn replace(
        self,
        folder: &Path,
        plan: &Plan,
        worker: &str,
        new: &Manifest,
    ) -> Result<(), DatasetError> {
        let write = |name: &str, text: &str| {
            let path = self.path.join(name);
            fs::write(&path, text).map_err(DatasetError::io(&path, "write"))
        };
        write(MANIFEST, &new.to_json())?;
        let older = older_files(folder)?;
        let lengths = Lengths {
            files: older.data.clone(),
        };
        write(
            REPLACED,
            &serde_json::to_string(&lengths).expect("names and numbers"),
        )?;
        let data = older.data.keys().map(|name| folder.join(name));
        for path in older.control.iter().cloned().chain(data) {
            fs::remove_file(&path).map_err(DatasetError::io(&path, "replace"))?;
        }
        let store = Folder::new(folder, &self.path);
        let mut moved = Vec::new();
        for name in new.lengths().keys() {
            let target = folder.join(name);
            if let Err(error) = fs::rename(self.path.join(name), &target) {
                for path in &moved {
                    // The first error is the one to report.
                    let _ = fs::remove_file(path);
                }
                return Err(DatasetError::io(&target, "move into place")(error));
            }
            moved.push(target);
        }
        plan.agree(&store)?;
        for part in &new.parts {
            PartRecord::new(plan, worker, part.clone()).commit(&store, plan)?;
        }
        store
            .put_if_absent(layout::MANIFEST, new.to_json().as_bytes())
            .map(drop)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // Windows removes no file that is open.
        drop(self._lock.take());
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
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(e),
        _ => {}
    }
    fs::remove_dir(path)
}

/// What a folder holds of a dataset. Files that it lists and that are gone are left out.
#[derive(Debug, Default)]
struct Older {
    /// Files of rows, and their lengths.
    data: BTreeMap<String, u64>,
    /// Manifest, plan and records, in the order of their removal.
    control: Vec<PathBuf>,
}

impl Older {
    fn is_empty(&self) -> bool {
        self.control.is_empty() && self.data.is_empty()
    }
}

/// The files of the dataset in a folder.
///
/// # Errors
/// The first file in the folder that is not a dataset's.
fn older_files(folder: &Path) -> Result<Older, DatasetError> {
    let names = names_in(folder)?;
    let mut older = Older::default();
    let mut listed = BTreeMap::new();
    if names.iter().any(|n| n == OLD_MANIFEST) {
        let manifest =
            Manifest::read_old(folder).map_err(|e| not_ours(folder, OLD_MANIFEST, Some(e)))?;
        listed = manifest.lengths();
        older.control.push(folder.join(OLD_MANIFEST));
    }
    if names.iter().any(|n| n == META) {
        listed.extend(older_control(folder, &mut older.control)?);
    }
    for name in names {
        // Hidden folders: see `remove_abandoned`.
        if name == OLD_MANIFEST || name == META || name.starts_with(PARTIAL) {
            continue;
        }
        if !is_listed(folder, &name, &listed)? {
            return Err(not_ours(folder, &name, None));
        }
        let bytes = listed[&name];
        older.data.insert(name, bytes);
    }
    Ok(older)
}

/// Manifest, plan and records of a folder of schema 2, and the lengths of what they list.
fn older_control(
    folder: &Path,
    control: &mut Vec<PathBuf>,
) -> Result<BTreeMap<String, u64>, DatasetError> {
    let store = Folder::new(folder, folder);
    let meta = folder.join(META);
    if !fs::symlink_metadata(&meta).is_ok_and(|m| m.is_dir()) {
        return Err(not_ours(folder, META, None));
    }
    let refuse = |name: &str, e| not_ours(folder, name, Some(e));
    let mut listed = BTreeMap::new();
    if let Some(manifest) =
        Manifest::read_sealed(&store).map_err(|e| refuse(layout::MANIFEST, e))?
    {
        listed.extend(manifest.lengths());
        control.push(folder.join(layout::MANIFEST));
    }
    if meta.join("parts").exists() {
        for name in names_in(&meta.join("parts"))? {
            let name_in = format!("{}{name}", layout::PARTS);
            let Some(index) = layout::record_index(&name) else {
                return Err(not_ours(folder, &name_in, None));
            };
            if let Some(record) =
                PartRecord::read(&store, index, None).map_err(|e| refuse(&name_in, e))?
            {
                let files = record.part.files.into_iter();
                listed.extend(files.map(|f| (f.name, f.bytes)));
                control.push(folder.join(name_in));
            }
        }
    }
    if Plan::read(&store)
        .map_err(|e| refuse(layout::PLAN, e))?
        .is_some()
    {
        control.push(folder.join(layout::PLAN));
    }
    let known = ["plan.json", MANIFEST, "parts"];
    match names_in(&meta)?
        .iter()
        .find(|n| !known.contains(&n.as_str()) && !n.starts_with(PARTIAL) && !n.starts_with(PUT))
    {
        Some(name) => Err(not_ours(folder, &format!("{META}/{name}"), None)),
        None => Ok(listed),
    }
}

/// Whether a name is a regular file of the listed length.
fn is_listed(
    folder: &Path,
    name: &str,
    listed: &BTreeMap<String, u64>,
) -> Result<bool, DatasetError> {
    let path = folder.join(name);
    let found = fs::symlink_metadata(&path).map_err(DatasetError::io(&path, "look at"))?;
    Ok(found.is_file() && listed.get(name) == Some(&found.len()))
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
    let Place::Folder(_) = Place::of(folder)? else {
        return Ok(false);
    };
    check_not_mixed(folder, join)?;
    if !folder.is_dir() || join {
        return Ok(false);
    }
    // What a writer that died left behind is for the next writer to sort out.
    if !hidden_folders(folder)?.is_empty() {
        return Ok(false);
    }
    Ok(!older_files(folder)?.is_empty())
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
    match names.iter().find(|n| *n != META && !n.starts_with(PARTIAL)) {
        Some(found) => Err(not_ours(folder, found, None)),
        None => Ok(()),
    }
}

/// Removes what writers that died left in the folder of a dataset that is whole.
pub(crate) fn clean_dead(folder: &Path) -> Result<(), DatasetError> {
    remove_abandoned(folder).map(drop)
}

/// The hidden folders of writers, alive or not, also of earlier versions.
fn hidden_folders(folder: &Path) -> Result<Vec<PathBuf>, DatasetError> {
    let mut all = Vec::new();
    for within in [folder.to_owned(), folder.join(META)] {
        if within.is_dir() {
            let names = names_in(&within)?.into_iter();
            let names = names.filter(|n| n.starts_with(PARTIAL));
            all.extend(names.map(|n| within.join(n)));
        }
    }
    Ok(all)
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

/// Removes the hidden folders of writers that died, and what they had moved into place without coming to their end. Returns whether another
/// writer is alive.
fn remove_abandoned(folder: &Path) -> Result<bool, DatasetError> {
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
        let is_ours = inside.is_empty()
            || inside.iter().any(|n| n == LOCK)
                && inside.iter().all(|n| {
                    [LOCK, REPLACED, MANIFEST].contains(&n.as_str())
                        || n.starts_with(FRAGMENTS)
                        || n.starts_with(PUT)
                });
        if !is_ours {
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
        if inside.iter().any(|n| n == MANIFEST || n == REPLACED) {
            undo_replacing(folder, &hidden)?;
        }
        // Beside a living writer, a file without a record may be that one's.
        if !any_alive {
            remove_unrecorded(folder, &hidden, &inside)?;
        }
        match remove_partial(&hidden) {
            // Two writers cleaned up at once.
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
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

/// Removes what a writer that died had moved into place of an older dataset, and what it had left of that, unless it came to its end.
fn undo_replacing(folder: &Path, hidden: &Path) -> Result<(), DatasetError> {
    let is_whole = folder.join(OLD_MANIFEST).exists() || folder.join(layout::MANIFEST).exists();
    let replaced = hidden.join(REPLACED);
    // Before it wrote this list, it had changed nothing.
    if is_whole || !replaced.exists() {
        return Ok(());
    }
    let old: Option<Lengths> = fs::read(&replaced)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let old = match old {
        Some(lengths) => Some(lengths.files),
        None => Manifest::read_file(&replaced).ok().map(|m| m.lengths()),
    };
    let new = Manifest::read_file(&hidden.join(MANIFEST)).ok();
    for listed in [old, new.map(|m| m.lengths())].into_iter().flatten() {
        for name in listed.keys().filter(|n| layout::is_part_name(n)) {
            let path = folder.join(name);
            if path.exists() && is_listed(folder, name, &listed)? {
                fs::remove_file(&path).map_err(DatasetError::io(&path, "remove"))?;
            }
        }
    }
    let mut control = Vec::new();
    if folder.join(META).exists() {
        older_control(folder, &mut control)?;
    }
    for path in control {
        fs::remove_file(&path).map_err(DatasetError::io(&path, "remove"))?;
    }
    Ok(())
}

/// Removes the files of a part that a writer had moved into place without a record. They are still in its hidden folder, so they are known
/// by their contents.
fn remove_unrecorded(folder: &Path, hidden: &Path, inside: &[String]) -> Result<(), DatasetError> {
    if folder.join(OLD_MANIFEST).exists() || folder.join(layout::MANIFEST).exists() {
        return Ok(());
    }
    for name in inside {
        let Some(index) = layout::part_index(name) else {
            continue;
        };
        let (path, copy) = (folder.join(name), hidden.join(name));
        if !path.is_file() || folder.join(layout::record(index)).exists() {
            continue;
        }
        let hash = |path: &Path| hash_file(path).map_err(DatasetError::io(path, "read"));
        if hash(&path)? == hash(&copy)? {
            fs::remove_file(&path).map_err(DatasetError::io(&path, "remove"))?;
        }
    }
    Ok(())
}

/// Refuses folders that an earlier version wrote and that cannot be continued: shards in folders of their own, and a manifest at the top.
pub(crate) fn check_not_mixed(folder: &Path, join: bool) -> Result<(), DatasetError> {
    if !folder.is_dir() {
        return Ok(());
    }
    let mixed = |reason| {
        Err(DatasetError::Mixed {
            path: folder.to_owned(),
            reason,
        })
    };
    let names = names_in(folder)?;
    if names.iter().any(|n| Shard::from_folder(n).is_some()) {
        mixed("it holds the shards of a dataset, as an earlier version wrote them")
    } else if join && names.iter().any(|n| n == OLD_MANIFEST) {
        mixed("it holds a whole dataset of an earlier version, which cannot be continued")
    } else {
        Ok(())
    }
}

/// Creates a folder and says which of its ancestors and itself are new, outermost first.
pub(crate) fn create_folders(folder: &Path) -> Result<Vec<PathBuf>, DatasetError> {
    let mut new: Vec<PathBuf> = folder
        .ancestors()
        .take_while(|a| !a.as_os_str().is_empty() && !a.exists())
        .map(Path::to_owned)
        .collect();
    new.reverse();
    fs::create_dir_all(folder).map_err(|source| {
        remove_empty(&new);
        DatasetError::io(folder, "create the folder")(source)
    })?;
    Ok(new)
}

/// Removes folders, innermost first, as long as they are empty.
pub(crate) fn remove_empty(outermost_first: &[PathBuf]) {
    for folder in outermost_first.iter().rev() {
        // Not empty or gone: both are as they should be.
        if fs::remove_dir(folder).is_err() {
            break;
        }
    }
}

/// Removes the folders inside a dataset's folder, as long as they are empty.
pub(crate) fn remove_empty_meta(folder: &Path) {
    let meta = folder.join(META);
    remove_empty(&[meta.clone(), meta.join("parts")]);
    remove_empty(&[meta]);
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
