//! Files that are written: whole or not at all, and never over what is not peelnet's. The one place with this rule.
//!
//! A path is resolved first, and must lead to a regular file or to a free name. A command checks its outputs before it begins
//! ([`Outputs`]): an input is not replaced, nor a file of another kind, unless the user forces it. What was allowed then still holds just
//! before the rename, or nothing is replaced ([`write_whole`]).

use super::{invalid, read_head, shown};
use std::{
    cell::Cell,
    collections::BTreeMap,
    fs::{self, Metadata},
    io::{self, Write as _},
    path::{Component, Path, PathBuf, absolute},
    sync::{Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard},
    time::SystemTime,
};
use tempfile::NamedTempFile;

pub const STDOUT: &str = "-";

/// Bytes at the beginning of a file by which its kind is known.
const HEAD: u64 = 1 << 16;

/// Whether a path is an address, `scheme://…`, such as one of an object store; `file:/…` is a slip of the hand, and no file is called so.
pub fn is_remote(path: &Path) -> bool {
    if path.starts_with("file:") {
        return true;
    }
    let address = path.to_str().and_then(|text| text.split_once("://"));
    address.is_some_and(|(scheme, _)| {
        let mut letters = scheme.bytes();
        scheme.len() > 1 && letters.all(|b| b.is_ascii_alphanumeric() || b == b'+')
    })
}

/// The path on this machine that an address `file:///…` means; a path that is no address means itself.
fn local(path: &Path) -> io::Result<&Path> {
    if !is_remote(path) {
        return Ok(path);
    }
    let address = path.to_str();
    let file = address.and_then(|address| address.strip_prefix("file://"));
    let file = file.filter(|path| path.starts_with('/')).map(Path::new);
    file.ok_or_else(|| invalid("is no file of this machine; name one"))
}

/// Whether a name can only be a folder's: it ends in a separator, or in one and a dot. A [`Path`] of it does not say so.
fn is_folder_name(path: &Path) -> bool {
    let name = path.as_os_str().as_encoded_bytes();
    let name = name.strip_suffix(b".").unwrap_or(name);
    let last = name.last().copied().map(char::from);
    last.is_some_and(std::path::is_separator)
}

/// Where an absolute path of a file leads. Its last part stays, so that a link is seen as one.
fn resolve(path: &Path) -> io::Result<PathBuf> {
    match path.file_name() {
        Some(name) => Ok(resolve_folder(folder_of(path))?.join(name)),
        None => resolve_folder(path),
    }
}

/// Where an absolute path of a folder leads: `..` and links are resolved. A path out of a folder that does not exist is an error: it leads
/// nowhere now, and elsewhere once that folder is created.
fn resolve_folder(path: &Path) -> io::Result<PathBuf> {
    let mut resolved = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir if !resolved.exists() => {
                return Err(invalid(
                    "has '..' behind a folder that does not exist; leave both out",
                ));
            }
            // No link is left in what precedes it.
            Component::ParentDir => {
                resolved.pop();
            }
            Component::Normal(name) => {
                resolved.push(name);
                match resolved.canonicalize() {
                    Ok(real) => resolved = real,
                    Err(_) if resolved.is_symlink() => {
                        return Err(invalid("a link among its folders leads nowhere"));
                    }
                    // Folders that do not exist are created.
                    Err(_) => {}
                }
            }
            root => resolved.push(root),
        }
    }
    Ok(resolved)
}

/// The folder in each dataset of everything that is not rows. Its name begins with `_`: readers of whole folders skip it.
pub const META: &str = "_peelnet";

/// An error where a path leads into a dataset, which nothing but its own files may lie in. An address leads to no folder of this machine.
///
/// # Errors
/// See above, and a path that cannot be looked at.
pub fn check_outside_datasets(path: &Path) -> io::Result<()> {
    let Ok(path) = local(path) else {
        return Ok(());
    };
    let path = resolve(&absolute(path)?)?;
    let mut folders = path.ancestors().skip(1);
    let Some(dataset) = folders.find(|folder| folder.join(META).is_dir()) else {
        return Ok(());
    };
    let dataset = shown(dataset);
    Err(invalid(&format!(
        "lies in the dataset {dataset}; choose a place outside of it"
    )))
}

/// A regular file as it was found: equal as long as it is the same file with the same contents.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Existing {
    id: Option<(u64, u64)>,
    bytes: u64,
    modified: Option<SystemTime>,
    is_read_only: bool,
}

/// What stands at a resolved path.
fn find(file: &Path) -> io::Result<Option<Existing>> {
    let metadata = match fs::symlink_metadata(file) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
        other => other?,
    };
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if metadata.is_symlink() {
        return Err(invalid("is a link; name the file that it leads to"));
    }
    if !metadata.is_file() {
        return Err(invalid("is no regular file; name one, or - for stdout"));
    }
    Ok(Some(Existing {
        id: file_id(&metadata),
        bytes: metadata.len(),
        modified: metadata.modified().ok(),
        is_read_only: metadata.permissions().readonly(),
    }))
}

/// Device and number of a file, the same under all of its names; `None` where the system has none.
pub fn identity(path: &Path) -> Option<(u64, u64)> {
    file_id(&fs::metadata(path).ok()?)
}

/// Device and number of what stands at a path, which is no link's target.
fn id_at(path: &Path) -> Option<(u64, u64)> {
    file_id(&fs::symlink_metadata(path).ok()?)
}

/// Device and number of a file.
#[cfg(unix)]
fn file_id(metadata: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt as _;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn file_id(_: &Metadata) -> Option<(u64, u64)> {
    None
}

/// A file that is going to be written, and what may be replaced there.
#[derive(Clone, Debug)]
struct Output {
    /// Absolute, and otherwise as the user gave it.
    path: PathBuf,
    /// Where it leads; nothing for stdout.
    file: Option<PathBuf>,
    existing: Option<Existing>,
}

impl Output {
    /// Finds where a path leads and what stands there. A folder, a link, a device, a pipe, an address of another machine, or a path that
    /// cannot be looked at is an error.
    fn look(path: &Path) -> io::Result<Self> {
        if path == Path::new(STDOUT) {
            return Ok(Self {
                path: path.to_owned(),
                file: None,
                existing: None,
            });
        }
        if is_folder_name(path) {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let path = absolute(local(path)?)?;
        let file = resolve(&path)?;
        Ok(Self {
            existing: find(&file)?,
            file: Some(file),
            path,
        })
    }

    /// Whether both cannot be files: they have one path, or the path of one leads through the other.
    fn excludes(&self, other: &Self) -> bool {
        match (&self.file, &other.file) {
            (Some(a), Some(b)) => a.starts_with(b) || b.starts_with(a),
            (a, b) => a == b,
        }
    }

    fn is_read_only(&self) -> bool {
        self.existing.as_ref().is_some_and(|file| file.is_read_only)
    }

    /// The same as a command's [`Outputs`] saw it; in a folder whose files they saw, the others are new.
    fn allowed(&self) -> Option<Self> {
        let allowed = lock(&ALLOWED);
        let of_folder = || {
            let folder = allowed.get(folder_of(&self.path))?;
            Some(Self {
                path: self.path.clone(),
                file: Some(folder.file.as_ref()?.join(self.path.file_name()?)),
                existing: None,
            })
        };
        allowed.get(&self.path).cloned().or_else(of_folder)
    }
}

/// Writes a file whole: a temporary file beside it, which is then renamed. A missing folder is created; a file that is replaced keeps its
/// permissions, and is the one that a command's [`Outputs`] allowed to replace, or that was there when this was called.
///
/// # Errors
/// A folder, a link, a device, a pipe, an address of another machine, or a path that cannot be looked at or written; a file that came or
/// changed meanwhile. Then nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let found = Output::look(path)?;
    let allowed = found.allowed();
    let is_allowed = allowed.is_some();
    let expected = allowed.unwrap_or(found);
    let Some(file) = &expected.file else {
        // What was asked for is there and nowhere else.
        if is_stdout_closed() {
            let error = io::ErrorKind::NotConnected;
            return Err(io::Error::new(error, "stdout is closed"));
        }
        return to_stdout(bytes);
    };
    if !is_allowed && expected.is_read_only() {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, READ_ONLY));
    }
    let folder = folder_of(file);
    fs::create_dir_all(folder)?;
    let (mut unnamed, _unfinished) = temporary(folder, ".peelnet-")?;
    // The error of a temporary file has its name.
    unnamed.as_file_mut().write_all(bytes)?;
    if expected.existing.is_some()
        && let Ok(replaced) = fs::metadata(file)
    {
        unnamed.as_file().set_permissions(replaced.permissions())?;
    }
    // A power failure must not leave a name without contents.
    unnamed.as_file().sync_all()?;
    let _moving = moving();
    let now = Output::look(&expected.path)?;
    let is_same = now.existing.is_none() || now.existing == expected.existing;
    if !is_same || now.file != expected.file {
        return Err(changed());
    }
    match now.existing {
        Some(_) => unnamed.persist(file).map_err(|e| e.error)?,
        None => match unnamed.persist_noclobber(file) {
            Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => return Err(changed()),
            // File systems that cannot do this in one step.
            Err(e) => e.file.persist(file).map_err(|e| e.error)?,
            Ok(file) => file,
        },
    };
    if is_allowed {
        let written = Output::look(&expected.path)?;
        lock(&ALLOWED).insert(written.path.clone(), written);
    }
    Ok(())
}

/// Removes a file that a command's [`Outputs`] allowed to replace; nothing where none is.
///
/// # Errors
/// A file that came or changed meanwhile, and what cannot be looked at or removed.
pub fn remove_replaced(path: &Path) -> io::Result<()> {
    let _moving = moving();
    let now = Output::look(path)?;
    match (&now.existing, now.allowed()) {
        (None, _) => Ok(()),
        (Some(_), Some(allowed)) => Found(allowed).remove(),
        _ => Err(changed()),
    }
}

/// A file as it was found, to be removed later if it is still that.
#[derive(Debug)]
pub struct Found(Output);

impl Found {
    /// What stands at a path.
    ///
    /// # Errors
    /// As of [`check_file`].
    pub fn look(path: &Path) -> io::Result<Self> {
        Output::look(path).map(Self)
    }

    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Removes it.
    ///
    /// # Errors
    /// A file that came or changed meanwhile, and what cannot be looked at or removed.
    pub fn remove(&self) -> io::Result<()> {
        let _moving = moving();
        match Output::look(&self.0.path)?.existing == self.0.existing {
            true => fs::remove_file(&self.0.path),
            false => Err(changed()),
        }
    }
}

/// Refuses a path that [`write_whole`] refuses: a folder, a link, a device, a pipe, an address of another machine.
///
/// # Errors
/// See above, and a path that cannot be looked at.
pub fn check_file(path: &Path) -> io::Result<()> {
    Output::look(path).map(drop)
}

/// An unfinished file in a folder. Temporary files are private by default; this one has the permissions of any new file.
///
/// # Errors
/// If the folder cannot be written.
pub fn temporary(folder: &Path, prefix: &str) -> io::Result<(NamedTempFile, Unfinished)> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // A process that ends between the two would leave the file behind.
    let _moving = moving();
    let file = builder.prefix(prefix).tempfile_in(folder).map_err(plain)?;
    let unfinished = Unfinished::new(file.path());
    Ok((file, unfinished))
}

const READ_ONLY: &str = "the file there is read-only";

fn changed() -> io::Error {
    io::Error::new(
        io::ErrorKind::AlreadyExists,
        "another file came there, or the file changed, while this command worked; nothing is replaced",
    )
}

/// Whether this process may have begun without stdout: then the standard library opens `/dev/null` there, for reading as well. Some programs
/// that start others do the same where nobody wants what they print.
fn is_stdout_closed() -> bool {
    const READ_AND_WRITE: &str = "2";
    let leads_to_null =
        fs::read_link("/proc/self/fd/1").is_ok_and(|to| to == Path::new("/dev/null"));
    let info = fs::read_to_string("/proc/self/fdinfo/1").unwrap_or_default();
    let mut lines = info.lines();
    let flags = lines.find_map(|line| line.strip_prefix("flags:"));
    leads_to_null && flags.is_some_and(|flags| flags.ends_with(READ_AND_WRITE))
}

/// Writes to stdout.
///
/// # Errors
/// Where it cannot be written.
pub fn to_stdout(bytes: &[u8]) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(bytes).and_then(|()| stdout.flush())
}

/// What the [`Outputs`] of this process found where their files go, by path.
static ALLOWED: Mutex<BTreeMap<PathBuf, Output>> = Mutex::new(BTreeMap::new());

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether files can be created in a folder, or in the nearest of those above it that exists: creates one and removes it.
fn check_folder(folder: &Path) -> io::Result<()> {
    let folder = resolve_folder(&absolute(local(folder)?)?)?;
    let nearest = folder.ancestors().find(|folder| folder.exists());
    let created = tempfile::tempfile_in(nearest.unwrap_or(&folder));
    created.map(drop).map_err(plain)
}

/// An error without the temporary file's name, which would mislead.
fn plain(error: io::Error) -> io::Error {
    let code = error.raw_os_error();
    code.map_or_else(|| error.kind().into(), io::Error::from_raw_os_error)
}

/// Whether bytes hold a word, which is not empty.
pub fn holds(bytes: &[u8], word: &[u8]) -> bool {
    bytes.windows(word.len()).any(|w| w == word)
}

/// A kind of file that peelnet writes, known by its content: an output replaces only a file of its own kind.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What it is called in messages, with its article: "a model".
    pub name: &'static str,
    /// Whether a file that begins with these bytes is one that peelnet wrote.
    pub is: fn(head: &[u8]) -> bool,
}

impl Kind {
    /// Whether another file than one of this kind lies at a path, which is not peelnet's to replace.
    ///
    /// # Errors
    /// As [`write_whole`], or a file that cannot be read.
    pub fn is_foreign(&self, path: &Path) -> io::Result<bool> {
        Ok(self.is_ours(&Output::look(path)?)? == Some(false))
    }

    /// Whether the file that an output replaces is of this kind; `None` where it replaces none, an empty one, or stdout.
    fn is_ours(&self, output: &Output) -> io::Result<Option<bool>> {
        let (Some(file), Some(_)) = (&output.file, &output.existing) else {
            return Ok(None);
        };
        let head = read_head(file, HEAD)?;
        Ok((!head.is_empty()).then(|| (self.is)(&head)))
    }
}

/// An output that may not be written.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct Refused {
    /// Whether another name would do: the place as such can be written.
    pub is_wrong_value: bool,
    text: String,
}

impl Refused {
    fn new(is_wrong_value: bool, text: impl Into<String>) -> Self {
        Self {
            is_wrong_value,
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
        Self::new(false, format!("cannot be written: {error}"))
    }
}

/// What a command is going to write, checked file by file before it begins.
#[derive(Debug)]
pub struct Outputs {
    /// How the user lets outputs replace any file, such as `--force`, and whether that was said.
    force: (&'static str, bool),
    /// Files and folders that the command reads.
    inputs: Vec<PathBuf>,
    /// Files that it writes, as far as they are named, and folders.
    taken: Vec<Output>,
    /// What lay where it writes.
    replaced: Vec<(PathBuf, &'static str)>,
}

impl Outputs {
    /// Of a command that reads these files and folders.
    pub fn new<P: AsRef<Path>>(
        force: (&'static str, bool),
        inputs: impl IntoIterator<Item = P>,
    ) -> Self {
        // A shipped scene is no file.
        let file = |path: P| local(path.as_ref()).ok()?.canonicalize().ok();
        Self {
            force,
            inputs: inputs.into_iter().filter_map(file).collect(),
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
        let is_forced = self.force.1;
        let output = Output::look(path)?;
        if let Some(file) = &output.file {
            check_outside_datasets(file).map_err(|e| Refused::new(true, e.to_string()))?;
            check_folder(folder_of(file))?;
        }
        if self.taken.iter().any(|taken| taken.excludes(&output)) {
            let why = "another output of this command has this name, or that of a folder on the way; choose another";
            return Err(Refused::new(true, why));
        }
        if self.is_input(&output) && !is_forced {
            return Err(self.not_forced(true, "this command reads that file"));
        }
        if output.is_read_only() && !is_forced {
            return Err(self.not_forced(false, READ_ONLY));
        }
        if let Some(is_ours) = kind.is_ours(&output)? {
            if !is_ours && !is_forced {
                let why = format!("the file there is not {}", kind.name);
                return Err(self.not_forced(false, &why));
            }
            let what = if is_ours { kind.name } else { "another file" };
            self.replaced.push((path.to_owned(), what));
        }
        self.take(output);
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
        if is_remote(folder) {
            let refused = Refused::new(false, "is an address; name a folder of this machine");
            return Err(refused.about(setting, folder));
        }
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
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut names: Vec<PathBuf> = entries.map(|e| e.file_name().into()).collect();
        let is_like = |name: &PathBuf| Some(name.extension()?.eq_ignore_ascii_case(ending));
        names.retain(|name| is_like(name) == Some(true));
        names.sort();
        self.folder(setting, folder, names.iter().map(|name| (name, kind)))?;
        let found = || {
            let path = absolute(local(folder)?)?;
            Ok(Output {
                file: Some(resolve_folder(&path)?),
                path,
                existing: None,
            })
        };
        self.take(found().map_err(|e: io::Error| Refused::from(e).about(setting, folder))?);
        Ok(())
    }

    fn take(&mut self, output: Output) {
        lock(&ALLOWED).insert(output.path.clone(), output.clone());
        self.taken.push(output);
    }

    /// Whether a file goes to stdout, so that nothing else may.
    pub fn is_stdout_taken(&self) -> bool {
        self.taken.iter().any(|output| output.file.is_none())
    }

    /// Work begins that reads these files, too.
    ///
    /// # Errors
    /// An output that is read, such as a texture: which files these are is known only once a scene is loaded.
    pub fn begin<'a>(
        &mut self,
        read: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<(), Refused> {
        let read = read.into_iter().filter_map(|f| f.canonicalize().ok());
        self.inputs.extend(read);
        let input = self.taken.iter().find(|output| self.is_input(output));
        if let Some(output) = input.filter(|_| !self.force.1) {
            let path = shown(&output.path);
            let why = format!("--out: would replace {path}, which a scene of this command reads");
            return Err(self.not_forced(true, &why));
        }
        Ok(())
    }

    /// Which files were replaced so far, for a message.
    pub fn replaced(&self) -> Option<String> {
        let mut replaced = self.replaced.iter().filter(|(path, _)| {
            let now = Output::look(path).ok();
            now.is_some_and(|now| !self.taken.iter().any(|old| old.existing == now.existing))
        });
        let (first, what) = replaced.next()?;
        let more = match replaced.count() {
            0 => String::new(),
            1 => " and one more file".to_owned(),
            n => format!(" and {n} more files"),
        };
        Some(format!("replaced {} ({what}){more}", shown(first)))
    }

    fn is_input(&self, output: &Output) -> bool {
        let (file, mut inputs) = (output.file.as_ref(), self.inputs.iter());
        file.is_some_and(|file| inputs.any(|i| is_same(file, i)))
    }

    fn not_forced(&self, is_wrong_value: bool, why: &str) -> Refused {
        let hint = "choose another name, or replace it with";
        Refused::new(is_wrong_value, format!("{why}; {hint} {}", self.force.0))
    }
}

/// The outputs are written: what is there now is no concern of this command any more.
impl Drop for Outputs {
    fn drop(&mut self) {
        let is_ours = |path: &Path| self.taken.iter().any(|taken| taken.path == path);
        lock(&ALLOWED).retain(|path, _| !is_ours(path) && !is_ours(folder_of(path)));
    }
}

/// An error if a folder's name says stdout or is a file's, or if it cannot be written.
pub fn check_is_folder(setting: &str, folder: &Path) -> Result<(), Refused> {
    let refused = if folder == Path::new(STDOUT) {
        let why = "a folder is written, which stdout cannot hold; name a folder";
        Err(Refused::new(true, why))
    } else if folder.exists() && !folder.is_dir() {
        Err(Refused::new(false, "is a file; name a folder"))
    } else {
        check_folder(folder).map_err(Refused::from)
    };
    refused.map_err(|refused| refused.about(setting, folder))
}

/// Whether two paths are the same file, also by hard links.
fn is_same(a: &Path, b: &Path) -> bool {
    a == b || identity(a).is_some_and(|found| identity(b) == Some(found))
}

/// By path, with the device and number of those that were there when they were named.
static UNFINISHED: Mutex<BTreeMap<PathBuf, Option<(u64, u64)>>> = Mutex::new(BTreeMap::new());

/// Held for reading while finished files move into place, for writing by a process that ends.
static MOVING: RwLock<()> = RwLock::new(());

/// A temporary file or folder that [`remove_unfinished`] removes as long as this lives.
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// From now on this path is unfinished.
    pub fn new(path: &Path) -> Self {
        lock(&UNFINISHED).insert(path.to_owned(), id_at(path));
        Self(path.to_owned())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        lock(&UNFINISHED).remove(&self.0);
    }
}

thread_local! {
    /// How many [`Moving`] this thread has.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

/// Until this is dropped, a process that wants to end waits.
#[derive(Debug)]
pub struct Moving(Option<RwLockReadGuard<'static, ()>>);

/// Finished files move into place.
pub fn moving() -> Moving {
    // A second reader of a thread would wait behind who wants to write, and that one for the first.
    let outer = DEPTH.replace(DEPTH.get() + 1);
    Moving((outer == 0).then(|| MOVING.read().unwrap_or_else(PoisonError::into_inner)))
}

impl Drop for Moving {
    fn drop(&mut self) {
        self.0 = None;
        DEPTH.set(DEPTH.get() - 1);
    }
}

/// Waits for files that move into place, removes every file and folder that is unfinished, and lets no other move: for a process that ends
/// as soon as this returns, while other threads still work.
pub fn remove_unfinished() {
    let guard = MOVING.write().unwrap_or_else(PoisonError::into_inner);
    for (path, id) in &*lock(&UNFINISHED) {
        // Another file, which came to have this name.
        if id.is_some() && id_at(path) != *id {
            continue;
        }
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

    /// A thread that moves files within a move does not wait for a process that waits for the first.
    #[test]
    fn moves_nest() {
        let outer = moving();
        let ends = std::thread::spawn(|| drop(MOVING.write()));
        while MOVING.try_read().is_ok() {
            std::thread::yield_now();
        }
        drop(moving());
        drop(outer);
        ends.join().expect("gets its turn");
    }

    const NOTE: Kind = Kind {
        name: "a note",
        is: |head| head.starts_with(b"note"),
    };

    /// What a file or a link holds, by path, and its permissions.
    fn everything(folder: &Path) -> BTreeMap<PathBuf, (String, fs::Permissions)> {
        let mut found = BTreeMap::new();
        for entry in fs::read_dir(folder).expect("lists") {
            let path = entry.expect("an entry").path();
            let metadata = fs::symlink_metadata(&path).expect("stands");
            let mut text = String::new();
            if metadata.is_symlink() {
                text = format!("{:?}", fs::read_link(&path).expect("a link"));
            } else if metadata.is_file() {
                text = fs::read_to_string(&path).expect("reads");
            } else if metadata.is_dir() {
                found.extend(everything(&path));
            }
            found.insert(path, (text, metadata.permissions()));
        }
        found
    }

    /// A folder of files, links and a pipe, and an open file of it.
    #[cfg(unix)]
    fn folder() -> (tempfile::TempDir, fs::File) {
        use std::os::unix::fs::{PermissionsExt as _, symlink};
        let parent = std::env::temp_dir().canonicalize().expect("stands");
        let dir = tempfile::tempdir_in(parent).expect("temporary folder");
        let at = |name: &str| dir.path().join(name);
        for folder in ["far", "set/_peelnet"] {
            fs::create_dir_all(at(folder)).expect("creates");
        }
        for (name, text) in [
            ("note", "note: old"),
            ("input", "note: read"),
            ("mine", "a user's own"),
            ("locked", "note: whole"),
            ("empty", ""),
            ("far/note", "note: far"),
        ] {
            fs::write(at(name), text).expect("writes");
        }
        for (name, mode) in [("note", 0o600), ("locked", 0o444)] {
            fs::set_permissions(at(name), fs::Permissions::from_mode(mode)).expect("is ours");
        }
        fs::hard_link(at("input"), at("hard")).expect("links");
        for (target, link) in [
            ("note", "link"),
            ("link", "chain"),
            ("gone", "dangling"),
            ("circle", "circle"),
            ("far", "near"),
            ("/dev/null", "null"),
        ] {
            symlink(target, at(link)).expect("links");
        }
        let pipe = std::process::Command::new("mkfifo")
            .arg(at("pipe"))
            .status();
        assert!(pipe.expect("mkfifo runs").success());
        let open = fs::File::open(at("note")).expect("opens");
        (dir, open)
    }

    /// One line a case: the output (`DIR` is the folder), what happens there after it is reserved, and words of the error, none where it
    /// is written. An error leaves everything as it was, and nothing else is changed by an output.
    #[cfg(unix)]
    #[test]
    fn only_what_is_allowed_is_replaced() {
        use std::os::{fd::AsRawFd as _, unix::fs::symlink};
        type Change = fn(&Path) -> io::Result<()>;
        let no: Change = |_| Ok(());
        let appears: Change = |dir| fs::write(dir.join("new"), "note: another's");
        let written: Change = |dir| fs::write(dir.join("empty"), "mine");
        let replaced: Change = |dir| fs::rename(dir.join("mine"), dir.join("note"));
        let linked: Change = |dir| symlink("mine", dir.join("new"));
        let elsewhere: Change = |dir| {
            fs::remove_file(dir.join("near"))?;
            symlink(".", dir.join("near"))
        };
        let cases: &[(&str, Change, &str)] = &[
            ("DIR/new", no, ""),
            ("DIR/empty", no, ""),
            ("DIR/note", no, ""),
            ("DIR/locked", no, "is read-only"),
            ("DIR/new/", no, "is a directory"),
            ("DIR/new/.", no, "is a directory"),
            ("DIR/deep/er/new", no, ""),
            (
                "DIR/deep/../note",
                no,
                "behind a folder that does not exist",
            ),
            ("DIR/near/note", no, ""),
            ("DIR/near/../note", no, ""),
            ("file://DIR/note", no, ""),
            ("s3://bucket/note", no, "no file of this machine"),
            ("DIR/mine", no, "is not a note; choose another name, or"),
            ("DIR/input", no, "this command reads that file"),
            ("DIR/far/../input", no, "this command reads that file"),
            ("DIR/near/../input", no, "this command reads that file"),
            ("file://DIR/input", no, "this command reads that file"),
            ("DIR/hard", no, "this command reads that file"),
            ("DIR/set/new", no, "lies in the dataset"),
            ("DIR/near/../set/_peelnet/new", no, "lies in the dataset"),
            ("file://DIR/set/deep/new", no, "lies in the dataset"),
            ("file:DIR/new", no, "no file of this machine"),
            ("DIR/far", no, "is a directory"),
            ("DIR/far/..", no, "is a directory"),
            ("DIR/mine/new", no, "cannot be written"),
            ("DIR/link", no, "is a link"),
            ("DIR/chain", no, "is a link"),
            ("DIR/dangling", no, "is a link"),
            ("DIR/circle", no, "is a link"),
            ("DIR/null", no, "is a link"),
            ("DIR/dangling/new", no, "leads nowhere"),
            ("DIR/pipe", no, "no regular file"),
            ("/dev/null", no, "no regular file"),
            ("/dev/stdout", no, "is a link"),
            ("/proc/self/fd/OPEN", no, "is a link"),
            ("/proc/self/fd/1", no, "is a link"),
            ("/proc/self/new", no, "cannot be written"),
            ("DIR/new", appears, "another file came there"),
            (
                "DIR/deep/../new",
                appears,
                "behind a folder that does not exist",
            ),
            ("DIR/note", |dir| fs::remove_file(dir.join("note")), ""),
            ("DIR/empty", written, "the file changed"),
            ("DIR/note", replaced, "the file changed"),
            ("DIR/new", linked, "is a link"),
            ("DIR/near/note", elsewhere, "the file changed"),
        ];
        for (path, change, words) in cases {
            let (dir, open) = folder();
            let text = path.replace("DIR", &dir.path().to_string_lossy());
            let path = PathBuf::from(text.replace("OPEN", &open.as_raw_fd().to_string()));
            let mut outputs = Outputs::new(("--force", false), [dir.path().join("input")]);
            let mut before = everything(dir.path());
            let result = outputs.file("--out", &path, NOTE).and_then(|()| {
                change(dir.path()).expect("changes");
                before = everything(dir.path());
                write_whole(&path, b"note: new").map_err(Refused::from)
            });
            let said = result.err().map_or_else(String::new, |e| e.to_string());
            let is_as_expected = said.contains(words) && said.is_empty() == words.is_empty();
            assert!(is_as_expected, "{path:?}: '{said}'");
            let mut after = everything(dir.path());
            if words.is_empty() {
                let Output { file, .. } = Output::look(&path).expect("leads there");
                let file = file.expect("is no stdout");
                let (text, mode) = after.remove(&file).expect("is written");
                assert_eq!(text, "note: new");
                let was = before.remove(&file);
                assert_eq!(was.map_or(mode.clone(), |(_, mode)| mode), mode, "{path:?}");
                after.retain(|path, _| !path.starts_with(dir.path().join("deep")));
            }
            assert_eq!(after, before, "{path:?}");
        }
    }

    /// Commands that write a file several times, and files whose names are known late.
    #[test]
    fn what_a_command_wrote_is_its_own() {
        let dir = tempfile::tempdir().expect("temporary folder");
        let at = |name: &str| dir.path().join(name);
        let mut outputs = Outputs::new(("--force", false), [""; 0]);
        outputs.file("--out", &at("a"), NOTE).expect("is free");
        let images = at("images");
        outputs
            .files_like("--out", &images, "png", NOTE)
            .expect("are free");
        for file in [at("a"), at("images/1.png")] {
            for text in [b"note: 1", b"note: 2"] {
                write_whole(&file, text).expect("is its own");
                assert_eq!(fs::read(&file).expect("reads"), text);
            }
        }
        remove_replaced(&at("a")).expect("is its own");
        remove_replaced(&at("a")).expect("is gone");
        fs::write(at("a"), "mine").expect("writes");
        assert!(remove_replaced(&at("a")).is_err() && at("a").exists());
        fs::write(at("images/2.png"), "mine").expect("writes");
        assert!(write_whole(&at("images/2.png"), b"note").is_err());
        drop(outputs);
        // A library's caller decides.
        write_whole(&at("images/2.png"), b"note").expect("writes");
        assert!(write_whole(dir.path(), b"note").is_err());
    }

    /// A relative folder that does not exist yet: it is created in the one where the command runs.
    #[test]
    fn new_folders_may_be_relative() {
        for folder in ["new", "new/er", "./new", "../new"] {
            check_is_folder("--out", Path::new(folder)).expect("can be created");
        }
    }
}
