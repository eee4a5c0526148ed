//! glTF files as exporters write them, and as they should not.

use crate::{
    area, assert_all_refused, assert_framed, assert_refused, assert_says, image, load_files,
};
use ::gltf::binary::{Glb, Header};
use glam::{Vec2, Vec3};
use peelnet_scene::{Lighting, Scene, Source, Wrap};
use serde_json::{Value, json};
use std::sync::Arc;

fn glb(json: &Value, buffer: &[u8]) -> Vec<u8> {
    // Its length is written as it is.
    let header = Header {
        magic: *b"glTF",
        version: 2,
        length: 0,
    };
    let json = serde_json::to_vec(json).unwrap().into();
    let bin = Some(buffer.into());
    Glb { header, json, bin }.to_vec().unwrap()
}

/// Four vertices of a square in the plane z = 0, and the indices of two triangles.
fn square() -> Vec<u8> {
    let vertices: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let numbers = vertices.as_flattened().iter();
    let mut bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
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
            {"name": "sign", "emissiveFactor": [0.0, 1.0, 0.0], "extensions": {"KHR_materials_unlit": {}}},
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

fn load_bytes(bytes: &[u8]) -> Result<Scene, String> {
    load_files(&[("thing.glb", bytes)])
}

/// Loads a document with the square's buffer.
fn load(document: &Value) -> Result<Scene, String> {
    load_bytes(&glb(document, &square()))
}

fn set(document: &mut Value, path: &str, value: Value) {
    let mut at = document;
    for key in path.split('/') {
        at = match key.parse::<usize>() {
            Ok(i) => {
                let list = at.as_array_mut().unwrap();
                list.resize(list.len().max(i + 1), Value::Null);
                &mut list[i]
            }
            Err(_) => &mut at[key],
        };
    }
    *at = value;
}

/// The document with other values: paths with what is there, a line each, or ` ; ` between them.
fn changed(changes: &str) -> Value {
    let mut document = document();
    for change in changes.replace(" ; ", "\n").trim().lines() {
        let (path, value) = change.split_once(" = ").unwrap();
        set(&mut document, path, serde_json::from_str(value).unwrap());
    }
    document
}

#[test]
fn nodes_instances_materials_lights_and_cameras() {
    let scene = load(&document()).unwrap();
    assert_eq!((scene.objects.len(), scene.triangles()), (1, 16));
    let mesh = &scene.objects[0].mesh;
    let bounds = (Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 2.0, -1.0));
    assert_eq!(mesh.bounds(), Some(bounds));
    // The mirrored instance faces the same way: +z, without normals in the file.
    assert_eq!(area(mesh), 4.0 * (1.0 + 2.0));
    assert!(mesh.normals.iter().all(|n| n.z > 0.9));
    // Those of the first instance.
    let materials = &scene.objects[0].materials;
    let [glass, leaf, sign, lamp] = [0, 1, 2, 3].map(|i| &materials[i]);
    assert_eq!((glass.color, glass.alpha), ([0.2, 0.4, 0.6], 0.3));
    assert_eq!((glass.metallic, glass.roughness), (0.25, 0.75));
    assert!(glass.blend && glass.double_sided && glass.lighting == Lighting::Pbr);
    assert_eq!((leaf.alpha_cutoff, leaf.is_opaque()), (Some(0.4), true));
    assert_eq!((sign.lighting, sign.alpha), (Lighting::Unlit, 1.0));
    assert_eq!(sign.emission, [0.0; 3]);
    assert_eq!(lamp.emission, [2.0, 1.0, 0.0]);
    let point = Source::Point(Vec3::new(0.0, 3.0, -2.0));
    let lights = scene.lights.iter();
    let sources: Vec<_> = lights.map(|l| (l.source, l.intensity)).collect();
    // A directional light shines along its −z: it comes from +z.
    assert_eq!(sources, [(point, 40.0), (Source::Toward(Vec3::Z), 1.0)]);
    let camera = &scene.views[0];
    assert_eq!(camera.position, Vec3::new(0.0, 0.0, 5.0));
    // As far ahead as the middle of what is there.
    let middle = mesh.bounds().map(|(low, high)| (low + high) / 2.0);
    assert_eq!(camera.target, Vec3::new(0.0, 0.0, middle.unwrap().z));
    assert!((camera.fov_y_degrees - 0.8f32.to_degrees()).abs() < 1e-4 && camera.far == 50.0);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

/// A square that is folded along its diagonal has two flat faces, not a rounded edge.
#[test]
fn triangles_without_normals_are_flat() {
    let mut buffer = square();
    // z of the third vertex.
    buffer[32..36].copy_from_slice(&1f32.to_le_bytes());
    let mut document = document();
    set(&mut document, "accessors/0/max", json!([1, 1, 1]));
    let scene = load_bytes(&glb(&document, &buffer)).unwrap();
    let mesh = &scene.objects[0].mesh;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a).normalize();
        assert!(t.iter().all(|&i| mesh.normals[i as usize] == normal));
    }
}

/// Without a camera of its own all of it is seen.
#[test]
fn a_file_without_a_camera_is_framed() {
    assert_framed(&load(&changed("nodes/5 = {}")).unwrap());
}

/// A material with all of it: an image in a buffer and one beside the file, a texture transform, a sampler, vertex colours; and three with one
/// thing each. `LENGTH` is that of the image.
const IMAGES: &str = r#"
buffers/1 = {"byteLength": 32, "uri": "uvs.bin"}
buffers/2 = {"byteLength": 48, "uri": "colors.bin"}
buffers/3 = {"byteLength": LENGTH, "uri": "red.bin"}
bufferViews/2 = {"buffer": 1, "byteLength": 32}
bufferViews/3 = {"buffer": 2, "byteLength": 48}
buffers/4 = {"byteLength": LENGTH, "uri": "red.bin"}
bufferViews/4 = {"buffer": 3, "byteLength": LENGTH}
bufferViews/5 = {"buffer": 4, "byteLength": LENGTH}
accessors/2 = {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}
accessors/3 = {"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC3"}
meshes/0/primitives/0/attributes = {"POSITION": 0, "TEXCOORD_0": 2, "COLOR_0": 3}
meshes/0/primitives/1/attributes = {"POSITION": 0, "TEXCOORD_0": 2, "COLOR_0": 3}
meshes/0/primitives/2/attributes = {"POSITION": 0, "TEXCOORD_0": 2, "COLOR_0": 3}
images = [{"bufferView": 4, "mimeType": "image/png"}, {"uri": "a%20map.png"}, {"bufferView": 5, "mimeType": "image/png"}]
samplers = [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]
textures = [{"source": 0, "sampler": 0}, {"source": 1, "sampler": 0}, {"source": 2}]
materials/0/pbrMetallicRoughness/baseColorTexture/index = 0
materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform = {"offset": [0.25, 0.5], "scale": [2, 1], "rotation": 0}
materials/0/normalTexture = {"index": 1, "scale": 0.5, "extensions": {"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, 1], "rotation": 0}}}
materials/1/pbrMetallicRoughness = {"baseColorTexture": {"index": 2}}
materials/2/pbrMetallicRoughness = {"baseColorTexture": {"index": 0}}
materials/3/extensions = {"KHR_materials_transmission": {"transmissionFactor": 0.75}}
"#;

#[test]
fn images_vertex_colours_and_transmission() {
    let floats = |all: &[f32]| -> Vec<u8> { all.iter().flat_map(|x| x.to_le_bytes()).collect() };
    let red = image(&[[255, 0, 0, 128]; 2]);
    let document = changed(&IMAGES.replace("LENGTH", &red.len().to_string()));
    let normals = image(&[[128, 128, 255, 255]; 2]);
    let files = [
        ("thing.glb", &*glb(&document, &square())),
        ("uvs.bin", &floats(&[0., 1., 1., 1., 1., 0., 0., 0.])),
        ("colors.bin", &floats(&[1.0, 0.5, 0.25].repeat(4))),
        ("red.bin", &red),
        ("a map.png", &normals),
    ];
    let scene = load_files(&files).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let materials = &scene.objects[0].materials;
    let [glass, leaf, sign, lamp] = [0, 1, 2, 3].map(|i| &materials[i]);
    let color = glass.maps.color.as_ref().unwrap();
    assert_eq!((color.size, color.texels[0]), ([2, 1], [255, 0, 0, 128]));
    assert_eq!(glass.maps.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert!(glass.maps.nearest && glass.maps.normal_scale == 0.5);
    assert!(glass.maps.normal.is_some() && color.has_alpha);
    // One place in one file is decoded once.
    assert!(Arc::ptr_eq(color, leaf.maps.color.as_ref().unwrap()));
    // Opaque by its alpha mode, whatever its image holds.
    assert!(!sign.maps.color.as_ref().unwrap().has_alpha);
    // Three quarters pass, one quarter is scattered.
    assert_eq!((lamp.transmission, lamp.color), ([0.75; 3], [0.25; 3]));
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.uvs[0][1], Vec2::new(2.25, 1.5));
    assert_eq!(mesh.uvs[2][1], Vec2::new(1.0, 1.0));
    assert_eq!(mesh.colors[0], [1.0, 0.5, 0.25, 1.0]);
}

/// Many primitives may name the vertices of a whole file: each holds those that it uses.
#[test]
fn primitives_hold_the_vertices_that_they_use() {
    let scene = load(&changed("accessors/1/count = 3")).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!((mesh.positions.len(), mesh.normals.len()), (24, 24));
    assert_eq!(area(mesh), 2.0 * (1.0 + 2.0));
}

/// Specular colours and glossiness: the gold of the extension's description, whose fallback is not used, and a texel of chrome: black, white,
/// and half of its glossiness. The opacity is that of the diffuse texture.
#[test]
fn specular_and_glossiness() {
    let with = |extension: &str| {
        let document = changed(&format!(
            "extensionsUsed = [\"KHR_materials_pbrSpecularGlossiness\", \"KHR_lights_punctual\"] ; \
             accessors/2 = {{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC2\"}} ; \
             meshes/0/primitives/0/attributes/TEXCOORD_0 = 2 ; textures = [{{\"source\": 0}}, {{\"source\": 1}}] ; \
             images = [{{\"uri\": \"diffuse.png\"}}, {{\"uri\": \"specular.png\"}}] ; \
             materials/0/extensions = {{\"KHR_materials_pbrSpecularGlossiness\": {extension}}}"
        ));
        let files = [
            ("thing.glb", glb(&document, &square())),
            ("diffuse.png", image(&[[0, 0, 0, 128]; 2])),
            ("specular.png", image(&[[255, 255, 255, 102]; 2])),
        ];
        let scene = load_files(&files.each_ref().map(|(name, bytes)| (*name, &**bytes))).unwrap();
        let warnings = scene.warnings.join("\n");
        assert!(!warnings.contains("not drawn"), "{warnings}");
        scene.objects[0].materials[0].clone()
    };
    let m = with(
        "{\"diffuseFactor\": [0, 0, 0, 0.5], \"specularFactor\": [1, 0.766, 0.336], \"glossinessFactor\": 0.75}",
    );
    for (x, gold) in m.color.into_iter().zip([1.0, 0.766, 0.336]) {
        assert!((x - gold).abs() < 1e-3, "{:?}", m.color);
    }
    assert!((m.metallic - 1.0).abs() < 1e-4 && (m.roughness - 0.25).abs() < 1e-4);
    assert_eq!((m.lighting, m.alpha), (Lighting::Pbr, 0.5));
    assert!(m.maps.metallic_roughness.is_none());
    let m = with(
        "{\"diffuseTexture\": {\"index\": 0}, \"specularGlossinessTexture\": {\"index\": 1}, \"glossinessFactor\": 0.5}",
    );
    assert_eq!((m.color, m.metallic, m.roughness), ([1.0; 3], 1.0, 1.0));
    assert_eq!(m.maps.color.unwrap().texels[0], [255, 255, 255, 128]);
    let metal = m.maps.metallic_roughness.unwrap();
    assert_eq!(metal.texels[0], [255, 204, 255, 255]);
}

#[test]
fn what_is_not_drawn_is_reported() {
    let document = changed(
        "images = [{\"uri\": \"a.png\"}, {\"bufferView\": 0}] ; textures = [{\"source\": 0}, {\"source\": 1}] ; \
         materials/0/pbrMetallicRoughness/baseColorTexture = {\"index\": 0} ; materials/2/emissiveTexture = {\"index\": 1} ; \
         extensionsUsed = [\"KHR_materials_clearcoat\"] ; meshes/0/primitives/1/mode = 1 ; \
         extensions/KHR_lights_punctual/lights/1 = {\"type\": \"spot\", \"spot\": {}} ; \
         scenes = [{\"nodes\": [0]}, {\"nodes\": [0]}]",
    );
    let warnings = load(&document).unwrap().warnings.join("\n");
    let words = "image 0 ('a.png'), which cannot be read & image 1, which is neither & KHR_materials_clearcoat & Lines & spot lights & \
        scenes other than number 0 of 2";
    assert_says(&warnings, words);
    let document = changed(
        "textures = [{}] ; materials/0/normalTexture = {\"index\": 0, \"extensions\": {\"KHR_texture_transform\": {\"offset\": [0.5, 0]}}} ; \
         materials/0/pbrMetallicRoughness/baseColorFactor = [5, -1, 1, 0.5] ; nodes/0/extensions = {\"FOO_bar\": {}} ; \
         accessors/2 = {\"componentType\": 5126, \"count\": 4, \"type\": \"VEC4\"} ; meshes/0/primitives/0/attributes/TANGENT = 2",
    );
    let warnings = load(&document).unwrap().warnings.join("\n");
    let words = "a texture without an image & texture transforms of normal & extensions: FOO_bar & numbers outside of their range & \
        tangents of its own";
    assert_says(&warnings, words);
    let document = changed(
        "accessors/1/count = 5 ; nodes/1/matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2] ; nodes/1/translation = [0, 0, 0] ; \
         images = [{\"uri\": \"a.png\"}, {\"uri\": \"b.png\"}] ; textures = [{\"source\": 0}, {\"source\": 1}] ; \
         materials/0/emissiveTexture = {\"index\": 0} ; materials/1/emissiveTexture = {\"index\": 1}",
    );
    let warnings = load(&document).unwrap().warnings.join("\n");
    let words = "beyond the last triangle (mesh 0, primitive 0, mesh 0, primitive 1, mesh 0, primitive 2 and 1 more) & \
        beside a matrix: node 1 & perspective of a matrix: node 1 & image 0 ('a.png'), image 1 ('b.png'), which cannot be read";
    assert_says(&warnings, words);
}

/// A field of view of 516 degrees, and a place without a direction.
#[test]
fn cameras_without_sense_are_named() {
    let scene = load(&changed(
        "cameras/1 = {\"type\": \"perspective\", \"name\": \"wide\", \"perspective\": {\"yfov\": 9, \"znear\": 1}} ; \
         cameras/2 = {\"type\": \"perspective\", \"perspective\": {\"yfov\": 0.8, \"znear\": 1}} ; \
         nodes/0/children = [1, 3, 5, 6, 7] ; nodes/6 = {\"camera\": 1} ; nodes/7 = {\"camera\": 2, \"scale\": [0, 0, 0]}",
    ))
    .unwrap();
    assert_eq!(scene.views.len(), 1);
    assert_says(&scene.warnings.join("\n"), "left out: wide, camera 2");
}

/// As those of materials, and as scene files demand them.
#[test]
fn numbers_of_lights_are_taken_as_the_nearest_in_their_range() {
    let lights = "extensions/KHR_lights_punctual/lights";
    let scene = load(&changed(&format!(
        "{lights}/0/intensity = -30 ; {lights}/1/color = [-5, 0.5, 2] ; {lights}/1/name = \"sun\""
    )))
    .unwrap();
    let [point, sun] = &scene.lights[..] else {
        panic!("{:?}", scene.lights);
    };
    assert_eq!((point.intensity, sun.color), (0.0, [0.0, 0.5, 1.0]));
    let warnings = scene.warnings.join("\n");
    assert_says(&warnings, "nearest in it: light 0, sun");
}

/// A rotation of any length turns, and does nothing else.
#[test]
fn rotations_are_normalized() {
    let turned = |rotation: &str| {
        let document = changed(&format!(
            "nodes/0 = {{\"mesh\": 0, \"rotation\": {rotation}}}"
        ));
        load(&document).unwrap().objects[0].mesh.positions.clone()
    };
    let (long, unit) = (turned("[0, 0, 3, 4]"), turned("[0, 0, 0.6, 0.8]"));
    assert!(
        long.iter().zip(&unit).all(|(a, b)| a.abs_diff_eq(*b, 1e-6)),
        "{long:?} {unit:?}"
    );
}

/// Changes of the document, and words of the error: what is wrong, its place and a fix. The `gltf` crate takes much of this for granted. Most
/// were found by fuzzing. Files whose nodes are no tree may ask for a billion instances, or have no end.
const BAD: &str = r#"
meshes/0/primitives/0/attributes/POSITION = 7 => 'POSITION' is 7 & 2 accessors
nodes/0/children/0 = 4294967295 => nodes[0].children[0] & out of bounds & export
scenes = [{"nodes": []}] => no triangles
extensionsRequired = ["KHR_draco_mesh_compression"] => KHR_draco_mesh_compression
meshes/0/primitives/0/attributes = {} => no glTF
buffers = [{"byteLength": 60, "uri": "gone.bin"}] => buffer & .bin
asset = {"version": "7.0"} => glTF 7.0 & export it
asset = {"version": "1.0"} => glTF 1.0 & export it
asset = {"version": "2.1", "minVersion": "2.1"} => 2.1 or newer & export it
asset = {} => of no version & export it
asset = {"version": 2} => of no version & export it
accessors/0/type = "VEC2" => accessor 0
accessors/0/componentType = 5123 => accessor 0
accessors/0/count = 0 => accessor 0
accessors/0/byteOffset = 1125899906842624 => accessor 0
accessors/1/type = "VEC3" => accessor 1
accessors/1/componentType = 5126 => accessor 1
accessors/0/count = 18446744073709551615 => vertices
images = [{}] => image 0 lacks
cameras = [{"type": "orthographic", "perspective": {"yfov": 1, "znear": 1}}] => camera 0 lacks
extensions = {"KHR_lights_punctual": {"lights": [{"type": "spot"}]}} => light 0 lacks spot
extensions = {} => nodes[3].extensions & light & out of bounds
nodes/1/children = [2] => node 2 is a child of node 1 and of node 0 & one parent
nodes = [{"children": [1]}, {"children": [2]}, {"children": [1]}] => node 1 is a child of node 0 and of node 2 & one parent
nodes/1/children = [1] => node 1 is & one parent
scenes/0/nodes = [0, 1] => node 1 is a child of node 0 and of scene 0
scenes/0/nodes = [0, 0] => node 0 is a child of scene 0 and of scene 0
nodes = [{"children": [1, 1]}, {"children": [2, 2]}, {"mesh": 0}] => node 2 is a child of node 1 and of node 1 & one parent
"#;

#[test]
fn bad_files() {
    assert_all_refused(BAD, |changes| load(&changed(changes)));
    // Each part would have a copy of it.
    let long = format!("meshes/0/name = {:?}", "n".repeat(201));
    assert_refused(
        load(&changed(&long)),
        "meshes[0].name has 201 bytes & at most 200",
    );
    load(&changed(r#"asset = {"version": "2.1"}"#)).expect("a file that 2.0 can read");
    let mut nan = square();
    nan[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut beyond = square();
    beyond[48..50].copy_from_slice(&9u16.to_le_bytes());
    // A name that is not UTF-8 hides nothing from the check of references, although the crate skips it.
    let broken =
        changed(r#"meshes/0/primitives/0/attributes/POSITION = 77 ; materials/0/hidden = "X""#);
    let mut no_text = serde_json::to_vec(&broken).unwrap();
    let at = no_text.windows(6).position(|w| w == b"hidden").unwrap();
    no_text[at] = 0xa6;
    for (bytes, words) in [
        (
            b"not a file".to_vec(),
            "thing.glb & no glTF 2.0 file & export",
        ),
        (no_text, "thing.glb: is no glTF 2.0 file"),
        (
            glb(&document(), &nan),
            "mesh 0, primitive 0 & position 0 is not finite & repair",
        ),
        (
            glb(&document(), &beyond),
            "mesh 0, primitive 0 & index 9 & 4 vertices",
        ),
    ] {
        assert_refused(load_bytes(&bytes), words);
    }
}

/// The header's length is less than the header's own; of the shorter files there is nothing to read.
#[test]
fn lengths_of_headers_are_checked() {
    let good = glb(&document(), &square());
    for said in 0..12u8 {
        let mut short = good.clone();
        short[8..12].copy_from_slice(&[said, 0, 0, 0]);
        assert_refused(load_bytes(&short), &format!("has {said} byte"));
    }
    for length in 0..good.len() {
        assert_refused(load_bytes(&good[..length]), "thing.glb");
    }
}

/// Many nodes of a mesh with many primitives, and a strip of 70 million indices without data, are counted, not made; a long chain of nodes is
/// no circle.
#[test]
fn instances_are_counted_before_they_are_made() {
    let mut many = document();
    let primitive = many["meshes"][0]["primitives"][0].clone();
    many["meshes"][0]["primitives"] = vec![primitive; 2000].into();
    many["nodes"] = vec![json!({"mesh": 0}); 2000].into();
    many["scenes"][0]["nodes"] = (0..2000).collect();
    assert_refused(load(&many), "4000000 primitives & 1000000");
    let mut strip = document();
    let zeros = json!({"componentType": 5125, "count": 70_000_000, "type": "SCALAR"});
    strip["accessors"].as_array_mut().unwrap().push(zeros);
    set(&mut strip, "meshes/0/primitives/0/indices", json!(2));
    set(&mut strip, "meshes/0/primitives/0/mode", json!(5));
    assert_refused(load(&strip), "accessor 2 & 70000000 values without bytes");
    let mut long = document();
    let chain = (1..3000).map(|i| json!({"children": [i]}));
    long["nodes"] = chain.chain([json!({"mesh": 0})]).collect();
    assert_eq!(load(&long).unwrap().triangles(), 8);
}

/// What other programs leave out or put before a file: nothing of it is needed.
#[test]
fn common_files_that_are_not_strict() {
    let whole = load(&document()).unwrap();
    let same = |loaded: Result<Scene, String>| {
        let loaded = loaded.unwrap();
        assert_eq!(loaded.objects[0].mesh, whole.objects[0].mesh);
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    };
    // A byte order mark, and a buffer in a data URI.
    let hex: String = square().iter().map(|b| format!("%{b:02x}")).collect();
    let uri = format!("data:application/octet-stream,{hex}");
    let inside = changed(&format!(
        r#"buffers = [{{"byteLength": 60, "uri": "{uri}"}}]"#
    ));
    let text = format!("\u{feff}{inside}");
    same(load_files(&[("thing.gltf", text.as_bytes())]));
    same(load(&changed(
        "accessors/0/min = null ; accessors/0/max = [null, 0]",
    )));
    // The roots are the nodes that are no one's child.
    let mut d = document();
    d.as_object_mut().unwrap().remove("scenes");
    d.as_object_mut().unwrap().remove("scene");
    same(load(&d));
    same(load(&changed("scenes = null ; scene = null")));
    // Names are percent-encoded, or not.
    for (name, uri) in [("a b%.bin", "a%20b%25.bin"), ("a%20b.bin", "a%20b.bin")] {
        let text = changed(&format!("buffers/0/uri = \"{uri}\"")).to_string();
        same(load_files(&[
            ("thing.gltf", text.as_bytes()),
            (name, &square()),
        ]));
    }
}

/// Accessors without a buffer view are zeros, of which a sparse one replaces some.
#[test]
fn accessors_without_data_are_zeros() {
    let d = changed(
        r#"accessors/2 = {"componentType": 5126, "count": 4, "type": "VEC4"}
accessors/3 = {"componentType": 5126, "count": 4, "type": "VEC3"}
accessors/3/sparse = {"count": 2, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}
bufferViews/2 = {"buffer": 0, "byteOffset": 50, "byteLength": 4}
bufferViews/3 = {"buffer": 0, "byteOffset": 12, "byteLength": 24}
meshes/0/primitives = [{"attributes": {"POSITION": 3, "COLOR_0": 2}, "indices": 1, "material": 0}]"#,
    );
    let scene = load(&d).unwrap();
    let mesh = &scene.objects[0].mesh;
    // Indices 1 and 2 become the square's second and third vertices.
    let at = |i: usize| mesh.positions[i] + Vec3::new(0.0, 0.0, 2.0);
    let expected = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::ZERO];
    assert_eq!([0, 1, 2, 3].map(at), expected);
    assert_eq!(mesh.colors[0], [0.0; 4]);
}
