//! Mesh files as scenes.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use glam::{Vec3, Vec4};
use peelnet_scene::{Lighting, Scene};
use std::{io, path::Path};

const CUBE: &str = "mtllib cube.mtl\nv 1 1 1\nv 2 1 1\nv 2 2 1\nv 1 2 1\nv 1 1 2\nv 2 1 2\nv 2 2 2\nv 1 2 2\nusemtl m\n\
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

/// A scene of files in memory, of which the first is loaded.
fn load(files: &[(&str, &[u8])]) -> Result<Scene, String> {
    let read = |path: &Path| {
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let found = found.ok_or_else(|| io::Error::from(io::ErrorKind::NotFound));
        found.map(|(_, bytes)| bytes.to_vec())
    };
    Scene::from_bytes(files[0].0, read).map_err(|e| e.to_string())
}

/// Whether every vertex is inside every view.
fn assert_framed(scene: &Scene) {
    assert_eq!(scene.views.len(), 3);
    let object = &scene.objects[0];
    for camera in &scene.views {
        let clip = camera.clip_from_view(1.0) * camera.view_from_world();
        for p in &object.mesh.positions {
            let p: Vec4 = clip * p.extend(1.0);
            assert!(
                p.x.abs() < p.w && p.y.abs() < p.w && (0.0..p.w).contains(&p.z),
                "{p}"
            );
        }
    }
}

#[test]
fn an_obj_file_is_a_scene() {
    let glass = b"newmtl m\nKd 0.2 0.4 0.6\nd 0.3\n";
    for name in ["cube.obj", "cube.OBJ", "Cube.Obj"] {
        let scene = load(&[(name, CUBE.as_bytes()), ("cube.mtl", glass)]).unwrap();
        assert_framed(&scene);
        assert_eq!((scene.objects.len(), scene.triangles()), (1, 12));
        assert_eq!((scene.lights.len(), scene.files.len()), (2, 2));
        assert_eq!(scene.name.to_lowercase(), "cube");
        let m = &scene.objects[0].materials[0];
        assert_eq!((m.color, m.alpha), ([0.2, 0.4, 0.6], 0.3));
        assert_eq!((m.lighting, m.is_opaque()), (Lighting::Phong, false));
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
    let turned = load(&[("cube.obj", CUBE.as_bytes()), ("cube.mtl", glass)]).unwrap();
    let distance = |k: usize| (turned.views[k].position - Vec3::splat(1.5)).length();
    assert!((distance(0) - distance(2)).abs() < 1e-5);
}

/// A file on the file system, as it is read there; what is opaque stays so, and a warning says how to look through it.
#[test]
fn opaque_meshes_stay_opaque() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let scene = Scene::load(&path).unwrap();
    assert!(scene.objects[0].materials[0].is_opaque());
    let [warning] = scene.warnings.as_slice() else {
        panic!("{:?}", scene.warnings);
    };
    assert!(warning.contains("opaque") && warning.contains("alpha = 0.5"));
    let e = Scene::load_at(&path, Some(1.0)).unwrap_err().to_string();
    assert!(e.contains("timeline"), "{e}");
}

/// One pair of lights suits one kind of lighting: a material with a roughness decides for all.
#[test]
fn all_surfaces_are_lit_in_one_way() {
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n";
    let mtl = b"newmtl a\nKd 1 0 0\nnewmtl b\nPr 0.5\n";
    let scene = load(&[("a.obj", obj.as_bytes()), ("m.mtl", mtl)]).unwrap();
    let materials = &scene.objects[0].materials;
    assert!(materials.iter().all(|m| m.lighting == Lighting::Pbr));
    // Physically based light falls off with the square of the distance, so it begins brighter.
    assert!(scene.lights[0].intensity > 3.0);
}

/// Tiny, far from the origin, and so large that lengths overflow.
#[test]
fn any_size_is_framed_or_refused() {
    for (scale, offset) in [(1e-5, 0.0), (1e12, 0.0), (1.0, 1e6), (1e-3, -1e4)] {
        let v = |x: f32, y: f32| format!("v {} {} {offset}\n", x * scale + offset, y * scale);
        let obj = format!("{}{}{}f 1 2 3\n", v(0.0, 0.0), v(1.0, 0.0), v(0.0, 1.0));
        let scene = load(&[("a.obj", obj.as_bytes())]).unwrap();
        assert_framed(&scene);
        assert!(scene.views.iter().all(|c| c.view_from_world().is_finite()));
    }
    let e = load(&[("a.obj", b"v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n")]).unwrap_err();
    assert!(e.contains("a.obj") && e.contains("scale it down"), "{e}");
}

/// A triangle of either format, alone and as a mesh of a scene file.
#[test]
fn scans_are_scenes_and_meshes() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
        property uchar green\nproperty uchar blue\nproperty uchar alpha\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 255 0 0 128\n1 0 0 255 0 0 128\n0 1 0 255 0 0 128\n3 0 1 2\n";
    let stl = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    let scene = load(&[("scan.PLY", ply.as_bytes())]).unwrap();
    assert_framed(&scene);
    // Its opacity is the file's.
    assert!(!scene.objects[0].materials[0].is_opaque());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let scene = load(&[("part.Stl", stl.as_bytes())]).unwrap();
    assert_framed(&scene);
    assert!(scene.objects[0].materials[0].is_opaque());
    assert!(scene.warnings[0].contains("opaque"));
    let text = "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n[[light]]\nposition = [1, 1, 1]\n\
        [[object]]\nmesh = 'scan.ply'\nmaterial = { color = [0.5, 1, 1] }\n[[object]]\nmesh = 'part.stl'\nfit = 2.0\nmaterial = { alpha = 0.5 }\n";
    let scene = load(&[
        ("s.toml", text.as_bytes()),
        ("scan.ply", ply.as_bytes()),
        ("part.stl", stl.as_bytes()),
    ]);
    let scene = scene.unwrap();
    assert_eq!((scene.triangles(), scene.files.len()), (2, 3));
    let [scan, part] = [0, 1].map(|k: usize| &scene.objects[k].materials[0]);
    assert_eq!(
        (scan.color, scan.lighting),
        ([0.5, 1.0, 1.0], Lighting::Phong)
    );
    assert!(!scan.is_opaque() && !part.is_opaque());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn errors_name_the_file() {
    for (name, text) in [
        ("a.obj", "f 1 2 3\n"),
        ("gone.obj", ""),
        ("a.ply", "ply"),
        ("a.stl", ""),
    ] {
        let e = load(&[(name, text.as_bytes())]).unwrap_err();
        assert!(e.contains(name), "{e}");
    }
}
