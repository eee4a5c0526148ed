//! Files that are written: whole or not at all, through links, and onto devices.

use crate::unfinished::{Moving, Unfinished};
use std::{
    fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
};

/// The path that means stdout.
pub const STDOUT: &str = "-";

/// Symbolic links that are followed one after another.
const MAX_LINKS: usize = 40;

/// Where bytes for a path go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// A regular file that exists or not: the path itself, or what a symbolic link points to.
    File(PathBuf),
    /// Stdout: `-`, `/dev/stdout` and the like.
    Stdout,
    /// Stderr: `/dev/stderr` and the like.
    Stderr,
    /// A device, a pipe or a socket, which is written but never replaced.
    Stream(PathBuf),
}

/// Finds where bytes for a path go. Links are followed, so that they stay what they are.
///
/// # Errors
/// A folder, a circle of links, or a path that cannot be looked at.
pub fn destination(path: &Path) -> io::Result<Destination> {
    if path == Path::new(STDOUT) {
        return Ok(Destination::Stdout);
    }
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        // Opening these anew would lose the place where an earlier writer stopped.
        match path.to_str() {
            Some("/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1") => {
                return Ok(Destination::Stdout);
            }
            Some("/dev/stderr" | "/dev/fd/2" | "/proc/self/fd/2") => {
                return Ok(Destination::Stderr);
            }
            _ => {}
        }
        let metadata = match fs::symlink_metadata(&path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Destination::File(path)),
            other => other?,
        };
        if metadata.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if metadata.is_file() {
            return Ok(Destination::File(path));
        }
        if !metadata.is_symlink() || path.starts_with("/proc") {
            // A link of /proc is a file that is open, whatever its text says.
            return Ok(Destination::Stream(path));
        }
        let target = fs::read_link(&path)?;
        // An absolute target replaces the folder.
        path = folder_of(&path).join(target);
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        "symbolic links go round in a circle",
    ))
}

/// The folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether files can be created in a folder, or in the nearest of those above it that exists: creates one and removes it.
///
/// # Errors
/// Why not.
pub fn check_folder(folder: &Path) -> io::Result<()> {
    let there = |a: &&Path| a.as_os_str().is_empty() || a.exists();
    let nearest = folder.ancestors().find(there);
    let nearest = nearest.filter(|a| !a.as_os_str().is_empty());
    tempfile::tempfile_in(nearest.unwrap_or(Path::new(".")))
        .map(drop)
        .map_err(plain)
}

/// An error without the temporary file's name, which would mislead.
fn plain(error: io::Error) -> io::Error {
    error
        .raw_os_error()
        .map_or_else(|| error.kind().into(), io::Error::from_raw_os_error)
}

/// Writes a file under a temporary name in its own folder, then renames it. A missing folder is created; a regular file of that
/// name is replaced. A symbolic link stays one, and what it points to is written; `-` is stdout; a device or a pipe is written as it is.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match destination(path)? {
        Destination::Stdout => to_stream(io::stdout().lock(), bytes),
        Destination::Stderr => to_stream(io::stderr().lock(), bytes),
        Destination::Stream(path) => {
            to_stream(fs::OpenOptions::new().write(true).open(path)?, bytes)
        }
        Destination::File(path) => replace(&path, bytes),
    }
}

/// A reader that closes its pipe has read enough.
fn to_stream(mut stream: impl io::Write, bytes: &[u8]) -> io::Result<()> {
    match stream.write_all(bytes).and_then(|()| stream.flush()) {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = folder_of(path);
    fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a result has the permissions of any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let (mut file, _unfinished) = {
        // A process that ends between the two would leave the file behind.
        let _moving = Moving::begin();
        let file = builder
            .prefix(".peelnet-")
            .tempfile_in(folder)
            .map_err(plain)?;
        let unfinished = Unfinished::new(file.path());
        (file, unfinished)
    };
    // The error of a temporary file has its name.
    file.as_file_mut().write_all(bytes)?;
    let _moving = Moving::begin();
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_whole_files_and_leaves_no_other() {
        let dir = tempfile::tempdir().expect("temporary folder");
        let path = dir.path().join("a/b.txt");
        write_whole(&path, b"one").expect("writes");
        write_whole(&path, b"two").expect("writes");
        assert_eq!(fs::read(&path).expect("reads"), b"two");
        assert_eq!(
            fs::read_dir(dir.path().join("a")).expect("lists").count(),
            1
        );
    }

    /// A result can be read by whoever the user's umask allows, as any new file.
    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt as _;
        let dir = tempfile::tempdir().expect("temporary folder");
        let (ours, plain) = (dir.path().join("ours"), dir.path().join("plain"));
        write_whole(&ours, b"x").expect("writes");
        fs::write(&plain, b"x").expect("writes");
        let mode = |p: &Path| fs::metadata(p).expect("is there").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn a_file_in_the_way_of_a_folder_is_an_error() {
        let dir = tempfile::tempdir().expect("temporary folder");
        let file = dir.path().join("file");
        fs::write(&file, b"x").expect("writes");
        assert!(write_whole(&file.join("b.txt"), b"one").is_err());
        assert!(write_whole(dir.path(), b"one").is_err());
        assert_eq!(fs::read_dir(dir.path()).expect("lists").count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_devices_are_written() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().expect("temporary folder");
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("far")).expect("creates");
        symlink("far/file", at("link")).expect("links");
        symlink("link", at("chain")).expect("links");
        // First to a file that does not exist, then to one that does.
        for text in [b"one", b"two"] {
            write_whole(&at("chain"), text).expect("writes");
            assert_eq!(fs::read(at("far/file")).expect("reads"), text);
        }
        let is_link = |p: &Path| fs::symlink_metadata(p).expect("is there").is_symlink();
        assert!(is_link(&at("chain")) && is_link(&at("link")));
        symlink("circle", at("circle")).expect("links");
        assert!(write_whole(&at("circle"), b"x").is_err());
        symlink("/dev/full", at("full")).expect("links");
        assert!(write_whole(&at("full"), b"x").is_err());
        assert!(is_link(&at("full")));
        write_whole(Path::new("/dev/null"), b"x").expect("writes");
        let null = fs::metadata("/dev/null").expect("is there");
        assert!(!null.is_file());
        assert_eq!(
            destination(Path::new("/dev/stdout")).expect("finds"),
            Destination::Stdout
        );
        assert_eq!(
            destination(Path::new(STDOUT)).expect("finds"),
            Destination::Stdout
        );
    }
}
