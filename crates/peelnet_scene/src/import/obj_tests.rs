//! OBJ and MTL files as exporters write them, and as they should not.

use super::*;

fn load_counted(files: &[(&str, &[u8])]) -> (Result<Imported, SceneError>, usize) {
    crate::import::load_from_memory(files, Lighting::Unlit)
}

fn load(files: &[(&str, &[u8])]) -> Result<Imported, SceneError> {
    load_counted(files).0
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_negative_indices_groups_and_materials() {
    let obj = format!(
        "mtllib a.mtl\n{QUAD}g left\nusemtl glass\nf 1 2 3 4\ng right\nusemtl fog\nf -4 -3 -2\n"
    );
    let mtl = b"newmtl glass\nKd 0.25 0.5 1\nd 0.3\nnewmtl fog\nKd 1 1 1\nTr 0.9\n";
    let loaded = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).expect("loads");
    let m = &loaded.mesh;
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(m.triangles.len(), 3);
    assert_eq!(m.parts.len(), 2);
    assert_eq!(
        (m.parts[0].name.as_str(), m.parts[0].material.alpha),
        ("left", 0.3)
    );
    assert_eq!(m.parts[0].material.color, [0.25, 0.5, 1.0]);
    assert!((m.parts[1].material.alpha - 0.1).abs() < 1e-6);
    assert!(m.normals.iter().all(|n| *n == Vec3::Z));
}

/// An L-shaped face (concave), comments behind data, a continued line, and a texture that is not there.
#[test]
fn what_exporters_write() {
    let obj = "mtllib\ta.mtl # library\nv 0 0 0 # origin\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nusemtl\tbrass\nf 1 2 3 \\\n4 5 6\n";
    let mtl = b"newmtl brass\nKd 1 0 0 # red\nmap_Kd brass.png\n";
    let loaded = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).expect("loads");
    let m = &loaded.mesh;
    let area: f32 = m
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| m.positions[i as usize]);
            (b - a).cross(c - a).z / 2.0
        })
        .sum();
    assert_eq!((m.triangles.len(), area), (4, 3.0));
    assert_eq!(m.parts[0].material.color, [1.0, 0.0, 0.0]);
    assert_eq!(loaded.warnings.len(), 1);
    assert!(
        loaded.warnings[0].contains("brass.png"),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn bad_materials_are_named() {
    let obj = format!("mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\n");
    for (mtl, expected) in [
        (
            "newmtl m\nKd 1 0\n",
            "a.mtl:2: 'Kd 1 0' needs 1 or 3 numbers",
        ),
        ("newmtl m\nd x\n", "a.mtl:2: 'd x' cannot be read"),
        (
            "newmtl m\nd nan\n",
            "a.mtl: material 'm': a number is not finite",
        ),
        (
            "newmtl m\n\nTr 1.5\n",
            "a.mtl: material 'm': d and Tr must lie in 0 … 1",
        ),
        (
            "newmtl m\nTr x\n",
            "a.mtl: material 'm': Tr is not a number",
        ),
    ] {
        let e = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]).expect_err(mtl);
        assert!(e.to_string().contains(expected), "{e}");
    }
}

/// Vertices that a UV seam splits keep one normal: the surface is smooth there.
#[test]
fn physically_based_values_and_emission() {
    let mtl = b"newmtl m\nKd 1 0 0\nPr 0.3\nPm 0.8\nKe 2 0 1\n";
    let obj = format!("mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\n");
    let loaded = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]).expect("loads");
    let m = &loaded.mesh.parts[0].material;
    assert_eq!(
        (m.roughness, m.metallic, m.emission),
        (0.3, 0.8, [2.0, 0.0, 1.0])
    );
    // Unlit scenes stay unlit; these tests load so, or with Phong.
    assert_ne!(m.lighting, Lighting::Phong);
}

#[test]
fn seams_do_not_split_normals() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 4/2 2/2\n";
    let loaded = load(&[("a.obj", obj.as_bytes())]).expect("loads");
    let m = &loaded.mesh;
    let at_origin: Vec<Vec3> = (0..m.positions.len())
        .filter(|&i| m.positions[i] == Vec3::ZERO)
        .map(|i| m.normals[i])
        .collect();
    assert_eq!(at_origin.len(), 2);
    assert_eq!(at_origin[0], at_origin[1]);
}

/// Textures of all kinds, options, opacity in a file of its own, heights as normals, vertex colours, Latin-1; what is not drawn is reported.
#[test]
fn images_of_materials() {
    let picture = |texels: [[u8; 4]; 2]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::RgbaImage::from_raw(2, 1, texels.concat()).expect("two texels");
        let done = image.write_to(&mut bytes, image::ImageFormat::Png);
        done.map(|()| bytes.into_inner()).expect("encodes")
    };
    let color = picture([[200, 0, 0, 9], [0, 100, 0, 9]]);
    let leaf = picture([[0, 0, 0, 255], [255, 255, 255, 255]]);
    let mtl = b"newmtl m\nKd 1 1 1\nmap_Kd -clamp on a b.png\nmap_d leaf.png\nmap_Bump -bm 2 -s 2 2 leaf.png\nmap_Pr leaf.png\nmap_Ke a b.png\nmap_Ks gone.png\n# caf\xe9\n";
    let obj = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 1 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n";
    let files: [(&str, &[u8]); 4] = [
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl),
        ("a b.png", &color),
        ("leaf.png", &leaf),
    ];
    let (loaded, used) = load_counted(&files);
    let loaded = loaded.expect("loads");
    let mesh = &loaded.mesh;
    let m = &mesh.parts[0].material;
    // Opacity comes of map_d alone, whatever the colour's file holds.
    let color = m.maps.color.as_ref().expect("a map");
    assert_eq!(color.texels, [[200, 0, 0, 0], [0, 100, 0, 255]]);
    assert!(m.blend && m.maps.wrap == [crate::Wrap::Clamp; 2]);
    assert_eq!(m.maps.normal.as_ref().map(|n| n.size), Some([2, 1]));
    let values = m.maps.metallic_roughness.as_ref().expect("a map");
    assert_eq!((values.texels[1], m.roughness), ([255, 255, 255, 255], 1.0));
    assert_eq!(m.emission, [1.0; 3]);
    // v runs down.
    assert_eq!(mesh.uvs[0][2], Vec2::new(1.0, 0.0));
    assert_eq!(
        mesh.colors[..3],
        [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [1.0; 4]]
    );
    let warnings = loaded.warnings.join("\n");
    for word in ["option -s of map_Bump", "map_Ks", "Latin-1"] {
        assert!(warnings.contains(word), "{word}: {warnings}");
    }
    assert_eq!((loaded.warnings.len(), used), (2, 4), "{warnings}");
}

#[test]
fn a_missing_mtl_is_survived() {
    let obj = format!("mtllib gone.mtl\n{QUAD}usemtl glass\nf 1 2 3 4\n");
    let loaded = load(&[("a.obj", obj.as_bytes())]).expect("loads");
    assert_eq!(loaded.warnings.len(), 1);
    assert!(
        loaded.warnings[0].contains("gone.mtl"),
        "{:?}",
        loaded.warnings
    );
    assert_eq!(loaded.mesh.parts[0].material.color, [0.8; 3]);
}

/// A library that a file names a thousand times is read once, and its materials are there once.
#[test]
fn a_library_is_read_once() {
    let obj = format!("{}{QUAD}usemtl m\nf 1 2 3\n", "mtllib a.mtl\n".repeat(1000));
    let mtl = b"newmtl m\nKd 0.25 0.5 1\n";
    let (loaded, used) = load_counted(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl)]);
    let part = &loaded.expect("loads").mesh.parts[0];
    assert_eq!((used, part.material.color), (2, [0.25, 0.5, 1.0]));
}

#[test]
fn bad_normals_are_computed_and_flat_triangles_left_out() {
    let obj = format!("{QUAD}vn 0 0 0\nvn 0 0 -0\nvn 0 0 -2\nf 1//1 2//2 3//3\nf 1//1 1//1 2//2\n");
    let loaded = load(&[("a.obj", obj.as_bytes())]).expect("loads");
    assert_eq!(loaded.mesh.triangles.len(), 1);
    assert_eq!(loaded.warnings.len(), 2, "{:?}", loaded.warnings);
    for n in &loaded.mesh.normals {
        assert!((n.length() - 1.0).abs() < 1e-6);
    }
}

/// Each bad file gives one error that names the file, the line where that is known, and a fix.
#[test]
fn bad_files() {
    let quad = |rest: &str| format!("{QUAD}{rest}").into_bytes();
    let cases: [(Vec<u8>, &str); 12] = [
        (
            b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
            "a.obj:2: 'v nan 0 0'",
        ),
        (
            quad("vn 0 nan 0\nf 1//1 2//1 3//1\n"),
            "a.obj:5: 'vn 0 nan 0'",
        ),
        (
            b"v 0 0 0\nv 1 0 0 1e-42\nv 0 1 0\nf 1 2 3\n".to_vec(),
            "not finite",
        ),
        (b"v 0 zero 0\nf 1 1 1\n".to_vec(), "a.obj:1: 'v 0 zero 0'"),
        (
            b"v 0 0\nf 1 1 1\n".to_vec(),
            "a.obj:1: a vertex of 2 numbers",
        ),
        (
            b"v 0 0 0 1 0 0\nv 0 0 0\n".to_vec(),
            "a.obj:2: a vertex with a colour",
        ),
        (quad("f 1 2 5\n"), "a.obj:5"),
        (quad("f 0 1 2\n"), "a.obj:5"),
        (quad("f -1 -2 -5\n"), "a.obj:5"),
        // An index whose triple overflows 64 bits.
        (
            quad("f 1//1 1//1 1//6148914691236517206\n"),
            "a.obj:5: an index is too large",
        ),
        (Vec::new(), "a.obj: holds no faces"),
        (quad("f 1 2"), "a.obj:5: a face has fewer than 3 vertices"),
    ];
    for (bytes, expected) in cases {
        let e = load(&[("a.obj", &bytes)]).expect_err(expected).to_string();
        assert!(
            e.starts_with("a.obj") && e.contains(expected),
            "{expected}: {e}"
        );
        assert!(e.contains("repair") || e.contains('?'), "no fix: {e}");
    }
    let utf16 = [b'v', 0, b'\n', 0, 0xff, 0xfe];
    let e = load(&[("a.obj", &utf16)]).expect_err("UTF-16").to_string();
    assert!(e.contains("a.obj:2: is not UTF-8"), "{e}");
}

/// One number is grey, a halo's factor is an opacity, an exponent of 0 is no highlight, colours end at 1; marks are no statements.
#[test]
fn materials_as_old_exporters_write_them() {
    let mtl = "\u{feff}newmtl m\nKd 0.5\nKs 0.8\nNs 0\nd -halo 0.25\nnewmtl n\nKd 2 1 0\nd -halo 1\nKs 0.8 0.8 0.8\nNs 9\n";
    let obj = format!("\u{feff}mtllib a.mtl\n{QUAD}usemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\n");
    let files: [(&str, &[u8]); 2] = [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())];
    let loaded = load(&files).expect("loads");
    let [m, n] = [0, 1].map(|i| &loaded.mesh.parts[i].material);
    assert_eq!((m.color, m.specular, m.alpha), ([0.5; 3], 0.0, 0.25));
    assert_eq!((n.color, n.shininess, n.alpha), ([1.0, 1.0, 0.0], 9.0, 1.0));
    assert!((n.specular - 0.8).abs() < 1e-6);
    let warnings = loaded.warnings.join("\n");
    assert_eq!(warnings.matches("-halo").count(), 1, "{warnings}");
    assert!(
        warnings.contains("above 1 are taken as 1: 'n'"),
        "{warnings}"
    );
    // The same where the text is not UTF-8: the first line is a vertex still.
    let latin = [b"\xef\xbb\xbf", QUAD.as_bytes(), b"# caf\xe9\nf 1 2 3\n"].concat();
    let loaded = load(&[("a.obj", &latin)]).expect("loads");
    assert_eq!(loaded.mesh.positions[0], Vec3::ZERO);
}

/// Twenty thousand materials with one problem are one warning, and names cannot act on a terminal.
#[test]
fn warnings_are_grouped_and_printable() {
    let faces: Vec<String> = (0..20_000)
        .map(|i| format!("usemtl no\u{1b}[2J{i}\nf 1 2 3\n"))
        .collect();
    let mtl: Vec<String> = (0..20_000)
        .map(|i| format!("newmtl m{i}\nmap_Kd gone{i}.png\n"))
        .collect();
    let obj = format!("mtllib a.mtl\n{QUAD}{}", faces.concat());
    let mtl = mtl.concat();
    let files: [(&str, &[u8]); 2] = [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())];
    let loaded = load(&files).expect("loads");
    assert_eq!(
        loaded.warnings.len(),
        2,
        "{:?}",
        &loaded.warnings[..3.min(loaded.warnings.len())]
    );
    for warning in &loaded.warnings {
        assert!(warning.contains("and 19997 more"), "{warning}");
        assert!(!warning.contains(char::is_control), "{warning:?}");
    }
}
