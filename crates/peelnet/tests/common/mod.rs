//! What several tests of the program share.
#![allow(dead_code, reason = "no test uses all of it")]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A scene of two triangles that is drawn in no time.
pub const SCENE: &str = "name = \"two\"\n[camera]\nposition = [0, 0, 3]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nfov_y = 45\nnear = 0.1\n\
    far = 10\n[[object]]\nmesh = { shape = \"quad\", size = [1, 1] }\n[object.material]\ncolor = [0.8, 0.1, 0.1]\nalpha = 0.5\n";

/// Runs the program in a folder.
pub fn peelnet<A: AsRef<OsStr>>(folder: &Path, arguments: &[A]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_peelnet"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

/// What a command line said on stderr, which ends with this code.
pub fn ends_with(folder: &Path, line: &str, code: i32) -> String {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let output = peelnet(folder, &arguments);
    let text = String::from_utf8(output.stderr).expect("messages are text");
    assert_eq!(output.status.code(), Some(code), "{line}: {text}");
    text
}

/// Everything below a folder: what it is, and a hash of what it holds.
pub fn everything(folder: &Path) -> BTreeMap<PathBuf, (String, u64)> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).expect("lists") {
            let path = entry.expect("an entry").path();
            let kind = std::fs::symlink_metadata(&path)
                .expect("is there")
                .file_type();
            let mut hasher = DefaultHasher::new();
            let what = if kind.is_symlink() {
                let target = std::fs::read_link(&path).expect("a link");
                format!("link to {}", target.display())
            } else if kind.is_dir() {
                folders.push(path.clone());
                "folder".to_owned()
            } else if kind.is_file() {
                std::fs::read(&path).expect("reads").hash(&mut hasher);
                "file".to_owned()
            } else {
                "a device or a pipe".to_owned()
            };
            let name = path.strip_prefix(folder).expect("below it").to_owned();
            found.insert(name, (what, hasher.finish()));
        }
    }
    found
}
