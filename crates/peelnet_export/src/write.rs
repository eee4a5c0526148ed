//! A verified text and its description as files.

use crate::{ExportError, Language, Options, Verification, json::json, text, verify::verify};
use peelnet_files::STDOUT;
use peelnet_gpu::Gpu;
use peelnet_model::Model;
use std::path::{Path, PathBuf};

/// The description beside an exported text: its name with `json` instead of the last extension, `.es.glsl` being one. `None` of a text that
/// goes to stdout.
pub fn description_path(text: &Path) -> Option<PathBuf> {
    let name = text.to_string_lossy();
    let stem = name
        .strip_suffix(".es.glsl")
        .filter(|_| text.to_str().is_some());
    let path = stem.map_or_else(
        || text.with_extension("json"),
        |s| format!("{s}.json").into(),
    );
    (text != Path::new(STDOUT)).then_some(path)
}

/// Exports a model, verifies the text on the GPU, and only then writes it, whole, and its description beside it.
///
/// # Errors
/// A model without a shader function, a text that differs from the model, or a file that cannot be written.
pub fn export(
    gpu: &Gpu,
    model: &Model,
    path: &Path,
    options: &Options,
) -> Result<Verification, ExportError> {
    let in_wgsl = Options {
        language: Language::Wgsl,
        ..*options
    };
    write_verified(gpu, model, path, options, &text::text(model, &in_wgsl)?)
}

/// Writes if the text computes what the model does.
pub(crate) fn write_verified(
    gpu: &Gpu,
    model: &Model,
    path: &Path,
    options: &Options,
    wgsl: &str,
) -> Result<Verification, ExportError> {
    let verification = verify(gpu, model, wgsl)?;
    let description = json(model)?;
    let beside = description_path(path).map(|path| (path, description));
    let text = (path.to_owned(), text::text(model, options)?);
    for (path, text) in [text].into_iter().chain(beside) {
        peelnet_files::write_whole(&path, text.as_bytes())
            .map_err(|source| ExportError::Write { path, source })?;
    }
    Ok(verification)
}
