//! Files that never end, or that nobody writes into: each is refused with its name, before it is read.

#![cfg(unix)]
use crate::CAMERA;
use peelnet_scene::Scene;
use std::{fs, os::unix::fs::symlink, path::Path, process::Command};

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

/// A glTF file of one triangle whose buffer and image are named.
fn gltf(buffer: &str, image: &str) -> String {
    serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": image}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": buffer}],
    })
    .to_string()
}

/// Puts something that is no file to read at a path.
type Put = fn(&Path);

/// What loading a scene says, in an error or, where it goes on without the file, in warnings. All others are beside the file that is put.
fn said(put: Put, name: &str, scene: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let zeros =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let map = "mesh = { shape = 'box' }\nmaterial = { color_map = 'a.png' }\n";
    for (name, text) in [
        (
            "obj.toml",
            &*format!("{CAMERA}[[object]]\nmesh = 'a.obj'\n"),
        ),
        ("map.toml", &format!("{CAMERA}[[object]]\n{map}")),
        ("a.obj", OBJ),
        ("a.mtl", "newmtl m\nmap_Kd a.png\n"),
        ("a.gltf", &gltf("a.bin", "a.png")),
        ("inside.gltf", &gltf(zeros, "a.png")),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join(name);
    let _ = fs::remove_file(&path);
    put(&path);
    match Scene::load(folder.path().join(scene)) {
        Ok(scene) => scene.warnings.join("\n"),
        Err(e) => e.to_string(),
    }
}

const ENDLESS: [Put; 2] = [
    |path| symlink("/dev/zero", path).unwrap(),
    |path| assert!(Command::new("mkfifo").arg(path).status().unwrap().success()),
];

#[test]
fn files_that_never_end_are_refused_by_name() {
    for (name, scene) in [
        ("obj.toml", "obj.toml"),
        ("a.obj", "obj.toml"),
        ("a.mtl", "obj.toml"),
        ("a.png", "obj.toml"),
        ("a.png", "map.toml"),
        ("a.glb", "a.glb"),
        ("a.bin", "a.gltf"),
        ("a.png", "inside.gltf"),
    ] {
        for put in ENDLESS {
            let said = said(put, name, scene);
            let named = said.contains(name) && said.contains("not a regular file");
            assert!(named, "{name} of {scene}: {said}");
        }
    }
}
