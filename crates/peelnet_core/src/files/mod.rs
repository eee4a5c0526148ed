//! Files and foreign text: outputs appear whole or not at all ([`write_whole`]; datasets, which are folders, have their own
//! way) and replace only their own kind ([`Kind`]); inputs are regular files of bounded size ([`read`], [`open`]); names from files and
//! arguments are shown without what they could do to a terminal or a shader ([`printable`]).
#![allow(missing_docs, reason = "users of the facade do not see it")]

mod input;
mod output;
mod text;

/// An error of a path that is not what was asked for.
fn invalid(why: &str) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::InvalidInput, why)
}

pub use input::{check_size, open, read, read_head};
pub use output::{
    Found, Kind, META, Moving, Outputs, Refused, STDOUT, Unfinished, check_file, check_is_folder,
    check_outside_datasets, folder_of, holds, identity, is_remote, moving, remove_replaced,
    remove_unfinished, temporary, to_stdout, write_whole,
};
pub use text::{
    MAX_SHOWN, check_name, counted, error_line, hex, known_names, one_line, printable,
    printable_json, printable_lines, shown, thousands,
};
