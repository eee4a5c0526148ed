//! All tests of the program, in one binary: each further one would link everything again.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod command_line;
mod common;
mod examples;
mod extract_shared;
mod faults;
mod foreign_text;
#[cfg(unix)]
mod fuzzed_commands;
mod measured;
mod outputs;
mod pages;
mod whole_run;
