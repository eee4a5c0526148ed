//! Materials of the specular–glossiness workflow, in glTF and in scene files.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use peelnet_scene::{Lighting, Material, Scene};
use serde_json::{Value, json};
use std::{io, path::Path};

/// An image of one texel.
fn image(texel: [u8; 4]) -> Vec<u8> {
    let mut bytes = io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(1, 1, image::Rgba(texel));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Black diffuse, and white specular of a glossiness of 0.4.
fn read(name: &Path, text: &str) -> io::Result<Vec<u8>> {
    match name.to_str().unwrap() {
        "diffuse.png" => Ok(image([0, 0, 0, 128])),
        "specular.png" => Ok(image([255, 255, 255, 102])),
        "s.gltf" | "s.toml" => Ok(text.as_bytes().to_vec()),
        _ => Err(io::ErrorKind::NotFound.into()),
    }
}

fn load(name: &str, text: &str) -> Result<Scene, String> {
    Scene::from_bytes(name, |path| read(path, text)).map_err(|e| e.to_string())
}

fn gltf(extension: &Value) -> Scene {
    let floats: [f32; 15] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1.];
    let hex = |b: u8| format!("%{b:02x}");
    let bytes = floats.into_iter().flat_map(f32::to_le_bytes);
    let data: String = bytes.map(hex).collect();
    let document = json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_pbrSpecularGlossiness"],
        "extensionsRequired": ["KHR_materials_pbrSpecularGlossiness"],
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{
            "alphaMode": "BLEND",
            // For readers that do not know the extension.
            "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]},
            "extensions": {"KHR_materials_pbrSpecularGlossiness": extension},
        }],
        "textures": [{"source": 0}, {"source": 1}],
        "images": [{"uri": "diffuse.png"}, {"uri": "specular.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 60}],
        "buffers": [{"byteLength": 60, "uri": format!("data:application/octet-stream,{data}")}],
    });
    load("s.gltf", &document.to_string()).unwrap()
}

fn assert_gold(m: &Material) {
    for (x, gold) in m.color.into_iter().zip([1.0, 0.766, 0.336]) {
        assert!((x - gold).abs() < 1e-3, "{:?}", m.color);
    }
    assert!((m.metallic - 1.0).abs() < 1e-4 && (m.roughness - 0.25).abs() < 1e-4);
    assert_eq!(m.lighting, Lighting::Pbr);
    assert!(m.maps.metallic_roughness.is_none());
}

/// The gold of the extension's description; its fallback is not used.
#[test]
fn gltf_factors() {
    let scene = gltf(&json!({
        "diffuseFactor": [0.0, 0.0, 0.0, 0.5],
        "specularFactor": [1.0, 0.766, 0.336],
        "glossinessFactor": 0.75,
    }));
    let m = &scene.objects[0].materials[0];
    assert_gold(m);
    assert_eq!(m.alpha, 0.5);
    let warnings = scene.warnings.join("\n");
    assert!(!warnings.contains("not drawn"), "{warnings}");
}

/// A texel of chrome: black, white, and half of its glossiness. The opacity is that of the diffuse texture.
#[test]
fn gltf_textures() {
    let scene = gltf(&json!({
        "diffuseTexture": {"index": 0},
        "specularGlossinessTexture": {"index": 1},
        "glossinessFactor": 0.5,
    }));
    let m = &scene.objects[0].materials[0];
    assert_eq!((m.color, m.metallic, m.roughness), ([1.0; 3], 1.0, 1.0));
    let texel =
        |map: &Option<std::sync::Arc<peelnet_scene::Texture>>| map.as_ref().unwrap().texels[0];
    assert_eq!(texel(&m.maps.color), [255, 255, 255, 128]);
    assert_eq!(texel(&m.maps.metallic_roughness), [255, 204, 255, 255]);
    assert!(scene.files.len() == 3);
}

const HEAD: &str = "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n\
    [[light]]\nposition = [1, 2, 3]\n[[object]]\nname = 'a'\nmesh = { shape = 'box' }\n[object.material]\n";

fn material(text: &str) -> Result<Material, String> {
    let scene = load("s.toml", &format!("{HEAD}{text}\n"))?;
    Ok(scene.objects[0].materials[0].clone())
}

#[test]
fn scene_file_values() {
    let gold = "lighting = 'pbr'\ncolor = [0, 0, 0]\nspecular_color = [1, 0.766, 0.336]\nglossiness = 0.75";
    assert_gold(&material(gold).unwrap());
    // Without a specular colour it is a dielectric: its colour stays.
    let plastic = "lighting = 'pbr'\ncolor = [0.2, 0.4, 0.6]\nglossiness = 0.9";
    let m = material(plastic).unwrap();
    assert!((m.color[1] - 0.4).abs() < 1e-3 && m.metallic < 1e-3);
    assert!((m.roughness - 0.1).abs() < 1e-6);
    let unlit = "lighting = 'unlit'\ncolor = [0.2, 0.4, 0.6]\nspecular_color = [1, 1, 1]";
    assert_eq!(material(unlit).unwrap().color, [0.2, 0.4, 0.6]);
}

/// One texture with glossiness in its alpha, two of them, and a pattern.
#[test]
fn scene_file_textures() {
    let both =
        "lighting = 'pbr'\ncolor_map = 'diffuse.png'\nspecular_glossiness_map = 'specular.png'";
    let m = material(both).unwrap();
    assert_eq!((m.color, m.metallic, m.roughness), ([1.0; 3], 1.0, 1.0));
    assert_eq!(m.maps.color.unwrap().texels[0], [255, 255, 255, 128]);
    let metal = m.maps.metallic_roughness.unwrap();
    assert_eq!(metal.texels[0], [255, 153, 255, 255]);
    assert!(m.blend);
    // As a map of its own, the specular colours' alpha says nothing, and the glossiness is the red of another.
    let apart = "lighting = 'pbr'\ncolor = [0, 0, 0]\nspecular_color_map = 'specular.png'\nglossiness_map = 'diffuse.png'";
    let m = material(apart).unwrap();
    let metal = m.maps.metallic_roughness.unwrap();
    assert_eq!(metal.texels[0], [255, 255, 255, 255]);
    let pattern = "lighting = 'pbr'\nglossiness_map = { pattern = 'checker', size = 8 }";
    let m = material(pattern).unwrap();
    let metal = m.maps.metallic_roughness.unwrap();
    let mut rough: Vec<u8> = metal.texels.iter().map(|t| t[1]).collect();
    rough.sort_unstable();
    rough.dedup();
    assert_eq!(rough, [0, 255]);
}

/// Numbers are interpolated between states; those in textures stay.
#[test]
fn states_of_a_timeline() {
    let states = "color = [0, 0, 0]\nlighting = 'pbr'\nspecular_color = [1, 1, 1]\nglossiness = 1.0\n[[timeline]]\ntime = 0\n\
        [[timeline]]\ntime = 2\n[[timeline.object]]\nname = 'a'\nmaterial = { glossiness = 0.0 }\n\
        [[timeline]]\ntime = 4\n[[timeline.object]]\nname = 'a'\nmaterial = { specular_glossiness_map = 'specular.png' }\n";
    let text = format!("{HEAD}{states}");
    let at = |time: f32| {
        let scene = Scene::from_bytes_at("s.toml", Some(time), |path| read(path, &text));
        scene.unwrap().objects[0].materials[0].clone()
    };
    assert_eq!(at(0.5).roughness, 0.25);
    let last = at(4.0);
    assert_eq!((last.roughness, last.metallic), (1.0, 1.0));
    assert!(last.maps.metallic_roughness.is_some());
}

#[test]
fn bad_materials() {
    for (text, words) in [
        ("glossiness = 0.5", ["object 1.material.glossiness", "pbr"]),
        ("lighting = 'pbr'\nglossiness = 2", ["glossiness", "0 … 1"]),
        (
            "lighting = 'pbr'\nspecular_color = [0, 2, 0]",
            ["specular_color", "0 … 1"],
        ),
        (
            "lighting = 'pbr'\nglossiness = 1\nroughness = 0",
            ["glossiness", "one of them"],
        ),
        (
            "lighting = 'pbr'\nglossiness_map = 'specular.png'\nspecular_glossiness_map = 'specular.png'",
            ["glossiness_map", "one of them"],
        ),
        (
            "lighting = 'pbr'\nspecular_color_map = 'none.png'",
            ["none.png", "cannot read"],
        ),
    ] {
        let e = material(text).unwrap_err();
        for word in words {
            assert!(e.contains(word), "no '{word}' in: {e}");
        }
    }
}
