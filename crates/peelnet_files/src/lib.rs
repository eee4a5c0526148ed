//! Files and foreign text: outputs appear whole or not at all ([`write_whole`]; datasets, which are folders, have their own
//! way) and replace only their own kind ([`Kind`]); inputs are regular files of bounded size ([`read`], [`open`]); names from files and
//! arguments are shown without what they could do to a terminal or a shader ([`printable`]).

mod input;
mod kind;
mod output;
mod text;
mod unfinished;

pub use input::{check_size, open, read, read_head};
pub use kind::{Kind, Standing};
pub use output::{Destination, STDOUT, check_folder, destination, folder_of, write_whole};
pub use text::{
    MAX_SHOWN, counted, error_line, hex, one_line, printable, printable_json, printable_lines,
    shown, thousands,
};
pub use unfinished::{Moving, Unfinished, remove_unfinished};
