//! Buffers and URIs.

use crate::{
    error::SceneError,
    files::{FileKind, Files},
};
use base64::{
    Engine as _,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use peelnet_files::printable;
use std::path::{Path, PathBuf};

/// Base64 with or without padding, as exporters write it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The file that a URI names. The `gltf` crate reads from the file system only, so it is not asked.
fn uri_path(uri: &str, folder: &Path) -> Result<PathBuf, String> {
    let absolute = uri
        .strip_prefix("file://")
        .or_else(|| uri.strip_prefix("file:"));
    if let Some(path) = absolute {
        return Ok(path.into());
    }
    if uri.contains(':') {
        return Err(format!(
            "'{}' has a scheme that is not read",
            printable(uri)
        ));
    }
    let name = urlencoding::decode(uri);
    let name =
        name.map_err(|_| format!("'{}' is no name of a file; rename the file", printable(uri)))?;
    Ok(folder.join(&*name))
}

/// The bytes that a URI names or holds.
pub(super) fn read_uri(
    uri: &str,
    folder: &Path,
    kind: FileKind,
    files: &mut Files<'_>,
) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data
            .split_once(";base64,")
            .ok_or("a data URI is not base64")?;
        // Four letters are three bytes.
        let bytes = text.len() as u64 / 4 * 3;
        peelnet_files::check_size(bytes, kind.max_bytes()).map_err(|e| e.to_string())?;
        return BASE64.decode(text).map_err(|e| e.to_string());
    }
    let path = uri_path(uri, folder)?;
    let bytes = files.read(&path, kind).map_err(|e| match e {
        SceneError::Read { source, .. } => format!("'{}': {source}", printable(uri)),
        e => e.to_string(),
    })?;
    files.record(&path, &bytes);
    Ok(bytes)
}

/// The buffers of a document; `blob` is the binary chunk of a GLB file.
pub(super) fn read_buffers(
    document: &gltf::Document,
    folder: &Path,
    mut blob: Option<Vec<u8>>,
    files: &mut Files<'_>,
) -> Result<Vec<Vec<u8>>, String> {
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().ok_or("there is no binary chunk")?,
            gltf::buffer::Source::Uri(uri) => read_uri(uri, folder, FileKind::Mesh, files)?,
        };
        if bytes.len() < buffer.length() {
            return Err(format!(
                "buffer {} has {} bytes instead of {}",
                buffer.index(),
                bytes.len(),
                buffer.length()
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}
