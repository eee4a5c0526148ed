//! glTF files as exporters write them, and as they should not.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use glam::{Vec2, Vec3};
use peelnet_scene::{Lighting, Scene, Source, Wrap};
use serde_json::{Value, json};

/// A GLB file of this JSON and this buffer.
fn glb(json: &Value, buffer: &[u8]) -> Vec<u8> {
    let mut text = serde_json::to_vec(json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = buffer.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut file = b"glTF".to_vec();
    file.extend(word(2));
    file.extend(word(12 + 8 + text.len() + 8 + binary.len()));
    file.extend(word(text.len()));
    file.extend(b"JSON");
    file.extend(text);
    file.extend(word(binary.len()));
    file.extend(b"BIN\0");
    file.extend(binary);
    file
}

/// Four vertices of a square in the plane z = 0, and the indices of two triangles.
fn square() -> Vec<u8> {
    let vertices: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = vertices
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes
}

/// Two nodes that show the square, one mirrored; a light, a camera, four materials.
fn document() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_unlit", "KHR_materials_emissive_strength"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "color": [1.0, 0.5, 0.25], "intensity": 40.0},
            {"type": "directional"},
        ]}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"children": [1, 2, 3, 4, 5], "translation": [0.0, 0.0, -2.0]},
            {"mesh": 0},
            {"mesh": 0, "scale": [-1.0, 2.0, 1.0], "translation": [0.0, 0.0, 1.0]},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0.0, 3.0, 0.0]},
            {"extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"camera": 0, "translation": [0.0, 0.0, 7.0]},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "zfar": 50.0}}],
        "meshes": [{"name": "square", "primitives": [
            {"attributes": {"POSITION": 0}, "indices": 1, "material": 0},
            {"attributes": {"POSITION": 0}, "indices": 1, "material": 1},
            {"attributes": {"POSITION": 0}, "indices": 1, "material": 2},
            {"attributes": {"POSITION": 0}, "indices": 1, "material": 3},
        ]}],
        "materials": [
            {"name": "glass", "alphaMode": "BLEND", "doubleSided": true,
             "pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.6, 0.3], "metallicFactor": 0.25, "roughnessFactor": 0.75}},
            {"name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.4},
            {"name": "sign", "extensions": {"KHR_materials_unlit": {}}},
            {"name": "lamp", "emissiveFactor": [0.5, 0.25, 0.0], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}}},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": 60}],
    })
}

fn load(bytes: &[u8]) -> Result<Scene, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("thing.glb");
    std::fs::write(&path, bytes).unwrap();
    Scene::load(&path).map_err(|e| e.to_string())
}

#[test]
fn nodes_instances_materials_lights_and_cameras() {
    let scene = load(&glb(&document(), &square())).unwrap();
    assert_eq!((scene.objects.len(), scene.triangles()), (1, 16));
    let mesh = &scene.objects[0].mesh;
    let (low, high) = mesh.bounds().unwrap();
    assert_eq!(
        (low, high),
        (Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 2.0, -1.0))
    );
    // The mirrored instance faces the same way: +z, without normals in the file.
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        assert!((b - a).cross(c - a).z > 0.0 && mesh.normals[t[0] as usize].z > 0.9);
    }
    let [glass, leaf, sign, lamp] = &scene.objects[0].materials[..4] else {
        panic!("four materials of the first instance");
    };
    assert_eq!(
        (glass.color, glass.alpha, glass.blend),
        ([0.2, 0.4, 0.6], 0.3, true)
    );
    assert_eq!(
        (glass.metallic, glass.roughness, glass.double_sided),
        (0.25, 0.75, true)
    );
    assert_eq!(glass.lighting, Lighting::Pbr);
    assert_eq!((leaf.alpha_cutoff, leaf.is_opaque()), (Some(0.4), true));
    assert_eq!((sign.lighting, sign.alpha), (Lighting::Unlit, 1.0));
    assert_eq!(lamp.emission, [2.0, 1.0, 0.0]);
    let point = Source::Point(Vec3::new(0.0, 3.0, -2.0));
    let sources: Vec<_> = scene
        .lights
        .iter()
        .map(|l| (l.source, l.intensity))
        .collect();
    // A directional light shines along its −z: it comes from +z.
    assert_eq!(sources, [(point, 40.0), (Source::Toward(Vec3::Z), 1.0)]);
    let camera = &scene.views[0];
    assert_eq!(
        (camera.position, camera.target),
        (Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 0.0, 4.0))
    );
    assert!((camera.fov_y_degrees - 0.8f32.to_degrees()).abs() < 1e-4 && camera.far == 50.0);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

/// Without a camera of its own all of it is seen.
#[test]
fn a_file_without_a_camera_is_framed() {
    let mut document = document();
    document["nodes"][5]
        .as_object_mut()
        .unwrap()
        .remove("camera");
    let scene = load(&glb(&document, &square())).unwrap();
    let camera = &scene.views[0];
    let clip = camera.clip_from_view(1.0) * camera.view_from_world();
    let (low, high) = scene.objects[0].mesh.bounds().unwrap();
    for k in 0..8 {
        let pick = |bit: u32, i: usize| if k >> bit & 1 == 0 { low[i] } else { high[i] };
        let p = clip * glam::Vec4::new(pick(0, 0), pick(1, 1), pick(2, 2), 1.0);
        assert!(
            p.x.abs() < p.w && p.y.abs() < p.w && (0.0..p.w).contains(&p.z),
            "{p}"
        );
    }
}

/// An image in a buffer, one beside the file and one in a data URI; a texture transform, a sampler, vertex colours, and transmission.
#[test]
fn images_vertex_colours_and_transmission() {
    let image = |texel: [u8; 4]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::RgbaImage::from_pixel(2, 1, image::Rgba(texel));
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    let mut buffer = square();
    let mut views = document()["bufferViews"].as_array().unwrap().clone();
    let mut append = |bytes: Vec<u8>| {
        views.push(json!({"buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len()}));
        buffer.extend(bytes);
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        views.len() - 1
    };
    let floats = |all: &[f32]| all.iter().flat_map(|x| x.to_le_bytes()).collect();
    let uvs = append(floats(&[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]));
    let colors = append(floats(&[1.0, 0.5, 0.25].repeat(4)));
    let red = append(image([255, 0, 0, 128]));
    let mut document = document();
    document["bufferViews"] = views.clone().into();
    document["buffers"][0]["byteLength"] = buffer.len().into();
    let accessors = document["accessors"].as_array_mut().unwrap();
    accessors.push(json!({"bufferView": uvs, "componentType": 5126, "count": 4, "type": "VEC2"}));
    accessors
        .push(json!({"bufferView": colors, "componentType": 5126, "count": 4, "type": "VEC3"}));
    for primitive in document["meshes"][0]["primitives"].as_array_mut().unwrap() {
        primitive["attributes"]["TEXCOORD_0"] = 2.into();
        primitive["attributes"]["COLOR_0"] = 3.into();
    }
    document["images"] =
        json!([{"bufferView": red, "mimeType": "image/png"}, {"uri": "a%20map.png"}]);
    document["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    document["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1, "sampler": 0}]);
    let materials = document["materials"].as_array_mut().unwrap();
    let transform = json!({"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2.0, 1.0], "rotation": 0.0}});
    materials[0]["pbrMetallicRoughness"]["baseColorTexture"] =
        json!({"index": 0, "extensions": transform});
    materials[0]["normalTexture"] = json!({"index": 1, "scale": 0.5});
    materials[1]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 0}});
    materials[2]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 0}});
    materials[3]["extensions"] =
        json!({"KHR_materials_transmission": {"transmissionFactor": 0.75}});
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("thing.glb");
    std::fs::write(&path, glb(&document, &buffer)).unwrap();
    std::fs::write(folder.path().join("a map.png"), image([128, 128, 255, 255])).unwrap();
    let scene = Scene::load(&path).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let [glass, leaf, sign, lamp] = &scene.objects[0].materials[..4] else {
        panic!("four materials of the first instance");
    };
    let color = glass.maps.color.as_ref().unwrap();
    assert_eq!((color.size, color.texels[0]), ([2, 1], [255, 0, 0, 128]));
    assert_eq!(glass.maps.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert!(glass.maps.nearest && glass.maps.normal_scale == 0.5);
    assert!(glass.maps.normal.is_some() && leaf.maps.color.as_ref().unwrap().has_alpha());
    // Opaque by its alpha mode, whatever its image holds.
    assert!(!sign.maps.color.as_ref().unwrap().has_alpha());
    // Three quarters pass, one quarter is scattered.
    assert_eq!((lamp.transmission, lamp.color), ([0.75; 3], [0.25; 3]));
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.uvs[0][1], Vec2::new(2.25, 1.5));
    assert_eq!(mesh.uvs[2][1], Vec2::new(1.0, 1.0));
    assert_eq!(mesh.colors[0], [1.0, 0.5, 0.25, 1.0]);
}

/// What a file uses and is not drawn is reported.
#[test]
fn what_is_not_drawn_is_reported() {
    let mut document = document();
    document["images"] = json!([{"uri": "a.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    document["extensionsUsed"]
        .as_array_mut()
        .unwrap()
        .push("KHR_materials_clearcoat".into());
    document["meshes"][0]["primitives"][1]["mode"] = json!(1);
    document["extensions"]["KHR_lights_punctual"]["lights"][1] =
        json!({"type": "spot", "spot": {}});
    let warnings = load(&glb(&document, &square()))
        .unwrap()
        .warnings
        .join("\n");
    for word in [
        "image 0, which 'a.png' cannot be read",
        "KHR_materials_clearcoat",
        "Lines",
        "spot lights",
    ] {
        assert!(warnings.contains(word), "{word}: {warnings}");
    }
}

/// Every bad file gives one error with its place and a fix.
#[test]
fn bad_files() {
    let good = square();
    let with = |change: &dyn Fn(&mut Value)| {
        let mut d = document();
        change(&mut d);
        d
    };
    let mut nan = good.clone();
    nan[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut beyond = good.clone();
    beyond[48..50].copy_from_slice(&9u16.to_le_bytes());
    for (change, words) in [
        (
            json!({"at": "POSITION", "is": 7}),
            ["'POSITION' is 7", "2 accessors"],
        ),
        (
            json!({"at": "children", "is": 4_294_967_295u32}),
            ["'children' is 4294967295", "6 nodes"],
        ),
    ] {
        let mut d = document();
        match change["at"].as_str() {
            Some("POSITION") => {
                d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = change["is"].clone();
            }
            _ => d["nodes"][0]["children"][0] = change["is"].clone(),
        }
        let e = load(&glb(&d, &good)).expect_err("a reference to nothing");
        assert!(words.iter().all(|w| e.contains(w)), "{e}");
    }
    let whole = glb(&document(), &good);
    for (bytes, words) in [
        (
            b"not a file".to_vec(),
            vec!["thing.glb", "no glTF 2.0 file", "export"],
        ),
        (whole[..whole.len() / 2].to_vec(), vec!["thing.glb"]),
        (Vec::new(), vec!["thing.glb"]),
        (
            glb(&document(), &nan),
            vec!["mesh 0, primitive 0", "position 0 is not finite", "repair"],
        ),
        (
            glb(&document(), &beyond),
            vec!["mesh 0, primitive 0", "index 9", "4 vertices"],
        ),
        (
            glb(&with(&|d| d["scenes"] = json!([{"nodes": []}])), &good),
            vec!["no triangles"],
        ),
        (
            glb(
                &with(&|d| d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"])),
                &good,
            ),
            vec!["KHR_draco_mesh_compression"],
        ),
        (
            glb(
                &with(&|d| d["meshes"][0]["primitives"][0]["attributes"] = json!({})),
                &good,
            ),
            vec!["no glTF"],
        ),
        (
            glb(
                &with(&|d| d["buffers"] = json!([{"byteLength": 60, "uri": "gone.bin"}])),
                &good,
            ),
            vec!["buffer", ".bin"],
        ),
    ] {
        let e = load(&bytes).expect_err(&words.join(" "));
        for word in words {
            assert!(e.contains(word), "no '{word}' in: {e}");
        }
    }
}

/// The header's length is less than the header's own; of the shorter ones there is nothing to read.
#[test]
fn lengths_of_headers_are_checked() {
    let good = glb(&document(), &square());
    for said in 0..12u8 {
        let mut short = good.clone();
        short[8..12].copy_from_slice(&[said, 0, 0, 0]);
        let e = load(&short).expect_err("a length that is too short");
        assert!(e.contains(&format!("has {said} byte")), "{e}");
    }
    for length in 4..good.len() {
        load(&good[..length]).expect_err("a file that was cut off");
    }
}

/// What is not glTF 2 may look like it.
#[test]
fn other_versions_are_refused() {
    for (asset, word) in [
        (json!({"version": "7.0"}), "glTF 7.0"),
        (json!({"version": "1.0"}), "glTF 1.0"),
        (
            json!({"version": "2.1", "minVersion": "2.1"}),
            "2.1 or newer",
        ),
        (json!({}), "of no version"),
        (json!({"version": 2}), "of no version"),
    ] {
        let mut d = document();
        d["asset"] = asset;
        let e = load(&glb(&d, &square())).expect_err(word);
        assert!(e.contains(word) && e.contains("export it"), "{e}");
    }
    for asset in [
        json!({"version": "2.1"}),
        json!({"version": "2.0", "minVersion": "2.0"}),
    ] {
        let mut d = document();
        d["asset"] = asset;
        load(&glb(&d, &square())).expect("a file that 2.0 can read");
    }
}

/// A name that is not UTF-8 hides nothing from the check of references, although the crate skips it. Found by fuzzing.
#[test]
fn bytes_that_are_no_text_are_refused() {
    let mut broken = document();
    broken["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 77.into();
    broken["materials"][0]["hidden"] = "X".into();
    let mut bytes = serde_json::to_vec(&broken).unwrap();
    let at = bytes.windows(6).position(|w| w == b"hidden").unwrap();
    bytes[at] = 0xa6;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("thing.gltf");
    std::fs::write(&path, bytes).unwrap();
    let e = Scene::load(&path).unwrap_err().to_string();
    assert!(e.contains("thing.gltf: is no glTF 2.0 file"), "{e}");
}

/// Accessors of the wrong type, without elements, and beyond any file: the `gltf` crate does not check them. Found by fuzzing.
#[test]
fn accessors_have_the_type_that_their_use_needs() {
    for (accessor, key, value) in [
        (0, "type", json!("VEC2")),
        (0, "componentType", json!(5123)),
        (0, "count", json!(0)),
        (0, "byteOffset", json!(1u64 << 50)),
        (1, "type", json!("VEC3")),
        (1, "componentType", json!(5126)),
    ] {
        let mut d = document();
        d["accessors"][accessor][key] = value.clone();
        let e = load(&glb(&d, &square())).unwrap_err();
        let named =
            e.contains(&format!("accessor {accessor}")) || e.contains("is no glTF 2.0 file");
        assert!(named, "{key} {value}: {e}");
    }
}

/// The document as a file of its own, with its buffer in a data URI.
fn text(document: &Value, prefix: &str) -> Vec<u8> {
    let mut document = document.clone();
    let hex = |b: &u8| format!("%{b:02x}");
    let data: String = square().iter().map(hex).collect();
    document["buffers"] =
        json!([{"byteLength": 60, "uri": format!("data:application/octet-stream,{data}")}]);
    format!("{prefix}{document}").into_bytes()
}

fn load_text(bytes: &[u8]) -> Result<Scene, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("thing.gltf");
    std::fs::write(&path, bytes).unwrap();
    Scene::load(&path).map_err(|e| e.to_string())
}

/// Thirty levels of nodes that each name the next twice are a billion instances, and a circle has no end.
#[test]
fn nodes_have_one_parent() {
    let bad = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let mut d = document();
        change(&mut d);
        let e = load(&glb(&d, &square())).expect_err("is no tree");
        assert!(words.iter().all(|w| e.contains(w)), "{e}");
    };
    let twice = |d: &mut Value| {
        let mut nodes: Vec<Value> = (1..30).map(|i| json!({"children": [i, i]})).collect();
        nodes.push(json!({"mesh": 0}));
        d["nodes"] = nodes.into();
    };
    bad(
        &twice,
        &["node 1 is a child of nodes 0 and 0", "one parent"],
    );
    let shared = |d: &mut Value| d["nodes"][1]["children"] = json!([2]);
    bad(&shared, &["node 2 is a child of nodes", "one parent"]);
    let circle =
        |d: &mut Value| d["nodes"] = json!([{"mesh": 0}, {"children": [2]}, {"children": [1]}]);
    bad(&circle, &["node 1 is among its own descendants", "circle"]);
    let own = |d: &mut Value| d["nodes"][1]["children"] = json!([1]);
    bad(&own, &["node 1 is", "one parent"]);
    let root = |d: &mut Value| d["scenes"][0]["nodes"] = json!([0, 1]);
    bad(&root, &["node 1 is a child of scene 0 and node 0"]);
    let again = |d: &mut Value| d["scenes"][0]["nodes"] = json!([0, 0]);
    bad(&again, &["node 0 is a child of scene 0 twice"]);
}

/// A thousand nodes of a mesh with many primitives are counted, not made; a long chain of nodes is no circle.
#[test]
fn instances_are_counted_before_they_are_made() {
    let mut d = document();
    let primitive = d["meshes"][0]["primitives"][0].clone();
    d["meshes"][0]["primitives"] = vec![primitive; 2000].into();
    d["nodes"] = vec![json!({"mesh": 0}); 2000].into();
    d["scenes"][0]["nodes"] = (0..2000).collect();
    let e = load(&glb(&d, &square())).expect_err("too many");
    for word in ["4000000 primitives", "1000000"] {
        assert!(e.contains(word), "{e}");
    }
    // Counts whose sum overflows. Found by fuzzing.
    let mut d = document();
    d["accessors"][0]["count"] = u64::MAX.into();
    let e = load(&glb(&d, &square())).expect_err("too many");
    assert!(e.contains("vertices") || e.contains("triangles"), "{e}");
    // A strip of 70 million indices without data, which are zeros.
    let mut d = document();
    let accessors = d["accessors"].as_array_mut().unwrap();
    accessors.push(json!({"componentType": 5125, "count": 70_000_000, "type": "SCALAR"}));
    let primitive = &mut d["meshes"][0]["primitives"][0];
    primitive["indices"] = json!(2);
    primitive["mode"] = json!(5);
    let e = load(&glb(&d, &square())).expect_err("too many");
    for word in ["triangles", "50000000"] {
        assert!(e.contains(word), "{e}");
    }
    let mut d = document();
    let chain = (1..3000).map(|i| json!({"children": [i]}));
    d["nodes"] = chain.chain([json!({"mesh": 0})]).collect();
    assert_eq!(load(&glb(&d, &square())).unwrap().triangles(), 8);
}

/// What other programs leave out or put before a file: nothing of it is needed.
#[test]
fn common_files_that_are_not_strict() {
    let whole = load(&glb(&document(), &square())).unwrap();
    let same = |loaded: Scene| {
        assert_eq!(loaded.objects[0].mesh, whole.objects[0].mesh);
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    };
    same(load_text(&text(&document(), "\u{feff}")).unwrap());
    let mut d = document();
    d["accessors"][0].as_object_mut().unwrap().remove("min");
    d["accessors"][0]["max"] = json!([null, 0]);
    same(load(&glb(&d, &square())).unwrap());
    // The roots are the nodes that are no one's child.
    let mut d = document();
    d.as_object_mut().unwrap().remove("scenes");
    d.as_object_mut().unwrap().remove("scene");
    same(load(&glb(&d, &square())).unwrap());
    d["scenes"] = json!([{"nodes": [0]}, {"nodes": [0]}]);
    let warnings = load(&glb(&d, &square())).unwrap().warnings;
    assert!(
        warnings[0].contains("scenes other than number 0 of 2"),
        "{warnings:?}"
    );
    // Names are percent-encoded, or not.
    for (name, uri) in [("a b%.bin", "a%20b%25.bin"), ("a%20b.bin", "a%20b.bin")] {
        let folder = tempfile::tempdir().unwrap();
        let mut d = document();
        d["buffers"][0]["uri"] = uri.into();
        let path = folder.path().join("thing.gltf");
        std::fs::write(&path, d.to_string()).unwrap();
        std::fs::write(folder.path().join(name), square()).unwrap();
        same(Scene::load(&path).unwrap());
    }
}

/// Accessors without a buffer view are zeros, of which a sparse one replaces some.
#[test]
fn accessors_without_data_are_zeros() {
    let mut d = document();
    let accessors = d["accessors"].as_array_mut().unwrap();
    accessors.push(json!({"componentType": 5126, "count": 4, "type": "VEC4"}));
    accessors.push(json!({
        "componentType": 5126, "count": 4, "type": "VEC3",
        "sparse": {"count": 2, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}},
    }));
    d["bufferViews"].as_array_mut().unwrap().extend([
        json!({"buffer": 0, "byteOffset": 50, "byteLength": 4}),
        json!({"buffer": 0, "byteOffset": 12, "byteLength": 24}),
    ]);
    d["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 3, "COLOR_0": 2}, "indices": 1, "material": 0}]);
    let scene = load(&glb(&d, &square())).unwrap();
    let mesh = &scene.objects[0].mesh;
    // Indices 1 and 2 become the square's second and third vertices.
    let at = |i: usize| mesh.positions[i] + Vec3::new(0.0, 0.0, 2.0);
    assert_eq!(
        [at(0), at(1), at(2), at(3)],
        [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::ZERO]
    );
    assert_eq!(mesh.colors[0], [0.0; 4]);
}

/// Images, cameras and lights without what their kind needs: the `gltf` crate takes it for granted. Found by fuzzing.
#[test]
fn images_cameras_and_lights_are_whole() {
    let lights = json!({"KHR_lights_punctual": {"lights": [{"type": "spot"}]}});
    for (key, value, words) in [
        ("images", json!([{}]), "image 0 lacks"),
        (
            "cameras",
            json!([{"type": "orthographic", "perspective": {"yfov": 1, "znear": 1}}]),
            "camera 0 lacks",
        ),
        ("extensions", lights, "light 0 lacks spot"),
        (
            "extensions",
            json!({}),
            "node 3 shows light 0, but there are 0 lights",
        ),
    ] {
        let mut d = document();
        d[key] = value;
        let e = load(&glb(&d, &square())).expect_err(words);
        assert!(e.contains(words), "{e}");
    }
    let mut d = document();
    d["images"] = json!([{"bufferView": 0}]);
    d["textures"] = json!([{"source": 0}]);
    d["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    let warnings = load(&glb(&d, &square())).unwrap().warnings;
    assert!(
        warnings[0].contains("image 0, which is neither"),
        "{warnings:?}"
    );
}
