//! One command at a time writes to a model file and its checkpoint folder, or to a folder of results.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use peelnet_core::files::{Unfinished, folder_of, shown};

use crate::error::{TrainError, beside, io as io_error};

/// Held by a command as long as it may write to its model file or results: a second one with the same place is refused.
///
/// It is a lock of the operating system on `<out>.lock`, so it ends with the process, however that ends. The file is removed when this
/// is dropped; one that was left behind is not locked and not in the way.
#[derive(Debug)]
pub struct OutputLock {
    path: PathBuf,
    /// Folders that were created for it, innermost first.
    created: Vec<PathBuf>,
    file: File,
    _unfinished: Unfinished,
}

impl OutputLock {
    /// Takes the lock of a model file, or of what stands for a folder of results.
    ///
    /// # Errors
    /// Another command holds it, or the folder cannot be written.
    pub fn take(out: &Path) -> Result<Self, TrainError> {
        let path = beside(out, "lock");
        let failed = io_error(&path);
        let folder = folder_of(&path);
        let is_new = |a: &&Path| !a.as_os_str().is_empty() && !a.exists();
        let created = folder.ancestors().take_while(is_new).map(Path::to_owned);
        let created = created.collect();
        std::fs::create_dir_all(folder).map_err(&failed)?;
        // No link, whose target would be created, and no device.
        peelnet_core::files::check_file(&path).map_err(&failed)?;
        loop {
            let file = OpenOptions::new()
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path)
                .map_err(&failed)?;
            // Ours are empty, and would be removed.
            if file.metadata().map_err(&failed)?.len() > 0 {
                return Err(failed(io::Error::new(
                    io::ErrorKind::AlreadyExists,
                    "a file that is not peelnet's has the name of the lock; choose another name",
                )));
            }
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(TrainError::Failed(format!(
                        "{}: another command writes there; wait for it to end, or write to another place",
                        shown(out)
                    )));
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
            // Between opening and locking, its owner can have removed the file: then the name is free for others.
            if is_at(&file, &path).map_err(&failed)? {
                return Ok(Self {
                    _unfinished: Unfinished::new(&path),
                    path,
                    created,
                    file,
                });
            }
        }
    }
}

impl Drop for OutputLock {
    fn drop(&mut self) {
        // While it is still locked. A file that stays is not in the way, and another one of its name is not ours.
        if is_at(&self.file, &self.path).unwrap_or(false) {
            let _ = std::fs::remove_file(&self.path);
        }
        for folder in &self.created {
            // Those that hold something now stay.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Whether an open file is the one of this name.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt as _;
    let open = file.metadata()?;
    match std::fs::symlink_metadata(path) {
        Ok(named) => Ok((open.dev(), open.ino()) == (named.dev(), named.ino())),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(e) => Err(e),
    }
}

/// Elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> io::Result<bool> {
    path.try_exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_left_by_a_killed_process_is_not_in_the_way() {
        let folder = tempfile::tempdir().unwrap();
        let [out, other] = ["net-0.5", "net-0.7"].map(|name| folder.path().join(name));
        std::fs::write(folder.path().join("net-0.5.lock"), "").unwrap();
        // Another output is free.
        drop([&out, &other].map(|out| OutputLock::take(out).unwrap()));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn another_file_that_came_to_have_its_name_stays() {
        let folder = tempfile::tempdir().unwrap();
        let [out, note] = ["net", "net.lock"].map(|name| folder.path().join(name));
        let lock = OutputLock::take(&out).unwrap();
        std::fs::remove_file(&note).unwrap();
        std::fs::write(&note, "a user's own").unwrap();
        drop(lock);
        assert_eq!(std::fs::read(&note).unwrap(), b"a user's own");
    }

    /// Many threads take and drop one lock: never two hold it at once, though each removes the file.
    #[test]
    fn removing_the_lock_lets_no_two_in() {
        use std::sync::atomic::{AtomicU32, Ordering};
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("net");
        let (inside, taken) = (AtomicU32::new(0), AtomicU32::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..2000 {
                        if let Ok(lock) = OutputLock::take(&out) {
                            assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                            taken.fetch_add(1, Ordering::SeqCst);
                            inside.fetch_sub(1, Ordering::SeqCst);
                            drop(lock);
                        }
                    }
                });
            }
        });
        assert!(taken.into_inner() > 0);
    }
}
