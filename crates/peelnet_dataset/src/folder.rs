//! What lies in a dataset's folder: which files may be replaced, and what writers that died left behind.
//!
//! A file is a dataset's only by content: a manifest that parses as ours lists it, with this length. Everything else is foreign, and is
//! an error, never removed.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use peelnet_files::Unfinished;

use crate::error::DatasetError;
use crate::manifest::{self, FRAGMENTS, Manifest};
use crate::shard::Shard;

/// Prefix of the hidden folder that holds a dataset while it is written.
const PARTIAL: &str = ".partial-";
/// A file in it that its writer holds locked. It is created first and removed last.
const LOCK: &str = "lock";
/// The manifest of the older dataset, in the hidden folder while its files are replaced.
const REPLACED: &str = "replaced.json";

/// The hidden folder of a writer that is alive. Dropping it removes the folder.
#[derive(Debug)]
pub(crate) struct Partial {
    path: PathBuf,
    _lock: File,
    _unfinished: Unfinished,
}

impl Partial {
    /// Creates and locks a hidden folder.
    pub(crate) fn create(folder: &Path) -> Result<Self, DatasetError> {
        let hidden = tempfile::Builder::new()
            .prefix(PARTIAL)
            .tempdir_in(folder)
            .map_err(DatasetError::io(folder, "write into"))?;
        let unfinished = Unfinished::new(hidden.path());
        let lock_path = hidden.path().join(LOCK);
        let lock = File::create_new(&lock_path)
            .and_then(|lock| lock.lock().map(|()| lock))
            .map_err(DatasetError::io(&lock_path, "lock"))?;
        Ok(Self {
            // From here on it is removed in an order of ours.
            path: hidden.keep(),
            _lock: lock,
            _unfinished: unfinished,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Moves everything that the manifest lists, and the manifest last, into the folder, in place of an older dataset.
    ///
    /// The folder has no manifest until everything is in place: whoever opens it meanwhile, or after a crash, learns that it is
    /// incomplete. After a crash the manifests in the hidden folder say which files are a dataset's.
    pub(crate) fn move_into(self, folder: &Path, new: &Manifest) -> Result<(), DatasetError> {
        let older = older_files(folder)?;
        let manifest = folder.join(manifest::FILE_NAME);
        if manifest.exists() {
            fs::rename(&manifest, self.path.join(REPLACED))
                .map_err(DatasetError::io(&manifest, "replace"))?;
        }
        for path in older {
            fs::remove_file(&path).map_err(DatasetError::io(&path, "replace"))?;
        }
        let mut moved = Vec::new();
        for name in new.file_names().chain([manifest::FILE_NAME]) {
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
        Ok(())
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
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

/// The files of the dataset in a folder. Files that it lists and that are gone are left out.
///
/// # Errors
/// The first file in the folder that is not a dataset's.
fn older_files(folder: &Path) -> Result<Vec<PathBuf>, DatasetError> {
    let names = names_in(folder)?;
    let mut listed = BTreeMap::new();
    if names.iter().any(|n| n == manifest::FILE_NAME) {
        let manifest =
            Manifest::read(folder).map_err(|e| not_ours(folder, manifest::FILE_NAME, Some(e)))?;
        listed = manifest.lengths();
    }
    let mut files = Vec::new();
    for name in names {
        // Hidden folders: see `remove_abandoned`.
        if name == manifest::FILE_NAME || name.starts_with(PARTIAL) {
            continue;
        }
        if !is_listed(folder, &name, &listed)? {
            return Err(not_ours(folder, &name, None));
        }
        files.push(folder.join(name));
    }
    Ok(files)
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

/// Whether a dataset that is written into a folder replaces an older one. Nothing is changed: for a look before work begins.
///
/// # Errors
/// Those of [`DatasetWriter::create`](crate::DatasetWriter::create) for the folder.
pub fn replaces(folder: &Path, shard: Option<Shard>) -> Result<bool, DatasetError> {
    check_not_mixed(folder, shard)?;
    let folder = shard.map_or_else(|| folder.to_owned(), |s| folder.join(s.folder()));
    if !folder.is_dir() {
        return Ok(false);
    }
    // What a writer that died left behind is for the next writer to sort out.
    if names_in(&folder)?.iter().any(|n| n.starts_with(PARTIAL)) {
        return Ok(false);
    }
    older_files(&folder)?;
    Ok(folder.join(manifest::FILE_NAME).exists())
}

/// Refuses a folder that holds anything but a dataset, and removes what writers that died left in it.
///
/// # Errors
/// A foreign file, or a writer that is alive.
pub(crate) fn prepare(folder: &Path) -> Result<(), DatasetError> {
    remove_abandoned(folder)?;
    older_files(folder).map(drop)
}

/// Removes the hidden folders of writers that died, and what they had moved into place without coming to their end; refuses if one is
/// alive.
fn remove_abandoned(folder: &Path) -> Result<(), DatasetError> {
    let names = names_in(folder)?;
    let is_whole = names.iter().any(|n| n == manifest::FILE_NAME);
    for name in names.iter().filter(|n| n.starts_with(PARTIAL)) {
        let abandoned = folder.join(name);
        let inside = names_in(&abandoned)?;
        let is_ours = inside.is_empty()
            || inside.iter().any(|n| n == LOCK)
                && inside.iter().all(|n| {
                    [LOCK, REPLACED, manifest::FILE_NAME].contains(&n.as_str())
                        || n.starts_with(FRAGMENTS)
                });
        if !is_ours {
            return Err(not_ours(folder, name, None));
        }
        let alive = peelnet_files::open(&abandoned.join(LOCK))
            .is_ok_and(|lock| matches!(lock.try_lock(), Err(fs::TryLockError::WouldBlock)));
        if alive {
            return Err(DatasetError::Busy {
                path: folder.to_owned(),
            });
        }
        if !is_whole {
            for list in [REPLACED, manifest::FILE_NAME] {
                // Without a list, nothing had been moved or removed.
                let Ok(manifest) = Manifest::read_file(&abandoned.join(list)) else {
                    continue;
                };
                let listed = manifest.lengths();
                for name in listed.keys().filter(|n| names.contains(n)) {
                    let path = folder.join(name);
                    if path.exists() && is_listed(folder, name, &listed)? {
                        fs::remove_file(&path).map_err(DatasetError::io(&path, "remove"))?;
                    }
                }
            }
        }
        remove_partial(&abandoned).map_err(DatasetError::io(&abandoned, "remove"))?;
    }
    Ok(())
}

/// Refuses to put shards beside a whole dataset, a whole dataset beside shards, or shards of different N together.
pub(crate) fn check_not_mixed(folder: &Path, shard: Option<Shard>) -> Result<(), DatasetError> {
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
    let present: Vec<Shard> = names.iter().filter_map(|n| Shard::from_folder(n)).collect();
    match shard {
        None if !present.is_empty() => mixed("it holds the shards of a dataset"),
        Some(_) if names.iter().any(|n| n == manifest::FILE_NAME) => {
            mixed("it holds a whole dataset, not shards")
        }
        Some(shard) if present.iter().any(|s| s.of != shard.of) => {
            mixed("it holds shards of a dataset with another number of shards")
        }
        Some(_) => match names.iter().find(|n| Shard::from_folder(n).is_none()) {
            Some(found) => Err(not_ours(folder, found, None)),
            None => Ok(()),
        },
        None => Ok(()),
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

fn names_in(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(DatasetError::io(folder, "list"))? {
        let entry = entry.map_err(DatasetError::io(folder, "list"))?;
        names.push(entry.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
