//! The readers of files that users hand over, each as a function of any bytes: fuzz targets and the bounded search in
//! `tests/fuzzed_readers.rs` call the same ones. A reader answers or gives an error; it does not panic, hang, or take memory that the
//! file does not warrant.

use peelnet_bench::{bench::Bench, report::Results};
use peelnet_dataset::{Dataset, Format, Manifest, sha256};
use peelnet_model::Model;
use peelnet_peel::{ExtractOptions, synthetic::synthetic};
use peelnet_scene::Scene;
use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::{LazyLock, atomic::AtomicBool},
};
use tempfile::TempDir;

/// The name of a fuzz target, what it does with any bytes, and files to begin from: sound ones, and some that are nearly so.
pub type Reader = (&'static str, fn(&[u8]), fn() -> Vec<Vec<u8>>);

pub const READERS: [Reader; 11] = [
    (
        "scene",
        |bytes| load("s.toml", bytes),
        || committed("scene"),
    ),
    ("obj", obj, || committed("obj")),
    ("dataset", dataset, dataset_seeds),
    ("model", model, model_seeds),
    ("gltf", gltf, || committed("gltf")),
    ("ply", |bytes| load("f.ply", bytes), || committed("ply")),
    ("stl", |bytes| load("f.stl", bytes), || committed("stl")),
    ("texture", texture, texture_seeds),
    ("results", results, || committed("results")),
    (
        "splat",
        |bytes| load("f.splat", bytes),
        || committed("splat"),
    ),
    ("spz", |bytes| load("f.spz", bytes), || committed("spz")),
];

/// The files in `tests/seeds`, each with what its reader knows: polygons and strips, colours, textures, lights, timelines, sparse accessors.
fn committed(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("seeds")
        .join(name);
    let files = fs::read_dir(folder).expect("is committed").flatten();
    let mut paths: Vec<PathBuf> = files.map(|file| file.path()).collect();
    paths.sort();
    let read = |path| fs::read(path).expect("is committed");
    paths.into_iter().map(read).collect()
}

/// A folder of this process. Of the files that a scene or a mesh may name it has `a.obj` and `a.png`.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(folder.path().join("a.obj"), triangle).expect("writes");
    let texels = [[255, 0, 0, 128], [0, 255, 0, 255]].concat();
    let image = image::RgbaImage::from_raw(2, 1, texels).expect("two texels");
    image.save(folder.path().join("a.png")).expect("encodes");
    folder
});

fn put(name: &str, bytes: &[u8]) -> PathBuf {
    let path = FOLDER.path().join(name);
    fs::write(&path, bytes).expect("the temporary folder can be written");
    path
}

/// A file of this name; what the reader lets through can be drawn.
fn load(name: &str, bytes: &[u8]) {
    let Ok(scene) = Scene::load(put(name, bytes)) else {
        return;
    };
    for view in &scene.views {
        assert!(view.near > 0.0 && view.near < view.far && view.view_from_world().is_finite());
    }
    for object in &scene.objects {
        let mesh = &object.mesh;
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.normals.iter().all(|n| n.is_finite()));
        let mut vertices = mesh.triangles.iter().flatten();
        assert!(vertices.all(|i| (*i as usize) < mesh.positions.len()));
        assert_eq!(object.materials.len(), mesh.parts.len());
        assert!(mesh.uvs.iter().flatten().all(|uv| uv.is_finite()));
        for (part, material) in mesh.parts.iter().zip(&object.materials) {
            let Some(tangents) = mesh.tangents(part.triangles.clone()) else {
                assert_eq!(material.maps.all().iter().flatten().count(), 0);
                continue;
            };
            assert!(tangents.iter().flatten().flatten().all(|x| x.is_finite()));
        }
        assert!(mesh.colors.is_empty() || mesh.colors.len() == mesh.positions.len());
    }
}

/// A glTF or GLB file, by how it begins.
fn gltf(bytes: &[u8]) {
    let is_binary = bytes.starts_with(b"glTF");
    load(if is_binary { "g.glb" } else { "g.gltf" }, bytes);
}

/// An OBJ file, and behind the first zero byte the MTL file that it may name as `m.mtl`.
fn obj(bytes: &[u8]) {
    let mut parts = bytes.splitn(2, |b| *b == 0);
    let mesh = parts.next().unwrap_or_default();
    put("m.mtl", parts.next().unwrap_or_default());
    load("f.obj", mesh);
}

/// An image that a scene puts on a square.
fn texture(bytes: &[u8]) {
    put("texture", bytes);
    load("textured.toml", TEXTURED.as_bytes());
}

const TEXTURED: &str = r#"
[[view]]
position = [0, 0, 3]
target = [0, 0, 0]
up = [0, 1, 0]
fov_y = 40
near = 0.1
far = 10

[[object]]
mesh = { shape = "quad", size = [1, 1] }
material = { alpha = 0.5, color_map = "texture" }
"#;

/// A PNG and a JPEG image.
fn texture_seeds() -> Vec<Vec<u8>> {
    let image = image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([20 * x as u8, 30 * y as u8, 99]));
    let encoded = |format| {
        let mut bytes = io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).expect("encodes");
        bytes.into_inner()
    };
    [image::ImageFormat::Png, image::ImageFormat::Jpeg]
        .map(encoded)
        .to_vec()
}

/// A `results.json`; what is let through is shown in all of a bench's files.
fn results(bytes: &[u8]) {
    if let Ok(results) = Results::<Bench>::read(&put("results.json", bytes)) {
        results
            .write(FOLDER.path())
            .expect("the temporary folder can be written");
    }
}

const MANIFEST: &str = "_peelnet/manifest.json";

/// A dataset of two parts: the first byte says which of its files the others replace, and in which format.
fn dataset(bytes: &[u8]) {
    let (&which, contents) = bytes.split_first().unwrap_or((&0, &[]));
    let (folder, files) = &TEMPLATES[usize::from(which) % 3];
    let (name, sound) = &files[usize::from(which / 3) % files.len()];
    let (_, manifest) = &files[0];
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("writes");
    // So that length and hashes fit, and the contents are looked at.
    let mut adapted: Manifest = serde_json::from_slice(manifest).expect("is a manifest");
    let mut lines = String::new();
    for part in &mut adapted.parts {
        for file in &mut part.files {
            if file.name == *name {
                (file.bytes, file.sha256) = (contents.len() as u64, sha256(contents));
            }
            lines += &format!("{} {}\n", part.index, file.sha256);
        }
    }
    adapted.hash = sha256(lines.as_bytes());
    write(MANIFEST, &serde_json::to_vec(&adapted).expect("serialises"));
    write(name, contents);
    if let Ok(dataset) = Dataset::open(folder) {
        // Either all rows are read, or an error ends them.
        let rows: Result<Vec<usize>, _> = dataset.batches(64).map(|b| b.map(|b| b.len())).collect();
        if let Ok(rows) = rows {
            assert_eq!(rows.iter().sum::<usize>() as u64, dataset.rows());
        }
    }
    write(MANIFEST, manifest);
    write(name, sound);
}

fn dataset_seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for ((_, files), k) in TEMPLATES.iter().zip(0u8..) {
        for ((_, contents), file) in files.iter().zip(0u8..3) {
            seeds.push([&[k + 3 * file], contents.as_slice()].concat());
        }
    }
    seeds
}

/// A dataset's folder and its files; the manifest first.
type Template = (PathBuf, Vec<(String, Vec<u8>)>);

/// A small dataset of each format.
static TEMPLATES: LazyLock<[Template; 3]> = LazyLock::new(|| {
    [Format::Csv, Format::Npy, Format::Parquet].map(|format| {
        let out = FOLDER.path().join(format!("template-{format}"));
        let options = ExtractOptions {
            format,
            seed: 3,
            ..ExtractOptions::new(&out)
        };
        synthetic(12, &options, &AtomicBool::new(false), &mut |_| {}).expect("a small dataset");
        let names = fs::read_dir(&out).expect("lists").flatten();
        let names = names.map(|e| e.file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.filter(|name| !name.starts_with(['.', '_'])).collect();
        names.sort();
        names.insert(0, MANIFEST.to_owned());
        let read = |name: String| {
            let bytes = fs::read(out.join(&name)).expect("reads");
            (name, bytes)
        };
        let files = names.into_iter().map(read).collect();
        (out, files)
    })
});

fn model(bytes: &[u8]) {
    if let Ok(model) = Model::from_bytes(bytes, "m.safetensors") {
        // What was let through answers, whatever it is asked.
        for x in [0.0, 1.0, -1e30, f32::MAX] {
            let answer = model.shader_output(&vec![x; model.meta.inputs.len()]);
            assert!(answer.iter().all(|y| y.is_finite()), "{answer:?} of {x}");
        }
    }
}

fn model_seeds() -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    ["small", "thesis"]
        .map(|name| fs::read(root.join(name).join("model.safetensors")).expect("ships"))
        .to_vec()
}
