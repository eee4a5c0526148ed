//! What a process that must end now has to remove: temporary files and folders that are not finished.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard},
};

static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Held for reading while finished files move into place, for writing by a process that ends.
static MOVING: RwLock<()> = RwLock::new(());

fn paths() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file or folder that [`remove_unfinished`] removes as long as this lives.
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// From now on this path is unfinished.
    pub fn new(path: &Path) -> Self {
        paths().insert(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        paths().remove(&self.0);
    }
}

/// Moving several finished files into place: [`remove_unfinished`] waits until this is dropped.
#[derive(Debug)]
pub struct Moving {
    _guard: RwLockReadGuard<'static, ()>,
}

impl Moving {
    /// From now on a process that wants to end waits.
    pub fn begin() -> Self {
        Self {
            _guard: MOVING.read().unwrap_or_else(PoisonError::into_inner),
        }
    }
}

/// Waits for files that move into place, removes every file and folder that is unfinished, and lets no other move: for a process that ends
/// as soon as this returns, while other threads still work.
pub fn remove_unfinished() {
    let guard = MOVING.write().unwrap_or_else(PoisonError::into_inner);
    for path in &*paths() {
        // Gone already, or not ours to remove any more: both are as they should be.
        let _ = if path.is_dir() {
            std::fs::remove_dir_all(path)
        } else {
            std::fs::remove_file(path)
        };
    }
    // What is written from now on must not appear half.
    std::mem::forget(guard);
}
