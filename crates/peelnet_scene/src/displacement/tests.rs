//! Surfaces whose displacement is known.

use super::*;
use crate::{
    mesh::{Part, is_closed},
    shapes::tests::build,
};

fn material(map: Texture, scale: f32, level: Option<u32>) -> Material {
    let mut material = Material::unlit([1.0; 3], 0.5);
    material.maps.displacement = Some(Displacement {
        map: Arc::new(map),
        scale,
        middle: 0.0,
        level,
    });
    material
}

fn white() -> Texture {
    Texture::of("white", [4, 4], |_, _| [255; 4])
}

fn noise() -> Texture {
    Texture::of("noise", [16, 16], |x, y| {
        let v = (x * 37 + y * 91 + x * y * 13) % 256;
        [v as u8, v as u8, v as u8, 255]
    })
}

fn try_moved(mesh: &Mesh, materials: &[Material]) -> Result<Mesh, String> {
    let (mesh, mut materials) = (Arc::new(mesh.clone()), materials.to_vec());
    let moved = displaced(mesh, &mut materials, &mut Budget::default())?;
    assert!(materials.iter().all(|m| m.maps.displacement.is_none()));
    Ok((*moved).clone())
}

fn moved(mesh: &Mesh, material: &Material) -> Mesh {
    try_moved(mesh, &vec![material.clone(); mesh.parts.len()]).expect("fits")
}

/// A square of two units whose texture coordinates are from a to b.
fn square(a: f32, b: f32) -> Mesh {
    let mut mesh = build("shape = 'quad'");
    for uv in mesh.uvs.iter_mut().flatten() {
        *uv = Vec2::new(a + (b - a) * uv.x, 0.25 + 0.5 * uv.y);
    }
    mesh
}

/// A plane under a white map moves by exactly the scale, under a green one by its luminance.
#[test]
fn constant_maps_move_planes() {
    let plane = moved(&square(0.0, 1.0), &material(white(), 0.375, Some(2)));
    assert_eq!(plane.triangles.len(), 32);
    assert_eq!(plane.parts[0].triangles, 0..32);
    assert_eq!(plane.uvs.len(), 32);
    assert!(plane.positions.iter().all(|p| p.z == 0.375));
    assert!(plane.normals.iter().all(|n| *n == Vec3::Z));
    assert!(plane.parts[0].material.maps.displacement.is_none());
    let green = Texture::of("green", [1, 1], |_, _| [0, 255, 0, 255]);
    let plane = moved(&square(0.0, 1.0), &material(green, 1.0, Some(0)));
    assert!(plane.positions.iter().all(|p| p.z == 0.7152));
}

/// The map rises by 1 / 255 a texel over half of its 256 texels, so the plane by scale × 128 / 255 over its two units.
#[test]
fn ramps_have_their_slope() {
    let ramp = Texture::of("ramp", [256, 1], |x, _| [x as u8, x as u8, x as u8, 255]);
    let scale = 3.0;
    let plane = moved(&square(0.25, 0.75), &material(ramp, scale, Some(5)));
    let slope = scale * 128.0 / 255.0 / 2.0;
    let expected = Vec3::new(-slope, 0.0, 1.0).normalize();
    for (p, n) in plane.positions.iter().zip(&plane.normals) {
        assert!((*n - expected).length() < 1e-4, "{n} is not {expected}");
        let height = scale * 127.5 / 255.0 + slope * p.x;
        assert!((p.z - height).abs() < 1e-5, "{p}");
    }
}

/// A cube's faces have normals of their own; it stays closed, its corners move along its diagonals, and its edges stay sharp.
#[test]
fn closed_surfaces_stay_closed() {
    let cube = build("shape = 'box'");
    assert!(is_closed(&cube));
    let large = moved(&cube, &material(white(), 0.3, Some(3)));
    assert!(is_closed(&large));
    let corner = 1.0 + 0.3 / 3f32.sqrt();
    let (low, high) = large.bounds().expect("has vertices");
    // Flat faces move by the whole scale, edges by its share along them.
    assert!((high.x - 1.3).abs() < 1e-6 && (low.y + 1.3).abs() < 1e-6);
    let positions = large.positions.iter();
    let at_corner: Vec<_> = positions.filter(|p| p.abs().min_element() > 1.15).collect();
    assert_eq!(at_corner.len(), 24);
    for p in at_corner {
        assert!((p.abs() - Vec3::splat(corner)).length() < 1e-6, "{p}");
    }
    for mesh in [cube, build("shape = 'sphere'\ntriangles = 500")] {
        let bumpy = moved(&mesh, &material(noise(), 0.1, Some(2)));
        assert!(is_closed(&bumpy) == is_closed(&mesh));
        let mut normals = bumpy.normals.iter();
        assert!(normals.all(|n| (n.length() - 1.0).abs() < 1e-5));
        assert_ne!(bumpy.bounds(), mesh.bounds());
    }
}

/// A sphere that grows keeps its round normals, though its triangles are flat.
#[test]
fn round_surfaces_stay_round() {
    let sphere = build("shape = 'sphere'");
    let large = moved(&sphere, &material(white(), 0.5, Some(1)));
    for (p, n) in large.positions.iter().zip(&large.normals) {
        assert!((p.length() - 1.5).abs() < 0.01, "{p}");
        assert!(n.dot(p.normalize()) > 0.9995, "{n} at {p}");
    }
}

/// Where a part with a map meets one without, the positions that they share move by the mean.
#[test]
fn parts_without_maps_follow() {
    let mut mesh = square(0.0, 1.0);
    let second = Part {
        triangles: 1..2,
        ..mesh.parts[0].clone()
    };
    mesh.parts[0].triangles = 0..1;
    mesh.parts.push(second);
    let materials = [
        material(white(), 1.0, Some(0)),
        Material::unlit([1.0; 3], 0.5),
    ];
    let moved = try_moved(&mesh, &materials).expect("fits");
    // Corner 1 belongs to the first alone, corner 3 to the second; the others have half of their angle in either.
    let heights: Vec<f32> = moved.positions.iter().map(|p| p.z).collect();
    assert_eq!(heights, [0.5, 1.0, 0.5, 0.0]);
}

/// Of two texels for an edge, where nothing says how often; fewer cuts where there are many triangles.
#[test]
fn levels_are_bounded() {
    let automatic = |map| material(map, 0.1, None);
    // The diagonal spans 16 texels across and 8 down.
    let plane = moved(&square(0.0, 1.0), &automatic(noise()));
    assert_eq!(plane.triangles.len(), 2 << (2 * 4));
    let mesh = build("shape = 'sphere'\ntriangles = 100_000");
    let fine = Texture::of("fine", [4096, 4096], |_, _| [0; 4]);
    let level = level(&mesh, &[automatic(fine)]);
    assert!(mesh.triangles.len() << (2 * level) <= MAX_DISPLACED as usize);
    assert!(level == 2, "{level}");
    let e = try_moved(&mesh, &[material(white(), f32::INFINITY, Some(0))]).expect_err("too far");
    assert!(e.contains("too large"), "{e}");
}

/// What lies beyond the edges, and between texels.
#[test]
fn textures_are_sampled() {
    let steps = Texture::of("steps", [2, 1], |x, _| [(255 * x) as u8; 4]);
    let at = |u: f32, wrap: Wrap| luminance(&steps, Vec2::new(u, 0.5), [wrap; 2]);
    assert_eq!((at(0.25, Wrap::Clamp), at(0.75, Wrap::Clamp)), (0.0, 1.0));
    assert_eq!(at(0.5, Wrap::Clamp), 0.5);
    assert_eq!((at(1.0, Wrap::Repeat), at(1.0, Wrap::Mirror)), (0.5, 1.0));
    assert_eq!((at(9.0, Wrap::Clamp), at(-9.0, Wrap::Clamp)), (1.0, 0.0));
    assert_eq!(at(1.25, Wrap::Mirror), 1.0);
    assert!(at(f32::MAX, Wrap::Repeat).is_finite());
}
