//! Output: results to stdout, messages to stderr. Whatever is printed passes through here, so that no text from a file or an argument
//! reaches a terminal unescaped.

use peelnet::Failure;
use peelnet_core::files::{printable_json, printable_lines, to_stdout};
use std::io::{self, IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a file is written to stdout, so that nothing else may.
static STDOUT_IS_A_FILE: AtomicBool = AtomicBool::new(false);

/// What the global flags say about output.
#[derive(Clone, Copy, Debug)]
pub struct Console {
    quiet: bool,
    json: bool,
}

impl Console {
    pub const fn new(quiet: bool, json: bool) -> Self {
        Self { quiet, json }
    }

    /// A message for people, on stderr; silent with `--quiet`.
    pub fn message(self, text: impl AsRef<str>) {
        if !self.quiet {
            to_stderr("", text.as_ref());
        }
    }

    /// A warning, on stderr; shown even with `--quiet`, because it changes what a result means.
    pub fn warn(self, text: impl AsRef<str>) {
        to_stderr("warning: ", text.as_ref());
    }

    /// From now on stdout holds a file, and results go to stderr.
    pub fn give_stdout_away(self) {
        STDOUT_IS_A_FILE.store(true, Ordering::Relaxed);
    }

    /// The command's result on stdout: JSON with `--json`, else text. A reader that has closed its pipe has read enough, which is no error.
    pub fn result(
        self,
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> serde_json::Value,
    ) -> Result<(), Failure> {
        let text = if self.json {
            printable_json(&format!("{:#}", json())).into_owned()
        } else {
            printable_lines(&text()).into_owned()
        };
        let text = text.trim_end();
        let written = if STDOUT_IS_A_FILE.load(Ordering::Relaxed) {
            writeln!(io::stderr(), "{text}")
        } else if self.json {
            // A program waits for it, so a stdout that is closed is an error.
            to_stdout(format!("{text}\n").as_bytes())
        } else {
            let mut out = io::stdout().lock();
            writeln!(out, "{text}").and_then(|()| out.flush())
        };
        match written {
            Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
                Err(Failure::failed(format!("cannot write to stdout: {e}")))
            }
            _ => Ok(()),
        }
    }

    pub fn shows_progress(self) -> bool {
        !self.quiet && io::stderr().is_terminal()
    }
}

pub fn error(text: &str) {
    to_stderr("error: ", text);
}

fn to_stderr(before: &str, text: &str) {
    // If stderr is closed, there is nowhere to report it.
    let _ = writeln!(io::stderr(), "{before}{}", printable_lines(text));
}
