//! A verified text as a file.

use crate::{ExportError, Options, Verification, verify::verify, wgsl::wgsl};
use peelnet_gpu::Gpu;
use peelnet_model::Model;
use std::path::Path;

/// Exports a model, verifies the text on the GPU, and only then writes it, whole.
///
/// # Errors
/// A model without a shader function, a text that differs from the model, or a file that cannot be written.
pub fn export(
    gpu: &Gpu,
    model: &Model,
    path: &Path,
    options: &Options,
) -> Result<Verification, ExportError> {
    write_verified(gpu, model, path, &wgsl(model, options)?)
}

/// Writes a text if it computes what the model does.
pub(crate) fn write_verified(
    gpu: &Gpu,
    model: &Model,
    path: &Path,
    text: &str,
) -> Result<Verification, ExportError> {
    let verification = verify(gpu, model, text)?;
    peelnet_files::write_whole(path, text.as_bytes()).map_err(|source| ExportError::Write {
        path: path.to_owned(),
        source,
    })?;
    Ok(verification)
}
