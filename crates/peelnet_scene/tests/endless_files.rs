//! Files that never end, or that nobody writes into: each is refused with its name, before it is read.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_scene::Scene;
use std::{fs, os::unix::fs::symlink, path::Path, process::Command};

const CAMERA: &str =
    "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n[[object]]\n";
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

/// Puts something that never ends at a path.
type Endless = fn(&Path);

const ENDLESS: [Endless; 2] = [
    |path| symlink("/dev/zero", path).unwrap(),
    |path| assert!(Command::new("mkfifo").arg(path).status().unwrap().success()),
];

/// A folder's files, the one that never ends, and the scene that is loaded.
type Case<'a> = (&'a [(&'a str, &'a str)], &'a str, &'a str);

/// What loading says, in an error or, where it goes on without the file, in warnings.
fn said((files, endless, scene): Case<'_>, put: Endless) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    put(&folder.path().join(endless));
    match Scene::load(folder.path().join(scene)) {
        Ok(scene) => scene.warnings.join("\n"),
        Err(e) => e.to_string(),
    }
}

#[test]
fn files_that_never_end_are_refused_by_name() {
    let with_obj = format!("{CAMERA}mesh = 'a.obj'\n");
    let with_map =
        format!("{CAMERA}mesh = {{ shape = 'box' }}\nmaterial = {{ color_map = 'a.png' }}\n");
    let (mtl, outside) = ("newmtl m\nmap_Kd a.png\n", gltf("a.bin", "a.png"));
    let inside = gltf(
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",
        "a.png",
    );
    let cases: [Case<'_>; 8] = [
        (&[], "s.toml", "s.toml"),
        (&[("s.toml", &with_obj)], "a.obj", "s.toml"),
        (&[("s.toml", &with_obj), ("a.obj", OBJ)], "a.mtl", "s.toml"),
        (
            &[("s.toml", &with_obj), ("a.obj", OBJ), ("a.mtl", mtl)],
            "a.png",
            "s.toml",
        ),
        (&[("s.toml", &with_map)], "a.png", "s.toml"),
        (&[], "a.glb", "a.glb"),
        (&[("a.gltf", &outside)], "a.bin", "a.gltf"),
        (&[("a.gltf", &inside)], "a.png", "a.gltf"),
    ];
    for case in cases {
        for put in ENDLESS {
            let said = said(case, put);
            let named = said.contains(case.1) && said.contains("not a regular file");
            assert!(named, "{case:?}: {said}");
        }
    }
}

/// A sparse file takes no space on the disk, but would in memory: the limit of its kind holds before it is read.
#[test]
fn files_beyond_their_kinds_limit_are_not_read() {
    let with_map =
        format!("{CAMERA}mesh = {{ shape = 'box' }}\nmaterial = {{ color_map = 'a.png' }}\n");
    let put: Endless = |path| fs::File::create(path).unwrap().set_len(3 << 30).unwrap();
    for case in [
        (&[][..], "s.toml", "s.toml"),
        (&[("s.toml", with_map.as_str())], "a.png", "s.toml"),
    ] {
        let said = said(case, put);
        assert!(said.contains(case.1) && said.contains("at most"), "{said}");
    }
    if let Ok(status) = fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap();
        let kilobytes: u64 = peak.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!(kilobytes < 1 << 20, "{kilobytes} kB");
    }
}
