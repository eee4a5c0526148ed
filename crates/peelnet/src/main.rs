//! The command line `peelnet`: parsing, progress and messages, nothing else.
//!
//! [`cli`] declares the flags; every command is one file of [`commands`], which calls the libraries and prints.
//! Results go to stdout and messages to stderr, both through [`console`]; progress bars ([`progress`]) show on a
//! terminal only. Whatever fails becomes a [`failure::Failure`]: one line, and the exit code 1, or 2 for wrong
//! usage. Ctrl-C sets one flag ([`interrupt`]) that the long loops check, so files are complete or absent.

mod cli;
mod commands;
mod console;
mod failure;
mod interrupt;
mod learned;
mod methods_text;
mod parse;
mod progress;
mod summary_text;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = match cli::Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are asked for and go to stdout; everything else is wrong usage.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match commands::dispatch(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
