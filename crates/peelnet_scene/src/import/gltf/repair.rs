//! What the `gltf` crate demands of a file and drawing does not need, supplied: many exporters leave it out.

use super::checks::list;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Supplies bounds of positions, the zeros of accessors without a buffer view, the scene of a file without one, and kinds of images.
/// References and the version have been checked, so the document is an object.
pub(super) fn repair(document: &mut Value) {
    // Bounds of positions: nobody reads them here, so they may be anything.
    let primitives = list(&document["meshes"]).iter();
    let primitives = primitives.flat_map(|mesh| list(&mesh["primitives"]));
    let positions = primitives.filter_map(|p| p["attributes"]["POSITION"].as_u64());
    let positions: BTreeSet<u64> = positions.collect();
    for (accessor, i) in list_mut(document, "accessors").iter_mut().zip(0..) {
        if positions.contains(&i) && accessor.is_object() {
            accessor["min"] = json!([0, 0, 0]);
            accessor["max"] = json!([0, 0, 0]);
        }
    }
    supply_zeros(document);
    // In a file without scenes all nodes are drawn: its roots are those that are no one's child.
    if list(&document["scenes"]).is_empty() {
        let nodes = list(&document["nodes"]);
        let children = nodes.iter().flat_map(|node| list(&node["children"]));
        let children: BTreeSet<u64> = children.filter_map(Value::as_u64).collect();
        let roots = (0..nodes.len() as u64).filter(|i| !children.contains(i));
        document["scenes"] = json!([{"nodes": roots.collect::<Vec<_>>()}]);
        document["scene"] = json!(0);
    }
    // Its first bytes tell the kind of an image.
    for image in list_mut(document, "images") {
        if image.is_object() && image["mimeType"].is_null() {
            image["mimeType"] = json!("image/png");
        }
    }
}

fn list_mut<'a>(document: &'a mut Value, name: &str) -> &'a mut [Value] {
    let list = document.get_mut(name).and_then(Value::as_array_mut);
    list.map_or(&mut [], Vec::as_mut_slice)
}

/// An accessor without a buffer view holds zeros. As the crate reads these of sparse accessors only, it becomes one whose first element is
/// replaced by zeros.
fn supply_zeros(document: &mut Value) {
    let is_empty = |a: &Value| a.is_object() && a["bufferView"].is_null() && a["sparse"].is_null();
    if !list(&document["accessors"]).iter().any(is_empty) {
        return;
    }
    // As long as the largest element, a matrix of 16 floats.
    let zeros = format!("data:application/octet-stream;base64,{}==", "A".repeat(86));
    let buffer = push(document, "buffers", json!({"byteLength": 64, "uri": zeros}));
    let view = json!({"buffer": buffer, "byteLength": 64});
    let view = push(document, "bufferViews", view);
    let accessors = list_mut(document, "accessors").iter_mut();
    for accessor in accessors.filter(|a| is_empty(a)) {
        accessor["sparse"] = json!({
            "count": 1,
            "indices": {"bufferView": view, "componentType": 5125},
            "values": {"bufferView": view},
        });
    }
}

/// Appends to a list, which is made where it is missing; returns the element's number.
fn push(document: &mut Value, name: &str, value: Value) -> usize {
    if document[name].is_null() {
        document[name] = json!([]);
    }
    let list = document[name].as_array_mut();
    list.map_or(0, |list| {
        list.push(value);
        list.len() - 1
    })
}
