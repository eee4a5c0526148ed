//! What the `gltf` crate demands of a file and drawing does not need, supplied: many exporters leave it out.

use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Supplies bounds of positions, the zeros of accessors without a buffer view, the scene of a file without one, and kinds of images.
/// References have been checked.
pub(super) fn repair(document: &mut Value) {
    let Some(document) = document.as_object_mut() else {
        return;
    };
    supply_bounds(document);
    supply_zeros(document);
    supply_scene(document);
    // Its first bytes tell the kind of an image.
    let images = document.get_mut("images").and_then(Value::as_array_mut);
    for image in images
        .into_iter()
        .flatten()
        .filter_map(Value::as_object_mut)
    {
        image
            .entry("mimeType")
            .or_insert_with(|| json!("image/png"));
    }
}

/// The elements of a list of the document.
fn list<'a>(document: &'a Map<String, Value>, name: &str) -> &'a [Value] {
    let list = document.get(name).and_then(Value::as_array);
    list.map_or(&[], Vec::as_slice)
}

/// The same to be changed; `None` if it is something else than a list. A missing one is added.
fn list_mut<'a>(document: &'a mut Map<String, Value>, name: &str) -> Option<&'a mut Vec<Value>> {
    let list = document.entry(name).or_insert_with(|| json!([]));
    list.as_array_mut()
}

/// Bounds of positions: nobody reads them here, so they may be anything.
fn supply_bounds(document: &mut Map<String, Value>) {
    let meshes = list(document, "meshes").iter();
    let primitives = meshes.filter_map(|m| m["primitives"].as_array()).flatten();
    let positions: BTreeSet<usize> = primitives
        .filter_map(|p| p.pointer("/attributes/POSITION")?.as_u64())
        .map(|i| i as usize)
        .collect();
    let accessors = document.get_mut("accessors").and_then(Value::as_array_mut);
    let accessors = accessors.into_iter().flatten().enumerate();
    for (i, accessor) in accessors {
        if positions.contains(&i)
            && let Some(accessor) = accessor.as_object_mut()
        {
            accessor.insert("min".into(), json!([0, 0, 0]));
            accessor.insert("max".into(), json!([0, 0, 0]));
        }
    }
}

/// An accessor without a buffer view holds zeros. As the crate reads these of sparse accessors only, it becomes one whose first element is
/// replaced by zeros.
fn supply_zeros(document: &mut Map<String, Value>) {
    let is_empty = |a: &Value| a["bufferView"].is_null() && a["sparse"].is_null();
    if !list(document, "accessors").iter().any(is_empty) {
        return;
    }
    // As long as the largest element, a matrix of 16 floats.
    let zeros = format!("data:application/octet-stream;base64,{}==", "A".repeat(86));
    let Some(buffers) = list_mut(document, "buffers") else {
        return;
    };
    buffers.push(json!({"byteLength": 64, "uri": zeros}));
    let buffer = buffers.len() - 1;
    let Some(views) = list_mut(document, "bufferViews") else {
        return;
    };
    views.push(json!({"buffer": buffer, "byteLength": 64}));
    let view = views.len() - 1;
    let Some(accessors) = list_mut(document, "accessors") else {
        return;
    };
    for accessor in accessors.iter_mut().filter(|a| is_empty(a)) {
        if let Some(accessor) = accessor.as_object_mut() {
            let sparse = json!({
                "count": 1,
                "indices": {"bufferView": view, "componentType": 5125},
                "values": {"bufferView": view},
            });
            accessor.insert("sparse".into(), sparse);
        }
    }
}

/// In a file without scenes all nodes are drawn: its roots are those that are no one's child.
fn supply_scene(document: &mut Map<String, Value>) {
    if !list(document, "scenes").is_empty() {
        return;
    }
    let nodes = list(document, "nodes");
    let children = nodes.iter().filter_map(|n| n["children"].as_array());
    let children: BTreeSet<u64> = children.flatten().filter_map(Value::as_u64).collect();
    let roots = (0..nodes.len() as u64).filter(|i| !children.contains(i));
    let roots: Vec<u64> = roots.collect();
    document.insert("scenes".into(), json!([{"nodes": roots}]));
    document.insert("scene".into(), json!(0));
}
