//! Lists every folder here that holds a model.

use std::{env, fs, io, path::PathBuf};

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?);
    let out = PathBuf::from(env::var("OUT_DIR").map_err(io::Error::other)?);
    println!("cargo::rerun-if-changed={}", root.display());
    let mut entries = Vec::new();
    for folder in fs::read_dir(&root)? {
        let folder = folder?;
        let files = ["model.safetensors", "model.wgsl", "model.json"];
        let files = files.map(|name| folder.path().join(name));
        if files.iter().all(|file| file.is_file()) {
            entries.push((folder.file_name(), files));
        }
    }
    entries.sort();
    let text: String = entries
        .iter()
        .map(|(name, [file, wgsl, json])| {
            format!(
                "    Shipped {{ name: {name:?}, file: include_bytes!({file:?}), wgsl: include_str!({wgsl:?}), json: include_str!({json:?}) }},\n"
            )
        })
        .collect();
    fs::write(out.join("models.rs"), format!("&[\n{text}]\n"))
}
