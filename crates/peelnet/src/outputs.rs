//! What a command is going to write, checked before it begins: a file replaces nothing but an older file of its own kind.

use crate::commands::Context;
use crate::failure::Failure;
use crate::parse::shown;
use peelnet_files::{Destination, Kind, STDOUT, Standing, check_folder, destination, folder_of};
use peelnet_render::ImageFormat;
use peelnet_report::kind_of;
use peelnet_scene::Scene;
use std::path::{Path, PathBuf};

/// The outputs of a command, collected and checked one by one.
pub struct Outputs<'a> {
    context: &'a Context<'a>,
    /// Files and folders that the command reads.
    inputs: Vec<PathBuf>,
    /// Files that it writes, as far as they are named.
    taken: Vec<PathBuf>,
    /// What lies where it writes.
    replaced: Vec<(PathBuf, &'static str)>,
}

impl<'a> Outputs<'a> {
    /// Of a command that reads these files and folders.
    pub fn new<P: AsRef<Path>>(
        context: &'a Context<'a>,
        inputs: impl IntoIterator<Item = P>,
    ) -> Self {
        let inputs = inputs.into_iter();
        Self {
            context,
            // A shipped scene is no file.
            inputs: inputs
                .filter_map(|path| path.as_ref().canonicalize().ok())
                .collect(),
            taken: Vec::new(),
            replaced: Vec::new(),
        }
    }

    /// Checks a file.
    ///
    /// # Errors
    /// An input of the command, a file of another kind (both replaced with `--force`), a second output of this name, or a place that
    /// cannot be written.
    pub fn file(&mut self, flag: &str, path: &Path, kind: Kind) -> Result<(), Failure> {
        let cannot = |why: &dyn std::fmt::Display| {
            Failure::Failed(format!("{flag} {}: cannot be written: {why}", shown(path)))
        };
        let file = match destination(path).map_err(|e| cannot(&e))? {
            Destination::File(file) => file,
            Destination::Stdout => return self.stdout(flag),
            Destination::Stderr | Destination::Stream(_) => return Ok(()),
        };
        check_folder(folder_of(&file)).map_err(|e| cannot(&e))?;
        let file = absolute(&file);
        if self.taken.contains(&file) {
            return Err(Failure::Usage(format!(
                "{flag} {}: another output of this command has the same name; choose another",
                shown(path)
            )));
        }
        let force = self.context.global.force;
        if self.is_input(&file) && !force {
            return Err(Failure::Usage(format!(
                "{flag} {}: this command reads that file; choose another name, or replace it with --force",
                shown(path)
            )));
        }
        match kind.standing(&file).map_err(|e| cannot(&e))? {
            Standing::New | Standing::Stream => {}
            Standing::Foreign if !force => {
                return Err(Failure::Failed(format!(
                    "{flag} {}: the file there is not {}; choose another name, or replace it with --force",
                    shown(path),
                    kind.name
                )));
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
        flag: &str,
        folder: &Path,
        files: impl IntoIterator<Item = (impl AsRef<Path>, Kind)>,
    ) -> Result<(), Failure> {
        is_folder(flag, folder)?;
        for (name, kind) in files {
            self.file(flag, &folder.join(name), kind)?;
        }
        Ok(())
    }

    /// Checks the files of a measurement in a folder.
    ///
    /// # Errors
    /// As [`Outputs::folder`].
    pub fn results(&mut self, flag: &str, folder: &Path, files: &[&str]) -> Result<(), Failure> {
        let files = files.iter().map(|name| (name, kind_of(name)));
        self.folder(flag, folder, files)
    }

    /// Checks a folder that gets PNG images whose names are not known yet: none of those in it may be foreign.
    ///
    /// # Errors
    /// As [`Outputs::file`].
    pub fn pictures(&mut self, flag: &str, folder: &Path) -> Result<(), Failure> {
        let kind = ImageFormat::Png.kind();
        is_folder(flag, folder)?;
        let Ok(entries) = std::fs::read_dir(folder) else {
            return Ok(());
        };
        let mut names: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
        names.sort();
        for path in names {
            if path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("png"))
            {
                self.file(flag, &path, kind)?;
            }
        }
        Ok(())
    }

    /// Says what will be replaced, before work on these scenes begins.
    ///
    /// # Errors
    /// An output that a scene reads, such as a texture: which files these are is known only once it is loaded.
    pub fn begin(mut self, scenes: &[Scene]) -> Result<(), Failure> {
        let read = scenes.iter().flat_map(|s| &s.files);
        self.inputs = read.filter_map(|f| f.canonicalize().ok()).collect();
        let input = self.taken.iter().find(|file| self.is_input(file));
        if let Some(file) = input.filter(|_| !self.context.global.force) {
            return Err(Failure::Usage(format!(
                "--out: would replace {}, which a scene of this command reads; choose another name, or replace it with --force",
                shown(file)
            )));
        }
        let Some((first, what)) = self.replaced.first() else {
            return Ok(());
        };
        let more = match self.replaced.len() - 1 {
            0 => String::new(),
            1 => " and one more file".to_owned(),
            n => format!(" and {n} more files"),
        };
        self.context
            .console
            .message(format!("replacing {} ({what}){more}", shown(first)));
        Ok(())
    }

    /// Results then go to stderr, so that stdout holds the file alone.
    fn stdout(&mut self, flag: &str) -> Result<(), Failure> {
        let stdout = PathBuf::from(STDOUT);
        if self.taken.contains(&stdout) {
            return Err(Failure::Usage(format!(
                "{flag} -: another output of this command goes to stdout already"
            )));
        }
        self.taken.push(stdout);
        self.context.console.give_stdout_away();
        Ok(())
    }

    fn is_input(&self, file: &Path) -> bool {
        self.inputs
            .iter()
            .any(|input| file.starts_with(input) || is_same(file, input))
    }
}

/// An error if a folder's name says stdout or is a file's.
///
/// # Errors
/// See above.
pub fn is_folder(flag: &str, folder: &Path) -> Result<(), Failure> {
    if folder == Path::new(STDOUT) {
        return Err(Failure::Usage(format!(
            "{flag} -: a folder is written, which stdout cannot hold; name a folder"
        )));
    }
    if folder.exists() && !folder.is_dir() {
        return Err(Failure::Failed(format!(
            "{flag} {}: is a file; name a folder",
            shown(folder)
        )));
    }
    check_folder(folder)
        .map_err(|e| Failure::Failed(format!("{flag} {}: cannot be written: {e}", shown(folder))))
}

/// The path with its links resolved, as far as it exists.
fn absolute(path: &Path) -> PathBuf {
    let resolved = path.canonicalize().or_else(|_| {
        let folder = folder_of(path).canonicalize()?;
        Ok::<_, std::io::Error>(
            path.file_name()
                .map_or(folder.clone(), |name| folder.join(name)),
        )
    });
    resolved
        .or_else(|_| std::path::absolute(path))
        .unwrap_or_else(|_| path.to_owned())
}

/// Whether two paths are the same file, also by hard links.
#[cfg(unix)]
fn is_same(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let id = |p: &Path| std::fs::metadata(p).map(|m| (m.dev(), m.ino()));
    matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(not(unix))]
fn is_same(a: &Path, b: &Path) -> bool {
    a == b
}
