//! Lists every `.wgsl` file of this folder, so that a new shader needs no entry anywhere.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?);
    let out = PathBuf::from(env::var("OUT_DIR").map_err(io::Error::other)?);
    println!("cargo::rerun-if-changed={}", root.display());
    let mut entries = Vec::new();
    list(&root, "", &mut entries)?;
    entries.sort();
    let text: String = entries
        .iter()
        .map(|(path, file)| format!("    ({path:?}, include_str!({file:?})),\n"))
        .collect();
    fs::write(out.join("sources.rs"), format!("&[\n{text}]\n"))
}

/// Module path and file of every shader below a folder.
fn list(folder: &Path, prefix: &str, entries: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{prefix}{stem}");
        if path.is_dir() {
            list(&path, &format!("{name}::"), entries)?;
        } else if path.extension().is_some_and(|e| e == "wgsl") {
            entries.push((name, path));
        }
    }
    Ok(())
}
