//! The command line `peelnet`: parsing, progress and messages, nothing else.
//!
//! [`cli`] declares the flags; every command is one file of [`commands`], which calls the libraries and prints.
//! Results go to stdout and messages to stderr, both through [`console`]; progress bars ([`progress`]) show on a
//! terminal only. Whatever fails becomes a [`peelnet::Failure`]: one line, and the exit code 1, or 2 for wrong
//! usage. A signal ends every command within a second ([`interrupt`]), and files are complete or absent. What a command writes is
//! checked before it begins ([`peelnet_core::files::Outputs`]).

mod cli;
mod commands;
mod console;
mod interrupt;
mod methods_text;
mod progress;
mod summary_text;
mod values;

use clap::{CommandFactory as _, FromArgMatches as _};
use std::process::ExitCode;

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    set_runtime_folder();
    let mut command = with_negative_numbers(cli::Cli::command());
    let parsed = command.try_get_matches_from_mut(std::env::args_os());
    let parsed = parsed.and_then(|matches| cli::Cli::from_arg_matches(&matches));
    let cli = match parsed.map_err(|error| error.format(&mut command)) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are asked for and go to stdout; everything else is wrong usage.
            if error.use_stderr() && std::env::args_os().any(|a| is_foreign(&a)) {
                // Without colours: they would be escaped as well.
                let text = error.render().to_string();
                let text = text.trim_end().trim_start_matches("error: ");
                console::error(text);
            } else {
                let _ = error.print();
            }
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let code = match commands::dispatch(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            console::error(&failure.to_string());
            ExitCode::from(if failure.is_wrong_value { 2 } else { 1 })
        }
    };
    interrupt::exit_code(code)
}

/// Takes -1 for a value wherever a value is expected, so that the error is about the value.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let command = command.mut_args(|arg| {
        let takes_value = arg.get_action().takes_values() && !arg.is_positional();
        arg.allow_negative_numbers(takes_value)
    });
    command.mut_subcommands(with_negative_numbers)
}

/// Starts the program anew with `XDG_RUNTIME_DIR` where containers leave it out: Mesa's drivers print an error of their own without it, also
/// where nothing is wrong. A process cannot safely change its own variables.
#[cfg(target_os = "linux")]
fn set_runtime_folder() {
    use std::os::unix::process::CommandExt as _;
    const NAME: &str = "XDG_RUNTIME_DIR";
    if std::env::var_os(NAME).is_some_and(|folder| !folder.is_empty()) {
        return;
    }
    let mut arguments = std::env::args_os();
    let mut command = std::process::Command::new("/proc/self/exe");
    command.arg0(arguments.next().unwrap_or_default());
    // Returns only if it fails; the message is then all that is lost.
    let _ = command
        .args(arguments)
        .env(NAME, std::env::temp_dir())
        .exec();
}

/// Whether an argument, such as the name of a file, holds what must not reach a terminal.
fn is_foreign(argument: &std::ffi::OsStr) -> bool {
    let text = argument.to_string_lossy();
    peelnet_core::files::printable_lines(&text) != text
}
