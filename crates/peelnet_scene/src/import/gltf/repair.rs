//! What the `gltf` crate demands of a file and drawing does not need, supplied: many exporters leave it out.

use gltf::json::{
    Root,
    accessor::sparse::Sparse,
    image::MimeType,
    validation::{Error, Validate},
};
use serde_json::{from_value, json};
use std::collections::BTreeSet;

/// The first fault that the crate finds in a document, and its place. Bounds of positions may be anything, as nobody reads them here, and
/// accessors may lack a buffer view.
pub(super) fn fault_of(root: &Root) -> Option<String> {
    let mut fault = None;
    root.validate(root, gltf::json::Path::new, &mut |path, error| {
        let at = path().to_string();
        let is_view = at.ends_with(".bufferView") && error == Error::Missing;
        if !is_view && !at.ends_with(".min") && !at.ends_with(".max") {
            fault.get_or_insert_with(|| format!("{at}: {error}"));
        }
    });
    fault
}

/// Supplies the zeros of accessors without a buffer view, the scene of a file without one, and kinds of images.
pub(super) fn repair(root: &mut Root) -> serde_json::Result<()> {
    // The crate reads such zeros of sparse accessors only: theirs become one whose first element is replaced by zeros, which are as long as
    // the largest element, a matrix of 16 floats.
    let zeros = format!("data:application/octet-stream;base64,{}==", "A".repeat(86));
    let zeros = from_value(json!({"byteLength": 64, "uri": zeros}))?;
    let buffer = root.push::<gltf::json::Buffer>(zeros);
    let view = from_value(json!({"buffer": buffer, "byteLength": 64}))?;
    let view = root.push::<gltf::json::buffer::View>(view);
    let sparse: Sparse = from_value(json!({
        "count": 1,
        "indices": {"bufferView": view, "componentType": 5125},
        "values": {"bufferView": view},
    }))?;
    for accessor in &mut root.accessors {
        if accessor.buffer_view.is_none() {
            accessor.sparse.get_or_insert_with(|| sparse.clone());
        }
    }
    // In a file without scenes all nodes are drawn: its roots are those that are no one's child.
    if root.scenes.is_empty() {
        let children = root.nodes.iter().filter_map(|node| node.children.as_ref());
        let children: BTreeSet<usize> = children.flatten().map(|child| child.value()).collect();
        let roots = (0..root.nodes.len()).filter(|i| !children.contains(i));
        let scene = from_value(json!({"nodes": roots.collect::<Vec<_>>()}))?;
        root.scene = Some(root.push::<gltf::json::Scene>(scene));
    }
    // Its first bytes tell the kind of an image.
    for image in &mut root.images {
        let kind = || MimeType("image/png".into());
        image.mime_type.get_or_insert_with(kind);
    }
    Ok(())
}
