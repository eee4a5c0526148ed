//! Checks that the `gltf` crate does not do: it panics on positions out of range, on an image, a camera or a light that lacks its part, and on
//! an accessor of the wrong type.

use super::splats::SPLATTING;
use crate::{budget::MAX_TRIANGLES, files::MAX_MESH};
use gltf::{
    Semantic,
    accessor::{DataType, Dimensions},
    json::{
        Image, Root,
        camera::Type,
        extensions::{
            ENABLED_EXTENSIONS,
            scene::khr_lights_punctual::{Light, Type as Kind},
        },
        validation::Checked,
    },
};
use peelnet_core::files::{MAX_SHOWN as MAX_NAME, printable};
use serde_json::Value;
use std::collections::BTreeSet;

/// Refuses names that are longer than a name is shown: parts and materials have copies of them.
pub(super) fn check_names(document: &Value) -> Result<(), String> {
    let lists = document.as_object().into_iter().flatten();
    for (list, elements) in lists {
        for (i, element) in elements.as_array().into_iter().flatten().enumerate() {
            let name = element
                .get("name")
                .and_then(Value::as_str)
                .unwrap_or_default();
            if name.len() > MAX_NAME {
                return Err(format!(
                    "{list}[{i}].name has {} bytes; give it at most {MAX_NAME}",
                    name.len()
                ));
            }
        }
    }
    Ok(())
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

/// Whether a normal or an occlusion map has a texture transform other than the first map's. The crate does not return it.
pub(super) fn loses_transforms(document: &Value) -> bool {
    const TRANSFORM: &str = "/extensions/KHR_texture_transform";
    let materials = document["materials"].as_array();
    materials.into_iter().flatten().any(|m| {
        let of = |map: &str| m.pointer(map).map(|map| map.pointer(TRANSFORM));
        let first = [
            "/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture",
            "/extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture",
            "/pbrMetallicRoughness/baseColorTexture",
            "/pbrMetallicRoughness/metallicRoughnessTexture",
            "/emissiveTexture",
        ];
        let first = first.into_iter().find_map(of).flatten();
        ["/normalTexture", "/occlusionTexture"]
            .into_iter()
            .filter_map(of)
            .any(|own| own != first)
    })
}

/// Adds extensions that the file uses and does not list as used.
pub(super) fn list_extensions(document: &mut Value) {
    fn find(value: &Value, names: &mut BTreeSet<String>) {
        match value {
            Value::Array(values) => values.iter().for_each(|value| find(value, names)),
            Value::Object(fields) => {
                let extensions = fields.get("extensions").and_then(Value::as_object);
                names.extend(extensions.into_iter().flat_map(|e| e.keys().cloned()));
                let others = fields.iter().filter(|(name, _)| *name != "extras");
                others.for_each(|(_, value)| find(value, names));
            }
            _ => {}
        }
    }
    let mut names = BTreeSet::new();
    find(document, &mut names);
    let Some(fields) = document.as_object_mut() else {
        return;
    };
    let used = fields
        .entry("extensionsUsed")
        .or_insert_with(|| Value::Array(Vec::new()));
    if let Some(used) = used.as_array_mut() {
        for known in used.iter().filter_map(Value::as_str) {
            names.remove(known);
        }
        used.extend(names.into_iter().map(Value::String));
    }
}

/// Checks that the file needs no extension that the crate does not know: it would look for elements that such an extension leaves out.
pub(super) fn check_extensions(document: &Value) -> Result<(), String> {
    let required = document["extensionsRequired"].as_array();
    let mut required = required.into_iter().flatten().filter_map(Value::as_str);
    let unknown = required.find(|name| !ENABLED_EXTENSIONS.contains(name) && *name != SPLATTING);
    unknown.map_or(Ok(()), |name| {
        Err(format!(
            "needs the extension {}, which is not read; export it without",
            printable(name)
        ))
    })
}

/// Checks that positions are there, which the crate's own check takes for granted, and that images, cameras and lights hold what their kind
/// needs.
pub(super) fn check_elements(root: &Root) -> Result<(), String> {
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let positions = Checked::Valid(Semantic::Positions);
    let mut positions = primitives.filter_map(|p| p.attributes.get(&positions));
    if let Some(number) = positions.find(|number| root.get(**number).is_none()) {
        return Err(format!(
            "'POSITION' is {number}, but there are {} accessors; export the file again",
            root.accessors.len()
        ));
    }
    let lacks = |what: &str, i: usize, part: &str| {
        Err(format!("{what} {i} lacks {part}; export the file again"))
    };
    let is_empty = |image: &Image| image.uri.is_none() && image.buffer_view.is_none();
    if let Some(i) = root.images.iter().position(is_empty) {
        return lacks("image", i, "a uri or a buffer view");
    }
    for (i, camera) in root.cameras.iter().enumerate() {
        match camera.type_ {
            Checked::Valid(Type::Perspective) if camera.perspective.is_none() => {
                return lacks("camera", i, "perspective");
            }
            Checked::Valid(Type::Orthographic) if camera.orthographic.is_none() => {
                return lacks("camera", i, "orthographic");
            }
            _ => {}
        }
    }
    let lights: &[Light] = root.as_ref();
    let spot = Checked::Valid(Kind::Spot);
    let is_broken = |light: &Light| light.type_ == spot && light.spot.is_none();
    let broken = lights.iter().position(is_broken);
    broken.map_or(Ok(()), |i| lacks("light", i, "spot"))
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
    fits && is_addressed(accessor)
}

/// Whether an accessor can be addressed.
pub(super) fn is_addressed(accessor: &gltf::Accessor<'_>) -> bool {
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
    is_dense_readable && is_sparse_readable && (1..=3 * MAX_TRIANGLES as usize).contains(&count)
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
