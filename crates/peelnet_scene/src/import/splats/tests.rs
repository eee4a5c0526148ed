//! The same splats in every format, and files as they should not be.

use super::*;
use crate::{import::loader, scene::Scene, splats::FAINTEST};
use base64::Engine as _;
use flate2::{Compression, write::GzEncoder};
use peelnet_core::random::Random;
use serde_json::{Value, json};
use std::io::Write as _;

fn load(name: &str, bytes: &[u8]) -> Result<(Mesh, Vec<String>), String> {
    let read = |_: &Path, _: u64| Ok(bytes.to_vec());
    let mut files = Files::new(&read);
    let path = Path::new(name);
    let loaded = loader(path).expect("a mesh file")(path, &mut files);
    let loaded = loaded.map_err(|e| e.to_string())?;
    assert_eq!(
        loaded.is_y_down,
        !name.contains(".spz") && !name.contains(".gltf")
    );
    Ok((loaded.mesh, files.warnings.texts()))
}

/// A splat, and sixteen harmonics.
type Known = (Splat, Vec<[f32; 3]>);

fn some_splats(count: usize) -> Vec<Known> {
    let mut random = Random::new(1, &[]);
    let mut three = |low, high| [(); 3].map(|()| random.between(low, high));
    let splats = (0..count).map(|_| {
        let [x, y, z] = three(-1.0, 1.0);
        let [w, opacity, _] = three(0.1, 0.9);
        let splat = Splat {
            center: three(-2.0, 2.0).into(),
            scale: Vec3::from(three(-4.0, -1.0)).exp(),
            rotation: Vec4::new(x, y, z, w).normalize(),
            opacity,
        };
        let harmonics = (0..16).map(|k| match k {
            0 => three(0.0, 1.0).map(coefficient),
            _ => three(-0.9, 0.9),
        });
        (splat, harmonics.collect())
    });
    splats.collect()
}

/// Files are read as their numbers of bits allow: in parts of the range of positions and coefficients, and of scales.
fn assert_same(mesh: &Mesh, known: &[Known], degree: u8, tolerance: f32, format: &str) {
    let splats = mesh.splats.as_ref().expect("splats");
    assert_eq!(splats.degree, degree, "{format}");
    assert_eq!(mesh.positions.len(), known.len(), "{format}");
    assert_eq!(mesh.parts[0].triangles, 0..known.len(), "{format}");
    assert!(mesh.parts[0].material == crate::Material::unlit([1.0; 3], 1.0));
    let each = harmonics_of(degree);
    for (i, (splat, harmonics)) in known.iter().enumerate() {
        assert_eq!(mesh.triangles[i], [i as u32; 3]);
        assert_eq!(mesh.normals[i], Vec3::Z);
        let near = |got: Vec3, want: Vec3, what: &str| {
            let error = (got - want).abs().max_element();
            assert!(error <= tolerance, "{format}: {what} {got}, not {want}");
        };
        near(mesh.positions[i], splat.center, "center");
        near(splats.scales[i] / splat.scale, Vec3::ONE, "scale");
        near(
            Vec3::splat(splats.opacities[i]),
            Vec3::splat(splat.opacity),
            "opacity",
        );
        let turn = Vec4::from(splats.rotations[i]).dot(splat.rotation).abs();
        near(Vec3::splat(turn), Vec3::ONE, "rotation");
        let own = &splats.harmonics[i * each..(i + 1) * each];
        for (got, want) in own.iter().zip(harmonics) {
            near(Vec3::from(*got), Vec3::from(*want), "harmonic");
        }
    }
}

/// Numbers of a PLY file of some format, and of its properties' type.
fn numbers(values: impl IntoIterator<Item = f64>, format: &str, property: &str) -> Vec<u8> {
    let of = |x: f64| match (format, property) {
        ("ascii", _) => format!("{x} ").into_bytes(),
        (_, "uchar") => vec![x as u8],
        (_, "uint") => (x as u32).to_le_bytes().to_vec(),
        ("binary_little_endian", "float") => (x as f32).to_le_bytes().to_vec(),
        (_, "float") => (x as f32).to_be_bytes().to_vec(),
        ("binary_little_endian", _) => x.to_le_bytes().to_vec(),
        _ => x.to_be_bytes().to_vec(),
    };
    let mut bytes: Vec<u8> = values.into_iter().flat_map(of).collect();
    if format == "ascii" {
        bytes.push(b'\n');
    }
    bytes
}

fn names(all: &[&str]) -> Vec<String> {
    all.iter().map(|n| (*n).to_owned()).collect()
}

/// `f_rest_0` …, and the harmonics in their order: all of red, then green, then blue.
fn rest(degree: u8, harmonics: &[[f32; 3]]) -> (Vec<String>, Vec<f32>) {
    let own = &harmonics[1..harmonics_of(degree)];
    let names = (0..3 * own.len()).map(|i| format!("f_rest_{i}"));
    let values = (0..3).flat_map(|c| own.iter().map(move |h| h[c]));
    (names.collect(), values.collect())
}

fn element(name: &str, count: usize, properties: &[String], property: &str) -> String {
    let properties = properties
        .iter()
        .map(|p| format!("property {property} {p}\n"));
    format!("element {name} {count}\n{}", properties.collect::<String>())
}

/// The properties are not in the order of the INRIA files.
fn plain(known: &[Known], degree: u8, format: &str, property: &str) -> Vec<u8> {
    let properties = names(&[
        "nx", "rot_0", "rot_1", "rot_2", "rot_3", "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2",
        "opacity", "scale_0", "scale_1", "scale_2",
    ]);
    let properties = [properties, rest(degree, &known[0].1).0].concat();
    let element = element("vertex", known.len(), &properties, property);
    let mut bytes = format!("ply\nformat {format} 1.0\n{element}end_header\n").into_bytes();
    for (splat, harmonics) in known {
        // Of any length.
        let [x, y, z, w] = (splat.rotation * 3.0).to_array();
        let logit = -(1.0 / splat.opacity - 1.0).ln();
        let mut row = vec![0.0, w, x, y, z];
        row.extend(splat.center.to_array());
        row.extend(harmonics[0]);
        row.push(logit);
        row.extend(splat.scale.to_array().map(f32::ln));
        row.extend(rest(degree, harmonics).1);
        bytes.extend(numbers(row.into_iter().map(f64::from), format, property));
    }
    bytes
}

/// Three numbers in 32 bits, or four.
fn packed<const N: usize>(values: [f32; N], bits: [u32; N], [low, high]: [f32; 2]) -> f64 {
    let word = values.into_iter().zip(bits).fold(0u32, |word, (x, bits)| {
        let most = (1u32 << bits) - 1;
        let part = (x - low) / (high - low) * most as f32;
        (word << bits) | part.round().clamp(0.0, most as f32) as u32
    });
    word.into()
}

/// Without ranges of colours, as older files.
fn compressed(known: &[Known], degree: u8, has_colors: bool) -> Vec<u8> {
    let ends = |names: [&str; 3]| ["min", "max"].map(|end| names.map(|n| format!("{end}_{n}")));
    let mut chunk = [
        ends(["x", "y", "z"]),
        ends(["scale_x", "scale_y", "scale_z"]),
    ]
    .concat();
    let mut ranges = vec![-2.0, 2.0, -4.0, -1.0];
    if has_colors {
        chunk.extend(ends(["r", "g", "b"]));
        ranges.extend([-0.5, 1.5]);
    }
    let chunks = known.len().div_ceil(256);
    let vertex = names(&["position", "rotation", "scale", "color"]);
    let vertex: Vec<String> = vertex.iter().map(|n| format!("packed_{n}")).collect();
    let mut header = "ply\nformat binary_little_endian 1.0\n".to_owned();
    header += &element("chunk", chunks, &chunk.concat(), "float");
    header += &element("vertex", known.len(), &vertex, "uint");
    if degree > 0 {
        header += &element("sh", known.len(), &rest(degree, &known[0].1).0, "uchar");
    }
    let mut bytes = (header + "end_header\n").into_bytes();
    let little = "binary_little_endian";
    let row = ranges.iter().flat_map(|x| [*x; 3]);
    let row: Vec<f64> = row.collect();
    (0..chunks).for_each(|_| bytes.extend(numbers(row.clone(), little, "float")));
    for (splat, harmonics) in known {
        let [x, y, z, w] = splat.rotation.to_array();
        let wxyz = [w, x, y, z];
        let largest = (0..4).max_by(|a, b| wxyz[*a].abs().total_cmp(&wxyz[*b].abs()));
        let largest = largest.expect("four");
        let mut others = (0..4).filter(|k| *k != largest);
        let others = [(); 3].map(|()| wxyz[others.next().expect("three")]);
        let others = others.map(|x| x * wxyz[largest].signum());
        let root = std::f32::consts::FRAC_1_SQRT_2;
        let rotation =
            packed(others, [10; 3], [-root, root]) + (largest as f64) * f64::from(1 << 30);
        let color = harmonics[0].map(|c| 0.5 + c * CONSTANT_HARMONIC);
        let [low, high] = if has_colors { [-0.5, 1.5] } else { [0.0, 1.0] };
        let [r, g, b] = color.map(|c| (c - low) / (high - low));
        let words = [
            packed(splat.center.to_array(), [11, 10, 11], [-2.0, 2.0]),
            rotation,
            packed(
                splat.scale.to_array().map(f32::ln),
                [11, 10, 11],
                [-4.0, -1.0],
            ),
            packed([r, g, b, splat.opacity], [8; 4], [0.0, 1.0]),
        ];
        bytes.extend(numbers(words, little, "uint"));
    }
    for (_, harmonics) in known {
        let values = rest(degree, harmonics).1.into_iter();
        let values = values.map(|x| f64::from((x / 8.0 + 0.5) * 255.0).round());
        bytes.extend(numbers(values, little, "uchar"));
    }
    bytes
}

fn antimatter(known: &[Known]) -> Vec<u8> {
    let of = |(splat, harmonics): &Known| {
        let [x, y, z, w] = splat.rotation.to_array();
        let color = harmonics[0].map(|c| (0.5 + c * CONSTANT_HARMONIC) * 255.0);
        let [r, g, b] = color.map(|c| c.round() as u8);
        let turn = [w, x, y, z].map(|x| (x * 127.0 + 128.0).round() as u8);
        let places = [splat.center.to_array(), splat.scale.to_array()].concat();
        let places: Vec<u8> = places.iter().flat_map(|x| x.to_le_bytes()).collect();
        [
            places,
            vec![r, g, b, (splat.opacity * 255.0).round() as u8],
            turn.to_vec(),
        ]
        .concat()
    };
    known.iter().flat_map(of).collect()
}

fn zipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("in memory");
    encoder.finish().expect("in memory")
}

fn spz_header(version: u32, count: u32, degree: u8) -> Vec<u8> {
    let words = [0x5053_474eu32, version, count];
    let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    bytes.extend([degree, 12, 1, 0]);
    bytes
}

fn spz(known: &[Known], version: u32, degree: u8) -> Vec<u8> {
    let byte = |x: f32| x.round().clamp(0.0, 255.0) as u8;
    let mut bytes = spz_header(version, known.len() as u32, degree);
    let splats = || known.iter().map(|(splat, _)| splat);
    bytes.extend(splats().flat_map(|s| s.center.to_array()).flat_map(|x| {
        let [a, b, c, _] = ((x * 4096.0).round() as i32).to_le_bytes();
        [a, b, c]
    }));
    bytes.extend(splats().map(|s| byte(s.opacity * 255.0)));
    let colors = known.iter().flat_map(|(_, h)| h[0]);
    bytes.extend(colors.map(|c| byte((c * 0.15 + 0.5) * 255.0)));
    let scales = splats().flat_map(|s| s.scale.to_array());
    bytes.extend(scales.map(|s| byte((s.ln() + 10.0) * 16.0)));
    for splat in splats() {
        let rotation = splat.rotation.to_array();
        if version == 2 {
            bytes.extend([0, 1, 2].map(|k| byte(rotation[k] * 127.5 + 127.5)));
            continue;
        }
        let largest = (0..4).max_by(|a, b| rotation[*a].abs().total_cmp(&rotation[*b].abs()));
        let largest = largest.expect("four");
        let mut word = largest as u32;
        for k in (0..4).filter(|k| *k != largest) {
            let x = rotation[k] * rotation[largest].signum() * 511.0 * std::f32::consts::SQRT_2;
            word = word << 10 | u32::from(x < 0.0) << 9 | x.abs().round() as u32;
        }
        bytes.extend(word.to_le_bytes());
    }
    let more = known.iter().flat_map(|(_, h)| &h[1..harmonics_of(degree)]);
    bytes.extend(more.flatten().map(|x| byte(x * 128.0 + 128.0)));
    zipped(&bytes)
}

/// A document with a list for each attribute, and its buffer in it.
fn gltf(known: &[Known], degree: u8) -> Value {
    let mut attributes = vec![
        ("POSITION".to_owned(), "VEC3", Vec::new()),
        ("ROTATION".to_owned(), "VEC4", Vec::new()),
        ("SCALE".to_owned(), "VEC3", Vec::new()),
        ("OPACITY".to_owned(), "SCALAR", Vec::new()),
    ];
    let coefficients = (0..=degree).flat_map(|d| (0..=2 * d).map(move |k| [d, k]));
    let named = coefficients.map(|[d, k]| format!("SH_DEGREE_{d}_COEF_{k}"));
    attributes.extend(named.map(|name| (name, "VEC3", Vec::new())));
    for (splat, harmonics) in known {
        attributes[0].2.extend(splat.center.to_array());
        attributes[1].2.extend(splat.rotation.to_array());
        attributes[2].2.extend(splat.scale.to_array());
        attributes[3].2.push(splat.opacity);
        for (list, harmonic) in attributes[4..].iter_mut().zip(harmonics) {
            list.2.extend(harmonic);
        }
    }
    let mut bytes: Vec<u8> = Vec::new();
    let (mut views, mut accessors, mut named) = (Vec::new(), Vec::new(), json!({}));
    for (i, (name, kind, values)) in attributes.into_iter().enumerate() {
        views.push(json!({"buffer": 0, "byteOffset": bytes.len(), "byteLength": 4 * values.len()}));
        accessors.push(json!({
            "bufferView": i, "componentType": 5126, "count": known.len(), "type": kind,
        }));
        bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        let prefix = if i == 0 {
            ""
        } else {
            "KHR_gaussian_splatting:"
        };
        named[format!("{prefix}{name}")] = json!(i);
    }
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_gaussian_splatting"],
        "extensionsRequired": ["KHR_gaussian_splatting"],
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{data}"),
        }],
        "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"name": "cloud", "primitives": [{
            "mode": 0,
            "attributes": named,
            "extensions": {"KHR_gaussian_splatting": {
                "kernel": "ellipse", "colorSpace": "srgb_rec709_display",
            }},
        }]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    })
}

#[test]
fn every_format_holds_the_same_splats() {
    let known = some_splats(300);
    let check = |name: &str, bytes: &[u8], degree, tolerance, format: &str| {
        let (mesh, warnings) = load(name, bytes).expect(format);
        assert_eq!(warnings, [""; 0], "{format}");
        assert_same(&mesh, &known, degree, tolerance, format);
        let is_antialiased = mesh.splats.is_some_and(|s| s.antialiased);
        assert_eq!(is_antialiased, name == "a.spz", "{format}");
    };
    for degree in 0..=3 {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for property in ["float", "double"] {
                let bytes = plain(&known, degree, format, property);
                let what = format!("{format} of {property}, degree {degree}");
                check("a.ply", &bytes, degree, 1e-4, &what);
            }
        }
        for has_colors in [false, true] {
            let bytes = compressed(&known, degree, has_colors);
            let what = format!("compressed, degree {degree}, colours {has_colors}");
            check("a.compressed.ply", &bytes, degree, 0.02, &what);
        }
        for version in [2, 3] {
            let bytes = spz(&known, version, degree);
            let what = format!("spz {version}, degree {degree}");
            check("a.spz", &bytes, degree, 0.033, &what);
        }
        let text = gltf(&known, degree).to_string();
        check("a.gltf", text.as_bytes(), degree, 1e-6, "glTF");
    }
    check("a.splat", &antimatter(&known), 0, 0.02, "splat");
}

/// Values by hand: those at the ends of the bits.
#[test]
fn closed_forms() {
    let turn = |mesh: &Mesh| Vec4::from(mesh.splats.as_ref().expect("splats").rotations[0]);
    // −1 in 24 bits, and a quarter turn about y.
    let mut bytes = spz_header(3, 1, 0);
    bytes.extend([
        255, 255, 255, 0, 0, 128, 0, 16, 0, 51, 255, 0, 128, 160, 160, 176,
    ]);
    bytes.extend((3u32 << 30 | 511 << 10).to_le_bytes());
    let (mesh, _) = load("a.spz", &zipped(&bytes)).expect("fits");
    let center = Vec3::new(-1.0 / 4096.0, -2048.0, 1.0);
    assert_eq!(mesh.positions[0], center);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert!((turn(&mesh) - Vec4::new(0.0, half, 0.0, half)).length() < 1e-6);
    let splats = mesh.splats.expect("splats");
    assert_eq!(splats.opacities, [0.2]);
    assert_eq!(splats.scales, [Vec3::new(1.0, 1.0, 1f32.exp())]);
    assert!((splats.harmonics[0][0] - 0.5 / 0.15).abs() < 1e-6);
    // The reach of an opacity is where it falls below the faintest.
    let reach = splats.reach(0) / 1f32.exp();
    assert!((0.2 * (-0.5 * reach * reach).exp() / FAINTEST - 1.0).abs() < 1e-4);
}

/// It is refused in these words, with `&` between them.
fn assert_refused(name: &str, bytes: &[u8], words: &str) {
    let e = load(name, bytes).map(|_| ()).expect_err(words);
    for word in words.split(" & ") {
        assert!(e.contains(word), "no '{word}' in: {e}");
    }
}

#[test]
fn files_that_are_cut_off() {
    let known = some_splats(3);
    let little = "binary_little_endian";
    let good = [
        ("a.ply", plain(&known, 1, little, "float")),
        ("a.ply", compressed(&known, 1, true)),
        ("a.splat", antimatter(&known)),
        ("a.spz", spz(&known, 3, 1)),
    ];
    for (name, bytes) in &good {
        // Between its splats, a .splat file ends as well as at its end.
        for cut in [1, 5, bytes.len() / 3 + 1, bytes.len() - 9] {
            assert_refused(
                name,
                &bytes[..bytes.len() - cut],
                &format!("{name} & cut off"),
            );
        }
    }
}

#[test]
fn files_as_they_should_not_be() {
    let known = some_splats(3);
    let text = |bytes: Vec<u8>, from: &str, to: &str| {
        let text = String::from_utf8(bytes).expect("text");
        text.replacen(from, to, 1).into_bytes()
    };
    let ascii = || plain(&known, 1, "ascii", "float");
    let no = |mut value: Splat, change: fn(&mut Splat)| {
        change(&mut value);
        antimatter(&[(value, known[0].1.clone())])
    };
    let first = known[0].0;
    for (name, bytes, words) in [
        ("a.splat", Vec::new(), "0 bytes & 32 & empty"),
        ("a.spz", Vec::new(), "empty"),
        ("a.spz", b"no gzip, but words".to_vec(), "unpacked & Export"),
        ("a.spz", zipped(&[7; 99]), "NGSP"),
        ("a.spz", spz_header(4, 1, 0), "version 4 & .ply"),
        ("a.spz", zipped(&spz_header(1, 1, 0)), "version 1"),
        ("a.spz", zipped(&spz_header(3, 1, 4)), "degree 4"),
        ("a.spz", zipped(&spz_header(3, 0, 0)), "no splats"),
        (
            "a.spz",
            zipped(&spz_header(3, 60_000_000, 0)),
            "at most 50000000",
        ),
        ("a.ply", text(ascii(), "rot_3", "rot_4"), "'rot_3' & vertex"),
        (
            "a.ply",
            text(ascii(), "f_rest_8", "f_rest_9"),
            "have 8 of 'f_rest_0'",
        ),
        (
            "a.ply",
            text(ascii(), "float f_rest_8", "list uchar float f_rest_8"),
            "a.ply",
        ),
        (
            "a.ply",
            text(ascii(), "vertex 3", "vertex 99999999"),
            "cut off",
        ),
        (
            "a.splat",
            no(first, |s| s.center.x = f32::NAN),
            "1 splat & not finite",
        ),
        ("a.splat", no(first, |s| s.center.x = 1e16), "out of range"),
        ("a.splat", no(first, |s| s.scale.z = -1.0), "out of range"),
        (
            "a.splat",
            no(first, |s| s.rotation = Vec4::ZERO),
            "out of range",
        ),
    ] {
        assert_refused(name, &bytes, words);
    }
}

#[test]
fn gltf_files_as_they_should_not_be() {
    let known = some_splats(3);
    let gltf = |change: fn(&mut Value)| {
        let mut document = gltf(&known, 1);
        change(&mut document);
        document.to_string().into_bytes()
    };
    for (bytes, words) in [
        (
            gltf(|d| d["accessors"][1]["type"] = json!("VEC3")),
            "accessor 1 & export",
        ),
        (
            gltf(|d| d["accessors"][3]["count"] = json!(2)),
            "OPACITY & 3 values",
        ),
        (
            gltf(|d| {
                let attributes = d["meshes"][0]["primitives"][0]["attributes"].as_object_mut();
                attributes
                    .expect("there")
                    .remove("KHR_gaussian_splatting:SH_DEGREE_1_COEF_2");
            }),
            "no 'KHR_gaussian_splatting:SH_DEGREE_1_COEF_2'",
        ),
        (
            gltf(|d| {
                let extension = &mut d["meshes"][0]["primitives"][0]["extensions"];
                extension["KHR_gaussian_splatting"]["colorSpace"] = json!("lin_rec709_display");
            }),
            "not drawn: splats whose colour space is lin_rec709_display",
        ),
        (
            gltf(|d| {
                let primitive = &mut d["meshes"][0]["primitives"][0];
                primitive["attributes"] = json!({"POSITION": 0});
                let extension = &mut primitive["extensions"]["KHR_gaussian_splatting"];
                extension["extensions"]["KHR_gaussian_splatting_compression_spz_2"] = json!({});
            }),
            "not drawn: splats with the extension KHR_gaussian_splatting_compression_spz_2",
        ),
        (
            gltf(|d| d["nodes"][0]["scale"] = json!([0.0, 0.0, 0.0])),
            "scales it to nothing",
        ),
    ] {
        assert_refused("a.gltf", &bytes, words);
    }
}

/// One warning counts what is left out; what follows the last splat is not unpacked; small opacities stay.
#[test]
fn warnings() {
    let mut known = some_splats(5);
    known[1].0.scale.y = -1.0;
    known[3].0.center.x = f32::INFINITY;
    known[4].0.opacity = 0.0;
    let (mesh, warnings) = load("a.splat", &antimatter(&known)).expect("three");
    assert_eq!(mesh.positions.len(), 3);
    assert_eq!(mesh.splats.expect("splats").opacities[2], 0.0);
    assert_eq!(
        warnings,
        ["a.splat: 2 splats left out: numbers that are not finite or out of range"]
    );
    let mut bytes = spz_header(2, 1, 0);
    bytes.extend([0; 19]);
    bytes.extend(vec![0; 1 << 20]);
    let (mesh, warnings) = load("a.spz", &zipped(&bytes)).expect("one");
    assert_eq!(mesh.positions.len(), 1);
    assert_eq!(warnings, ["a.spz: not read: bytes behind its last splat"]);
}

/// Several primitives are one mesh, in their places, of the highest degree; scales of drafts are logarithms; whole numbers are normalized.
#[test]
fn primitives_of_gltf_files() {
    let known = some_splats(4);
    let mut document = gltf(&known, 2);
    let mut second = document["meshes"][0].clone();
    let attributes = second["primitives"][0]["attributes"].as_object_mut();
    attributes
        .expect("there")
        .retain(|name, _| !name.contains("DEGREE_2"));
    document["meshes"]
        .as_array_mut()
        .expect("there")
        .push(second);
    document["nodes"] = json!([{"mesh": 0}, {"mesh": 1, "translation": [10.0, 0.0, 0.0], "scale": [2.0, 2.0, 2.0]}]);
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    let (mesh, warnings) = load("a.gltf", document.to_string().as_bytes()).expect("fits");
    assert_eq!(warnings, [""; 0]);
    assert_eq!(
        (mesh.parts.len(), mesh.parts[1].triangles.clone()),
        (2, 4..8)
    );
    assert_eq!(mesh.triangles[5], [5; 3]);
    assert_eq!(mesh.positions[5], known[1].0.center * 2.0 + Vec3::X * 10.0);
    let splats = mesh.splats.as_ref().expect("splats");
    assert_eq!(splats.degree, 2);
    assert_eq!(splats.harmonics.len(), 8 * 9);
    assert_eq!(splats.harmonics[5 * 9..5 * 9 + 4], known[1].1[..4]);
    assert_eq!(splats.harmonics[5 * 9 + 4..6 * 9], [[0.0; 3]; 5]);
    assert!(
        (splats.scales[5] / known[1].0.scale - 2.0)
            .abs()
            .max_element()
            < 1e-5
    );
    // Kept in another order, harmonics go with their splats.
    let mut kept = mesh.clone();
    kept.triangles = vec![[5; 3], [2; 3]];
    kept.keep_used();
    let of_kept = kept.splats.as_ref().expect("splats");
    assert_eq!(kept.positions, [mesh.positions[5], mesh.positions[2]]);
    assert_eq!(of_kept.scales, [splats.scales[5], splats.scales[2]]);
    assert_eq!(of_kept.harmonics[9..], splats.harmonics[18..27]);
    // Beside splats, triangles are left out.
    let mut beside = kept.clone();
    beside.splats = None;
    let mut warnings = crate::warnings::Warnings::default();
    kept.append(
        beside.into_part("b", crate::Material::unlit([1.0; 3], 1.0)),
        "f: ",
        &mut warnings,
    );
    assert_eq!(kept.positions.len(), 2);
    let text = "f: triangles beside splats ('b'); give them a file of their own";
    assert_eq!(warnings.texts(), [text]);

    let mut logarithms = known.clone();
    for (splat, _) in &mut logarithms {
        splat.scale = splat.scale.map(f32::ln);
    }
    let text = gltf(&logarithms, 0).to_string();
    let (mesh, warnings) = load("a.gltf", text.as_bytes()).expect("fits");
    assert!(
        warnings.len() == 1 && warnings[0].contains("logarithms"),
        "{warnings:?}"
    );
    assert_same(&mesh, &known, 0, 1e-5, "logarithms");

    let mut document = gltf(&known[..1], 0);
    let bytes = base64::engine::general_purpose::STANDARD.encode([0, 127, 0, 0, 51, 0, 0, 0]);
    document["buffers"]
        .as_array_mut()
        .expect("there")
        .push(json!({
            "byteLength": 8, "uri": format!("data:application/octet-stream;base64,{bytes}"),
        }));
    let views = document["bufferViews"].as_array_mut().expect("there");
    views.extend([0, 4].map(|at| json!({"buffer": 1, "byteOffset": at, "byteLength": 4})));
    document["accessors"][1] = json!({
        "bufferView": 5, "componentType": 5120, "normalized": true, "count": 1, "type": "VEC4",
    });
    document["accessors"][3] = json!({
        "bufferView": 6, "componentType": 5121, "normalized": true, "count": 1, "type": "SCALAR",
    });
    let (mesh, _) = load("a.gltf", document.to_string().as_bytes()).expect("fits");
    let splats = mesh.splats.expect("splats");
    assert_eq!(
        (splats.rotations[0], splats.opacities[0]),
        (Quat::from_xyzw(0.0, 1.0, 0.0, 0.0), 0.2)
    );
}

/// The camera shows the middle of a file, and reaches what floats far away; nothing lights it.
#[test]
fn scenes_of_splats() {
    let mut known = some_splats(200);
    known[7].0.center = Vec3::new(0.0, 0.0, 5000.0);
    for (name, bytes, up) in [
        ("a.splat", antimatter(&known), Vec3::NEG_Y),
        ("a.ply", plain(&known, 0, "ascii", "float"), Vec3::NEG_Y),
        ("a.gltf", gltf(&known, 0).to_string().into_bytes(), Vec3::Y),
    ] {
        let scene = Scene::from_bytes(name, |_| Ok(bytes.clone())).expect(name);
        assert_eq!(scene.warnings, [""; 0], "{name}");
        assert!(scene.lights.is_empty() && scene.background == [0.0; 3]);
        assert_eq!(scene.views.len(), 3);
        for view in &scene.views {
            assert_eq!(view.up, up);
            let distance = (view.position - view.target).length();
            assert!(
                view.target.length() < 0.5 && (6.0..11.0).contains(&distance),
                "{view:?}"
            );
            assert!(view.near < 0.2 && view.far > (known[7].0.center - view.position).length());
        }
    }
    // As an object it fits what it shows.
    let text = "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n\
        [[object]]\nmesh = 'a.splat'\nfit = 2.0\n";
    let bytes = antimatter(&known);
    let scene = Scene::from_bytes("s.toml", |path| {
        let is_scene = path.extension().is_some_and(|e| e == "toml");
        Ok(if is_scene {
            text.as_bytes().to_vec()
        } else {
            bytes.clone()
        })
    });
    let scale = scene.expect("fits").objects[0].world_from_object.x_axis.x;
    assert!((0.4..0.7).contains(&scale), "{scale}");
}
