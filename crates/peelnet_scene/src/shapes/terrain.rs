//! Land.

use super::{Surface, count, length, surfaces::Waves, unwrap::Unwrap};
use crate::mesh::smooth_normals;
use glam::{Vec2, Vec3};

/// Octaves of ridges, each twice as fine as the one before and so much lower.
const OCTAVES: usize = 5;
const FALL: f32 = 0.45;

/// A grid of squares over the xz plane with ridged noise as its height (after Musgrave, in Ebert et al., "Texturing and Modeling",
/// 1994), facing up.
///
/// # Errors
/// A text that names the parameter out of range and its bounds.
pub(super) fn build(
    size: [f32; 2],
    height: f32,
    seed: u64,
    triangles: usize,
) -> Result<(Surface, Unwrap), String> {
    for s in size {
        length("size", s)?;
    }
    length("height", height)?;
    // Squares whose number comes nearest to half of the triangles.
    let squares = count(triangles)? as f32 / 2.0;
    let nx = ((squares * size[0] / size[1]).sqrt().round() as usize).clamp(1, triangles / 2);
    let nz = ((squares / nx as f32).round() as usize).max(1);
    let octaves: Vec<Waves> = (0..OCTAVES as u64)
        .map(|k| Waves::new(seed.wrapping_add(k)))
        .collect();
    let mut uvs = Vec::with_capacity((nx + 1) * (nz + 1));
    for z in 0..=nz {
        for x in 0..=nx {
            uvs.push(Vec2::new(x as f32 / nx as f32, z as f32 / nz as f32));
        }
    }
    let heights: Vec<f32> = uvs.iter().map(|&uv| ridges(&octaves, uv)).collect();
    let (low, high) = heights
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), &h| {
            (a.min(h), b.max(h))
        });
    let positions: Vec<Vec3> = uvs
        .iter()
        .zip(&heights)
        .map(|(uv, h)| {
            let y = (h - low) / (high - low).max(f32::MIN_POSITIVE) - 0.5;
            Vec3::new((uv.x - 0.5) * size[0], y * height, (uv.y - 0.5) * size[1])
        })
        .collect();
    let at = |x: usize, z: usize| (z * (nx + 1) + x) as u32;
    let mut triangles = Vec::with_capacity(2 * nx * nz);
    for z in 0..nz {
        for x in 0..nx {
            let (a, b) = (at(x, z), at(x + 1, z));
            let (c, d) = (at(x, z + 1), at(x + 1, z + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    let normals = smooth_normals(&positions, &triangles);
    Ok(((positions, normals, triangles), Unwrap::Vertices(uvs)))
}

fn ridges(octaves: &[Waves], uv: Vec2) -> f32 {
    let (mut sum, mut weight, mut scale) = (0.0, 1.0, 1.0);
    for waves in octaves {
        let p = Vec3::new(uv.x * 2.0 - 1.0, 0.0, uv.y * 2.0 - 1.0) * scale;
        let ridge = 1.0 - waves.at(p).abs();
        sum += weight * ridge * ridge;
        weight *= FALL;
        scale *= 2.0;
    }
    sum
}
