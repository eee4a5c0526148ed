//! What a file is, by its content: an output replaces only a file of its own kind.

use crate::{Destination, destination, read_head};
use std::{io, path::Path};

/// Bytes at the beginning of a file by which its kind is known.
const HEAD: u64 = 1 << 16;

/// A kind of file that peelnet writes.
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
    /// Nothing, or an empty file.
    New,
    /// A file of the kind, which is replaced.
    Replaced,
    /// Another file, which is not peelnet's to replace.
    Foreign,
    /// Stdout, a device or a pipe.
    Stream,
}

impl Kind {
    /// What lies at a path.
    ///
    /// # Errors
    /// A folder, or a file that cannot be read.
    pub fn standing(&self, path: &Path) -> io::Result<Standing> {
        let Destination::File(path) = destination(path)? else {
            return Ok(Standing::Stream);
        };
        match read_head(&path, HEAD) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(Standing::New),
            Err(e) => Err(e),
            Ok(head) if head.is_empty() => Ok(Standing::New),
            Ok(head) if (self.is)(&head) => Ok(Standing::Replaced),
            Ok(_) => Ok(Standing::Foreign),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_there_is_known_by_its_content() {
        const NOTE: Kind = Kind {
            name: "a note",
            is: |head| head.starts_with(b"note"),
        };
        let dir = tempfile::tempdir().expect("temporary folder");
        let at = |name: &str, text: &str| {
            let path = dir.path().join(name);
            std::fs::write(&path, text).expect("writes");
            NOTE.standing(&path).expect("stands")
        };
        assert_eq!(at("a", "note: x"), Standing::Replaced);
        assert_eq!(at("b", "not a note"), Standing::Foreign);
        assert_eq!(at("c", ""), Standing::New);
        let missing = dir.path().join("d/e");
        assert_eq!(NOTE.standing(&missing).expect("stands"), Standing::New);
        assert!(NOTE.standing(dir.path()).is_err());
        let stdout = NOTE.standing(Path::new(crate::STDOUT));
        assert_eq!(stdout.expect("stands"), Standing::Stream);
    }
}
