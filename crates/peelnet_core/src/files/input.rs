//! Files that are read: regular ones, of bounded size.

use super::invalid;
use std::{
    fs::{File, Metadata, metadata},
    io::{self, Read as _},
    path::Path,
};

/// Opens a regular file. A device or a pipe is refused before it is opened, because it could block or never end.
///
/// # Errors
/// A folder, a file of another kind, or one that cannot be opened.
pub fn open(path: &Path) -> io::Result<File> {
    check_regular(&metadata(path)?)?;
    // Some of them never end, or wait for ever.
    let place = path.canonicalize()?;
    if cfg!(target_os = "linux") && (place.starts_with("/proc") || place.starts_with("/sys")) {
        return Err(invalid("not a regular file, but one of the system"));
    }
    let file = File::open(path)?;
    // What lies there can have changed meanwhile.
    check_regular(&file.metadata()?)?;
    Ok(file)
}

/// Reads a regular file of at most `limit` bytes.
///
/// # Errors
/// As [`open`], and a file that is larger or cannot be read.
pub fn read(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    check_size(file.metadata()?.len(), limit)?;
    let mut bytes = Vec::new();
    // A file can grow while it is read.
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    check_size(bytes.len() as u64, limit)?;
    Ok(bytes)
}

/// The first bytes of a regular file, at most `limit` of them.
///
/// # Errors
/// As [`open`], and a file that cannot be read.
pub fn read_head(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn check_regular(metadata: &Metadata) -> io::Result<()> {
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(invalid("not a regular file"));
    }
    Ok(())
}

/// An error if so many bytes are more than the limit.
pub fn check_size(bytes: u64, limit: u64) -> io::Result<()> {
    if bytes <= limit {
        return Ok(());
    }
    Err(io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!("{bytes} bytes, and at most {limit} are read"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_of_a_bounded_size_are_read() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let e = read(folder.path(), 100).expect_err("a folder");
        assert_eq!(e.kind(), io::ErrorKind::IsADirectory);
        let large = folder.path().join("large");
        let file = File::create(&large).expect("creates");
        // Sparse: takes no space.
        file.set_len(1 << 40).expect("grows");
        let e = read(&large, 100).expect_err("too large");
        assert_eq!(e.kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(read_head(&large, 7).expect("reads"), [0; 7]);
        #[cfg(unix)]
        {
            let at = |name: &str| folder.path().join(name);
            std::os::unix::fs::symlink("/dev/zero", at("link")).expect("links");
            // Nobody writes into the pipe: opening it would wait for ever.
            let pipe = std::process::Command::new("mkfifo")
                .arg(at("pipe"))
                .status();
            assert!(pipe.expect("mkfifo runs").success());
            for path in ["/dev/zero".into(), at("link"), at("pipe")] {
                let e = read(&path, 100).expect_err("no file");
                assert!(e.to_string().contains("regular"), "{e}");
                assert!(read_head(&path, 1).is_err());
            }
        }
    }
}
