//! OBJ and MTL files as exporters write them, and as they should not.

use crate::{Loaded, area, assert_all_refused, assert_refused, assert_says, image, load_mesh};
use glam::{Vec2, Vec3};
use peelnet_scene::{Lighting, Maps, Wrap};
use std::sync::Arc;

fn load(obj: &str, mtl: &str) -> Loaded {
    let files = [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())];
    load_mesh(&files).unwrap()
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_negative_indices_groups_and_materials() {
    let obj = format!(
        "mtllib a.mtl\n{QUAD}g left\nusemtl glass\nf 1 2 3 4\ng right\nusemtl fog\nf -4 -3 -2\n"
    );
    let mtl = "newmtl glass\nKd 0.25 0.5 1\nd 0.3\nnewmtl fog\nKd 1 1 1\nTr 0.9\n";
    let (m, warnings, _) = load(&obj, mtl);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(m.triangles.len(), 3);
    assert_eq!(m.parts.len(), 2);
    assert_eq!(m.parts[0].name, "left");
    assert_eq!(m.parts[0].material.alpha, 0.3);
    assert_eq!(m.parts[0].material.color, [0.25, 0.5, 1.0]);
    assert!((m.parts[1].material.alpha - 0.1).abs() < 1e-6);
    assert!(m.normals.iter().all(|n| *n == Vec3::Z));
}

/// An L-shaped face (concave) before its vertices, lines and points, comments behind data, a continued line, and a texture that is not there.
#[test]
fn what_exporters_write() {
    let obj = "mtllib\ta.mtl # library\nusemtl\tbrass\nf 1 2 3 \\\n4 5 6\nl 1 2 3\np 1\n\
        v 0 0 0 # origin\n\\\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
    let (m, warnings, _) = load(obj, "newmtl brass\nKd 1 0 0 # red\nmap_Kd brass.png\n");
    assert_eq!((m.triangles.len(), area(&m)), (4, 3.0));
    assert_eq!(m.parts[0].material.color, [1.0, 0.0, 0.0]);
    assert_says(&warnings.join("\n"), "brass.png & not drawn: l, p");
    // What an exporter writes for nothing is no warning; what changes the picture is.
    let obj = format!(
        "mtllib a.mtl\nusemtl a\n{}f 1 2 3\n",
        QUAD.replace("0 0 0\n", "0 0 0 255 0 0\n")
    );
    let obj = ["1 0 0", "1 1 0", "0 1 0"].iter().fold(obj, |obj, v| {
        obj.replace(&format!("v {v}\n"), &format!("v {v} 1 1 1\n"))
    });
    let (_, warnings, _) = load(&obj, "newmtl a\nTf 0.1 1 1\nnewmtl b\nTf 1 1 1\nKdd 3\n");
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert_says(
        &warnings.join("\n"),
        "not drawn: Tf, Kdd & colours outside of 0 … 1",
    );
}

/// Lines of a library, where ` ; ` ends one, and the error; the same of what follows the vertices of a square.
const BAD_MATERIALS: &str = r"
newmtl m ; Kd 1 0 => a.mtl:2: 'Kd 1 0' needs 1 or 3 numbers
newmtl m ; \ ; Ks 0. 0 => a.mtl:2: 'Ks 0. 0' needs 1 or 3 numbers
newmtl m ; d x => a.mtl:2: 'd x' holds no finite number
newmtl m ; d nan => a.mtl:2: 'd nan' holds no finite number
newmtl m ;  ; Tr 1.5 => a.mtl:3: 'Tr 1.5' must lie in 0 … 1
newmtl m ; Tr x => a.mtl:2: 'Tr x' holds no finite number
newmtl m ; Pm abc => a.mtl:2: 'Pm abc' holds no finite number
newmtl m ; Pr xyz => a.mtl:2: 'Pr xyz' holds no finite number
";
const BAD_STATEMENTS: &str = "
v nan 0 0 ; f 1 2 3 => a.obj:5: 'v nan 0 0' holds no finite numbers
v 1 0 0 1e-42 ; f 1 2 3 => a.obj:5: 'v 1 0 0 1e-42' holds no finite numbers
v 0 zero 0 ; f 1 2 3 => a.obj:5: 'v 0 zero 0' holds no finite numbers
vn 0 nan 0 ; f 1//1 2//1 3//1 => a.obj:5: 'vn 0 nan 0' holds no finite numbers
v 0 0 ; f 1 2 3 => a.obj:5: 'v 0 0' is a vertex of 2 numbers
v 0 0 0 1 0 0 ; f 1 2 3 => a.obj:5: 'v 0 0 0 1 0 0' is among vertices some of which have a colour
vt 1 ; f 1 2 3 => a.obj:5: 'vt 1' holds too few numbers
f 1 2 5 => a.obj:5: 'f 1 2 5' names a vertex that is not there; repair the face
f 0 1 2 => a.obj:5: 'f 0 1 2' names a vertex
f -1 -2 -5 => a.obj:5: 'f -1 -2 -5' names a vertex
f 1//1 1//1 1//6148914691236517206 ; vn 0 0 1 => a.obj:5: 'f
f 1 2 3/1/1/1 => a.obj:5: 'f
f 1 2 => a.obj:5: 'f 1 2' is a face of fewer than 3 vertices
g empty => a.obj: holds no faces
f 1 1 1 => a.obj: holds no triangle with an area
";

/// Each bad file gives one error that names the file, the line where that is known, and a fix.
#[test]
fn bad_files() {
    let load = |obj: &str, mtl: &str| {
        let loaded = load_mesh(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]);
        loaded.inspect_err(|e| {
            let has_fix = ["repair", "xport", "?"].iter().any(|fix| e.contains(fix));
            assert!(e.starts_with("a.") && has_fix, "{e}");
        })
    };
    let with_material = format!("mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\n");
    assert_all_refused(BAD_MATERIALS, |mtl| load(&with_material, mtl));
    assert_all_refused(BAD_STATEMENTS, |text| load(&format!("{QUAD}{text}\n"), ""));
    // Each part and each material would have a copy of it.
    let long = "n".repeat(201);
    let words = "has a name of more than 200 bytes";
    assert_refused(load(&with_material, &format!("newmtl {long}")), words);
    for statement in ["o", "g", "usemtl"] {
        let obj = format!("{QUAD}{statement} {long}\nf 1 2 3\n");
        assert_refused(load(&obj, ""), words);
    }
    let utf16 = [b'v', 0, b'\n', 0, 0xff, 0xfe];
    assert_refused(load_mesh(&[("a.obj", &utf16)]), "a.obj:2: is not UTF-8");
}

/// Vertices that a UV seam splits keep one normal: the surface is smooth there.
#[test]
fn seams_do_not_split_normals() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 4/2 2/2\n";
    let (m, ..) = load(obj, "");
    let vertices = m.positions.iter().zip(&m.normals);
    let at_origin = vertices.filter(|(p, _)| **p == Vec3::ZERO);
    let normals: Vec<&Vec3> = at_origin.map(|(_, n)| n).collect();
    assert!(normals.len() == 2 && normals[0] == normals[1]);
}

/// Textures of all kinds, options, opacity in a file of its own, heights as normals, vertex colours, Latin-1; what is not drawn is reported.
#[test]
fn images_of_materials() {
    let color = image(&[[200, 0, 0, 9], [0, 100, 0, 9]]);
    let leaf = image(&[[0, 0, 0, 255], [255, 255, 255, 255]]);
    let mtl = b"newmtl m\nKd 1 1 1\nmap_Kd -clamp on a b.png\nmap_d leaf.png\nmap_Bump -bm 2 -s 2 2 leaf.png\nmap_Pr leaf.png\nmap_Ke a b.png\nmap_Ks gone.png\n# caf\xe9\n";
    let obj = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 1 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n";
    let files: [(&str, &[u8]); 4] = [
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl),
        ("a b.png", &color),
        ("leaf.png", &leaf),
    ];
    let (mesh, warnings, used) = load_mesh(&files).unwrap();
    let m = &mesh.parts[0].material;
    // Opacity comes of map_d alone, whatever the colour's file holds.
    let color = m.maps.color.as_ref().expect("a map");
    assert_eq!(color.texels, [[200, 0, 0, 0], [0, 100, 0, 255]]);
    assert!(m.blend && m.maps.wrap == [Wrap::Clamp; 2]);
    assert_eq!(m.maps.normal.as_ref().map(|n| n.size), Some([2, 1]));
    let values = m.maps.metallic_roughness.as_ref().expect("a map");
    assert_eq!((values.texels[1], m.roughness), ([255, 255, 255, 255], 1.0));
    assert_eq!(m.emission, [1.0; 3]);
    // v runs down.
    assert_eq!(mesh.uvs[0][2], Vec2::new(1.0, 0.0));
    let [red, green] = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]];
    assert_eq!(mesh.colors, [red, green, [1.0; 4]]);
    assert_eq!((warnings.len(), used), (2, 4), "{warnings:?}");
    let words = "option -s of map_Bump & map_Ks & Latin-1";
    assert_says(&warnings.join("\n"), words);
}

#[test]
fn what_one_statement_says_and_another_does_not_is_reported() {
    let red = image(&[[200, 0, 0, 9]; 2]);
    let mtl =
        b"newmtl m\nd 0.5\nTr 0.9\nnewmtl n\nd 0.33\nTr 0.66\nmap_Kd a.png\nnewmtl m\nKd 0 0 1\n";
    let obj = format!("mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\n");
    let files: [(&str, &[u8]); 3] = [("a.obj", obj.as_bytes()), ("a.mtl", mtl), ("a.png", &red)];
    let (mesh, warnings, _) = load_mesh(&files).unwrap();
    assert_eq!(mesh.parts[0].material.color, [0.0, 0.0, 1.0]);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    let words = "a.mtl: d is drawn and not Tr, which disagrees: m & texture a.png: its opacity is not drawn & \
        a.obj: materials of one name: m; the last is drawn";
    assert_says(&warnings.join("\n"), words);
}

/// Strengths of one height field are a texture and a scale each.
#[test]
fn strengths_share_their_normals() {
    let heights = image(&[[0, 0, 0, 255], [255, 255, 255, 255]]);
    let obj =
        format!("mtllib a.mtl\n{QUAD}vt 0 0\nusemtl m\nf 1/1 2/1 3/1\nusemtl n\nf 1/1 3/1 4/1\n");
    let mtl = b"newmtl m\nmap_Bump -bm 3 a.png\nnewmtl n\nmap_Bump -bm -5 a.png\n";
    let files: [(&str, &[u8]); 3] = [
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl),
        ("a.png", &heights),
    ];
    let (mesh, ..) = load_mesh(&files).unwrap();
    let [m, n] = [0, 1].map(|k| &mesh.parts[k].material.maps);
    let normals = |maps: &Maps| maps.normal.clone().expect("a map");
    assert!(Arc::ptr_eq(&normals(m), &normals(n)));
    assert_eq!((m.normal_scale, n.normal_scale), (0.75, -1.25));
}

/// A library that is missing is a warning; one that a file names a thousand times is read once.
#[test]
fn libraries_are_read_once() {
    let obj = format!("mtllib gone.mtl\n{QUAD}usemtl glass\nf 1 2 3 4\n");
    let (mesh, warnings, _) = load(&obj, "");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("gone.mtl"), "{warnings:?}");
    assert_eq!(mesh.parts[0].material.color, [0.8; 3]);
    let obj = format!("{}{QUAD}usemtl m\nf 1 2 3\n", "mtllib a.mtl\n".repeat(1000));
    let (mesh, _, used) = load(&obj, "newmtl m\nKd 0.25 0.5 1\n");
    assert_eq!((used, mesh.parts[0].material.color), (2, [0.25, 0.5, 1.0]));
}

#[test]
fn bad_normals_are_computed_and_flat_triangles_left_out() {
    let obj = format!("{QUAD}vn 0 0 0\nvn 0 0 -0\nvn 0 0 -2\nf 1//1 2//2 3//3\nf 1//1 1//1 2//2\n");
    let (mesh, warnings, _) = load(&obj, "");
    assert_eq!(mesh.triangles.len(), 1);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    for n in &mesh.normals {
        assert!((n.length() - 1.0).abs() < 1e-6);
    }
}

/// One number is grey, a halo's factor is an opacity, an exponent of 0 is no highlight, colours end at 1; marks are no statements.
#[test]
fn materials_as_old_exporters_write_them() {
    let mtl = "\u{feff}newmtl m\nKd 0.5\nKs 0.8\nNs 0\nd -halo 0.25\nnewmtl n\nKd 2 1 0\nd -halo 1\nKs 0.8 0.8 0.8\nNs 9\nPr 0.3\nPm 0.8\nKe 2 0 1\nnewmtl o\nPm 7\nnewmtl p\nKe -1\n";
    let obj = format!("\u{feff}mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\n");
    let (mesh, warnings, _) = load(&obj, mtl);
    let [m, n] = [0, 1].map(|i| &mesh.parts[i].material);
    assert_eq!((m.color, m.specular, m.alpha), ([0.5; 3], 0.0, 0.25));
    assert_eq!((n.color, n.shininess, n.alpha), ([1.0, 1.0, 0.0], 9.0, 1.0));
    assert!((n.specular - 0.8).abs() < 1e-6);
    let values = (n.roughness, n.metallic, n.emission);
    assert_eq!(values, (0.3, 0.8, [2.0, 0.0, 1.0]));
    // Unlit scenes stay unlit.
    assert_eq!(n.lighting, Lighting::Unlit);
    let warnings = warnings.join("\n");
    assert_eq!(warnings.matches("-halo").count(), 1, "{warnings}");
    assert_says(&warnings, "nearest in it: n, o, p");
    // The same where the text is not UTF-8: the first line is a vertex still.
    let latin = [b"\xef\xbb\xbf", QUAD.as_bytes(), b"# caf\xe9\nf 1 2 3\n"].concat();
    let (mesh, ..) = load_mesh(&[("a.obj", &latin)]).unwrap();
    assert_eq!(mesh.positions[0], Vec3::ZERO);
}
