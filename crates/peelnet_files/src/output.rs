//! Files that are written: whole or not at all, through links, onto devices, and never over what is not peelnet's.

use crate::{read_head, shown};
use std::{
    collections::BTreeSet,
    error::Error,
    fmt, fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard},
};

/// The path that means stdout.
pub const STDOUT: &str = "-";

/// Symbolic links that are followed one after another.
const MAX_LINKS: usize = 40;

/// Bytes at the beginning of a file by which its kind is known.
const HEAD: u64 = 1 << 16;

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
    let why = "symbolic links go round in a circle";
    Err(io::Error::new(io::ErrorKind::InvalidInput, why))
}

/// The folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether files can be created in a folder, or in the nearest of those above it that exists: creates one and removes it.
fn check_folder(folder: &Path) -> io::Result<()> {
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

/// A kind of file that peelnet writes, known by its content: an output replaces only a file of its own kind.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What it is called in messages, with its article: "a model".
    pub name: &'static str,
    /// Whether a file that begins with these bytes is one that peelnet wrote.
    pub is: fn(head: &[u8]) -> bool,
}

/// What lies where a file is to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Nothing, an empty file, stdout, a device or a pipe.
    Free,
    /// A file of the kind, which is replaced.
    Replaced,
    /// Another file, which is not peelnet's to replace.
    Foreign,
}

impl Kind {
    /// What lies at a path.
    ///
    /// # Errors
    /// A folder, or a file that cannot be read.
    pub fn standing(&self, path: &Path) -> io::Result<Standing> {
        let Destination::File(path) = destination(path)? else {
            return Ok(Standing::Free);
        };
        match read_head(&path, HEAD) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(Standing::Free),
            Err(e) => Err(e),
            Ok(head) if head.is_empty() => Ok(Standing::Free),
            Ok(head) if (self.is)(&head) => Ok(Standing::Replaced),
            Ok(_) => Ok(Standing::Foreign),
        }
    }
}

/// An output that may not be written.
#[derive(Debug)]
pub struct Refused {
    /// Whether another name would do: the place as such can be written.
    pub is_wrong_value: bool,
    text: String,
}

impl Refused {
    fn wrong(text: impl Into<String>) -> Self {
        Self {
            is_wrong_value: true,
            text: text.into(),
        }
    }

    fn about(self, setting: &str, path: &Path) -> Self {
        Self {
            text: format!("{setting} {}: {}", shown(path), self.text),
            ..self
        }
    }
}

impl From<io::Error> for Refused {
    fn from(error: io::Error) -> Self {
        Self {
            is_wrong_value: false,
            text: format!("cannot be written: {error}"),
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Error for Refused {}

/// What a command is going to write, checked file by file before it begins.
#[derive(Debug)]
pub struct Outputs {
    /// How the user lets outputs replace any file, such as `--force`, and whether that was said.
    force: (&'static str, bool),
    /// Files and folders that the command reads.
    inputs: Vec<PathBuf>,
    /// Files that it writes, as far as they are named.
    taken: Vec<PathBuf>,
    /// What lies where it writes.
    replaced: Vec<(PathBuf, &'static str)>,
}

impl Outputs {
    /// Of a command that reads these files and folders.
    pub fn new<P: AsRef<Path>>(
        force: (&'static str, bool),
        inputs: impl IntoIterator<Item = P>,
    ) -> Self {
        let inputs = inputs.into_iter();
        Self {
            force,
            // A shipped scene is no file.
            inputs: inputs
                .filter_map(|path| path.as_ref().canonicalize().ok())
                .collect(),
            taken: Vec::new(),
            replaced: Vec::new(),
        }
    }

    /// Checks a file that the setting of this name asks for.
    ///
    /// # Errors
    /// An input of the command, a file of another kind (both replaced where that is forced), a second output of this name, or a place
    /// that cannot be written.
    pub fn file(&mut self, setting: &str, path: &Path, kind: Kind) -> Result<(), Refused> {
        self.check(path, kind)
            .map_err(|refused| refused.about(setting, path))
    }

    fn check(&mut self, path: &Path, kind: Kind) -> Result<(), Refused> {
        let (force, is_forced) = self.force;
        let file = match destination(path)? {
            Destination::File(file) => {
                check_folder(folder_of(&file))?;
                absolute(&file)
            }
            Destination::Stdout => PathBuf::from(STDOUT),
            Destination::Stderr | Destination::Stream(_) => return Ok(()),
        };
        if self.taken.contains(&file) {
            let why = "another output of this command has the same name; choose another";
            return Err(Refused::wrong(why));
        }
        if self.is_input(&file) && !is_forced {
            return Err(Refused::wrong(format!(
                "this command reads that file; choose another name, or replace it with {force}"
            )));
        }
        match kind.standing(path)? {
            Standing::Free => {}
            Standing::Foreign if !is_forced => {
                let text = format!(
                    "the file there is not {}; choose another name, or replace it with {force}",
                    kind.name
                );
                return Err(Refused {
                    is_wrong_value: false,
                    text,
                });
            }
            Standing::Foreign => self.replaced.push((path.to_owned(), "another file")),
            Standing::Replaced => self.replaced.push((path.to_owned(), kind.name)),
        }
        self.taken.push(file);
        Ok(())
    }

    /// Checks files of these names in a folder.
    ///
    /// # Errors
    /// As [`Outputs::file`], and stdout or a file instead of a folder.
    pub fn folder(
        &mut self,
        setting: &str,
        folder: &Path,
        files: impl IntoIterator<Item = (impl AsRef<Path>, Kind)>,
    ) -> Result<(), Refused> {
        check_is_folder(setting, folder)?;
        for (name, kind) in files {
            self.file(setting, &folder.join(name), kind)?;
        }
        Ok(())
    }

    /// Checks a folder that gets files whose names are not known yet: none of those with the ending in it may be of another kind.
    ///
    /// # Errors
    /// As [`Outputs::folder`].
    pub fn files_like(
        &mut self,
        setting: &str,
        folder: &Path,
        ending: &str,
        kind: Kind,
    ) -> Result<(), Refused> {
        check_is_folder(setting, folder)?;
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut names: Vec<PathBuf> = entries.map(|e| e.path()).collect();
        names.retain(|path| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case(ending))
        });
        names.sort();
        names
            .iter()
            .try_for_each(|path| self.file(setting, path, kind))
    }

    /// Whether a file goes to stdout, so that nothing else may.
    pub fn is_stdout_taken(&self) -> bool {
        self.taken.iter().any(|file| file == Path::new(STDOUT))
    }

    /// What will be replaced, for a message before work begins that reads these files, too.
    ///
    /// # Errors
    /// An output that is read, such as a texture: which files these are is known only once a scene is loaded.
    pub fn begin<'a>(
        mut self,
        read: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<Option<String>, Refused> {
        self.inputs = read
            .into_iter()
            .filter_map(|f| f.canonicalize().ok())
            .collect();
        let (force, is_forced) = self.force;
        let input = self.taken.iter().find(|file| self.is_input(file));
        if let Some(file) = input.filter(|_| !is_forced) {
            return Err(Refused::wrong(format!(
                "--out: would replace {}, which a scene of this command reads; choose another name, or replace it with {force}",
                shown(file)
            )));
        }
        let Some((first, what)) = self.replaced.first() else {
            return Ok(None);
        };
        let more = match self.replaced.len() - 1 {
            0 => String::new(),
            1 => " and one more file".to_owned(),
            n => format!(" and {n} more files"),
        };
        Ok(Some(format!("replacing {} ({what}){more}", shown(first))))
    }

    fn is_input(&self, file: &Path) -> bool {
        self.inputs
            .iter()
            .any(|input| file.starts_with(input) || is_same(file, input))
    }
}

/// An error if a folder's name says stdout or is a file's, or if it cannot be written.
///
/// # Errors
/// See above.
pub fn check_is_folder(setting: &str, folder: &Path) -> Result<(), Refused> {
    let refused = if folder == Path::new(STDOUT) {
        let why = "a folder is written, which stdout cannot hold; name a folder";
        Err(Refused::wrong(why))
    } else if folder.exists() && !folder.is_dir() {
        Err(Refused {
            is_wrong_value: false,
            text: "is a file; name a folder".to_owned(),
        })
    } else {
        check_folder(folder).map_err(Refused::from)
    };
    refused.map_err(|refused| refused.about(setting, folder))
}

/// The path with its links resolved, as far as it exists.
fn absolute(path: &Path) -> PathBuf {
    let in_folder = || Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?));
    let resolved = path.canonicalize().ok().or_else(in_folder);
    resolved
        .or_else(|| std::path::absolute(path).ok())
        .unwrap_or_else(|| path.to_owned())
}

/// Whether two paths are the same file, also by hard links.
#[cfg(unix)]
fn is_same(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let id = |p: &Path| fs::metadata(p).map(|m| (m.dev(), m.ino()));
    matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(not(unix))]
fn is_same(a: &Path, b: &Path) -> bool {
    a == b
}

/// Writes a file under a temporary name in its own folder, then renames it. A missing folder is created; a regular file of that
/// name is replaced and keeps its permissions. A symbolic link stays one, and what it points to is written; `-` is stdout; a device or a
/// pipe is written as it is.
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
    if let Ok(replaced) = fs::metadata(path) {
        file.as_file().set_permissions(replaced.permissions())?;
    }
    // The error of a temporary file has its name.
    file.as_file_mut().write_all(bytes)?;
    let _moving = Moving::begin();
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Held for reading while finished files move into place, for writing by a process that ends.
static MOVING: RwLock<()> = RwLock::new(());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file or folder that [`remove_unfinished`] removes as long as this lives.
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// From now on this path is unfinished.
    pub fn new(path: &Path) -> Self {
        unfinished().insert(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        unfinished().remove(&self.0);
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
    for path in &*unfinished() {
        // Gone already, or not ours to remove any more: both are as they should be.
        let _ = if path.is_dir() {
            fs::remove_dir_all(path)
        } else {
            fs::remove_file(path)
        };
    }
    // What is written from now on must not appear half.
    std::mem::forget(guard);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A result can be read by whoever the user's umask allows, as any new file, and what is replaced keeps its permissions.
    #[test]
    fn replaces_whole_files_and_leaves_no_other() {
        let dir = tempfile::tempdir().expect("temporary folder");
        let (path, plain) = (dir.path().join("a/b.txt"), dir.path().join("plain"));
        write_whole(&path, b"one").expect("writes");
        fs::write(&plain, b"x").expect("writes");
        let permissions = |p: &Path| fs::metadata(p).expect("is there").permissions();
        assert_eq!(permissions(&path), permissions(&plain));
        #[cfg(unix)]
        {
            let private: fs::Permissions = std::os::unix::fs::PermissionsExt::from_mode(0o600);
            fs::set_permissions(&path, private).expect("is ours");
        }
        let before = permissions(&path);
        write_whole(&path, b"two").expect("writes");
        assert_eq!(fs::read(&path).expect("reads"), b"two");
        assert_eq!(permissions(&path), before);
        // A file in the way of a folder, and a folder in the way of a file.
        assert!(write_whole(&path.join("c.txt"), b"one").is_err());
        assert!(write_whole(dir.path(), b"one").is_err());
        for (folder, files) in [(dir.path(), 2), (&dir.path().join("a"), 1)] {
            assert_eq!(fs::read_dir(folder).expect("lists").count(), files);
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_devices_are_written() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().expect("temporary folder");
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("far")).expect("creates");
        for (target, link) in [
            ("far/file", "link"),
            ("link", "chain"),
            ("circle", "circle"),
            ("/dev/full", "full"),
        ] {
            symlink(target, at(link)).expect("links");
        }
        // First to a file that does not exist, then to one that does.
        for text in [b"one", b"two"] {
            write_whole(&at("chain"), text).expect("writes");
            assert_eq!(fs::read(at("far/file")).expect("reads"), text);
        }
        for refused in ["circle", "full"] {
            assert!(write_whole(&at(refused), b"x").is_err(), "{refused}");
        }
        for link in ["chain", "link", "circle", "full"] {
            assert!(at(link).is_symlink(), "{link}");
        }
        write_whole(Path::new("/dev/null"), b"x").expect("writes");
        assert!(!fs::metadata("/dev/null").expect("is there").is_file());
        for stdout in [STDOUT, "/dev/stdout"] {
            let found = destination(Path::new(stdout)).expect("is found");
            assert_eq!(found, Destination::Stdout, "{stdout}");
        }
    }

    #[test]
    fn what_lies_there_is_known_by_its_content() {
        const NOTE: Kind = Kind {
            name: "a note",
            is: |head| head.starts_with(b"note"),
        };
        let dir = tempfile::tempdir().expect("temporary folder");
        for (name, text) in [("a", "note: x"), ("b", "not a note"), ("c", "")] {
            fs::write(dir.path().join(name), text).expect("writes");
        }
        let path = |name: &str| match name {
            STDOUT => PathBuf::from(STDOUT),
            name => dir.path().join(name),
        };
        for (name, expected) in [
            ("a", Standing::Replaced),
            ("b", Standing::Foreign),
            ("c", Standing::Free),
            ("d/e", Standing::Free),
            (STDOUT, Standing::Free),
        ] {
            assert_eq!(NOTE.standing(&path(name)).expect("stands"), expected);
        }
        assert!(NOTE.standing(dir.path()).is_err());
        let mut outputs = Outputs::new(("--force", false), [path("a")]);
        // An input, a foreign file, a new one, and a second of its name.
        for (name, words) in [
            ("a", "this command reads that file"),
            (
                "b",
                "is not a note; choose another name, or replace it with --force",
            ),
            ("c", ""),
            ("c", "another output of this command has the same name"),
        ] {
            let result = outputs.file("--out", &path(name), NOTE);
            let text = result.err().map_or_else(String::new, |e| e.to_string());
            assert!(text.contains(words) && text.is_empty() == words.is_empty());
        }
        let mut forced = Outputs::new(("--force", true), [path("a")]);
        forced.file("--out", &path("a"), NOTE).expect("is forced");
        let said = forced.begin([]).expect("is forced").unwrap_or_default();
        assert!(said.ends_with("a (a note)"), "{said}");
    }
}
