//! Where a dataset lies that several writers share: a few operations that folders and object stores both have.
//!
//! Nothing here needs a lock or a clock: whoever creates a name first has it, and everyone else learns that it is taken.
//!
//! Folders are done with the standard library. `object_store`'s `LocalFileSystem` would bring a runtime into every build, take a part
//! through memory to create its file where here a name is linked, leave files without an owner beside the rows when its process is
//! killed, and fail where there are no hard links.

#[cfg(feature = "object-store")]
mod remote;

use std::collections::BTreeMap;
use std::fmt;
use std::fs::{self, File};
use std::io::{Error, ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(crate) use peelnet_core::files::META;
use peelnet_core::files::is_remote;

use crate::error::DatasetError;
use crate::hash::hash_file;

/// What all writers agree on.
pub(crate) const PLAN: &str = "_peelnet/plan.json";
/// The manifest of a sealed dataset.
pub(crate) const MANIFEST: &str = "_peelnet/manifest.json";
/// The records of finished parts.
pub(crate) const PARTS: &str = "_peelnet/parts";
/// Prefix of what a writer has in `_peelnet/` until it is finished: a hidden folder with parts, and
/// small files.
pub(crate) const PARTIAL: &str = ".partial-";
/// Prefix of all parts' file names.
pub(crate) const FRAGMENTS: &str = "fragments-";

/// A file on this machine with a store's contents: removed when it is dropped, if it is a copy.
#[derive(Debug)]
pub(crate) struct Fetched {
    path: PathBuf,
    /// The name in the store, for messages.
    pub shown: PathBuf,
    _copy: Option<(tempfile::TempPath, peelnet_core::files::Unfinished)>,
}

impl Fetched {
    pub(crate) fn open(&self) -> Result<File, DatasetError> {
        peelnet_core::files::open(&self.path).map_err(DatasetError::io(&self.shown, "open"))
    }

    /// Length and sha256.
    pub(crate) fn hash(&self) -> Result<(u64, String), DatasetError> {
        hash_file(&self.path).map_err(DatasetError::io(&self.shown, "read"))
    }
}

/// A folder, or a prefix of a bucket. Names are relative, with `/`.
pub(crate) trait Store: fmt::Debug + Send + Sync {
    fn path(&self) -> &Path;

    /// The folder of this machine that it is, where it is one: its files are replaced, and what writers that died left there is removed.
    fn folder(&self) -> Option<&Path> {
        None
    }

    /// Names and lengths of the files directly under a prefix, which may be empty. None where there is no such prefix.
    fn list(&self, prefix: &str) -> Result<BTreeMap<String, u64>, DatasetError>;

    /// A small file's contents; `None` where it does not exist.
    fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>, DatasetError>;

    /// Creates a small file, whole or not at all; false where the name is taken.
    fn put_if_absent(&self, name: &str, bytes: &[u8]) -> Result<bool, DatasetError>;

    /// Creates a file with the contents of a finished one; false where the name is taken.
    fn put_file_if_absent(&self, name: &str, file: &Path) -> Result<bool, DatasetError>;

    /// A file of this machine with the contents.
    fn fetch(&self, name: &str) -> Result<Fetched, DatasetError>;

    /// Removes a file; one that is gone is no error.
    fn remove(&self, name: &str) -> Result<(), DatasetError>;

    /// The name as a path, for messages.
    fn shown(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Folder {
    pub path: PathBuf,
    /// Where unfinished files are made, on the same file system; beside the finished ones if there is none.
    pub scratch: Option<PathBuf>,
}

impl Store for Folder {
    fn path(&self) -> &Path {
        &self.path
    }

    fn folder(&self) -> Option<&Path> {
        Some(&self.path)
    }

    fn list(&self, prefix: &str) -> Result<BTreeMap<String, u64>, DatasetError> {
        let folder = self.path.join(prefix);
        let mut all = BTreeMap::new();
        for name in names_in(&folder)? {
            // Links are followed: parts may lie on another disk.
            match fs::metadata(folder.join(&name)) {
                Ok(metadata) if metadata.is_dir() => {}
                Ok(metadata) => drop(all.insert(name, metadata.len())),
                // Another writer's, gone between the two looks.
                Err(e) if is_absent(&e) => {}
                Err(e) => return Err(DatasetError::io(&folder, "list")(e)),
            }
        }
        Ok(all)
    }

    fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>, DatasetError> {
        let path = self.path.join(name);
        match peelnet_core::files::read(&path, most) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
            Err(e) => Err(DatasetError::io(&path, "read")(e)),
        }
    }

    fn put_if_absent(&self, name: &str, bytes: &[u8]) -> Result<bool, DatasetError> {
        let target = self.path.join(name);
        let folder = peelnet_core::files::folder_of(&target);
        fs::create_dir_all(folder).map_err(DatasetError::io(folder, "create the folder"))?;
        // Where the next writer finds and removes what a killed one leaves.
        let meta = Some(self.path.join(META)).filter(|meta| meta.is_dir());
        let scratch = self.scratch.as_deref().or(meta.as_deref());
        let scratch = scratch.unwrap_or(folder);
        let write = || {
            let (mut file, _unfinished) = peelnet_core::files::temporary(scratch, PARTIAL)?;
            file.write_all(bytes)?;
            match file.persist_noclobber(&target) {
                Err(e) if e.error.kind() == ErrorKind::AlreadyExists => Ok(false),
                persisted => persisted.map(|_| true).map_err(|e| e.error),
            }
        };
        write().map_err(DatasetError::io(&target, "write"))
    }

    fn put_file_if_absent(&self, name: &str, file: &Path) -> Result<bool, DatasetError> {
        let target = self.path.join(name);
        let moved = match fs::hard_link(file, &target) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => return Ok(false),
            // File systems without hard links: nothing is replaced but in a race that these cannot decide.
            Err(_) if !target.exists() => fs::rename(file, &target),
            other => other,
        };
        moved.map_err(DatasetError::io(&target, "move into place"))?;
        Ok(true)
    }

    fn fetch(&self, name: &str) -> Result<Fetched, DatasetError> {
        Ok(Fetched {
            path: self.shown(name),
            shown: self.shown(name),
            _copy: None,
        })
    }

    fn remove(&self, name: &str) -> Result<(), DatasetError> {
        let path = self.path.join(name);
        match fs::remove_file(&path) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(DatasetError::io(&path, "remove")(e)),
            _ => Ok(()),
        }
    }
}

/// Whether an error says that nothing has a name, in a folder or in no folder.
pub(crate) fn is_absent(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Names of what lies in a folder, sorted; none where there is no such folder.
pub(crate) fn names_in(folder: &Path) -> Result<Vec<String>, DatasetError> {
    let name = |entry: std::io::Result<fs::DirEntry>| {
        entry.map(|e| e.file_name().to_string_lossy().into_owned())
    };
    let names = match fs::read_dir(folder) {
        Err(e) if is_absent(&e) => Ok(vec![]),
        entries => entries.and_then(|entries| entries.map(name).collect()),
    };
    let mut names: Vec<String> = names.map_err(DatasetError::io(folder, "list"))?;
    names.sort();
    Ok(names)
}

/// The store that a path stands for: `scheme://…` is an object store, `file:///…` a folder. Nothing need be there.
pub(crate) fn store_at(path: &Path) -> Result<Arc<dyn Store>, DatasetError> {
    let folder = match path.to_str().filter(|_| is_remote(path)) {
        None => path,
        Some(url) => match url.strip_prefix("file:") {
            Some(rest) if rest.starts_with("///") => Path::new(&rest[2..]),
            Some(_) => {
                let reason = "an address of a folder is file:///path";
                return Err(DatasetError::invalid(path, reason));
            }
            None => return remote(url),
        },
    };
    Ok(Arc::new(Folder {
        path: folder.to_owned(),
        scratch: None,
    }))
}

/// The store of a dataset that should be there.
pub(crate) fn open_store(path: &Path) -> Result<Arc<dyn Store>, DatasetError> {
    let store = store_at(path)?;
    if let Some(folder) = store.folder() {
        let instead = match folder.exists() {
            false => Some("there is no such dataset"),
            true => folder
                .is_file()
                .then_some("is a file, and a dataset is a folder"),
        };
        if let Some(what) = instead {
            let fix = "write one of a scene with `peelnet extract SCENE --out DATASET`";
            return Err(DatasetError::invalid(path, format!("{what}; {fix}")));
        }
        // The error of the system says what is wrong with it.
        fs::read_dir(folder).map_err(DatasetError::io(folder, "open the dataset's folder"))?;
    }
    Ok(store)
}

/// The bytes of one object, of at most `most`; `None` where it does not exist. The path is an address, see [`peelnet_core::files::is_remote`].
///
/// # Errors
/// An address that is none, a server that cannot be asked, or an object that is too large.
pub fn read_object(path: &Path, most: u64) -> Result<Option<Vec<u8>>, DatasetError> {
    let (store, name) = object(path)?;
    store.get(&name, most)
}

/// Creates one object, whole or not at all; false where the name is taken, by whatever bytes. The path is an address, see [`peelnet_core::files::is_remote`].
///
/// # Errors
/// An address that is none, or a server that cannot be asked or refuses.
pub fn create_object(path: &Path, bytes: &[u8]) -> Result<bool, DatasetError> {
    let (store, name) = object(path)?;
    store.put_if_absent(&name, bytes)
}

/// Where an object lies, and its name there.
fn object(path: &Path) -> Result<(Arc<dyn Store>, String), DatasetError> {
    let text = path.to_str().unwrap_or_default();
    let (prefix, name) = text.rsplit_once('/').unwrap_or_default();
    let store = store_at(Path::new(prefix))?;
    if name.is_empty() || !is_remote(Path::new(prefix)) || prefix.ends_with('/') {
        let reason = "the address of a file is scheme://bucket/prefix/name";
        // An address may have a password in it.
        let scheme = text.split_once("://").map_or("", |(scheme, _)| scheme);
        return Err(DatasetError::invalid(Path::new(scheme), reason));
    }
    Ok((store, name.to_owned()))
}

#[cfg(feature = "object-store")]
fn remote(url: &str) -> Result<Arc<dyn Store>, DatasetError> {
    remote::Remote::open(url)
}

#[cfg(not(feature = "object-store"))]
fn remote(url: &str) -> Result<Arc<dyn Store>, DatasetError> {
    let scheme = url.split_once("://").map_or("", |(scheme, _)| scheme);
    Err(DatasetError::invalid(
        // An address may have a password in it.
        Path::new(&format!("{scheme}://…")),
        "this build reads and writes folders only; build peelnet with `--features object-store`",
    ))
}
