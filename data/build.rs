//! Lists the scene files of the folders here.

use std::{env, fs, io, path::PathBuf};

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?);
    let out = PathBuf::from(env::var("OUT_DIR").map_err(io::Error::other)?);
    println!("cargo::rerun-if-changed={}", root.display());
    for folder in ["scenes", "effects"] {
        let mut entries = Vec::new();
        for entry in fs::read_dir(root.join(folder))? {
            let file = entry?.path();
            if file.extension().is_some_and(|e| e == "toml") {
                entries.push((file.file_stem().unwrap_or_default().to_owned(), file));
            }
        }
        entries.sort();
        let text: String = entries
            .iter()
            .map(|(name, file)| {
                let path = format!("data/{folder}/{}.toml", name.to_string_lossy());
                format!(
                    "    SceneFile {{ name: {name:?}, path: {path:?}, text: include_str!({file:?}) }},\n"
                )
            })
            .collect();
        fs::write(out.join(format!("{folder}.rs")), format!("&[\n{text}]\n"))?;
    }
    Ok(())
}
