//! Files that appear whole or not at all: every result of peelnet but a dataset (which is a folder and has its own
//! way) is written through [`write_whole`].

use std::{io, io::Write as _, path::Path};

/// Writes a file under a temporary name in its own folder, then renames it. A missing folder is created; a file of that
/// name is replaced.
///
/// # Errors
/// If the folder or the file cannot be written; then nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a result has the permissions of any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.prefix(".peelnet-").tempfile_in(folder)?;
    file.write_all(bytes)?;
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
        assert_eq!(std::fs::read(&path).expect("reads"), b"two");
        assert_eq!(
            std::fs::read_dir(dir.path().join("a"))
                .expect("lists")
                .count(),
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
        std::fs::write(&plain, b"x").expect("writes");
        let mode = |p: &Path| std::fs::metadata(p).expect("is there").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn a_file_in_the_way_of_a_folder_is_an_error() {
        let dir = tempfile::tempdir().expect("temporary folder");
        let file = dir.path().join("file");
        std::fs::write(&file, b"x").expect("writes");
        assert!(write_whole(&file.join("b.txt"), b"one").is_err());
        assert_eq!(std::fs::read_dir(dir.path()).expect("lists").count(), 1);
    }
}
