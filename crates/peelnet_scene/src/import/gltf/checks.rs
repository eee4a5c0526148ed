//! Checks that the `gltf` crate does not do: it panics on positions out of range, and on an accessor of the wrong type.

use crate::{budget::MAX_TRIANGLES, files::MAX_MESH};
use gltf::{
    Semantic,
    accessor::{DataType, Dimensions},
    json::extensions::ENABLED_EXTENSIONS,
};
use peelnet_core::files::printable;
use serde_json::Value;

/// Checks the extensions that the file needs, and numbers that the crate does not check.
pub(super) fn check_references(document: &Value) -> Result<(), String> {
    // The crate would look for elements that such an extension leaves out.
    let required = document["extensionsRequired"].as_array();
    let mut required = required.into_iter().flatten().filter_map(Value::as_str);
    if let Some(name) = required.find(|name| !ENABLED_EXTENSIONS.contains(name)) {
        return Err(format!(
            "needs the extension {}, which is not read; export it without",
            printable(name)
        ));
    }
    check_numbers(document, document, "")
}

/// Checks, in a value of a field, the numbers of positions, which the crate uses before it checks them, and of what is supplied to files
/// that lack it.
fn check_numbers(document: &Value, value: &Value, field: &str) -> Result<(), String> {
    match value {
        Value::Object(fields) => {
            let mut fields = fields.iter().filter(|(name, _)| *name != "extras");
            fields.try_for_each(|(name, inner)| check_numbers(document, inner, name))
        }
        Value::Array(all) => all
            .iter()
            .try_for_each(|inner| check_numbers(document, inner, field)),
        Value::Number(number) => {
            let name = match field {
                "POSITION" => "accessors",
                "bufferView" => "bufferViews",
                "buffer" => "buffers",
                "scene" => "scenes",
                _ => return Ok(()),
            };
            let length = list(&document[name]).len() as u64;
            if number.as_u64().is_some_and(|n| n < length) {
                return Ok(());
            }
            Err(format!(
                "'{field}' is {number}, but there are {length} {name}; export the file again"
            ))
        }
        _ => Ok(()),
    }
}

/// Checks that the file is of glTF 2, and needs nothing newer than 2.0 of its reader.
pub(super) fn check_version(document: &Value) -> Result<(), String> {
    let asset = &document["asset"];
    let version = asset["version"].as_str().unwrap_or_default();
    let needed = asset["minVersion"].as_str().unwrap_or("2.0");
    if version.starts_with("2.") && needed == "2.0" {
        return Ok(());
    }
    Err(format!(
        "is glTF {}, and 2.0 is read; export it as that",
        match version {
            "" => "of no version".into(),
            _ if version.starts_with("2.") => format!("{} or newer", printable(needed)).into(),
            _ => printable(version),
        }
    ))
}

/// Checks that images, cameras and lights hold what their kind needs.
pub(super) fn check_kinds(document: &Value) -> Result<(), String> {
    let lacks = |what: &str, i: usize, part: &str| {
        Err(format!("{what} {i} lacks {part}; export the file again"))
    };
    for (i, image) in list(&document["images"]).iter().enumerate() {
        if !image["uri"].is_string() && image["bufferView"].is_null() {
            return lacks("image", i, "a uri or a buffer view");
        }
    }
    for (i, camera) in list(&document["cameras"]).iter().enumerate() {
        if let Some(kind) = camera["type"].as_str()
            && !camera[kind].is_object()
        {
            return lacks("camera", i, &printable(kind));
        }
    }
    let lights = list(&document["extensions"]["KHR_lights_punctual"]["lights"]);
    let is_broken = |light: &Value| light["type"] == "spot" && !light["spot"].is_object();
    if let Some(i) = lights.iter().position(is_broken) {
        return lacks("light", i, "spot");
    }
    Ok(())
}

pub(super) fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Whether an accessor has the type that its meaning needs, or that of indices, and can be addressed.
pub(super) fn is_readable(accessor: &gltf::Accessor<'_>, semantic: Option<&Semantic>) -> bool {
    use DataType as T;
    use Dimensions as D;
    let kind = (accessor.dimensions(), accessor.data_type());
    let fits = match semantic {
        None => matches!(kind, (D::Scalar, T::U8 | T::U16 | T::U32)),
        Some(Semantic::Positions | Semantic::Normals) => kind == (D::Vec3, T::F32),
        Some(Semantic::TexCoords(_)) => matches!(kind, (D::Vec2, T::F32 | T::U8 | T::U16)),
        Some(Semantic::Colors(0)) => {
            matches!(kind, (D::Vec3 | D::Vec4, T::F32 | T::U8 | T::U16))
        }
        // Nobody reads it.
        Some(_) => return true,
    };
    let (count, size) = (accessor.count(), accessor.size());
    let is_dense_readable = accessor
        .view()
        .is_none_or(|view| is_addressable(&view, accessor.offset(), size, count));
    let is_sparse_readable = accessor.sparse().is_none_or(|sparse| {
        let (indices, values) = (sparse.indices(), sparse.values());
        let n = sparse.count();
        let index_size = indices.index_type().size();
        (1..=count).contains(&n)
            && is_addressable(&indices.view(), indices.offset(), index_size, n)
            && is_addressable(&values.view(), values.offset(), size, n)
    });
    fits && is_dense_readable
        && is_sparse_readable
        && (1..=3 * MAX_TRIANGLES as usize).contains(&count)
}

/// Whether `count` elements do not overlap, can be in a file, and the crate's sums of offsets and lengths fit a `usize`, on 32-bit
/// systems too.
fn is_addressable(view: &gltf::buffer::View<'_>, offset: usize, size: usize, count: usize) -> bool {
    let stride = view.stride().unwrap_or(size);
    let all = [view.offset(), view.length(), offset].map(|n| n as u64);
    let elements = (stride as u64).saturating_mul(count as u64);
    let bytes = all.into_iter().fold(elements, u64::saturating_add);
    // Each of the four is at most the size of a file.
    stride >= size && bytes <= (4 * MAX_MESH).min(isize::MAX as u64)
}
