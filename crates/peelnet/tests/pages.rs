//! Pages about an extraction that is not made, and about a dataset.

use crate::common::{Folder, SCENE, SPHERES};
use peelnet_core::files::thousands;
use serde_json::{Value, json};
use std::path::Path;

/// A scene's name that is markup.
const MARKUP: &str = "<script>alert(1)</script>";

/// A triangle with alpha in a binary glTF file.
fn triangle() -> Vec<u8> {
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"alphaMode": "BLEND", "doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}}],
        "buffers": [{"byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let vertices = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let vertices: Vec<u8> = vertices.into_iter().flat_map(f32::to_le_bytes).collect();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    let length = (28 + text.len() + vertices.len()) as u32;
    file.extend(length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &vertices)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

fn folder() -> Folder {
    let name = format!("\"{MARKUP}\"");
    let named = SCENE.replace("\"two\"", &name);
    let folder = Folder::new(&[("s.toml", SPHERES), ("named.toml", &named)]);
    folder.write("triangle.glb", triangle());
    folder
}

fn page(folder: &Folder, name: &str) -> String {
    let page = String::from_utf8(folder.read(name)).unwrap();
    assert!(page.contains("&lt;script&gt;alert(1)") && !page.contains(MARKUP));
    // It needs no other file.
    assert!(!page.contains("src=\"images") && !page.contains("href="));
    page
}

/// The figures are those of the extraction with the same options: sampled pixels, varied copies, fragments left out. Small parts are encoded
/// whole, so that their bytes are known.
#[test]
fn a_preview_counts_what_an_extraction_writes() {
    let folder = folder();
    let rest = "--peel dual --max-passes 1 --views 1 --format csv";
    for (k, flags) in ["--pixels 0.5 --augment 1", rest, "--format npy"]
        .into_iter()
        .enumerate()
    {
        let line = format!("extract s.toml named.toml triangle.glb --size 64x48 {flags} --out");
        let before = folder.everything();
        let preview = folder.json(&format!("{line} p{k} --preview"));
        let mut after = folder.everything();
        after.retain(|path, _| !before.contains_key(path));
        let new: Vec<_> = after
            .keys()
            .map(|path| path.display().to_string())
            .collect();
        assert_eq!(new, [format!("p{k}"), format!("p{k}/preview.html")]);
        let written = folder.json(&format!("{line} d{k}"));
        for name in ["rows", "pixels", "lost_fragments", "coplanar_ties"] {
            assert_eq!(preview[name], written[name], "{flags}: {name}");
        }
        assert_eq!(preview["parts"], written["work_items"], "{flags}");
        assert_eq!(preview["sampled_rows"], written["rows"], "{flags}");
        let lost = written["lost_fragments"].as_u64() > Some(0);
        assert_eq!(lost, flags == rest, "{flags}");
        let manifest = folder.read(&format!("d{k}/_peelnet/manifest.json"));
        let manifest: Value = serde_json::from_slice(&manifest).unwrap();
        let files = manifest["parts"].as_array().unwrap().iter();
        let files = files.flat_map(|part| part["files"].as_array().unwrap());
        let bytes: u64 = files.filter_map(|file| file["bytes"].as_u64()).sum();
        let expected = preview["expected_bytes"].as_f64().unwrap();
        assert!(
            (expected / bytes as f64 - 1.0).abs() < 0.01,
            "{flags}: {expected}, {bytes}"
        );
        let scenes = preview["scenes"].as_array().unwrap();
        assert_eq!(scenes.len(), 3);
        for scene in scenes {
            let name = scene["name"].as_str().unwrap();
            assert_eq!(scene["rows"], written["rows_by_scene"][name], "{flags}");
            for (bins, all) in [
                ("depth", "rows"),
                ("alpha", "rows"),
                ("fragments_per_pixel", "pixels"),
            ] {
                let bins = scene[bins].as_array().unwrap().iter();
                let sum: u64 = bins.filter_map(|bin| bin["count"].as_u64()).sum();
                assert_eq!(Some(sum), scene[all].as_u64(), "{flags}: {all} of {name}");
            }
        }
        // A glTF file without cameras has three.
        let views = if flags == rest { 3 } else { 6 };
        let page = page(&folder, &format!("p{k}/preview.html"));
        assert_eq!(page.matches("data:image/png").count(), views, "{flags}");
        assert_eq!(page.matches("rows by linear depth").count(), 3, "{flags}");
    }
    let said = folder.says("extract s.toml --size 8x8 --out p0 --preview", 0);
    assert!(
        said.contains("replaced p0/preview.html (a report of peelnet)"),
        "{said}"
    );
}

/// Small frames have a cell for each pixel: the rows in the page are all of those views.
#[test]
fn a_datasets_page_has_its_counts_views_and_rows() {
    let folder = folder();
    let written = folder.json("extract s.toml named.toml --size 64x48 --out d");
    let before = folder.everything();
    let said = folder.says("inspect d --html d.html", 0);
    assert!(said.contains("the page is d.html"), "{said}");
    let mut after = folder.everything();
    assert!(after.remove(Path::new("d.html")).is_some());
    assert_eq!(after, before);
    let page = page(&folder, "d.html");
    let rows = &written["rows_by_scene"];
    // First views of both scenes, and another one.
    assert_eq!(page.matches("data:image/png").count(), 3);
    let sums = ["rows", "pixels"].map(|name| thousands(written[name].as_u64().unwrap()));
    let sums = format!("<p>{} rows of {} pixels in 3 parts.", sums[0], sums[1]);
    assert!(page.contains(&sums), "{sums}");
    let data = page.split("<script type=\"application/json\">").skip(1);
    let data = data.map(|text| text.split("</script>").next().unwrap());
    let counts = data.map(|text| -> u64 {
        let grid: Value = serde_json::from_str(text).unwrap();
        assert_eq!([&grid["width"], &grid["height"]], [64, 48]);
        let cells = grid["cells"].as_object().unwrap().values();
        let values = cells.clone().map(|cell| cell[3].as_array().unwrap().len());
        let counts: Vec<u64> = cells.filter_map(|cell| cell[2].as_u64()).collect();
        assert!(values.eq(counts.iter().map(|n| 7 * *n as usize)));
        counts.iter().sum()
    });
    let counts: Vec<u64> = counts.collect();
    assert_eq!(Some(counts[1]), rows[MARKUP].as_u64());
    assert!(counts[0] > counts[1] && Some(counts[0]) < rows["three-spheres"].as_u64());
    // What the checks find is in the page as well, which goes to stdout here.
    assert!(page.matches("<td>holds</td>").count() == 5);
    let output = folder
        .command("inspect d --html - --json")
        .output()
        .unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), page);
    // No rows at all.
    folder.prints("extract named.toml --size 1x1 --pixels 1e-9 --out e");
    folder.prints("inspect e --html e.html");
    let text = String::from_utf8(folder.read("e.html")).unwrap();
    assert!(text.contains("0 rows of 0 pixels in 1 part") && text.contains("it is empty"));
}
