//! Files as programs write them, and as they should not: in memory, but for those that never end.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod endless_files;
mod gltf;
mod obj;
mod ply;
mod scene_files;
mod stl;

use peelnet_scene::{Mesh, Scene};
use std::{io, path::Path, sync::Arc};

const CAMERA: &str = "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n";

/// A PNG image, a texel high.
fn image(texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_raw(texels.len() as u32, 1, texels.concat()).unwrap();
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A scene of files in memory, of which the first is loaded.
fn load_at(files: &[(&str, &[u8])], time: Option<f32>) -> Result<Scene, String> {
    let scene = Scene::from_bytes_at(files[0].0, time, |path| {
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let found = found.ok_or_else(|| io::Error::from(io::ErrorKind::NotFound));
        found.map(|(_, bytes)| bytes.to_vec())
    });
    scene.map_err(|e| e.to_string())
}

fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, String> {
    load_at(files, None)
}

/// All `words`, between ` & `, are in a text.
fn assert_says(text: &str, words: &str) {
    for word in words.split(" & ") {
        assert!(text.contains(word), "no '{word}' in: {text}");
    }
}

/// `words` are in the error.
fn assert_refused<T>(loaded: Result<T, String>, words: &str) {
    let e = loaded.map(|_| ()).expect_err(words);
    assert_says(&e, words);
    assert!(!e.contains(char::is_control), "{e:?}");
}

/// The same of each row of a table: what `load` takes, where ` ; ` ends a line, and the words.
fn assert_all_refused<T>(table: &str, load: impl Fn(&str) -> Result<T, String>) {
    for row in table.trim_matches('\n').lines() {
        let (text, words) = row.rsplit_once(" => ").unwrap();
        assert_refused(load(&text.replace(" ; ", "\n")), words);
    }
}

/// Every vertex is inside each of three views.
fn assert_framed(scene: &Scene) {
    assert_eq!(scene.views.len(), 3);
    for camera in &scene.views {
        let clip = camera.clip_from_view(1.0) * camera.view_from_world();
        for p in &scene.objects[0].mesh.positions {
            let p = clip * p.extend(1.0);
            let is_seen = p.x.abs() < p.w && p.y.abs() < p.w && (0.0..p.w).contains(&p.z);
            assert!(is_seen, "{p}");
        }
        assert!(camera.view_from_world().is_finite());
    }
}

/// A mesh, the warnings, and how many files were read.
type Loaded = (Arc<Mesh>, Vec<String>, usize);

/// A mesh of files, of which the first is loaded, in a scene without lights.
fn load_mesh(files: &[(&str, &[u8])]) -> Result<Loaded, String> {
    let text = format!("{CAMERA}[[object]]\nmesh = '{}'\n", files[0].0);
    let scene = load_files(&[&[("s.toml", text.as_bytes())], files].concat())?;
    let mesh = Arc::clone(&scene.objects[0].mesh);
    Ok((mesh, scene.warnings, scene.files.len() - 1))
}

/// The area of a mesh that faces +z.
fn area(mesh: &Mesh) -> f32 {
    let areas = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).z / 2.0
    });
    areas.sum()
}
