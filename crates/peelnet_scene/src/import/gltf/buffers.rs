use super::nodes::Reader;
use crate::files::MAX_MESH;
use base64::{
    Engine as _,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use peelnet_core::files::printable;
use std::{path::Path, sync::Arc};

/// Base64 with or without padding, as exporters write it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

impl Reader<'_, '_> {
    /// The bytes that a URI names or holds. The `gltf` crate reads from the file system only, so it is not asked.
    pub fn read_uri(&mut self, uri: &str, limit: u64) -> Result<Arc<Vec<u8>>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            return read_data(data, limit).map(Arc::new);
        }
        let absolute = uri
            .strip_prefix("file://")
            .or_else(|| uri.strip_prefix("file:"));
        if absolute.is_none() && uri.contains(':') {
            return Err("has a scheme that is not read".to_owned());
        }
        let name = absolute.unwrap_or(uri);
        let decoded = urlencoding::decode(name);
        let folder = self.path.parent().unwrap_or(Path::new("."));
        let mut read = |name: &str| self.files.buffer(&folder.join(name), limit);
        // Some exporters write names as they are, with percent signs that encode nothing.
        let found = match decoded {
            Ok(decoded) if decoded != name => read(&decoded).or_else(|e| read(name).map_err(|_| e)),
            _ => read(name),
        };
        found.map_err(|e| e.reason())
    }

    /// Reads the buffers of a document; `blob` is the binary chunk of a GLB file.
    pub fn read_buffers(
        &mut self,
        document: &gltf::Document,
        mut blob: Option<Vec<u8>>,
    ) -> Result<(), String> {
        for buffer in document.buffers() {
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => {
                    Arc::new(blob.take().ok_or("there is no binary chunk")?)
                }
                gltf::buffer::Source::Uri(uri) => {
                    let read = self.read_uri(uri, MAX_MESH);
                    read.map_err(|e| format!("'{}' {e}", printable(uri)))?
                }
            };
            let (index, held, needed) = (buffer.index(), bytes.len(), buffer.length());
            if held < needed {
                return Err(format!(
                    "buffer {index} has {held} bytes instead of {needed}"
                ));
            }
            self.buffers.push(bytes);
        }
        Ok(())
    }

    /// Zeros, and what a sparse accessor has in place of some of them, lie in no bytes that say how many there can be.
    pub fn check_zeros(&self, document: &gltf::Document) -> Result<(), String> {
        let held = self.buffers.iter().map(|bytes| bytes.len()).max();
        let held = held.unwrap_or_default();
        let mut zeros = document.accessors().filter(|a| a.view().is_none());
        match zeros.find(|a| a.count() > held) {
            None => Ok(()),
            Some(accessor) => Err(format!(
                "accessor {} has {} values without bytes, and its largest buffer {held} bytes; export it again",
                accessor.index(),
                accessor.count()
            )),
        }
    }
}

/// The bytes of a data URI, behind its scheme.
fn read_data(data: &str, limit: u64) -> Result<Vec<u8>, String> {
    let (head, text) = data.split_once(',').ok_or("a data URI holds no data")?;
    let Some(_) = head.strip_suffix(";base64") else {
        return Ok(urlencoding::decode_binary(text.as_bytes()).into_owned());
    };
    // Four letters are three bytes.
    let bytes = text.len() as u64 / 4 * 3;
    peelnet_core::files::check_size(bytes, limit).map_err(|e| e.to_string())?;
    BASE64.decode(text).map_err(|e| e.to_string())
}
