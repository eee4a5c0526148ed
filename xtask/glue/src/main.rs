//! `glue FILE.wasm FOLDER [--unpacked]`: a wasm file for the web as NAME_bg.wasm.gz, or unpacked as NAME_bg.wasm, and the JavaScript that loads it.

use std::{
    env,
    error::Error,
    fs::{self, File},
    io::BufWriter,
    path::Path,
};

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<_> = env::args_os().skip(1).collect();
    let (wasm, folder, is_packed) = match paths.as_slice() {
        [wasm, folder] => (wasm, folder, true),
        [wasm, folder, flag] if flag == "--unpacked" => (wasm, folder, false),
        _ => return Err("usage: glue FILE.wasm FOLDER [--unpacked]".into()),
    };
    let (wasm, folder) = (Path::new(wasm), Path::new(folder));
    wasm_bindgen_cli_support::Bindgen::new()
        .input_path(wasm)
        .web(true)
        .map_err(|e| format!("{e:?}"))?
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
        .map_err(|e| format!("{e:?}"))?;
    if !is_packed {
        return Ok(());
    }
    let name = wasm.file_stem().unwrap_or_default().to_string_lossy();
    let plain = folder.join(format!("{name}_bg.wasm"));
    let packed = BufWriter::new(File::create(plain.with_extension("wasm.gz"))?);
    let options = zopfli::Options {
        iteration_count: std::num::NonZeroU64::new(5).ok_or("no iterations")?,
        maximum_block_splits: 60,
        ..zopfli::Options::default()
    };
    zopfli::compress(options, zopfli::Format::Gzip, &*fs::read(&plain)?, packed)?;
    fs::remove_file(plain)?;
    Ok(())
}
