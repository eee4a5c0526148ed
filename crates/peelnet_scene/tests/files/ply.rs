//! PLY files as scanners' programs write them, and as they should not.

use crate::{Loaded, area, assert_all_refused, assert_refused, assert_says, load_mesh};
use glam::{Vec2, Vec3};
use peelnet_scene::Mesh;

fn load(bytes: &[u8]) -> Result<Loaded, String> {
    load_mesh(&[("a.ply", bytes)])
}

fn load_text(header: &str, body: &str) -> Loaded {
    load(format!("{header}{body}").as_bytes()).unwrap()
}

fn header(format: &str, lines: &str) -> String {
    format!("ply\nformat {format} 1.0\ncomment by hand\n{lines}end_header\n")
}

const SQUARE: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
element face 1\nproperty list uchar int vertex_indices\n";

const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

pub fn square_text() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("{x} {y} {z} 255 188 0 255\n"));
    header("ascii", SQUARE) + &vertices.concat() + "4 0 1 2 3\n"
}

/// The same square in binary: bytes of four numbers in either order.
fn square_binary(is_big: bool) -> Vec<u8> {
    let four = |mut bytes: [u8; 4]| {
        if is_big {
            bytes.reverse();
        }
        bytes
    };
    let format = if is_big { "big" } else { "little" };
    let mut bytes = header(&format!("binary_{format}_endian"), SQUARE).into_bytes();
    for corner in CORNERS {
        bytes.extend(corner.iter().flat_map(|x| four(x.to_le_bytes())));
        bytes.extend([255, 188, 0, 255]);
    }
    bytes.push(4);
    bytes.extend((0i32..4).flat_map(|i| four(i.to_le_bytes())));
    bytes
}

/// The same of all three formats, and of the line ends of other systems.
#[test]
fn text_and_both_orders_of_bytes() {
    let text = square_text();
    for bytes in [
        text.clone().into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        text.replace("4 0 1 2 3\n", "\n4 0 1 2 3").into_bytes(),
        text.replace("1 1 0 255", "1. +1 .0 255").into_bytes(),
        square_binary(false),
        square_binary(true),
    ] {
        let (m, warnings, _) = load(&bytes).unwrap();
        assert_eq!(m.positions, CORNERS.map(Vec3::from));
        assert_eq!(m.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(m.normals.iter().all(|n| *n == Vec3::Z));
        // Bytes are sRGB: 188 is half of the light.
        let [r, g, b, a] = m.colors[3];
        assert_eq!((r, b, a), (1.0, 0.0, 1.0));
        assert!((g - 0.503).abs() < 1e-3, "{g}");
        let material = &m.parts[0].material;
        assert_eq!((material.color, material.is_opaque()), ([1.0; 3], true));
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

/// What the header's counts leave out is warned of.
#[test]
fn what_stands_behind_the_last_element_is_warned_of() {
    let text = square_text() + "3 0 1 2\n\n3 0 2 3\n";
    let binary = [&square_binary(true)[..], &[0]].concat();
    for (bytes, words) in [
        (text.as_bytes(), "not read: 2 lines behind its last element"),
        (&binary, "not read: 1 byte behind its last element"),
    ] {
        let (m, warnings, _) = load(bytes).unwrap();
        assert_eq!(m.triangles.len(), 2);
        assert_says(&warnings.join("\n"), words);
    }
}

/// Floating-point colours are linear; an opacity makes the surface blend, unless it is 0 all over.
#[test]
fn colours_and_opacity_of_vertices() {
    let lines = "element vertex 3\nproperty double x\nproperty double y\nproperty double z\n\
        property float red\nproperty float green\nproperty float blue\nproperty float alpha\n\
        element face 1\nproperty list uchar uint vertex_index\n";
    let with = |alpha: &str| {
        let vertex = |p: &str| format!("{p} 0.5 2 -1 {alpha}\n");
        let vertices: String = ["0 0 0", "1 0 0", "0 1 0"].map(vertex).concat();
        load_text(&header("ascii", lines), &(vertices + "3 0 1 2\n"))
    };
    let (mesh, ..) = with("0.25");
    assert_eq!(mesh.colors, [[0.5, 1.0, 0.0, 0.25]; 3]);
    assert!(!mesh.parts[0].material.is_opaque());
    let (mesh, warnings, _) = with("0");
    assert_eq!(mesh.colors[0][3], 1.0);
    assert!(mesh.parts[0].material.is_opaque());
    assert_says(
        &warnings.join("\n"),
        "opacity of 0 & colours outside of 0 … 1",
    );
}

/// Normals of the file, of which one is zero; texture coordinates of vertices and of faces; a concave polygon; other elements between.
#[test]
fn normals_texture_coordinates_and_polygons() {
    let lines = "comment TextureFile a.png\nelement camera 2\nproperty list uchar float view\n\
        element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
        property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n";
    let body = "2 1 2\n0\n0 0 0 0 0 2 0 0\n2 1 0 0 0 0 0 0\n0 2 0 0 0 1 0.5 1\n1 1 0 0 0 1 0 0\n";
    let with = |face: &str| load_text(&header("ascii", lines), &format!("{body}{face}\n"));
    let (m, warnings, _) = with("4 0 1 2 3 0");
    assert!(m.normals.iter().all(|n| *n == Vec3::Z));
    assert_eq!((m.triangles.len(), area(&m)), (2, 1.0));
    let uv_of = |m: &Mesh, vertex: u32| {
        let mut corners = m.triangles.iter().flatten().zip(m.uvs.iter().flatten());
        corners.find(|(i, _)| **i == vertex).map(|(_, uv)| *uv)
    };
    assert_eq!(uv_of(&m, 2), Some(Vec2::new(0.5, 0.0)));
    assert_says(&warnings.join("\n"), "color_map & 1 normal");
    let (own, ..) = with("4 0 1 2 3 8 0 0 0.25 0 0 0.75 0 0");
    assert_eq!(uv_of(&own, 1), Some(Vec2::new(0.25, 1.0)));
    assert_eq!(uv_of(&own, 2), Some(Vec2::new(0.0, 0.25)));
}

/// Two strips, of which the second begins behind −1: all triangles face the same way.
#[test]
fn triangle_strips() {
    let lines = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\n";
    let body = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n";
    let (m, ..) = load_text(&header("ascii", lines), body);
    assert_eq!((m.triangles.len(), area(&m)), (3, 1.5));
}

/// Opacity without colours is kept; what is not drawn is named; a colour has three channels.
#[test]
fn properties_that_few_files_have() {
    let with = |property: &str| {
        let lines = format!(
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty {property}\n\
             element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n"
        );
        let body = "0 0 0 51\n1 0 0 51\n0 1 0 51\n3 0 1 2 9\n";
        load_mesh(&[("a.ply", (header("ascii", &lines) + body).as_bytes())])
    };
    let (m, warnings, _) = with("uchar alpha").unwrap();
    assert_eq!(m.colors, [[1.0, 1.0, 1.0, 0.2]; 3]);
    assert_says(&warnings.join("\n"), "not drawn: red of face");
    let signed = square_text().replace("uchar red", "char red");
    let (_, warnings, _) = load(signed.replace("255 188", "-1 188").as_bytes()).unwrap();
    assert_says(&warnings.join("\n"), "outside of 0 … 1");
    let (_, warnings, _) = with("float confidence").unwrap();
    assert_says(
        &warnings.join("\n"),
        "not drawn: confidence of vertex, red of face",
    );
    assert_refused(with("uchar red"), "some of red, green and blue");
}

/// Split vertices keep one normal; triangles without area and faces of two vertices are left out, and counted.
#[test]
fn seams_and_degenerate_faces() {
    let lines = "element vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
        element face 4\nproperty list uchar int vertex_indices\n";
    let body = "0 0 0\n1 0 0\n1 1 0\n0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n3 3 5 4\n3 0 3 1\n2 0 1\n";
    let (m, warnings, _) = load_text(&header("ascii", lines), body);
    assert_eq!(m.triangles.len(), 2);
    assert_eq!((m.normals[0], m.normals[1]), (m.normals[3], m.normals[4]));
    let words = "1 triangle without area & 1 face of fewer than 3";
    assert_says(&warnings.join("\n"), words);
}

/// What of the square is replaced by what, and words of the error.
const BAD: &str = "
ascii => utf => a.ply:2 & header
format => comment => header
uchar green => uchar red => twice
float y => float w => no 'y'
vertex_indices => indices => face & no vertex_indices
int vertex => float vertex => a.ply:19 & 'face'
element vertex 4 => element vertex 1152921504606846976 => 1152921504606846976 & 'vertex' & cut off
element face 1 => element face 1152921504606846976 => 1152921504606846976 & 'face' & cut off
element vertex 4 => element vertex 18446744073709551616 => a.ply:4
element face 1 => element face 2 => 'face' & cut off
element face 1 => element face 0 => 4 points & point cloud & reconstruct
1 1 0 => 1 nan 0 => a.ply:17 & 'vertex'
1 1 0 => 1 1e99 0 => vertex 2 & finite
1 1 0 => 1 2e15 0 => vertex 2 & farther than
4 0 1 2 3 => 4 0 1 2 4 => face 0 & index 4 & 4 vertices
4 0 1 2 3 => 4 0 1 2 -1 => face 0 & index -1
4 0 1 2 3 => 9 0 1 2 3 => a.ply:19 & 'face'
4 0 1 2 3 => 3 0 1 2 3 => a.ply:19 & 'face' & more values
0 1 0 255 188 0 255 => 0 1 0 255 188 0 255 7 => a.ply:18 & 'vertex' & more values
element vertex 4 => element vertex 3 => a.ply:18 & 'face' & more values
4 0 1 2 3 => 3 0 1 1 => no triangle with an area
ply => obj => a.ply:1 & begin with 'ply'
end_header => end => end_header & cut off
";

/// Every bad file is one error that names the file, the place and a fix, and takes no memory first.
#[test]
fn bad_files() {
    assert_all_refused(BAD, |change| {
        let (old, new) = change.split_once(" => ").unwrap();
        let loaded = load(square_text().replacen(old, new, 1).as_bytes());
        loaded.inspect_err(|e| assert!(e.starts_with("a.ply"), "{e}"))
    });
}

/// Wherever a file is cut off, it is an error that says so.
#[test]
fn truncated_files() {
    for whole in [square_binary(false), square_binary(true)] {
        for length in 0..whole.len() {
            assert_refused(load(&whole[..length]), "a.ply");
        }
    }
    // A list as long as 32 bits can say.
    let lines = SQUARE.replace("list uchar int", "list uint int");
    let mut bytes = header("binary_little_endian", &lines).into_bytes();
    bytes.extend([0; 4 * 16]);
    bytes.extend([255; 16]);
    assert_refused(load(&bytes), "a.ply & face & cut off");
    // Elements without properties take no bytes, however many there are.
    let none = format!("element nothing {}\n", u64::MAX);
    let text = square_text().replace("element vertex", &format!("{none}element vertex"));
    assert!(load(text.as_bytes()).is_ok());
}
