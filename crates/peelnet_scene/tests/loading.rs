//! Scenes whose files come from a function instead of the file system.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_scene::{Material, Scene, SceneError};
use std::{
    cell::RefCell,
    collections::BTreeMap,
    io,
    path::{Path, PathBuf},
};

const SCENE: &str = "
[camera]
position = [0, 0, 6]
target = [0, 0, 0]
near = 0.1
far = 100

[[object]]
mesh = 'meshes/a.obj'

[[object]]
mesh = 'meshes/b.gltf'
material = { color_map = 'image.png' }

[[object]]
mesh = { shape = 'sphere' }
material = { color_map = 'image.png', emissive_map = 'image.png' }
";

/// A scene file that names an OBJ file with a library, a glTF file with a buffer, and an image, each in more than one place.
fn files() -> BTreeMap<PathBuf, Vec<u8>> {
    let mut image = io::Cursor::new(Vec::new());
    image::RgbaImage::new(2, 1)
        .write_to(&mut image, image::ImageFormat::Png)
        .unwrap();
    let numbers: [f32; 15] = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 0.0, 1.0, 0.0, 0.0, 1.0, // UVs
    ];
    let buffer = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let gltf = serde_json::json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"uri": "../image%20two.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
        "buffers": [{"byteLength": 60, "uri": "a%20buffer.bin"}],
    });
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
    let mtl = "newmtl m\nmap_Kd a.png\nmap_Ke a.png\n";
    [
        ("room/scene.toml", SCENE.into()),
        ("room/meshes/a.obj", obj.into()),
        ("room/meshes/a.mtl", mtl.into()),
        ("room/meshes/a.png", image.get_ref().clone()),
        ("room/meshes/b.gltf", gltf.to_string().into_bytes()),
        ("room/meshes/a buffer.bin", buffer),
        ("room/meshes/../image two.png", image.get_ref().clone()),
        ("room/image.png", image.get_ref().clone()),
    ]
    .map(|(name, bytes): (&str, Vec<u8>)| (PathBuf::from(name), bytes))
    .into()
}

#[test]
fn every_file_is_read_once_through_the_function() {
    let files = files();
    let read = RefCell::new(Vec::new());
    let scene = Scene::from_bytes("room/scene.toml", |path| {
        read.borrow_mut().push(path.to_owned());
        let bytes = files.get(path).cloned();
        bytes.ok_or(io::ErrorKind::NotFound.into())
    })
    .unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let mut read = read.into_inner();
    read.sort();
    assert_eq!(read, files.keys().cloned().collect::<Vec<_>>());
    // The same from the file system.
    let folder = tempfile::tempdir().unwrap();
    for (path, bytes) in &files {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    let loaded = Scene::load(folder.path().join("room/scene.toml")).unwrap();
    assert_eq!(loaded.hash, scene.hash);
    let all_maps = |scene: &Scene| -> Vec<bool> {
        let materials = scene.objects.iter().flat_map(|o| &o.materials);
        let maps = materials.flat_map(|m| m.maps.all().map(|map| map.is_some()));
        maps.collect()
    };
    assert_eq!(all_maps(&loaded), all_maps(&scene));
    assert!(all_maps(&scene).contains(&true));
}

/// A file that the function does not give is an error with its path.
#[test]
fn a_missing_file_is_an_error() {
    let files = files();
    for missing in [
        "room/scene.toml",
        "room/meshes/a.obj",
        "room/meshes/b.gltf",
        "room/image.png",
    ] {
        let e = Scene::from_bytes("room/scene.toml", |path| match files.get(path) {
            Some(bytes) if path != Path::new(missing) => Ok(bytes.clone()),
            _ => Err(io::ErrorKind::NotFound.into()),
        })
        .unwrap_err();
        assert!(
            matches!(&e, SceneError::Read { path, .. } if path == Path::new(missing)),
            "{e}"
        );
    }
}

/// A renderer on another thread can own a scene and change it.
#[test]
fn scenes_can_be_sent_cloned_and_changed() {
    fn is_open<T: Clone + Send + Sync + 'static>() {}
    is_open::<Scene>();
    let files = files();
    let mut scene = Scene::from_bytes("room/scene.toml", |path| {
        files
            .get(path)
            .cloned()
            .ok_or(io::ErrorKind::NotFound.into())
    })
    .unwrap();
    let before = scene.clone();
    scene.objects[1].world_from_object = glam::Mat4::from_scale(glam::Vec3::splat(2.0));
    scene.objects[2].materials[0] = Material::unlit([1.0, 0.0, 0.0], 0.5);
    assert!(std::sync::Arc::ptr_eq(
        &scene.objects[1].mesh,
        &before.objects[1].mesh
    ));
    assert_ne!(scene.objects[2].materials, before.objects[2].materials);
}
