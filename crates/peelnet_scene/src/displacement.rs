//! Displacement maps: at load, a mesh is cut finer and moved along its normals by the luminance of a texture. Passes draw what results, and
//! know nothing of it.

#[cfg(test)]
mod tests;

use crate::{
    budget::{Budget, MAX_CUT},
    material::Material,
    mesh::{Mesh, area_of, key_of},
    texture::{Displacement, Texture, Wrap},
};
use glam::{DVec3, Quat, Vec2, Vec3};
use std::{collections::HashMap, sync::Arc};

/// How often a triangle is cut at most: into a million.
pub(crate) const MAX_LEVEL: u32 = 10;

/// Most triangles that are made where nothing says how often they are cut.
const MAX_DISPLACED: u64 = 4_000_000;

/// How often a triangle is cut at most where nothing says how often.
const MOST_CUTS: u32 = 6;

/// Lengths beyond this overflow when they are squared.
const LONGEST: f32 = 1e15;

/// A texture's luminance between its four nearest texels, which hold heights and no light: its bytes are linear.
fn luminance(map: &Texture, uv: Vec2, wrap: [Wrap; 2]) -> f32 {
    let size = map.size.map(|n| n as f32);
    // The first texel's centre is half a texel from the edge.
    let place = (uv * Vec2::from(size) - 0.5).clamp(Vec2::splat(-1e9), Vec2::splat(1e9));
    let first = place.floor();
    let part = place - first;
    let value = |dx: i64, dy: i64| {
        let x = wrapped(first.x as i64 + dx, map.size[0], wrap[0]);
        let y = wrapped(first.y as i64 + dy, map.size[1], wrap[1]);
        let [r, g, b, _] = map.texels[y * map.size[0] as usize + x].map(u32::from);
        // In whole numbers, so that grey stays as it is (Rec. 709).
        (2126 * r + 7152 * g + 722 * b) as f32 / (10_000.0 * 255.0)
    };
    let across = |dy: i64| {
        let [a, b] = [value(0, dy), value(1, dy)];
        a + part.x * (b - a)
    };
    let [top, bottom] = [across(0), across(1)];
    top + part.y * (bottom - top)
}

/// The texel that stands for one beyond the edges.
fn wrapped(i: i64, n: u32, wrap: Wrap) -> usize {
    let n = i64::from(n.max(1));
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * n);
            i.min(2 * n - 1 - i)
        }
    };
    i as usize
}

/// How often a mesh's triangles are cut: all alike, as finer parts beside coarser ones would leave cracks.
fn level(mesh: &Mesh, materials: &[Material]) -> u32 {
    let mut level = 0;
    let mut automatic = 0;
    for (part, material) in mesh.parts.iter().zip(materials) {
        let Some(displacement) = &material.maps.displacement else {
            continue;
        };
        if let Some(given) = displacement.level {
            level = level.max(given);
            continue;
        }
        let size = Vec2::from(displacement.map.size.map(|n| n as f32));
        let uvs = mesh.uvs.get(part.triangles.clone()).unwrap_or_default();
        let edges = uvs.iter().flat_map(|[a, b, c]| [a - b, b - c, c - a]);
        let longest = edges.map(|edge| (edge * size).length()).fold(0.0, f32::max);
        while automatic < MOST_CUTS && longest > (2 << automatic) as f32 {
            automatic += 1;
        }
    }
    let triangles = mesh.triangles.len() as u64;
    while automatic > 0 && triangles << (2 * automatic) > MAX_DISPLACED {
        automatic -= 1;
    }
    level.max(automatic)
}

/// Takes what a mesh cut so often needs.
fn take(mesh: &Mesh, level: u32, budget: &mut Budget) -> Result<(), String> {
    if level > MAX_LEVEL {
        return Err(format!(
            "displacement_level {level} must lie in 0 … {MAX_LEVEL}"
        ));
    }
    let all = mesh.triangles.len() as u64;
    let triangles = all << (2 * level);
    // A cut has a middle for each edge, of which there are at most three to a triangle: the sum over all cuts.
    let vertices = mesh.positions.len() as u64 + triangles - all;
    let cut = budget.take_cut(triangles - all);
    let taken = cut.and_then(|()| budget.take_mesh(triangles, vertices));
    taken.map_err(|e| {
        let fits = (0..level).rev().find(|l| (all << (2 * l)) - all <= MAX_CUT);
        let fix = fits.map_or_else(String::new, |l| {
            format!(", with a displacement_level of {l} or less")
        });
        format!("cuts {all} triangles {level} times: {e}{fix}")
    })
}

/// A mesh moved by the displacements of its materials, one for each part, which they have no more.
///
/// Vertices at one position move alike, along the mean of their normals and by the mean of their heights, each weighted by the angle of
/// its triangle there: seams of normals and of textures do not open. Normals lean as the surface does: each turns as the mean of the
/// triangles around it turns, so edges stay sharp and round surfaces round.
pub(crate) fn displaced(
    mesh: Arc<Mesh>,
    materials: &mut [Material],
    budget: &mut Budget,
) -> Result<Arc<Mesh>, String> {
    let displacements = || {
        materials
            .iter()
            .filter_map(|m| m.maps.displacement.as_ref())
    };
    if displacements().next().is_none() {
        return Ok(mesh);
    }
    let is_large = |d: &&Displacement| !(d.scale.abs() <= LONGEST && d.middle.abs() <= LONGEST);
    if let Some(Displacement { scale, middle, .. }) = displacements().find(is_large) {
        return Err(format!(
            "a displacement of {scale} about {middle} is too large"
        ));
    }
    let level = level(&mesh, materials);
    take(&mesh, level, budget)?;
    let mut cut = (*mesh).clone();
    for _ in 0..level {
        cut = cut.subdivided();
    }
    let moves = moves(&cut, materials);
    let moved = |p: &Vec3| *p + moves.get(&key_of(*p)).copied().unwrap_or_default();
    let positions: Vec<Vec3> = cut.positions.iter().map(moved).collect();
    if positions.iter().any(|p| !p.is_finite()) {
        return Err("a vertex moves too far; make displacement_scale smaller".into());
    }
    cut.normals = leaning(&cut, &positions);
    cut.positions = positions;
    let of_parts = cut.parts.iter_mut().map(|part| &mut part.material);
    for material in of_parts.chain(materials) {
        material.maps.displacement = None;
    }
    Ok(Arc::new(cut))
}

/// How far each position moves that does.
fn moves(mesh: &Mesh, materials: &[Material]) -> HashMap<[u32; 3], Vec3> {
    // Sums over the triangles around a position: normals and heights by their angles, and the angles.
    let mut all: HashMap<[u32; 3], (DVec3, f64, f64)> = HashMap::new();
    for (part, material) in mesh.parts.iter().zip(materials) {
        let displacement = material.maps.displacement.as_ref();
        for t in part.triangles.clone() {
            let triangle = mesh.triangles[t].map(|i| i as usize);
            for k in 0..3 {
                let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3].map(|k| mesh.positions[triangle[k]]);
                let angle = f64::from((b - a).angle_between(c - a));
                // A triangle without area has no angles.
                if !angle.is_finite() {
                    continue;
                }
                let uv = mesh.uvs.get(t).map(|uvs| uvs[k]);
                let height = displacement.zip(uv).map_or(0.0, |(d, uv)| {
                    d.scale * (luminance(&d.map, uv, material.maps.wrap) - d.middle)
                });
                let around = all.entry(key_of(a)).or_default();
                around.0 += mesh.normals[triangle[k]].as_dvec3() * angle;
                around.1 += f64::from(height) * angle;
                around.2 += angle;
            }
        }
    }
    let moved = all.into_iter().filter(|(_, (_, height, _))| *height != 0.0);
    let by = |(key, (normal, height, angle)): (_, (DVec3, f64, f64))| {
        let by = normal.normalize_or_zero() * (height / angle);
        (key, by.as_vec3())
    };
    moved.map(by).collect()
}

/// The normals of a mesh whose vertices move. Vertices of one position and normal are one: a seam of its texture does not split a surface.
fn leaning(mesh: &Mesh, moved: &[Vec3]) -> Vec<Vec3> {
    let key = |i: u32| {
        let i = i as usize;
        (key_of(mesh.positions[i]), key_of(mesh.normals[i]))
    };
    let mut sums: HashMap<_, [Vec3; 2]> = HashMap::new();
    for t in &mesh.triangles {
        let areas = [area_of(&mesh.positions, *t), area_of(moved, *t)];
        for &i in t {
            let sum = sums.entry(key(i)).or_default();
            *sum = [sum[0] + areas[0], sum[1] + areas[1]];
        }
    }
    let turned = |i: u32| {
        let normal = mesh.normals[i as usize];
        let [before, after] = sums.get(&key(i)).copied().unwrap_or_default();
        if before == after {
            return normal;
        }
        let ends = before.try_normalize().zip(after.try_normalize());
        let turned = ends.map(|(a, b)| Quat::from_rotation_arc(a, b) * normal);
        turned.and_then(Vec3::try_normalize).unwrap_or(normal)
    };
    (0..mesh.normals.len() as u32).map(turned).collect()
}
