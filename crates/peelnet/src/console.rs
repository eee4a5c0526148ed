//! Output: results to stdout, messages to stderr.

use crate::failure::Failure;
use std::io::{self, IsTerminal as _, Write as _};

/// What the global flags say about output.
#[derive(Clone, Copy, Debug)]
pub struct Console {
    quiet: bool,
    json: bool,
}

impl Console {
    /// From the flags `--quiet` and `--json`.
    pub const fn new(quiet: bool, json: bool) -> Self {
        Self { quiet, json }
    }

    /// A message for people, on stderr; silent with `--quiet`.
    pub fn message(self, text: impl AsRef<str>) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{}", text.as_ref());
        }
    }

    /// A warning, on stderr; shown even with `--quiet`, because it changes what a result means.
    pub fn warn(self, text: impl AsRef<str>) {
        let _ = writeln!(io::stderr(), "warning: {}", text.as_ref());
    }

    /// The command's result on stdout: JSON with `--json`, else text.
    ///
    /// # Errors
    /// If stdout cannot be written. A reader that has closed its pipe has read enough, which is no error.
    pub fn result(
        self,
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> serde_json::Value,
    ) -> Result<(), Failure> {
        let text = if self.json {
            format!("{:#}", json())
        } else {
            text()
        };
        let mut out = io::stdout().lock();
        match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
            Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
                Err(Failure::Failed(format!("cannot write to stdout: {e}")))
            }
            _ => Ok(()),
        }
    }

    /// Whether progress bars may be drawn.
    pub fn shows_progress(self) -> bool {
        !self.quiet && io::stderr().is_terminal()
    }
}
