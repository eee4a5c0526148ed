//! glTF 2.0 and GLB files: nodes, instances, materials with their textures, vertex colours, Gaussian splats, point and directional lights, and
//! cameras. What a file uses and is not drawn is reported in a warning, never dropped silently.

mod buffers;
mod checks;
mod materials;
mod nodes;
mod primitives;
mod repair;
mod splats;

use super::Imported;
use crate::{
    error::SceneError,
    files::{Files, MAX_MESH},
};
use gltf::json::{Root, extensions::ENABLED_EXTENSIONS};
use nodes::Reader;
use peelnet_core::files::{counted, printable};
use serde_json::Value;
use std::{borrow::Cow, path::Path, sync::Arc};

/// Size of the largest JSON that is read, bytes: in memory it takes up to 16 times as much. Buffers can lie outside of it.
const MAX_JSON_BYTES: usize = 256 << 20;

/// Checks that the length in the header of a GLB file holds that header, which the crate subtracts from it unseen. Found by fuzzing.
fn check_length(bytes: &[u8]) -> Result<(), String> {
    const HEADER: u32 = 12;
    let said = bytes.get(8..12).and_then(|said| said.try_into().ok());
    let said = said.map_or(0, u32::from_le_bytes);
    if said < HEADER {
        return Err(format!(
            "is no glTF 2.0 file: its header says that it has {}, of which the header alone takes {HEADER}; export it again",
            counted(said.into(), "byte")
        ));
    }
    Ok(())
}

struct Parsed {
    document: gltf::Document,
    /// The binary chunk of a GLB file.
    blob: Option<Vec<u8>>,
    /// See [`checks::loses_transforms`].
    loses_transforms: bool,
    declared: splats::AllDeclared,
}

/// The document of a glTF or GLB file, checked.
fn parse(bytes: &[u8]) -> Result<Parsed, String> {
    let bad = |e: &dyn std::fmt::Display| format!("is no glTF 2.0 file: {e}; export it again");
    let glb;
    let (text, blob) = if bytes.starts_with(b"glTF") {
        check_length(bytes)?;
        glb = gltf::binary::Glb::from_slice(bytes).map_err(|e| bad(&e))?;
        (&*glb.json, glb.bin.map(Cow::into_owned))
    } else {
        (bytes, None)
    };
    if text.len() > MAX_JSON_BYTES {
        return Err(format!(
            "its JSON has {} bytes, and at most {MAX_JSON_BYTES} are read; export it as .glb, or with buffers of their own",
            text.len()
        ));
    }
    // A byte order mark is no JSON, but some editors write one.
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    // The crate skips unknown names without checking that they are text.
    let mut document = serde_json::from_slice::<Value>(text).map_err(|e| bad(&e))?;
    if let Some(fields) = document.as_object_mut() {
        fields.retain(|name, field| !(field.is_null() && name.starts_with("scene")));
    }
    checks::check_names(&document)?;
    checks::list_extensions(&mut document);
    checks::check_version(&document)?;
    checks::check_extensions(&document)?;
    let loses_transforms = checks::loses_transforms(&document);
    let declared = splats::take_declared(&mut document);
    let mut root: Root = serde_json::from_value(document)
        // The text has lines and columns for it.
        .map_err(|e| bad(&Root::from_slice(text).err().unwrap_or(e)))?;
    checks::check_elements(&root)?;
    repair::fault_of(&root).map_or(Ok(()), |e| Err(bad(&e)))?;
    repair::repair(&mut root).map_err(|e| bad(&e))?;
    let document = gltf::Document::from_json_without_validation(root);
    Ok(Parsed {
        document,
        blob,
        loses_transforms,
        declared,
    })
}

/// Reads a glTF or GLB file and the buffers and images that it names: a part of the mesh for each primitive. All materials say how they are lit.
pub(super) fn load(path: &Path, files: &mut Files<'_>) -> Result<Imported, SceneError> {
    let fail = |message: String| SceneError::file(path, None, message);
    let bytes = files.read(path, MAX_MESH)?;
    let parsed = parse(&bytes).map_err(&fail)?;
    let (document, blob) = (parsed.document, parsed.blob);
    drop(bytes);
    let mut reader = Reader::new(path, files, &document);
    reader.declared = Arc::new(parsed.declared);
    let read = reader.read_buffers(&document, blob);
    read.map_err(|e| fail(format!("its buffer {e}; keep the .bin files beside it")))?;
    reader.check_zeros(&document).map_err(&fail)?;
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next())
        .ok_or_else(|| fail("holds no scene; export one".into()))?;
    if document.scenes().len() > 1 {
        let (drawn, all) = (scene.index(), document.scenes().len());
        let others = format!("scenes other than number {drawn} of {all}");
        reader.missing(&others, "", "");
    }
    for (i, node) in document.as_json().nodes.iter().enumerate() {
        let Some(m) = node.matrix else { continue };
        if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
            let what = "translation, rotation or scale beside a matrix: node ";
            reader.missing(what, &i.to_string(), "");
        }
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            reader.missing("perspective of a matrix: node ", &i.to_string(), "");
        }
    }
    reader.scene(&scene)?;
    if document.animations().len() > 0 {
        reader.missing("animations (the first pose is drawn)", "", "");
    }
    if parsed.loses_transforms {
        let what = "texture transforms of normal and occlusion maps (the first map's is used)";
        reader.missing(what, "", "");
    }
    if document.skins().len() > 0 {
        reader.missing("skins (the bind pose is drawn)", "", "");
    }
    let is_unknown = |extension: &&str| {
        !ENABLED_EXTENSIONS.contains(extension) && *extension != splats::SPLATTING
    };
    for extension in document.extensions_used().filter(is_unknown) {
        reader.missing("extensions: ", &printable(extension), "");
    }
    if reader.loaded.mesh.triangles.is_empty() {
        let instead = reader.files.warnings.texts().join("; ");
        return Err(fail(format!(
            "holds no triangles; export a mesh{}{instead}",
            if instead.is_empty() { "" } else { ". " },
        )));
    }
    Ok(reader.loaded)
}
