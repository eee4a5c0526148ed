//! The readers of files that users hand over, each as a function of any bytes: fuzz targets and the bounded search in
//! `tests/fuzzed_readers.rs` call the same ones. A reader answers or gives an error; it does not panic, hang, or take memory that the
//! file does not warrant.

use peelnet_dataset::{Dataset, Format};
use peelnet_model::Model;
use peelnet_peel::synthetic::{SyntheticOptions, synthetic};
use peelnet_scene::Scene;
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{OnceLock, atomic::AtomicBool},
};
use tempfile::TempDir;

/// A reader and files to begin from.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    /// The fuzz target's name.
    pub name: &'static str,
    /// Reads any bytes.
    pub read: fn(&[u8]),
    /// Files that are sound, and some that are nearly so.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All of them.
pub const READERS: [Reader; 7] = [
    Reader {
        name: "scene",
        read: scene,
        seeds: scene_seeds,
    },
    Reader {
        name: "obj",
        read: obj,
        seeds: obj_seeds,
    },
    Reader {
        name: "dataset",
        read: dataset,
        seeds: dataset_seeds,
    },
    Reader {
        name: "model",
        read: model,
        seeds: model_seeds,
    },
    Reader {
        name: "gltf",
        read: gltf,
        seeds: gltf_seeds,
    },
    Reader {
        name: "ply",
        read: ply,
        seeds: ply_seeds,
    },
    Reader {
        name: "stl",
        read: stl,
        seeds: stl_seeds,
    },
];

/// A folder of this process that is removed with it.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| tempfile::tempdir().expect("a temporary folder"))
        .path()
}

fn put(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    fs::write(&path, bytes).expect("the temporary folder can be written");
    path
}

/// An image of two texels, half transparent red and green: PNG, in base 64.
const IMAGE: &str = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEUlEQVR4nGP4z8DQwPCf4T8ADn0Dfur2k8AAAAAASUVORK5CYII=";

/// The image as a file's bytes.
fn image() -> Vec<u8> {
    let texture = [[255, 0, 0, 128], [0, 255, 0, 255]].concat();
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_raw(2, 1, texture).expect("two texels");
    let written = image.write_to(&mut bytes, image::ImageFormat::Png);
    written.map(|()| bytes.into_inner()).expect("encodes")
}

/// A scene file; the files that it may name do not exist, but for `a.obj` and `a.png`.
fn scene(bytes: &[u8]) {
    put(
        "a.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n",
    );
    put("a.png", &image());
    if let Ok(scene) = Scene::load(put("s.toml", bytes)) {
        is_sound(&scene);
    }
}

/// What a reader let through can be drawn.
fn is_sound(scene: &Scene) {
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
    let name = if bytes.starts_with(b"glTF") {
        "g.glb"
    } else {
        "g.gltf"
    };
    if let Ok(scene) = Scene::load(put(name, bytes)) {
        is_sound(&scene);
    }
}

/// A triangle with its buffer as a data URI: nine zeros but for two vertices, in base 64.
fn gltf_seeds() -> Vec<Vec<u8>> {
    let buffer = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"mesh":0,"children":[1],"scale":[1,2,1]}},{{"mesh":0,"translation":[0,0,1],"rotation":[0,0,0,1]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":4,"material":0}}]}}],
"materials":[{{"alphaMode":"BLEND","doubleSided":true,"emissiveFactor":[0,1,0],"pbrMetallicRoughness":{{"baseColorFactor":[1,0,0,0.5],"metallicFactor":0.1}}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],
"buffers":[{{"byteLength":36,"uri":"data:application/octet-stream;base64,{buffer}"}}]}}"#
    );
    // The same with UVs, vertex colours and a texture.
    let mapped = text
        .replace(r#""POSITION":0"#, r#""POSITION":0,"COLOR_0":0,"TEXCOORD_0":1"#)
        .replace(
            r#""metallicFactor":0.1"#,
            r#""baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"scale":[2,1],"rotation":1}}},"metallicRoughnessTexture":{"index":0}"#,
        )
        .replace(
            r#""alphaMode""#,
            r#""normalTexture":{"index":0,"scale":0.5},"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5}},"alphaMode""#,
        )
        .replace(
            r#"],
"bufferViews""#,
            r#",{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"}],
"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],"images":[{"uri":"data:image/png;base64,IMAGE"}],
"bufferViews""#,
        )
        .replace("IMAGE", IMAGE);
    let specular = mapped.replace(
        r#""KHR_materials_transmission":{"transmissionFactor":0.5}"#,
        r#""KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0,0,1],"specularGlossinessTexture":{"index":0}}"#,
    );
    // Nodes that share a child, an accessor without data and a sparse one, a byte order mark, no scene, data without base 64.
    let shared = text.replace(r#""children":[1],"#, r#""children":[1,1],"#);
    let sparse = text.replace(
        r#"}],
"bufferViews""#,
        r#"},{"componentType":5126,"count":3,"type":"VEC3"},
{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":0,"byteOffset":12}}}],
"bufferViews""#,
    );
    let sparse = sparse.replace(r#""POSITION":0"#, r#""POSITION":2,"NORMAL":1"#);
    let rootless = text.replace(r#""scene":0,"scenes":[{"nodes":[0]}],"#, "");
    let zeros = "%00".repeat(36);
    let encoded = text.replace(&format!(";base64,{buffer}"), &format!(",{zeros}"));
    [
        text,
        mapped,
        specular,
        shared,
        sparse,
        format!("\u{feff}{rootless}"),
        encoded,
    ]
    .map(String::into_bytes)
    .to_vec()
}

fn scene_seeds() -> Vec<Vec<u8>> {
    let camera = "name = 's'\nbackground = [0.1, 1, 1.0]\n[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nfov_y = 45.0\nnear = 0.1\nfar = 100\n";
    let object = "[[object]]\nmesh = 'a.obj'\nfit = 1.0\nscale = 2.0\nrotate = [0, 90, 0]\ntranslate = [1, 0, 0]\nlayer = 1\n[object.material]\ncolor = [1, 0, 0]\nalpha = 0.5\nlighting = 'phong'\n";
    let scatter = "[[scatter]]\ncount = 9\nseed = 4\nmesh = { shape = 'torus' }\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\nscale = [0.1, 0.3]\nalpha = [0.2, 0.8]\n";
    let grid = "[[scatter]]\ncount = 4\nmeshes = ['a.obj', { shape = 'sphere', triangles = 60 }]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\ngrid = [2, 2, 1]\njitter = 0.2\n";
    let light =
        "[orbit]\nviews = 3\n[[light]]\nposition = [1, 2, 3]\ncolor = [1, 1, 1]\nintensity = 2\n";
    [
        format!("{camera}{object}"),
        format!("{camera}{light}{scatter}"),
        format!("{camera}{grid}"),
        format!("{camera}[[object]]\nmesh = {{ shape = 'box', size = [1, 2, 3] }}\n"),
        camera.to_owned(),
        format!(
            "{camera}[[light]]\ndirection = [0, -1, 0]\n{}",
            object.replace("'phong'", "'pbr'\ncolor_map = 'a.png'\nmetallic_roughness_map = { pattern = 'cracks', size = 8 }\nnormal_map = { pattern = 'noise', size = 8, height = 0.2 }\ntransmission_color = [1, 0, 0]\ndisplacement_map = 'a.png'\ndisplacement_scale = 0.1\ndisplacement_level = 1")
        ),
        format!(
            "{camera}[[light]]\nposition = [1, 2, 3]\n{}",
            object.replace("'phong'", "'pbr'\nspecular_color = [1, 0.5, 0.25]\nglossiness_map = 'a.png'\nspecular_color_map = { pattern = 'noise', size = 8 }")
        ),
        format!(
            "{camera}[[object]]\nname = 'a'\nvertex_colors = [[0, 0, 0, 0], [1, 1, 1, 1]]\nmesh = {{ shape = 'lathe', triangles = 60, offset = 0.1, profile = [[0, -1], [1, 0], [0, 1]] }}\n[[timeline]]\ntime = 0\n[[timeline]]\ntime = 1\nlabel = 'b'\n[[timeline.object]]\nname = 'a'\nmaterial = {{ alpha = 0.5 }}\n"
        ),
    ]
    .map(String::into_bytes)
    .to_vec()
}

/// An OBJ file, and behind the first zero byte the MTL file that it may name as `m.mtl`.
fn obj(bytes: &[u8]) {
    let (mesh, materials) = match bytes.iter().position(|b| *b == 0) {
        Some(at) => (&bytes[..at], &bytes[at + 1..]),
        None => (bytes, &b""[..]),
    };
    put("m.mtl", materials);
    put("a.png", &image());
    if let Ok(scene) = Scene::load(put("f.obj", mesh)) {
        is_sound(&scene);
    }
}

fn obj_seeds() -> Vec<Vec<u8>> {
    let mesh = "mtllib m.mtl\no part\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvt 1 0\nvn 0 0 1\ng side\nusemtl red\ns 1\nf 1/1/1 2/2/1 3//1\nf -4 -2 -1\nf 1 2 3 4\n";
    let materials = "newmtl red\nKd 1 0 0\nKs 0.1 0.1 0.1\nNs 30\nd 0.5\nTr 0.5\nillum 2\nmap_Kd a.png\nmap_d -clamp on a.png\nmap_Bump -bm 0.5 a.png\nmap_Ke a.png\ndisp -mm 0 0.5 a.png\n";
    vec![
        format!("{mesh}\0{materials}").into_bytes(),
        b"v 0 0 0\nv 1 0 0 \\\n\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3\n# end \xe9".to_vec(),
        mesh.replace('\n', "\r\n").into_bytes(),
    ]
}

/// A PLY file, as a scene.
fn ply(bytes: &[u8]) {
    if let Ok(scene) = Scene::load(put("f.ply", bytes)) {
        is_sound(&scene);
    }
}

/// Text, and both orders of bytes: polygons, colours, normals, texture coordinates, a strip, and elements of other kinds.
fn ply_seeds() -> Vec<Vec<u8>> {
    let vertex = "property float x\nproperty float y\nproperty float z\n";
    let color =
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float alpha\n";
    let face = "property list uchar int vertex_indices\n";
    let text = format!(
        "ply\r\nformat ascii 1.0\ncomment by hand\nelement vertex 4\n{vertex}{color}property float s\nproperty float t\n\
         element face 2\n{face}property list uchar float texcoord\nelement edge 1\nproperty int v\nend_header\n\
         0 0 0 255 0 0 1 0 0\n1 0 0 9 9 9 .5 1 0\n1 1 0 0 0 0 1 1 1\n0 1 0 0 0 0 1 0 1\n4 0 1 2 3 0\n3 0 1 2 6 0 0 1 0 1 1\n7\n"
    );
    let binary = |is_big: bool| {
        let order = if is_big { "big" } else { "little" };
        let number = |bytes: [u8; 4]| {
            let mut bytes = bytes;
            if is_big {
                bytes.reverse();
            }
            bytes
        };
        let head = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\n{vertex}property float nx\nelement face 1\n{face}\
             element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        );
        let mut bytes = head.into_bytes();
        for k in 0..16u8 {
            let x = f32::from(k * 7 % 5);
            bytes.extend(number(x.to_le_bytes()));
        }
        bytes.push(3);
        for i in [0i32, 1, 2, 6, 0, 1, 2, -1, 1, 3] {
            bytes.extend(number(i.to_le_bytes()));
        }
        bytes
    };
    vec![text.into_bytes(), binary(false), binary(true)]
}

/// An STL file, as a scene.
fn stl(bytes: &[u8]) {
    if let Ok(scene) = Scene::load(put("f.stl", bytes)) {
        is_sound(&scene);
    }
}

fn stl_seeds() -> Vec<Vec<u8>> {
    let facet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
    let text = format!(
        "solid a part\n{facet}{}endsolid a part\n",
        facet.replace('0', "2")
    );
    let mut binary = b"solid by a program".to_vec();
    binary.resize(80, 0);
    binary.extend(2u32.to_le_bytes());
    for k in 0..2u8 {
        let numbers = (0..12u8).map(|i| f32::from((i * i + k) % 7));
        binary.extend(numbers.flat_map(f32::to_le_bytes));
        binary.extend([0, 0]);
    }
    vec![text.into_bytes(), binary]
}

/// Where a dataset's manifest lies.
const MANIFEST: &str = "_peelnet/manifest.json";

/// A dataset of two parts: the first byte says which of its files the others replace, and in which format.
fn dataset(bytes: &[u8]) {
    let (&which, contents) = bytes.split_first().unwrap_or((&0, &[]));
    let format = [Format::Csv, Format::Npy, Format::Parquet][usize::from(which) % 3];
    let template = template(format);
    let files = &template.files;
    let file = usize::from(which / 3) % files.len();
    let folder = folder().join(format!("read-{format}"));
    let _ = fs::create_dir_all(folder.join("_peelnet"));
    let mut manifest = template.manifest.clone();
    for (i, (name, sound)) in files.iter().enumerate() {
        if i == file {
            fs::write(folder.join(name), contents).expect("writes");
            // So that the length fits, and the contents are looked at.
            let length = |n: usize| format!("\"bytes\": {n}");
            manifest = manifest.replace(&length(sound.len()), &length(contents.len()));
        } else {
            fs::write(folder.join(name), sound).expect("writes");
        }
    }
    if files[file].0 != MANIFEST {
        fs::write(folder.join(MANIFEST), manifest).expect("writes");
    }
    if let Ok(dataset) = Dataset::open(&folder) {
        // Either all rows are read, or an error ends them.
        let rows: Result<Vec<usize>, _> = dataset.batches(64).map(|b| b.map(|b| b.len())).collect();
        if let Ok(rows) = rows {
            assert_eq!(rows.iter().sum::<usize>() as u64, dataset.rows());
        }
    }
}

fn dataset_seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for (format, k) in [Format::Csv, Format::Npy, Format::Parquet]
        .into_iter()
        .zip(0u8..)
    {
        for ((_, contents), file) in template(format).files.iter().zip(0u8..3) {
            seeds.push([&[k + 3 * file], contents.as_slice()].concat());
        }
    }
    seeds
}

struct Template {
    manifest: String,
    /// Name and contents; the manifest first.
    files: Vec<(String, Vec<u8>)>,
}

/// A small dataset of a format.
fn template(format: Format) -> &'static Template {
    static TEMPLATES: [OnceLock<Template>; 3] = [const { OnceLock::new() }; 3];
    let slot = match format {
        Format::Csv => 0,
        Format::Npy => 1,
        Format::Parquet => 2,
    };
    TEMPLATES[slot].get_or_init(|| {
        let out = folder().join(format!("template-{format}"));
        let options = SyntheticOptions {
            out: out.clone(),
            lists: 12,
            format,
            seed: 3,
            resume: false,
            command: "test".into(),
        };
        synthetic(&options, &AtomicBool::new(false), &mut |_| {}).expect("a small dataset");
        let names = fs::read_dir(&out).expect("lists").flatten();
        let mut names: Vec<String> = names
            .map(|e| e.file_name().to_string_lossy().into_owned())
            .filter(|name| !name.starts_with(['.', '_']))
            .collect();
        names.push(MANIFEST.to_owned());
        names.sort_by_key(|name| (name != MANIFEST, name.clone()));
        let read = |name: &String| fs::read(out.join(name)).expect("reads");
        Template {
            manifest: String::from_utf8_lossy(&read(&names[0])).into_owned(),
            files: names.iter().map(|n| (n.clone(), read(n))).collect(),
        }
    })
}

/// A model file.
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
