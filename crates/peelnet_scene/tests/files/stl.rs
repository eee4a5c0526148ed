//! STL files as CAD programs write them, and as they should not.

use crate::{CAMERA, Loaded, assert_all_refused, assert_refused, load_files, load_mesh};
use glam::Vec3;

fn load(bytes: &[u8]) -> Result<Loaded, String> {
    load_mesh(&[("a.stl", bytes)])
}

/// The twelve triangles of a unit cube.
pub fn cube() -> Vec<[Vec3; 3]> {
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let vertex = |i: i32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    let halves = quads.map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    halves.iter().flatten().map(|t| t.map(vertex)).collect()
}

fn binary(triangles: &[[Vec3; 3]], header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for t in triangles {
        let vertices = t.iter().flat_map(|v| v.to_array());
        let all = [0.0; 3].into_iter().chain(vertices);
        bytes.extend(all.flat_map(f32::to_le_bytes));
        bytes.extend([7, 0]);
    }
    bytes
}

pub fn text(triangles: &[[Vec3; 3]]) -> String {
    let vertex = |v: Vec3| format!("vertex {} {} {}\n", v.x, v.y, v.z);
    let facets = triangles.iter().map(|t| {
        let vertices = t.map(vertex).concat();
        format!("facet normal 0 0 0\n outer loop\n{vertices} endloop\nendfacet\n")
    });
    let facets: String = facets.collect();
    format!("solid a cube\n{facets}endsolid a cube\n")
}

/// A cube keeps its edges: three normals at each of its eight positions.
#[test]
fn binary_and_text() {
    let plain = text(&cube());
    for bytes in [
        binary(&cube(), b""),
        // Many programs begin a binary file as if it were text.
        binary(&cube(), b"solid made by a program"),
        plain.clone().into_bytes(),
        plain.to_uppercase().into_bytes(),
        plain.replace('\n', " \r\n\r\n").into_bytes(),
        plain.replace("\n outer", " outer").into_bytes(),
        plain.replace("a cube", "").into_bytes(),
        [&plain.as_bytes()[..8], b"\xe9", &plain.as_bytes()[8..]].concat(),
        // Two solids.
        plain
            .replacen("endfacet\n", "endfacet\nendsolid\nsolid b\n", 1)
            .into_bytes(),
    ] {
        let (m, warnings, _) = load(&bytes).unwrap();
        assert_eq!((m.triangles.len(), m.positions.len()), (12, 24));
        for (i, t) in m.triangles.iter().enumerate() {
            assert_eq!(t.map(|v| m.positions[v as usize]), cube()[i]);
            let [a, b, c] = cube()[i];
            let flat = (b - a).cross(c - a).normalize();
            assert!(t.iter().all(|&v| m.normals[v as usize] == flat));
        }
        assert!(m.parts[0].material.is_opaque() && m.colors.is_empty());
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

/// A round surface has one vertex at each position, with a normal along its radius.
#[test]
fn round_surfaces_are_smooth() {
    let text = format!("{CAMERA}[[object]]\nmesh = {{ shape = 'sphere' }}\n");
    let scene = load_files(&[("s.toml", text.as_bytes())]).unwrap();
    let sphere = &scene.objects[0].mesh;
    let at = |i: u32| sphere.positions[i as usize];
    let soup: Vec<_> = sphere.triangles.iter().map(|t| t.map(at)).collect();
    let (m, ..) = load(&binary(&soup, b"")).unwrap();
    let bits = |p: &Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let distinct: std::collections::HashSet<_> = m.positions.iter().map(bits).collect();
    assert_eq!(m.positions.len(), distinct.len());
    for (p, n) in m.positions.iter().zip(&m.normals) {
        assert!(p.normalize().dot(*n) > 0.99, "{p} {n}");
    }
}

/// What of the cube is replaced by what, where ` ; ` ends a line, and words of the error.
const BAD: &str = "
0 0 0 ; vertex => 0 x 0 ; vertex => a.stl:4 & not finite
vertex 0 0 0 => vertex 0 nan 0 => a.stl:4 & not finite
vertex 0 0 0 => vertex 0 1e16 0 => a.stl:4 & farther
vertex 0 0 0 => vertex 0 0 => a.stl:4 & 'vertex 0 0'
 endloop =>  vertex 0 0 0 ;  endloop => a.stl:8 & 4 vertices
 endloop =>  outer => a.stl:8 & 'endfacet' inside of a facet
facet normal => face normal => a.stl:2 & 'face
";

#[test]
fn bad_files() {
    let good = text(&cube());
    assert_eq!(good.lines().nth(3), Some("vertex 0 0 0"));
    assert_all_refused(BAD, |change| {
        let (old, new) = change.split_once(" => ").unwrap();
        load(good.replacen(old, new, 1).as_bytes())
    });
    for (text, words) in [
        ("", "a.stl & 0 bytes & 84 & cut off"),
        ("solid a\nendsolid a\n", "a.stl & no facets"),
        (&good[..good.len() - 60], "a.stl & cut off"),
    ] {
        assert_refused(load(text.as_bytes()), words);
    }
}

/// Counts that the file cannot hold, numbers that are none, and files cut off anywhere.
#[test]
fn bad_binary_files() {
    let good = binary(&cube(), b"");
    for length in 0..good.len() {
        assert_refused(load(&good[..length]), "a.stl & cut off");
    }
    let mut many = good.clone();
    many[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_refused(load(&many), "a.stl & 4,294,967,295 triangles");
    let mut nan = good.clone();
    nan[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_refused(load(&nan), "a.stl & triangle 1 & not finite");
    let mut more = good;
    more.extend([0; 7]);
    let (_, warnings, _) = load(&more).unwrap();
    assert!(warnings[0].contains("7 bytes"), "{warnings:?}");
    assert_refused(load(&binary(&[], b"")), "a.stl & no facets");
}
