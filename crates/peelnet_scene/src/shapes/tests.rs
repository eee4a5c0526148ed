//! Generated shapes: closed, facing outwards, of the right volume.

use super::*;
use crate::{
    material::Lighting,
    mesh::{edges_of, is_closed},
};
use std::collections::HashSet;

pub(crate) fn build(text: &str) -> Mesh {
    let shape: Shape = toml::from_str(text).expect(text);
    let built = shape.build(&Material::default_with(Lighting::Unlit), true);
    built.expect(text)
}

fn volume(mesh: &Mesh) -> f64 {
    let cone = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        f64::from(a.dot(b.cross(c))) / 6.0
    };
    mesh.triangles.iter().map(cone).sum()
}

const LATHE: &str = "shape = 'lathe'\noffset = 0.05\nprofile = [[0, -1], [0.6, -1], [0.9, 0], [0.4, 0.8], [0.5, 1], [0.3, 0.8], [0.7, 0], [0, -0.8]]";

/// Every edge belongs to two triangles, once each way; V − E + F is the surface's Euler characteristic. No triangle is stretched over the
/// seam, none is mirrored, and textures stand upright: v falls where y rises, on the outside.
#[test]
fn closed_shapes_are_watertight_face_outwards_and_are_unwrapped() {
    for (name, euler) in [
        ("shape = 'sphere'", 2),
        ("shape = 'torus'", 0),
        ("shape = 'box'\nsize = [1, 2, 3]", 2),
        ("shape = 'capsule'", 2),
        ("shape = 'bumpy'\nseed = 3\namplitude = 0.4", 2),
        ("shape = 'cup'", 2),
        (LATHE, 2),
    ] {
        let mesh = build(name);
        assert!(is_closed(&mesh), "{name} is open");
        let edges = edges_of(&mesh);
        let vertices: HashSet<_> = edges.keys().map(|[from, _]| from).collect();
        let counts = [vertices.len(), edges.len() / 2, mesh.triangles.len()];
        let [v, e, f] = counts.map(|n| n as i64);
        assert_eq!(v - e + f, euler, "{name}");
        assert!(volume(&mesh) > 0.0, "{name} is turned inside out");
        for n in &mesh.normals {
            assert!((n.length() - 1.0).abs() < 1e-5, "{name}: normal {n}");
        }
        assert_eq!(mesh.uvs.len(), mesh.triangles.len(), "{name}");
        for (uv, t) in mesh.uvs.iter().zip(&mesh.triangles) {
            let [a, b, c] = *uv;
            // v runs down: what turns left on the surface turns right on the texture.
            let area = (b - a).perp_dot(c - a);
            assert!(area < 0.0, "{name}: {uv:?}");
            for axis in 0..2 {
                let all = uv.map(|p| p[axis]);
                let spread = all.iter().fold(0f32, |m, x| m.max((x - all[0]).abs()));
                assert!(spread <= 0.5 || spread == 1.0, "{name}: {uv:?} of {t:?}");
            }
        }
    }
}

/// An inscribed grid of n segments misses about (2π/n)²/6 of a circle's area. The thesis's models have 11,102 triangles; the figures we compare
/// with, 10,950.
#[test]
fn volumes_and_counts_are_those_asked() {
    let pi = std::f64::consts::PI;
    for (text, want) in [
        ("shape = 'sphere'", 4.0 / 3.0 * pi),
        ("shape = 'torus'\nradius = 2\ntube = 0.5", pi * pi),
        ("shape = 'capsule'\nradius = 1\nheight = 2", 10.0 / 3.0 * pi),
        (
            "shape = 'cup'\nthickness = 0.25",
            pi * (2.0 - 0.5625 * 1.75),
        ),
        ("shape = 'bumpy'\namplitude = 0", 4.0 / 3.0 * pi),
    ] {
        for n in [10_950, 11_100, 40_000] {
            let mesh = build(&format!("{text}\ntriangles = {n}"));
            let off = mesh.triangles.len() as f64 / f64::from(n) - 1.0;
            assert!(off.abs() < 0.03, "{text}: {} for {n}", mesh.triangles.len());
            let v = volume(&mesh);
            let is_close = (v / want - 1.0).abs() < 2e-3;
            assert!(is_close || n < 40_000, "{text}: {v} for {want}");
        }
    }
    let cuboid = volume(&build("shape = 'box'\nsize = [1, 2, 3]"));
    assert!((cuboid - 6.0).abs() < 1e-5, "{cuboid}");
}

/// Strands are as many as asked, no longer than asked, never inside the head, and hang down where they droop.
#[test]
fn strands_grow_out_of_the_sphere_and_hang_down() {
    const TEXT: &str = "shape = 'strands'\nradius = 0.8\ncount = 40\nsegments = 12\nlength = 1.5\nwidth = 0.02\nroots = 0.1\ncurl = 0.3";
    let mesh = build(&format!("{TEXT}\ndroop = 2.0"));
    assert_eq!(mesh.triangles.len(), 40 * 12 * 2);
    assert_eq!(mesh.uvs.len(), mesh.triangles.len());
    let middles = |mesh: &Mesh| -> Vec<Vec3> {
        let pairs = mesh.positions.chunks(2);
        pairs.map(|p| (p[0] + p[1]) / 2.0).collect()
    };
    let course = middles(&mesh);
    // Rounding of a few sums of lengths near 1.
    const ROUNDING: f32 = 1e-5;
    for p in &course {
        assert!(p.length() >= 0.8 * 1.02 - ROUNDING, "{p}");
    }
    for (strand, pairs) in course.chunks(13).zip(mesh.positions.chunks(26)) {
        assert!(strand[0].y >= 0.8 * 1.02 * 0.1 - ROUNDING, "{}", strand[0]);
        let length: f32 = strand.windows(2).map(|w| w[0].distance(w[1])).sum();
        assert!(length <= 1.5 + ROUNDING, "{length}");
        let width = |k: usize| pairs[2 * k].distance(pairs[2 * k + 1]);
        assert!((width(0) - 0.02).abs() < ROUNDING && (width(12) - 0.02 / 3.0).abs() < ROUNDING);
    }
    for n in &mesh.normals {
        assert!((n.length() - 1.0).abs() < ROUNDING, "{n}");
    }
    let height = |course: &[Vec3]| course.iter().map(|p| p.y).sum::<f32>() / course.len() as f32;
    let straight = middles(&build(&format!("{TEXT}\ndroop = 0.0")));
    assert!(height(&course) < height(&straight) - 0.3);
}

/// Land faces up, has the extent that is asked, and repeats with its seed.
#[test]
fn terrain_faces_up_within_its_box() {
    let text = |seed| {
        format!("shape = 'terrain'\nsize = [4, 2]\nheight = 0.7\nseed = {seed}\ntriangles = 5000")
    };
    let mesh = build(&text(3));
    let off = mesh.triangles.len() as f64 / 5000.0 - 1.0;
    assert!(off.abs() < 0.03, "{}", mesh.triangles.len());
    let (low, high) = mesh.bounds().expect("has vertices");
    let off = high - low - Vec3::new(4.0, 0.7, 2.0);
    assert!(off.abs().max_element() < 1e-5, "{off}");
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        assert!((b - a).cross(c - a).y > 0.0);
    }
    assert!(mesh.normals.iter().all(|n| n.y > 0.0));
    assert_eq!(mesh.positions, build(&text(3)).positions);
    assert_ne!(mesh.positions, build(&text(4)).positions);
}

/// Splats of a shape are those of its seed, flat along their normals and mostly faint, and their colours are those that a display has.
#[test]
fn splats_are_as_captures_have_them() {
    let mesh = build("shape = 'splats'\ndegree = 2\nseed = 3");
    assert_eq!(mesh, build("shape = 'splats'\ndegree = 2\nseed = 3"));
    assert_ne!(mesh, build("shape = 'splats'\ndegree = 2"));
    assert_eq!(mesh.parts[0].material, Material::unlit([1.0; 3], 1.0));
    let splats = mesh.splats.as_ref().expect("splats");
    assert_eq!(mesh.positions.len(), 2000);
    assert_eq!(splats.harmonics.len(), 2000 * 9);
    let inside = mesh.positions.iter().filter(|p| p.length() < 1.2).count();
    assert!((1960..2000).contains(&inside), "{inside}");
    assert!(splats.opacities.iter().all(|a| (0.05..=0.99).contains(a)));
    let mean = splats.opacities.iter().sum::<f32>() / 2000.0;
    assert!((0.35..0.5).contains(&mean), "{mean}");
    for (i, scale) in splats.scales.iter().enumerate() {
        assert!(scale.z <= 0.5 * scale.y && splats.rotations[i].is_normalized());
        let color = splats.harmonics[9 * i].map(|c| 0.5 + crate::CONSTANT_HARMONIC * c);
        assert!(color.iter().all(|c| (0.0..=1.0).contains(c)), "{color:?}");
    }
    for (text, words) in [
        ("count = 0", "count 0 must lie in 1 … 20000000"),
        ("degree = 4", "degree 4"),
        ("size = 0.0", "size 0"),
        ("opacity = 2.0", "opacity"),
    ] {
        let shape: Shape = toml::from_str(&format!("shape = 'splats'\n{text}")).expect(text);
        let e = shape.build(&Material::unlit([1.0; 3], 1.0), false);
        let e = e.expect_err(text);
        assert!(e.contains(words), "{e}");
    }
}
