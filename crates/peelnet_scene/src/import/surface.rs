//! Surfaces of OBJ, PLY and STL files, as meshes; files of splats are loaded in the same way.

use super::Imported;
use crate::{
    error::{SceneError, shown},
    files::{Files, MAX_MESH},
    material::Material,
    mesh::{Mesh, area_of, key_of},
    warnings::Warnings,
};
use glam::{Vec2, Vec3};
use peelnet_core::files::counted;
use std::{collections::HashMap, path::Path};

/// Positions beyond this overflow when they are squared.
const FARTHEST: f32 = 1e15;

/// Reads a file without materials, whose triangles `surface` finds.
pub(super) fn load(
    path: &Path,
    files: &mut Files<'_>,
    surface: impl FnOnce(&Path, &[u8], &mut Files<'_>) -> Result<Mesh, Fault>,
) -> Result<Imported, SceneError> {
    let bytes = files.read(path, MAX_MESH)?;
    let mesh = surface(path, &bytes, files).and_then(|mut surface| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let material = surface.material(path, files);
        let part = (name.into_owned(), material, surface);
        assemble(vec![part], path, &mut files.warnings).map_err(in_file)
    });
    let mesh = mesh.map_err(|(line, message)| SceneError::file(path, line, message))?;
    Ok(Imported {
        is_y_down: mesh.splats.is_some(),
        mesh,
        ..Imported::default()
    })
}

/// The line, from 1, in a file that has lines, and what is wrong there.
pub(super) type Fault = (Option<usize>, String);

pub(super) fn in_file(message: impl Into<String>) -> Fault {
    (None, message.into())
}

/// Warns of bytes or lines that a file's own counts leave out.
pub(super) fn warn_of_rest(files: &mut Files<'_>, path: &Path, rest: u64, unit: &str, last: &str) {
    if rest > 0 {
        let rest = counted(rest, unit);
        files.warn(path, &format!("not read: {rest} behind its last {last}"));
    }
}

pub(super) fn fault_of(position: Vec3) -> Option<String> {
    if !position.is_finite() {
        return Some("is not finite".into());
    }
    let is_far = position.abs().max_element() > FARTHEST;
    is_far.then(|| format!("lies farther than {FARTHEST:e} from the origin"))
}

impl Mesh {
    /// An opaque light grey material, which is white under vertex colours; of splats, which have colours and opacities of their own, a white one.
    fn material(&mut self, path: &Path, files: &mut Files<'_>) -> Material {
        if self.splats.is_some() {
            return Material::unlit([1.0; 3], 1.0);
        }
        let mut material = Material::default_with(files.lighting);
        if self.colors.is_empty() {
            return material;
        }
        material.color = [1.0; 3];
        if self.colors.iter().all(|c| c[3] == 0.0) {
            let message = "every vertex has an opacity of 0, which is taken as 1";
            files.warn(path, message);
            self.colors.iter_mut().for_each(|c| c[3] = 1.0);
        }
        material.blend = self.colors.iter().any(|c| c[3] < 1.0);
        material
    }

    /// Drops triangles without area, but not those of splats: exactly zero, as a sliver is a triangle. Returns how many.
    pub(super) fn drop_degenerate(&mut self) -> usize {
        if self.splats.is_some() {
            return 0;
        }
        let all = self.triangles.len();
        let has_area = |t: &[u32; 3]| area_of(&self.positions, *t) != Vec3::ZERO;
        if self.triangles.iter().all(has_area) {
            return 0;
        }
        let mut triangles = self.triangles.iter();
        self.uvs.retain(|_| triangles.next().is_some_and(has_area));
        let triangles = std::mem::take(&mut self.triangles);
        self.triangles = triangles.into_iter().filter(has_area).collect();
        all - self.triangles.len()
    }
}

/// Smooth normals by position: vertices that are split have one.
fn normals_by_position(parts: &[(String, Material, Mesh)]) -> HashMap<[u32; 3], Vec3> {
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    for (_, _, surface) in parts {
        for t in &surface.triangles {
            let area = area_of(&surface.positions, *t);
            for &i in t {
                let key = key_of(surface.positions[i as usize]);
                *sums.entry(key).or_default() += area;
            }
        }
    }
    for sum in sums.values_mut() {
        *sum = sum.normalize_or(Vec3::Z);
    }
    sums
}

/// The mesh of all parts, of which each may lack anything but positions: without triangles that have no area, and with computed normals where a part has none or zeros. Parts split
/// vertices, but not the surface: computed normals are those of all triangles around a position.
pub(super) fn assemble(
    mut parts: Vec<(String, Material, Mesh)>,
    path: &Path,
    warnings: &mut Warnings,
) -> Result<Mesh, String> {
    let file = format!("{}: ", shown(path));
    let [mut lost_triangles, mut lost_normals, mut lost_uvs] = [0; 3];
    for (_, _, surface) in &mut parts {
        lost_triangles += surface.drop_degenerate();
        for normal in &mut surface.normals {
            *normal = normal.try_normalize().unwrap_or_default();
            lost_normals += usize::from(*normal == Vec3::ZERO);
        }
        let uvs = surface.uvs.iter_mut().flatten();
        for uv in uvs.filter(|uv| !uv.is_finite()) {
            *uv = Vec2::ZERO;
            lost_uvs += 1;
        }
    }
    parts.retain(|(_, _, surface)| !surface.triangles.is_empty());
    let is_incomplete = |(_, _, s): &(_, _, Mesh)| s.normals.len() < s.positions.len();
    let mut smooth = HashMap::new();
    if lost_normals > 0 || parts.iter().any(is_incomplete) {
        smooth = normals_by_position(&parts);
    }
    let mut mesh = Mesh::default();
    for (name, material, mut surface) in parts {
        let n = surface.positions.len();
        surface.normals.resize(n, Vec3::ZERO);
        for (normal, position) in surface.normals.iter_mut().zip(&surface.positions) {
            if *normal == Vec3::ZERO {
                *normal = smooth.get(&key_of(*position)).copied().unwrap_or(Vec3::Z);
            }
        }
        mesh.append(surface.into_part(name, material), &file, warnings);
    }
    for (count, what, why) in [
        (lost_uvs, "UV", "that is not finite is taken as 0"),
        (lost_triangles, "triangle", "without area left out"),
        (
            lost_normals,
            "normal",
            "without a direction computed from the triangles",
        ),
    ] {
        if count > 0 {
            let count = counted(count as u64, what);
            warnings.add(format!("{file}{count} {why}"));
        }
    }
    if mesh.triangles.is_empty() {
        return Err("holds no triangle with an area; export the mesh again".into());
    }
    Ok(mesh)
}
